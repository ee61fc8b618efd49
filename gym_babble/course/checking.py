"""Checks the files that students hand in: judges each answer again, and runs nobody's code."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gym_babble.course.handing_in import FORMAT, MOST_LETTERS
from gym_babble.course.lessons import exercises_of
from gym_babble.errors import ConfigError
from gym_babble.files.handed_in import UnreadableError, one_line, read_handed_in

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.course.exercise import Exercise

__all__ = ["COLUMNS", "CheckedFile", "check_handed_in"]

COLUMNS = ("file", "name", "lesson", "right", "wrong", "missing", "version", "verdict")
FIELDS = {"format", "package", "lesson", "name", "answers"}


@dataclass(frozen=True, kw_only=True)
class CheckedFile:
    """What was found in a file."""

    file: str
    """Name of the file."""
    name: str = ""
    """Who handed it in, as the file says."""
    lesson: str = ""
    """Number of the lesson."""
    version: str = ""
    """Version of the package that wrote it, as the file says."""
    states: dict[str, str] = field(default_factory=dict)
    """State of each exercise: "right", "missing", or what is wrong."""
    problem: str = ""
    """What is wrong with the file; empty for one that can be judged."""

    @property
    def right(self) -> tuple[str, ...]:
        """Ids of the exercises that are right."""
        return tuple(k for k, state in self.states.items() if state == "right")

    @property
    def missing(self) -> tuple[str, ...]:
        """Ids of the exercises without an answer."""
        return tuple(k for k, state in self.states.items() if state == "missing")

    @property
    def wrong(self) -> tuple[str, ...]:
        """Ids of the exercises with a wrong answer."""
        return tuple(k for k in self.states if k not in self.right + self.missing)

    @property
    def verdict(self) -> str:
        """In a few words: "complete", "incomplete", or what is wrong with the file."""
        return self.problem or ("complete" if len(self.right) == len(self.states) else "incomplete")

    def row(self) -> tuple[str, ...]:
        """Its cells in the columns `COLUMNS`."""
        return (
            self.file,
            self.name,
            self.lesson,
            "" if self.problem else f"{len(self.right)}/{len(self.states)}",
            " ".join(self.wrong),
            " ".join(self.missing),
            self.version,
            self.verdict,
        )


def check_handed_in(path: Path) -> CheckedFile:
    """Judges the answers of a file again. A file that is broken gives a result that says so."""
    file = one_line(path.name)
    try:
        document = _document(read_handed_in(path))
        lesson, name, version = (_text(document, key) for key in ("lesson", "name", "package"))
        states = _states(exercises_of(lesson), document["answers"])
    except (UnreadableError, ConfigError) as error:
        return CheckedFile(file=file, problem=one_line(str(error)))
    return CheckedFile(
        file=file, name=one_line(name), lesson=lesson, version=one_line(version), states=states
    )


def _document(text: str) -> dict[str, Any]:
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ConfigError("it is no JSON") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise ConfigError(f"it is no file of hand_in: its format is not {FORMAT!r}")
    if document.keys() != FIELDS:
        odd = ", ".join(map(repr, sorted(document.keys() ^ FIELDS)))
        raise ConfigError(f"it was altered: fields {odd} are missing or unknown")
    return document


def _text(document: dict[str, Any], key: str) -> str:
    value = document[key]
    if not isinstance(value, str) or len(value) > MOST_LETTERS:
        raise ConfigError(f"{key} is no text of at most {MOST_LETTERS} letters")
    return value


def _states(exercises: tuple[Exercise, ...], answers: Any) -> dict[str, str]:
    known = {exercise.id for exercise in exercises}
    if not isinstance(answers, dict) or not answers.keys() <= known:
        raise ConfigError("answers are not of the exercises of this lesson")
    return {exercise.id: _state(exercise, answers) for exercise in exercises}


def _state(exercise: Exercise, answers: dict[str, Any]) -> str:
    if exercise.id not in answers:
        return "missing"
    try:
        finding = exercise.find(exercise.answer.read(answers[exercise.id]))
    except ConfigError as error:
        return one_line(f"not an answer: {error}")
    return "right" if finding.is_right else one_line(finding.text)
