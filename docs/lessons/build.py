"""Make notebooks from the lessons: a student's and an instructor's version of each, executed.

    python docs/lessons/build.py                         # both versions of all but slow lessons
    python docs/lessons/build.py 2-muscles --write-only  # one lesson, not executed

Run this with the Python of an environment that has the wheel, jupytext, nbclient and ipykernel:
`make lessons` makes one. README.md beside this file says how a lesson is written.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from importlib.metadata import metadata
from pathlib import Path
from typing import Any

import jupytext
import nbformat
from nbclient import NotebookClient

from gym_babble.course.checking import check_handed_in
from gym_babble.course.lessons import exercises_of

LESSONS = Path(__file__).resolve().parent
OUT = LESSONS.parent.parent / "build" / "lessons"
VERSIONS = ("student", "instructor")
SECONDS_A_CELL = 30
"""A cell that takes longer is an error."""
BLOCK = re.compile(
    r"^ *### solution\n(?P<instructor>.*?)^ *### student\n(?P<student>.*?)^ *### end(?:\n|\Z)",
    re.MULTILINE | re.DOTALL,
)
PROJECT = dict(one.split(", ") for one in metadata("gym-babble").get_all("Project-URL"))
PAGES = f"{PROJECT['Repository']}/blob/main/docs/"
"""Where the pages are that a lesson links to, for who has a notebook alone."""
LINK = re.compile(r"(?P<image>!?)(?P<text>\[[^\]]*\]\()\.\./(?!lab/)(?P<page>[^)]*)\)")
STATE = re.compile(r'data-exercise="([^"]+)" data-state="(\w+)"')
ANSI = re.compile(r"\x1b\[[0-9;]*m")
SETUP = """\
# Installs what is missing. In an environment that has everything, this does nothing.
from importlib.util import find_spec

if not find_spec("gym_babble"):
    raise ModuleNotFoundError("install gym-babble, or the wheel of your class: {start}")
if not all(map(find_spec, {modules!r})):
    %pip install --quiet "gym-babble[{extras}]"\
"""
MODULES = {"figures": ("matplotlib",), "sb3": ("stable_baselines3",)}
"""What a lesson imports of each extra that it needs."""
NO_NETWORK = """
import socket

def _refuse(name):
    raise OSError(f"a lesson asks for {name}: lessons run without a network")

def _guarded(connect):
    def connect_here(self, address):
        if isinstance(address, tuple) and address[0] not in ("127.0.0.1", "localhost", "::1"):
            _refuse(address)
        return connect(self, address)
    return connect_here

socket.socket.connect = _guarded(socket.socket.connect)
socket.socket.connect_ex = _guarded(socket.socket.connect_ex)
"""
"""Runs at the start of each kernel."""


@dataclass(frozen=True)
class Lesson:
    """A lesson's source."""

    path: Path

    @property
    def name(self) -> str:
        """Its name, such as "2-muscles"."""
        return self.path.stem

    @property
    def source(self) -> Any:
        """The notebook with both versions in it."""
        return jupytext.read(self.path)

    @property
    def about(self) -> dict[str, Any]:
        """The part `course` of its head: `extras`, and `slow` for one that CI leaves out."""
        return dict(self.source.metadata["course"])

    def version(self, version: str) -> Any:
        """The notebook for students, or for instructors."""
        notebook = self.source
        extras = str(notebook.metadata.pop("course")["extras"])
        notebook.metadata.pop("jupytext", None)
        cells = [cell for cell in notebook.cells if _belongs(cell, version)]
        modules = tuple(name for extra in extras.split(",") for name in MODULES[extra])
        setup = SETUP.format(modules=modules, extras=extras, start=f"{PAGES}start.md")
        cells.insert(1, nbformat.v4.new_code_cell(setup))
        for k, cell in enumerate(cells):
            cell["id"] = f"cell-{k}"  # The same each time.
            if cell.cell_type == "code":
                cell.source = BLOCK.sub(lambda block: block[version], cell.source).rstrip("\n")
            else:
                cell.source = LINK.sub(_in_repository, cell.source)
        notebook.cells = cells
        return notebook


def _in_repository(link: re.Match[str]) -> str:
    raw = "?raw=true" if link["image"] else ""
    return f"{link['image']}{link['text']}{PAGES}{link['page']}{raw})"


def lessons() -> list[Lesson]:
    """All lessons in their order."""
    return [Lesson(path) for path in sorted(LESSONS.glob("[0-9]-*.md"))]


