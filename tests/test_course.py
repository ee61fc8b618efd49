"""`gym_babble.course`: answers are judged, handed in, and judged again from the file."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gym_babble import course
from gym_babble.course import checks
from gym_babble.course.answers import Choice, Function, Number, Numbers, Observed, UnsuitableError
from gym_babble.course.checking import check_handed_in
from gym_babble.course.exercise import Exercise, right, wrong
from gym_babble.course.handing_in import _plain
from gym_babble.course.lessons import EXERCISES, LESSONS
from gym_babble.course.settings import Settings
from gym_babble.errors import ConfigError


def judge(seen):
    number = float(np.sum(seen if not isinstance(seen, dict) else seen["a"]))
    return right("It is three.") if abs(number - 3) < 0.01 else wrong("It is not three.", "Count.")


def draw(seen, axes):
    axes.plot([0, seen])


def draw_nothing(seen, axes):
    raise RuntimeError(f"{seen} {axes}")


def observe(agent):
    return {"a": [agent.predict(k) for k in range(3)]}


KINDS = {
    "1.1": Number(unit="s"),
    "1.2": Numbers(shape=(2,)),
    "1.3": Function(inputs=lambda: [(1,), (2,)]),
    "1.4": Observed(observe_by=observe, parts={"a": (3,)}),
}
MADE_UP = {
    key: Exercise(
        id=key, asks="three", answer=kind, judge=judge, draw=draw if key == "1.1" else None
    )
    for key, kind in KINDS.items()
}


@pytest.fixture(autouse=True)
def session(monkeypatch):
    """A session without answers, in which lesson 1 has an exercise of each kind."""
    monkeypatch.setattr(checks, "answers_seen", {})
    monkeypatch.setattr("gym_babble.course.handing_in.answers_seen", checks.answers_seen)
    for key in [key for key in EXERCISES if key.startswith("1.")]:
        monkeypatch.delitem(EXERCISES, key)
    for key, exercise in MADE_UP.items():
        monkeypatch.setitem(EXERCISES, key, exercise)
    monkeypatch.setitem(LESSONS, "1", tuple(MADE_UP.values()))


class Agent:
    """An agent that does the same thing always."""

    def __init__(self, action):
        self.action = action

    def predict(self, observation):
        del observation
        return self.action


RIGHT = {
    "1.1": [3, 3.0, np.float32(3), np.array(3), np.array([3.0]), [3]],
    "1.2": [[1, 2], (1.5, 1.5), np.array([0, 3])],
    "1.3": [lambda x: x, lambda x: np.array([x]), lambda x: 3 - x, lambda x, scale=1: scale * x],
    "1.4": [Agent(1), Agent(np.float64(1.0))],
}


@pytest.mark.parametrize(("exercise", "answer"), [(k, a) for k, v in RIGHT.items() for a in v])
def test_right_answers_of_several_kinds_are_right(exercise, answer):
    result = course.check(exercise, answer)
    assert result.right
    assert repr(result) == f"{exercise}  Right. It is three."


@pytest.mark.parametrize(
    ("exercise", "answer"),
    [
        ("1.1", ...),
        ("1.2", (..., ...)),
        ("1.2", [1, ...]),
        ("1.3", ...),
        ("1.3", lambda _: ...),
        ("1.4", {"agent": ...}),
    ],
)
def test_an_answer_with_a_blank_in_it_is_not_answered_yet(exercise, answer):
    result = course.check(exercise, answer)
    assert result.state == "unanswered"
    assert repr(result) == f"{exercise}  Not answered yet. Asked for: three."
    assert not checks.answers_seen


def fails(x):
    return {}["missing"] + x


@pytest.mark.parametrize(
    ("exercise", "answer", "said"),
    [
        ("1.1", 4, "not three"),
        ("1.1", "3", "without quotes"),
        ("1.1", None, "None"),
        ("1.1", True, "not made of real numbers"),
        ("1.1", 3 + 0j, "not made of real numbers"),
        ("1.1", math.nan, "not finite"),
        ("1.1", math.inf, "not finite"),
        ("1.1", 1e300, "between -1e+06 and 1e+06"),
        ("1.1", 10**400, "not made of real numbers"),
        ("1.1", [1, 2], "2 numbers"),
        ("1.1", fails, "Call it"),
        ("1.1", {}, "not made of real numbers"),
        ("1.2", [1, 2, 3], "shape (3,)"),
        ("1.2", [[1], [1, 2]], "not an array"),
        ("1.3", 3, "A function is expected"),
        ("1.3", lambda: 3, "TypeError"),
        ("1.3", lambda _: None, "`return`"),
        ("1.3", lambda _: "3", "text"),
        ("1.3", lambda x: [x, x], "shape (2,)"),
        ("1.3", fails, "KeyError: 'missing'"),
        ("1.3", lambda _: sys.exit(3), "SystemExit"),
        ("1.4", 3, "AttributeError"),
        ("1.4", Agent("left"), "not made of real numbers"),
        ("1.4", Agent([1, 2]), "shape (3, 2)"),
    ],
)
def test_wrong_answers_of_all_kinds_say_what_is_wrong_and_help(exercise, answer, said):
    result = course.check(exercise, answer)
    assert result.state == "wrong"
    assert said in repr(result)
    assert result.hint


def test_the_line_that_raises_is_shown():
    assert course.check("1.3", fails).hint == (
        f'Look at line {fails.__code__.co_firstlineno + 1} of fails: return {{}}["missing"] + x.'
    )
    deep = course.check("1.3", lambda x: np.linalg.inv(x) + 1)
    assert "of <lambda>: deep = course.check" in deep.hint


@pytest.mark.parametrize("exercise", ["9.9", "", 1.1, 11, None, "1"])
def test_an_unknown_exercise_is_an_error_that_names_those_that_there_are(exercise):
    with pytest.raises(ValueError, match=r"exercise = .*(1\.1, 1\.2|write check\(\"1\.1\")"):
        course.check(exercise, 3)


def test_a_judge_with_a_fault_ends_neither_a_notebook_nor_the_table_of_a_class(
    tmp_path, monkeypatch
):
    faulty = Exercise(id="1.1", asks="three", answer=Number(), judge=fails, draw=draw_nothing)
    monkeypatch.setitem(EXERCISES, "1.1", faulty)
    monkeypatch.setitem(LESSONS, "1", (faulty,))
    result = course.check("1.1", 3)
    assert result.state == "wrong"
    assert "cannot be judged: KeyError" in result.text
    assert "No picture: RuntimeError" in result.note
    done = course.hand_in(1, "Ada", tmp_path)
    assert "cannot be judged" in check_handed_in(done.path).states["1.1"]


def test_a_function_cannot_change_what_it_is_judged_by():
    inputs = [(np.zeros(2),)]
    kind = Function(inputs=lambda: inputs)

    def changes(x):
        x += 1
        return x.sum()

    assert kind.observe(changes) == [2]
    assert inputs[0][0].sum() == 0


def test_words_are_compared_without_capitals_and_spaces():
    kind = Choice("left", "right")
    assert kind.observe(" Left ") == "left"
    with pytest.raises(UnsuitableError, match="'left', 'right'"):
        kind.observe("straight")


def test_a_notebook_shows_the_state_the_text_and_the_picture():
    page = course.check("1.1", 4)._repr_html_()
    assert 'data-exercise="1.1" data-state="wrong"' in page
    assert "<strong>1.1 Not right yet.</strong> It is not three." in page
    assert '<img alt="Your answer to 1.1' in page
    assert "base64" not in course.check("1.2", [1, 1])._repr_html_()


def test_a_students_text_is_no_html():
    page = course.check("1.1", "<script>")._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


def test_without_matplotlib_a_line_says_why_there_is_no_picture(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    result = course.check("1.1", 3)
    assert result.right
    assert result.figure is None
    assert "pip install 'gym-babble[figures]'" in repr(result)


def handed_in(tmp_path, answers=RIGHT, name="Ada Lovelace"):
    for exercise, these in answers.items():
        course.check(exercise, these[0])
    return course.hand_in(1, name, tmp_path)


def test_a_lesson_is_handed_in_and_judged_again_to_the_same_end(tmp_path):
    done = handed_in(tmp_path)
    assert done.path == tmp_path / "lesson-1-ada-lovelace.json"
    assert "4 of 4 right" in repr(done)
    checked = check_handed_in(done.path)
    assert (checked.name, checked.lesson, checked.verdict) == ("Ada Lovelace", "1", "complete")
    assert checked.right == ("1.1", "1.2", "1.3", "1.4")


def test_the_file_holds_what_was_seen_and_no_code(tmp_path):
    document = json.loads(handed_in(tmp_path).path.read_text(encoding="utf-8"))
    assert document["answers"] == {
        "1.1": 3.0,
        "1.2": [1.0, 2.0],
        "1.3": [1.0, 2.0],
        "1.4": {"a": [1.0, 1.0, 1.0]},
    }


def test_wrong_and_missing_answers_are_named(tmp_path):
    done = handed_in(tmp_path, {"1.1": [4], "1.2": [[1, 2]]})
    assert done.states == {
        "1.1": "not right yet",
        "1.2": "right",
        "1.3": "not answered in this session",
        "1.4": "not answered in this session",
    }
    checked = check_handed_in(done.path)
    assert checked.verdict == "incomplete"
    assert (checked.wrong, checked.missing) == (("1.1",), ("1.3", "1.4"))
    assert checked.states["1.1"] == "It is not three."
    assert checked.row()[3:6] == ("1/4", "1.1", "1.3 1.4")


def test_a_right_answer_stays_when_a_wrong_one_follows():
    course.check("1.1", 3)
    course.check("1.1", 4)
    assert checks.answers_seen["1.1"].is_right


def test_without_a_name_nothing_is_written(tmp_path):
    done = course.hand_in(1, ..., tmp_path)
    assert done.path is None
    assert "give your name" in repr(done)
    assert not [*tmp_path.iterdir()]


def test_a_new_session_keeps_the_file_of_an_earlier_one(tmp_path):
    course.check("1.1", 3)
    earlier = course.hand_in(1, "Ada", tmp_path).path
    before = earlier.read_bytes()
    checks.answers_seen.clear()
    done = course.hand_in(1, "Ada", tmp_path)
    assert done.path is None
    assert "Run the notebook from its start" in repr(done)
    assert earlier.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("Zoë Ørsted", "zoë-ørsted"),
        ("../../etc/passwd", "etc-passwd"),
        ("李", "李"),
        ("a\n=1", "a-1"),
    ],
)
def test_a_name_becomes_a_part_of_the_files_name(tmp_path, name, file):
    assert handed_in(tmp_path, name=name).path == tmp_path / f"lesson-1-{file}.json"


@pytest.mark.parametrize(
    ("lesson", "name", "said"),
    [(9, "Ada", "lesson = '9'"), (1, "...", "no letters"), (1, "a" * 201, "201"), (1, 3, "text")],
)
def test_what_cannot_be_handed_in_is_an_error(tmp_path, lesson, name, said):
    with pytest.raises(ConfigError, match=said):
        course.hand_in(lesson, name, tmp_path)


GOOD = {"format": "gym-babble lesson 1", "package": "0", "lesson": "1", "name": "A", "answers": {}}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "no JSON"),
        ("[" * 100_000, "no JSON"),
        ("[1]", "no file of hand_in"),
        ('{"version": 1}', "no file of hand_in"),
        ("x" * (4 * 2**20 + 1), "more than 4,194,304 bytes"),
        ({**GOOD, "code": "import os"}, "'code'"),
        ({key: GOOD[key] for key in GOOD if key != "name"}, "'name'"),
        ({**GOOD, "lesson": "9"}, "lesson = '9'"),
        ({**GOOD, "lesson": 1}, "lesson is no text"),
        ({**GOOD, "name": "x" * 201}, "name is no text of at most 200"),
        ({**GOOD, "answers": {"2.1": 1}}, "not of the exercises"),
        ({**GOOD, "answers": [1]}, "not of the exercises"),
    ],
)
def test_a_broken_file_has_a_row_that_says_what_is_wrong(tmp_path, content, said):
    path = tmp_path / "broken.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    checked = check_handed_in(path)
    assert said in checked.verdict
    assert not checked.states


@pytest.mark.parametrize(
    "value",
    [None, "3", True, [], {}, {"a": 3}, [[1], 2], 1e999, -1e999, 10**400, [1] * 1000, "=1+1\n"],
)
@pytest.mark.parametrize("exercise", MADE_UP)
def test_a_forged_answer_is_a_wrong_one(tmp_path, exercise, value):
    path = tmp_path / "forged.json"
    path.write_text(json.dumps({**GOOD, "answers": {exercise: value}}), encoding="utf-8")
    checked = check_handed_in(path)
    assert checked.wrong == (exercise,)
    assert checked.states[exercise].startswith("not an answer: ")
    assert checked.states[exercise].isprintable()


def test_the_command_prints_a_row_for_each_file(tmp_path, run):
    good = handed_in(tmp_path).path
    bad = tmp_path / "bad.json"
    bad.write_text("{")
    table = tmp_path / "class.csv"
    code, out, _ = run("course", "check", good, bad, tmp_path / "none", "--csv", table, "--json")
    assert code == 0
    assert [row["verdict"] for row in json.loads(out)][:2] == ["complete", "it is no JSON"]
    rows = [*csv.DictReader(table.read_text(encoding="utf-8").splitlines())]
    assert [row["right"] for row in rows] == ["4/4", "", ""]
    assert rows[0]["name"] == "Ada Lovelace"
    assert "it cannot be read" in rows[2]["verdict"]


def test_importing_the_course_loads_nothing_heavy():
    program = "import sys, gym_babble.course; print(*{n.partition('.')[0] for n in sys.modules})"
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    heavy = {"matplotlib", "scipy", "torch", "stable_baselines3", "typer"}
    assert not heavy & set(run.stdout.split())


def observed(kind):
    """Anything that may be observed of an answer of a kind."""

    def within(shape):
        return arrays(np.float64, shape, elements=st.floats(kind.low, kind.high))

    if isinstance(kind, Number):
        return st.floats(kind.low, kind.high)
    if isinstance(kind, Numbers):
        return within(kind.shape)
    if isinstance(kind, Choice):
        return st.sampled_from(kind.choices)
    if isinstance(kind, Settings):
        return st.sampled_from(["{}", '{"sigma": "wide"}', '{"readout": {}, "sizes": [1]}'])
    if isinstance(kind, Function):
        return within((len(kind.inputs()), *kind.shape))
    return st.fixed_dictionaries({name: within(shape) for name, shape in kind.parts.items()})


@pytest.mark.parametrize("exercise", EXERCISES.values(), ids=EXERCISES)
@settings(max_examples=8)
@given(data=st.data())
def test_no_answer_makes_a_judge_or_a_picture_raise(exercise, data):
    pyplot = pytest.importorskip("matplotlib.figure")
    seen = data.draw(observed(exercise.answer))
    finding = exercise.judge(seen)
    assert finding.text.endswith((".", "!", "?"))
    assert finding.is_right or finding.hint
    if exercise.draw is not None:
        exercise.draw(seen, pyplot.Figure().subplots())


@pytest.mark.parametrize("exercise", EXERCISES.values(), ids=EXERCISES)
@settings(max_examples=5)
@given(data=st.data())
def test_a_file_gives_the_judge_the_same_bits_as_the_notebook(exercise, data):
    seen = data.draw(observed(exercise.answer))
    again = exercise.answer.read(json.loads(json.dumps(_plain(seen))))
    parts, parts_again = (each if isinstance(each, dict) else {"": each} for each in (seen, again))
    assert parts.keys() == parts_again.keys()
    for name, part in parts.items():
        assert np.array_equal(part, parts_again[name])


@pytest.mark.parametrize(("number", "lesson"), LESSONS.items())
def test_exercises_are_numbered_in_their_order(number, lesson):
    assert [e.id for e in lesson] == [f"{number}.{k}" for k in range(1, len(lesson) + 1)]
