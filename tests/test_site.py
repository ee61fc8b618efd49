"""The site's own parts: pages from the registry, docstrings for Sphinx, the check of a site.

`make docs` builds and checks the site itself.
"""

import runpy
import sys

import pytest
from comparing import ENVIRONMENTS

import gym_babble
from gym_babble.envs import registry


@pytest.fixture(scope="module")
def part(repository):
    """A module of docs/_ext by its name, as its public names."""
    folder = str(repository / "docs" / "_ext")

    def load(name):
        sys.path.insert(0, folder)
        try:
            return runpy.run_path(f"{folder}/{name}.py")
        finally:
            sys.path.remove(folder)

    return load


def test_each_id_has_a_page_with_its_own_numbers(part, repository):
    pages = part("environment_pages")
    assert pages["DOCUMENTED"] == tuple(ENVIRONMENTS)
    for row in ENVIRONMENTS:
        text = pages["page"](row)
        assert text.startswith(f"# {row.id}\n")
        for option in registry.TASKS[row.task].options:
            assert f"| `{option.name}` | `{row.options[option.name]!r}` |" in text
        for name, value in row.presets.items():
            assert f"`{name}={value!r}`" in text
        heads = [line for line in text.splitlines() if line.startswith("## ")]
        assert heads[:4] == [
            "## Description",
            "## Action space",
            "## Observation space",
            "## Rewards",
        ]
        assert heads[-1] == "## Version history"
        film = repository / "docs" / "images" / "environments" / f"{row.id}.gif"
        assert 10_000 < film.stat().st_size < 400_000


def test_the_table_of_an_observation_counts_all_its_numbers(part):
    pages = part("environment_pages")
    env = gym_babble.envs.BabbleGraspEnv()
    rows = pages["entry_rows"](env.interface.spec.senses)
    last = {str(row[0]).rpartition("–")[2] for row in rows}
    assert str(sum(len(one.labels) for one in env.interface.spec.senses) - 1) in last
    assert ("4–444", "`fovea`") in {row[:2] for row in rows}  # 441 equal ones are one row.


def test_every_public_module_has_a_page(part):
    modules = part("module_pages")
    assert not modules["undocumented"]()
    assert {"config", "course", "envs", "sb3"} <= set(modules["top_level"]())
    assert "HebbBabbling" in modules["public_names"]("")
    assert "HebbBabbling" not in modules["public_names"]("agents")  # One import path a name.


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (["Weights |w| of `a|b`."], [r"Weights \|w\| of `a|b`."]),
        (["Two:", "- one", "- two"], ["Two:", "", "- one", "- two"]),
        (["Reach.", "", "## Description", "", "| a |"], ["Reach.", ""]),
    ],
)
def test_docstrings_become_what_sphinx_reads(part, before, after):
    lines = [*before]
    part("docstrings")["process"](None, "class", "", None, None, lines)
    assert lines[: len(after)] == after


def test_a_colon_in_the_text_of_a_field_stays(part):
    docstrings = part("docstrings")
    lines = ["Options, e.g. `{1: 2}`."]
    docstrings["process"](None, "attribute", "", None, None, lines)
    assert ":" not in lines[0]
    docstrings["show_colons"](None, "attribute", "", None, None, lines)
    assert lines == ["Options, e.g. `{1: 2}`."]


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ('<a href="other.html#there">x</a>', None),
        ('<a href="https://example.org">x</a>', None),
        ('<a href="other.html#gone">x</a>', "no such anchor"),
        ('<a href="gone.html">x</a>', "no such file"),
        ('<a href="/other.html">x</a>', "leads out of the site"),
        ('<a href="../../etc">x</a>', "leads out of the site"),
        ('<img src="https://example.org/x.png">', "is loaded from another host"),
        ('<script src="//example.org/x.js"></script>', "is loaded from another host"),
    ],
)
def test_the_check_of_links_finds(part, tmp_path, body, fault):
    (tmp_path / "index.html").write_text(body, encoding="utf-8")
    (tmp_path / "other.html").write_text('<p id="there">', encoding="utf-8")
    found = part("check_site")["broken_links"](tmp_path)
    assert [text.rpartition(": ")[2] for text in found] == ([fault] if fault else [])


def test_the_check_of_a_site_fails_without_its_pages(part, tmp_path):
    with pytest.raises(SystemExit, match=r"environment envs/BabbleReach-v0\.html is missing"):
        part("check_site")["main"](tmp_path)
