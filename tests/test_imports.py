"""The graphs of files that test_architecture.py looks for circles in."""

from imports import circles, leaves, merged, rust_graph


def test_circles_are_found_through_others_and_folders():
    graph = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": set(), "f": {"f"}}
    assert circles(graph) == [{"a", "b", "c"}]
    assert circles(merged(graph, dict.fromkeys("abc", "one") | dict.fromkeys("def", "two"))) == []
    assert circles(merged(graph, {name: name in "ad" for name in graph})) == [{True, False}]


def test_a_use_is_of_the_file_that_defines_the_item(tmp_path):
    files = {
        "lib.rs": "mod arm; pub mod hand; pub use arm::Arm; pub use hand::{Hand, fingers::*};",
        "arm.rs": "use crate::{Hand, Finger}; pub struct Arm; // crate::hand::Palm",
        "hand/mod.rs": "mod palm; pub mod fingers; pub use palm::Palm; pub struct Hand(Palm);",
        "hand/palm.rs": "use super::Hand; pub struct Palm;",
        "hand/fingers.rs": "pub struct Finger; fn f() { crate::Arm; super::super::arm::g(); }",
    }
    for name, source in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(source, encoding="utf-8")
    assert rust_graph(tmp_path) == {
        "lib.rs": set(),
        "arm.rs": {"hand/mod.rs", "hand/fingers.rs"},
        "hand/mod.rs": {"hand/palm.rs"},
        "hand/palm.rs": {"hand/mod.rs"},
        "hand/fingers.rs": {"arm.rs"},
    }


def test_use_trees_are_read_whole():
    tree = "crate::{a::{self, B as C}, d::*,\n e}"
    assert dict(leaves(tree)) == {
        ("crate", "a"): "a",
        ("crate", "a", "B"): "C",
        ("crate", "d", "*"): "*",
        ("crate", "e"): "e",
    }
