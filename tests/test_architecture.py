"""Who may know whom: each test fails when a line of ARCHITECTURE.md's invariants is crossed."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from imports import circles, merged, python_graph, rust_graph

from gym_babble.envs.registry import ENVIRONMENTS, TASKS

# Each crate with the crates of ours that it may depend on. A new crate enters here first.
MAY_KNOW = {
    "babble_brain": set(),
    "babble_eye": set(),
    "babble_body": {"babble_eye"},
    "babble_env": {"babble_brain", "babble_eye", "babble_body"},
    "babble_agent": {"babble_brain", "babble_env"},
    "babble_golden": {"babble_body", "babble_env"},
    "babble_lab": {
        *("babble_brain", "babble_eye", "babble_body", "babble_env", "babble_agent"),
    },
    "babble_wasm": {"babble_env", "babble_lab"},
    "babble_bindgen": set(),
    "babble_server": {"babble_env"},
    "babble_py": {
        *("babble_brain", "babble_eye", "babble_body", "babble_env", "babble_agent"),
        *("babble_lab", "babble_server"),
    },
}

# Libraries that one crate alone may name, by their first letters (rapier3d, parry3d, numpy ...).
OWNERS = {
    "rapier": "babble_body",
    "parry": "babble_body",
    "pyo3": "babble_py",
    "numpy": "babble_py",
}

# What steps, shows and stores any task, and the words that belong to one of them.
SHARED = {
    "rust/babble_env/src": (
        "batch",
        "case",
        "erased",
        "option_spec",
        "outcome",
        "picture",
        "executor",
        "snapshot",
        "spec",
        "task",
    ),
    "gym_babble/envs": ("interface", "making", "member", "registry", "single", "vector", "window"),
}
OF_ONE_TASK = re.compile(
    r"(?i)\w*(reach|grasp)\w*|\b(is|ever)_success\b|\b(obstacle|target|control|b1)\b"
)

# The packages and modules of gym_babble: each may import those before it.
LAYERS = (
    *(
        "errors",
        "checks",
        "config",
        "progress",
        "files",
        "envs",
        "brain",
        "agents",
        "export",
        "remote",
        "sb3",
        "rllib",
    ),
    *("lab", "study", "viz", "paper", "report", "course", "cli"),
)

HEAVY_MODULES = {
    *("jinja2", "matplotlib", "msgspec", "pygame", "ray", "rich", "scipy", "stable_baselines3"),
    *("torch", "typer", "websockets"),
}


@pytest.fixture(scope="module")
def crates(repository: Path) -> dict[str, dict[str, Any]]:
    """The workspace's packages by name, as cargo reads them."""
    command = ["cargo", "metadata", "--no-deps", "--offline", "--format-version", "1"]
    run = subprocess.run(command, cwd=repository, check=True, capture_output=True, text=True)
    return {package["name"]: package for package in json.loads(run.stdout)["packages"]}


def dependencies(crate: dict[str, Any]) -> set[str]:
    """Names of all the crates that `crate` depends on, also in tests, benches and build scripts."""
    return {dependency["name"] for dependency in crate["dependencies"]}


def owner_of(library: str) -> str | None:
    return next((crate for prefix, crate in OWNERS.items() if library.startswith(prefix)), None)


def libraries_named(source: str) -> set[str]:
    """Libraries with an owner that Rust code names, comments and strings aside."""
    code = re.sub(r'"[^"\n]*"|//.*', "", source)
    return set(re.findall(rf"\b(?:{'|'.join(OWNERS)})\w*", code))


def test_each_crate_knows_only_those_below_it(crates):
    ours = {name: dependencies(crate) & crates.keys() for name, crate in crates.items()}
    too_much = {name: known - MAY_KNOW[name] for name, known in ours.items()}
    assert not {name: known for name, known in too_much.items() if known}


def test_each_engine_and_binding_has_one_owner_among_the_dependencies(crates):
    strangers = {
        (name, library)
        for name, crate in crates.items()
        for library in dependencies(crate)
        if owner_of(library) not in {None, name}
    }
    assert not strangers


def test_each_engine_and_binding_is_named_in_its_owners_sources_alone(crates, repository):
    # Dependencies do not show a library that another crate re-exports; sources do.
    strangers = {
        (str(path.relative_to(repository)), library)
        for name in crates
        for path in (repository / "rust" / name).rglob("*.rs")
        for library in libraries_named(path.read_text(encoding="utf-8"))
        if owner_of(library) != name
    }
    assert not strangers


@pytest.mark.parametrize(
    "path", [f"{folder}/{name}" for folder, names in SHARED.items() for name in names]
)
def test_shared_code_knows_no_task(repository, path):
    (file,) = repository.glob(f"{path}.*")
    # Prose aside: Rust's and Python's comments, and docstrings.
    code = re.sub(r'"""(?s:.*?)"""|(//|#).*', "", file.read_text(encoding="utf-8"))
    assert not {found.group() for found in OF_ONE_TASK.finditer(code)}


