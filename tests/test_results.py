"""README and docs show the stored results, and have no other rates."""

import json
import re

import pytest

from results import pages, run, stores
from results.blocks import BLOCKS
from results.sentences import SENTENCES
from results.stores import STORES, Stores

PAGES = pages.names()


@pytest.fixture(scope="module")
def stored():
    return Stores()


@pytest.mark.parametrize("page", PAGES)
def test_a_page_shows_the_stored_results(page, stored):
    """Fails when a number is edited by hand, or when a store is measured and the page not written:
    `python -m results.pages` writes it."""
    text = pages.read(page)
    assert pages.filled(page, text, stored) == text


@pytest.mark.parametrize("page", PAGES)
def test_every_rate_of_a_page_is_stored_or_said_to_be_fixed(page):
    """A rate of your own goes into a table of results/blocks.py, or into results/sentences.md."""
    assert not pages.unstored(page, pages.read(page))


def test_every_table_and_sentence_is_in_a_page():
    blocks = [name for page in PAGES for _, name, _ in pages.BLOCK.findall(pages.read(page))]
    assert sorted(blocks) == sorted(BLOCKS)
    assert set(SENTENCES) <= set(PAGES)


def test_a_store_has_its_commands_versions_and_date():
    for name, runs in STORES.items():
        document = json.loads(stores.path_of(name).read_text(encoding="utf-8"))
        found = {title: about["command"] for title, about in document["runs"].items()}
        assert found == {title: f"{command} --json" for title, command in runs.items()}, name
        assert document["about"]["versions"]["numpy"]
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", document["about"]["date"])
    files = {path.stem for path in stores.FOLDER.glob("*.json")}
    assert files == STORES.keys()


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("succeeds in .731 of the cases", 1),
        ("from 0.731 to 1.00", 2),
        ("48 of 48 reach", 1),
        ("about .7", 1),
        ("<!-- results: table1 -->\n.731\n<!-- end -->", 0),
        ("`pattern` takes 0.35 s or 0.25 cm, version 1.2.3, `.731`", 0),
        ("a [link](page-.731.png)", 0),
        ("```\n.731\n```", 0),
    ],
)
def test_the_scan_finds_rates_and_nothing_else(text, found):
    assert len(pages.unstored("other.md", text)) == found


def test_a_sentence_is_found_across_lines_and_its_numbers_are_replaced(monkeypatch):
    monkeypatch.setitem(
        SENTENCES, "page.md", pages.Sentences(["reaches {a/b:3} of\n{a/n:,d} (z = {a/z:.1f})"])
    )
    page = "It reaches .5\nof 7 (z = 0.0). It\nreaches more."
    written = pages.filled("page.md", page, Stores(a={"b": 0.7312, "n": 5000, "z": -3.78}))
    assert written == "It reaches .731\nof 5,000 (z = −3.8). It\nreaches more."


@pytest.mark.parametrize(("path", "value"), [("a/0/x", 1), ("a/name=b/x", 2), ("a/name=b c/x", 3)])
def test_a_path_leads_to_a_value(path, value):
    rows = [{"name": "a", "x": 1}, {"name": "b", "x": 2}, {"name": "b c", "x": 3}]
    assert Stores(a=rows).find(path) == value


def test_a_measured_store_has_what_its_command_prints(tmp_path, monkeypatch):
    commands = {"few": "python docs/experiments/grasp_sizes.py --trials 2 --diameters 2.4"}
    monkeypatch.setitem(STORES, "small", commands)
    monkeypatch.setattr(stores, "FOLDER", tmp_path)
    run.measure("small")
    about = json.loads((tmp_path / "small.json").read_text(encoding="utf-8"))["about"]
    assert about["versions"]["gym-babble"]
    assert Stores().find("small/few/0/trials") == 2


def test_an_unknown_store_is_named_before_any_work(capsys):
    with pytest.raises(SystemExit):
        run.main(["table1", "table3"])
    assert "table3: not one of table1" in capsys.readouterr().err
