"""The lessons' sources: each has what a lesson needs, and both versions are made from them.

`make lessons` executes them.
"""

from __future__ import annotations

import re
import runpy

import pytest
from conftest import ROOT

from gym_babble.course.lessons import LESSONS

jupytext = pytest.importorskip("jupytext")

BUILD = runpy.run_path(str(ROOT / "docs/lessons/build.py"))
SOURCES = {lesson.name: lesson for lesson in BUILD["lessons"]()}
SECTIONS = ("Aims", "Background", "Think", "In the lab", "References", "Hand in")
IN_LAB = re.compile(
    r"\[Open the lab in this state\]\(\.\./lab/index\.html#(\S+)\)\. With the package on your own "
    r"machine: run\s`gym-babble lab`, and open `http://127\.0\.0\.1:8742/#(\S+)`\."
)
CHECKED = re.compile(r'course\.check\("(\d\.\d+)"')


def text(notebook, kind=None):
    return "\n".join(cell.source for cell in notebook.cells if kind in (None, cell.cell_type))


def test_a_block_gives_each_version_its_part():
    source = "a = 1\n### solution\nb = 2\n### student\nb = ...\n### end\nc = 3\n"
    parts = {v: BUILD["BLOCK"].sub(lambda block, v=v: block[v], source) for v in BUILD["VERSIONS"]}
    assert parts == {"student": "a = 1\nb = ...\nc = 3\n", "instructor": "a = 1\nb = 2\nc = 3\n"}


def test_a_block_may_stand_in_a_function():
    source = (
        "def f(x):\n    ### solution\n    return x\n    ### student\n    return ...\n    ### end"
    )
    found = BUILD["BLOCK"].sub(lambda block: block["student"], source)
    assert found == "def f(x):\n    return ...\n"


@pytest.fixture(params=SOURCES.values(), ids=SOURCES)
def lesson(request):
    return request.param


def test_a_lesson_has_its_sections_in_order(lesson):
    heads = re.findall(r"^## (.+)$", text(lesson.source, "markdown"), re.MULTILINE)
    assert [head for head in heads if head in SECTIONS] == [*SECTIONS]
    assert lesson.source.cells[0].source.startswith(f"# {lesson.name[0]} ")


def test_a_lesson_checks_each_of_its_exercises_once(lesson):
    checked = CHECKED.findall(text(lesson.source, "code"))
    assert sorted(checked) == [exercise.id for exercise in LESSONS[lesson.name[0]]]
    assert 3 <= len(checked) <= 6


def test_a_lesson_leads_into_the_lab_and_is_handed_in(lesson):
    (site, machine) = IN_LAB.search(text(lesson.source, "markdown")).groups()
    assert site == machine
    assert lesson.source.cells[-1].source.endswith(f'course.hand_in("{lesson.name[0]}", name)')


def test_links_of_a_notebook_lead_to_pages_in_the_repository(lesson):
    notebook = lesson.version("student")
    links = re.findall(r"\]\((?!https?://)([^)]*)\)", text(notebook, "markdown"))
    assert all(link.startswith("../lab/") for link in links)
    pages = re.findall(r"/blob/main/docs/([^)#?]*)", text(notebook, "markdown"))
    assert all((ROOT / "docs" / page).is_file() for page in pages)


def answers_in(notebook):
    return [cell for cell in notebook.cells if "instructor" in cell.metadata.get("tags", [])]


def test_students_get_the_blanks_and_no_answers(lesson):
    student, instructor = (lesson.version(version) for version in ("student", "instructor"))
    assert "### " not in text(student, "code") + text(instructor, "code")
    assert text(student, "code").count("...") >= len(LESSONS[lesson.name[0]])
    assert not answers_in(student)
    answers = answers_in(instructor)
    assert answers
    assert all(cell.source.startswith("**Suggested answer") for cell in answers)


def test_a_version_is_the_same_each_time_and_has_no_outputs(lesson):
    for version in ("student", "instructor"):
        notebook = lesson.version(version)
        assert notebook == lesson.version(version)
        assert not any(cell.get("outputs") for cell in notebook.cells)
        assert notebook.cells[1].source.startswith("# Installs what is missing.")


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("import socket; socket.create_connection(('192.0.2.1', 80), 5)", "without a network"),
        ("1 / 0", "ZeroDivisionError"),
    ],
)
def test_a_cell_that_raises_or_asks_for_the_network_ends_the_build(tmp_path, code, said):
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    with pytest.raises(Exception, match=said):
        BUILD["execute"](notebook, tmp_path)


def test_no_lesson_is_missing():
    assert [name[0] for name in SOURCES] == [*LESSONS]