@pytest.mark.parametrize(
    ("source", "libraries"),
    [
        ("use rapier3d::prelude::*;", {"rapier3d"}),
        ("let hit = babble_body::parry3d::query::cast();", {"parry3d"}),
        ("use babble_body::rapier3d as engine; // as pyo3 does", {"rapier3d"}),
        ("/// Same as numpy::clip.", set()),
        ('let text = "numpy"; my_rapier();', set()),
    ],
)
def test_the_scan_sees_code_and_not_prose(source, libraries):
    assert libraries_named(source) == libraries


def test_each_crate_that_simulates_turns_on_the_lints_of_clippy_toml(repository):
    # Not the bindings, the server, the comparison and the tool, which compute nothing.
    others = {"babble_py", "babble_server", "babble_golden", "babble_bindgen"}
    for crate in MAY_KNOW.keys() - others:
        source = (repository / "rust" / crate / "src/lib.rs").read_text(encoding="utf-8")
        assert "#![warn(clippy::disallowed_methods, clippy::disallowed_types)]" in source, crate
    kept_out = (repository / "clippy.toml").read_text(encoding="utf-8")
    for name in ("f64::sin", "f32::exp", "f64::mul_add", "ParallelIterator::sum", "HashMap"):
        assert name in kept_out


def test_the_core_can_do_without_threads_and_engines(repository):
    # As it is built for WebAssembly.
    native = {"babble_py", "babble_server", "babble_bindgen"}
    packages = [f"--package={name}" for name in MAY_KNOW.keys() - native]
    command = ["cargo", "tree", "--offline", "--no-default-features", "--edges=normal", *packages]
    run = subprocess.run(
        [*command, "--prefix=none"], cwd=repository, check=True, capture_output=True, text=True
    )
    names = {line.split()[0] for line in run.stdout.splitlines() if line}
    assert names >= {"nalgebra", "serde"}
    assert not {name for name in names if name.startswith(("rayon", "rapier", "parry"))}


def test_few_files_of_a_crate_use_each_other_in_a_circle(repository):
    found = [
        (source.parts[-3], sorted(circle))
        for source in sorted((repository / "rust").glob("*/src/lib.rs"))
        for circle in circles(rust_graph(source.parent))
    ]
    # Only inside a folder that is one thing.
    folders = [{Path(file).parent for file in circle} for _, circle in found]
    assert all(len(these) == 1 and Path() not in these for these in folders), found
    assert len(found) <= 3, found


def test_no_modules_of_the_package_import_each_other_in_a_circle(repository):
    graph = python_graph(repository / "gym_babble")
    assert not circles(graph)


def test_each_package_imports_those_below_it_alone(repository):
    graph = python_graph(repository / "gym_babble")
    package = {name: name.removeprefix("gym_babble.").partition(".")[0] for name in graph}
    used = merged(graph, package)
    assert set(used) == {"gym_babble", *LAYERS}  # A new package enters LAYERS first.
    for k, name in enumerate(LAYERS):
        assert used[name] <= set(LAYERS[:k]), name


def test_import_loads_nothing_heavy(capsys):
    program = "import sys, gym_babble; print(*{name.partition('.')[0] for name in sys.modules})"
    started = time.perf_counter()
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    with capsys.disabled():
        print(f"\nimport gym_babble, in a new interpreter: {time.perf_counter() - started:.2f} s")
    assert not HEAVY_MODULES & set(run.stdout.split())


def strings_together(source: str) -> list[set[str]]:
    """The strings of each tuple, list, set and dict that Python code writes out."""
    literals = ast.Tuple | ast.List | ast.Set | ast.Dict
    return [
        {leaf.value for leaf in ast.walk(node) if isinstance(leaf, ast.Constant)}
        for node in ast.walk(ast.parse(source))
        if isinstance(node, literals)
    ]


def test_python_has_no_list_of_ids_or_of_an_options_values(repository):
    ids = [{env.id for env in ENVIRONMENTS if env.task == task} for task in TASKS]
    values = [{*option.values} for task in TASKS.values() for option in task.options]
    # Two of something may well stand together for a reason of their own.
    lists = [known for known in (*ids, *values) if len(known) > 2]
    assert len(lists) > 4
    found = [
        (path.name, known)
        for path in (repository / "gym_babble").rglob("*.py")
        for strings in strings_together(path.read_text(encoding="utf-8"))
        for known in lists
        if known <= strings
    ]
    assert not found


def test_the_package_has_few_files_at_its_top(repository):
    top = {path.name for path in (repository / "gym_babble").glob("*.py")}
    assert top >= {"__init__.py", "sb3.py", "rllib.py"}
    assert len(top) <= 7, top