def _belongs(cell: Any, version: str) -> bool:
    return version == "instructor" or "instructor" not in cell.metadata.get("tags", ())


def execute(notebook: Any, folder: Path) -> list[float]:
    """Executes a notebook in a folder, and returns the seconds of each cell.

    Raises:
        nbclient.exceptions.CellExecutionError: A cell raises.
        nbclient.exceptions.CellTimeoutError: A cell takes longer than `SECONDS_A_CELL`.
    """
    startup = folder / ".ipython" / "profile_default" / "startup"
    startup.mkdir(parents=True)
    (startup / "no_network.py").write_text(NO_NETWORK, encoding="utf-8")
    os.environ |= {"IPYTHONDIR": str(startup.parents[1]), "PIP_NO_INDEX": "1"}
    resources = {"metadata": {"path": str(folder)}}
    client = NotebookClient(notebook, timeout=SECONDS_A_CELL, resources=resources)
    manager = client.create_kernel_manager()
    manager.transport, manager.ip = "ipc", str(folder / "kernel")
    seconds = []
    with client.setup_kernel():
        for k, cell in enumerate(notebook.cells):
            began = time.perf_counter()
            client.execute_cell(cell, k)
            seconds.append(time.perf_counter() - began)
            cell.metadata.pop("execution", None)
    return seconds


def states(notebook: Any) -> dict[str, str]:
    """What `check` said of each exercise in an executed notebook."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    pages = ["".join(output.get("data", {}).get("text/html", "")) for output in outputs]
    return dict(found for page in pages for found in STATE.findall(page))


def problems(version: str, lesson: Lesson, notebook: Any, folder: Path) -> list[str]:
    """What is wrong with an executed version."""
    wanted = {"student": "unanswered", "instructor": "right"}[version]
    found, ids = states(notebook), [exercise.id for exercise in exercises_of(lesson.name[0])]
    said = [f"{one}: {found.get(one, 'not checked')}" for one in ids if found.get(one) != wanted]
    said += [f"{one} is not an exercise of this lesson" for one in found.keys() - {*ids}]
    if version == "instructor":
        files = [check_handed_in(path) for path in folder.glob("lesson-*.json")]
        if [file.verdict for file in files] != ["complete"]:
            said.append(f"handed in: {files}")
    return said


def build(lesson: Lesson, version: str, *, run: bool) -> tuple[str, list[str]]:
    """Writes one version of a lesson, and returns a line about it and what is wrong."""
    notebook, said = lesson.version(version), []
    line = f"{lesson.name}, {version}"
    if run:
        with tempfile.TemporaryDirectory() as name:
            try:
                seconds = execute(notebook, Path(name))
            except Exception as error:  # noqa: BLE001 - the other notebooks go on
                return line, [ANSI.sub("", str(error))[-1_500:]]
            said = problems(version, lesson, notebook, Path(name))
        line += f": {sum(seconds):.1f} s, slowest cell {max(seconds):.1f} s"
    target = OUT / version / f"{lesson.name}.ipynb"
    target.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, target)
    return line, said


def _build(task: tuple[Lesson, str, bool]) -> tuple[str, list[str]]:
    lesson, version, run = task
    return build(lesson, version, run=run)


def main() -> None:
    """Build the lessons that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "names", nargs="*", help="lessons, such as 2-muscles; all that are not slow"
    )
    parser.add_argument(
        "--slow", action="store_true", help="the slow lessons instead of the others"
    )
    parser.add_argument("--write-only", action="store_true", help="do not execute them")
    options = parser.parse_args()
    every = lessons()
    if unknown := {*options.names} - {lesson.name for lesson in every}:
        parser.error(f"no lesson is called {', '.join(unknown)}")
    chosen = [
        lesson
        for lesson in every
        if lesson.name in options.names
        or (not options.names and bool(lesson.about.get("slow")) == options.slow)
    ]
    tasks = [(lesson, version, not options.write_only) for lesson in chosen for version in VERSIONS]
    began, failed = time.perf_counter(), 0
    with ProcessPoolExecutor(2) as pool:
        for line, said in pool.map(_build, tasks):
            print(line, flush=True)
            failed += len(said)
            print(*(f"  error: {problem}" for problem in said), sep="\n", end="\n" if said else "")
    print(f"{len(tasks)} notebooks in {OUT}, {time.perf_counter() - began:.0f} s")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
