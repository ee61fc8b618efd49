"""What the command line prints: in any encoding, and paths as they are."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from gym_babble import HebbBabbling, Random
from gym_babble.agents.loading import named_agent
from gym_babble.study.tables import plain_table, stacked

QUICK = ["--movements", "20", "--quasi-static"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("encoding", "words"),
    [
        ("cp1252", ["compare", "--agents", "scripted", "--cases", "5"]),
        ("latin-1", ["evaluate", "scripted", "--cases", "5"]),
        ("ascii", ["info", "BabbleGrasp-v0"]),
        ("ascii", ["doctor"]),
        ("ascii", ["export", "--task", "reach"]),
        ("ascii", ["babble", "--help"]),
        ("ascii", ["evaluate", "größe"]),
    ],
    ids=lambda x: " ".join(x[:1]) if isinstance(x, list) else x,
)
def test_an_output_that_is_not_utf_8_shows_what_it_can(encoding, words, tmp_path):
    # As pipes on Windows have it; the results must not be lost for the sake of a "⁶".
    run = subprocess.run(
        [sys.executable, "-c", f"from gym_babble.cli import main; main({words!r})"],
        capture_output=True,
        check=False,
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"},
    )
    assert b"Traceback" not in run.stderr
    known = "größe" not in words
    assert run.returncode == (0 if known else 2)
    shown = (run.stdout if known else run.stderr).decode(encoding, errors="replace")
    assert len(shown) > 20
    if encoding == "ascii" and words[0] == "info":
        assert "?" in shown


ODD_NAMES = [
    "agent[seed0]",
    "x[/y]",
    "x[red]y",
    "x[link=file:y]z",
    "two  spaces",
    ":smile:",
    "50%{x}",
    "long-" * 30,
]


@pytest.mark.parametrize("name", ODD_NAMES)
def test_a_path_is_printed_as_it_is(run, here, name):
    path = Path(name)
    path.parent.mkdir(exist_ok=True)
    code, printed, _ = run("babble", "--out", name, *QUICK)
    assert code == 0
    assert name in printed.splitlines()[0]
    code, printed, _ = run("evaluate", name, "--cases", 5)
    assert code == 0
    # A table cuts what is too wide for it.
    assert path.name[:12] in printed
    assert json.loads(run("evaluate", name, "--cases", 5, "--json")[1])["agent"] == name
    code, _, said = run("evaluate", f"{name}.missing", "--cases", 5)
    assert (code, f"{name}.missing" in said) == (2, True)
    config = here / f"{name}.toml"
    config.write_text("profile = 'icub'\n")
    code, printed, said = run(
        *("reproduce", "table1", "--seeds", 1, "--cases", 5, *QUICK, "--config", f"{name}.toml")
    )
    assert code == 0
    assert name[:12] in printed
    config.write_text("profile = 'nobody'\n")
    code, _, said = run("info", "BabbleReach-v0", "--config", f"{name}.toml")
    assert (code, f"{name}.toml" in said) == (2, True)


def test_a_report_shows_markup_in_a_path_as_text(run, here):
    name = "<b>x[red]&"
    (here / f"{name}.toml").write_text("profile = 'icub'\n")
    words = ("compare", "--agents", "scripted", "--cases", 5, "--config", f"{name}.toml")
    code, _, said = run(*words, "--report", "report")
    assert code == 0
    assert str(Path("report/index.html")) in said.replace("\n", "")
    page = Path("report/index.html").read_text(encoding="utf-8")
    assert "&lt;b&gt;x[red]&amp;" in page
    assert "<b>x" not in page


def test_a_table_shows_square_brackets_also_in_a_strangers_console():
    table = plain_table("title [/x]", ["", stacked("head [/x]", "below [/x]")])
    table.add_row("row", stacked("cell [/x]", "under [/x]"))
    console = Console(width=80, markup=True)
    with console.capture() as captured:
        console.print(table)
    assert captured.get().count("[/x]") == 5


def test_a_name_wins_over_a_file_that_is_called_like_it(run, here):
    HebbBabbling(quasi_static=True, seed=3).learn(20).save(here / "random")
    assert isinstance(named_agent("random").agent, Random)
    assert isinstance(named_agent("./random").agent, HebbBabbling)
    for name in ("random", "./random"):
        code, printed, _ = run("evaluate", name, "--cases", 5)
        assert code == 0
        assert f"\n{name} " in printed
    assert "./random" in run("evaluate", "--help")[1]
