"""What commands write: checked before they learn, printed before they write, of one run."""

from __future__ import annotations

import errno
import json
import os
import re
import runpy
import subprocess
import sys

import pytest

from gym_babble import HebbBabbling
from gym_babble.errors import ConfigError
from gym_babble.files import write

FOLDERS = {
    "compare": ["compare", "--agents", "random", "--cases", "3", "--report"],
    "table1": [
        *("reproduce", "table1", "--movements", "250", "--cases", "5", "--seeds", "1", "--out"),
    ],
    "table2": [
        *("reproduce", "table2", "--babbles", "50", "--cases", "5", "--seeds", "1"),
        *("--hold-trials", "1", "--out"),
    ],
}
"""Commands that write into a folder, without its name."""
FILES = {
    "babble": ["babble", "--movements", "250", "--quasi-static", "--out"],
    "babble-grasp": ["babble", "--task", "grasp", "--babbles", "50", "--out"],
    "export": ["export", "--out"],
    "record": ["record", "random", "--size", "160", "--out"],
    **{
        name: ["reproduce", name, *trials, "--out"]
        for name, trials in (
            ("fig2", ()),
            ("fig4", ("--movements", "250")),
            ("fig5", ("--movements", "250")),
            ("fig7", ("--babbles", "50")),
            ("fig8", ("--babbles", "50")),
            ("sight", ()),
        )
    },
}
"""Commands that write one file, without its name."""
PRINT = ("babble", "babble-grasp", "fig4", "fig5", "table1", "table2")
"""Commands that print results beside what they write."""
LONG = ("table2", "fig7", "fig8")


def names_of(commands):
    return [pytest.param(c, marks=pytest.mark.slow) if c in LONG else c for c in commands]


def name_of(command):
    return "out" if "babble" in command or "export" in command else "out.png"


def refuse(*_, **__):
    raise AssertionError("learnt before the output was checked")


@pytest.mark.parametrize("command", FOLDERS.values(), ids=FOLDERS)
def test_a_folder_that_cannot_be_written_is_found_before_learning(
    command, run, tmp_path, monkeypatch
):
    monkeypatch.setattr(HebbBabbling, "learn", refuse)
    (tmp_path / "file").touch()
    for path in (tmp_path / "file", tmp_path / "file" / "a", tmp_path / "missing" / "a"):
        code, out, err = run(*command, path)
        assert (code, out) == (2, "")
        assert f"{command[-1]} {path}: " in " ".join(err.split())
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("command", FILES.values(), ids=FILES)
def test_a_file_that_cannot_be_written_is_found_before_learning(
    command, run, tmp_path, monkeypatch
):
    monkeypatch.setattr(HebbBabbling, "learn", refuse)
    name = name_of(command)
    (tmp_path / "folder" / name).mkdir(parents=True)
    (tmp_path / "file").touch()
    for folder in ("folder", "file", "missing"):
        path = tmp_path / folder / name
        code, out, err = run(*command, path)
        assert (code, out) == (2, "")
        assert f"--out {path}: " in " ".join(err.split())


@pytest.mark.parametrize(
    "words",
    [
        ("film.py", "--out"),
        ("ppo.py", "--save"),
    ],
    ids=" ".join,
)
def test_examples_find_it_before_learning_too(words, repository, tmp_path, monkeypatch):
    monkeypatch.setattr(HebbBabbling, "learn", refuse)
    monkeypatch.chdir(tmp_path)
    name, option = words
    path = tmp_path / "missing" / "out.gif"
    monkeypatch.setattr(sys, "argv", [name, option, str(path)])
    with pytest.raises(ConfigError, match=f"{option} .*missing is missing; create it first"):
        runpy.run_path(str(repository / "examples" / name), run_name="__main__")


@pytest.mark.parametrize("name", names_of(PRINT))
def test_results_are_printed_before_a_write_that_fails(name, run, tmp_path, monkeypatch):
    def fill(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(write, "_write_part", fill)
    command = FILES.get(name) or FOLDERS[name]
    path = tmp_path / name_of(command)
    code, out, err = run(*command, path)
    assert code == 1
    assert str(path) in "".join(err.split("\n"))
    assert "No space left on device" in " ".join(err.split())
    assert re.search(r"\d", out)
    assert not [file for file in tmp_path.rglob("*") if file.is_file()]


@pytest.mark.parametrize("name", names_of((*FOLDERS, *FILES)))
def test_a_write_that_fails_leaves_the_earlier_run(name, run, tmp_path, monkeypatch):
    command = FILES.get(name) or FOLDERS[name]
    path = tmp_path / name_of(command)
    assert run(*command, path)[0] == 0
    files = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    assert files
    written = write._write_part

    def fill(target, content):
        written(target, content[: len(content) // 2]).unlink()
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(write, "_write_part", fill)
    assert run(*command, path)[0] == 1
    assert {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == files


@pytest.mark.slow
def test_numbers_and_page_are_of_one_run_when_two_run_at_once(tmp_path):
    program = "import sys; from gym_babble.cli import main; main(sys.argv[1:])"
    command = ["compare", "--agents", "random", "--report", str(tmp_path), "--cases"]
    runs = [
        subprocess.Popen([sys.executable, "-c", program, *command, str(cases)])
        for cases in (20, 21, 22, 23)
    ]
    assert [run.wait() for run in runs] == [0] * len(runs)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    results = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    (cases,) = {task["cases"] for task in results["tasks"]}
    assert f"--cases {cases}" in page
