"""`hand_in`: the answers of a lesson as a file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble._core import __version__
from gym_babble.checks import check_path, check_text
from gym_babble.course.checks import answers_seen
from gym_babble.course.lessons import exercises_of
from gym_babble.course.results import HandedIn
from gym_babble.errors import ConfigError
from gym_babble.files import check_file, write_file

if TYPE_CHECKING:
    from pathlib import Path
    from types import EllipsisType

    from gym_babble.course.answers import Seen

__all__ = ["FORMAT", "MOST_LETTERS", "hand_in"]

FORMAT = "gym-babble lesson 1"
"""First field of a file: what it is, and the version of its format."""
MOST_LETTERS = 200
"""Letters of a name, at most."""


def hand_in(lesson: str | int, name: str | EllipsisType, folder: str | Path = ".") -> HandedIn:
    """Writes the answers that `check` has seen in this session, as `lesson-5-ada.json`.

    The file holds data alone: numbers, arrays and words, and of a function what it returned. Of
    each exercise it has the last right answer, or the last answer if none was right.

    Args:
        lesson: Number of the lesson.
        name: Who hands it in; at most 200 letters. With `...` nothing is written, as for a session
            without answers.
        folder: Where to write the file, which replaces an earlier one.

    Returns:
        The file's path, and what it says of each exercise.

    Raises:
        ConfigError: There is no such lesson, or the name has no letters or too many.
        OSError: The file cannot be written.
    """
    exercises = exercises_of(lesson)
    states = {exercise.id: _state(exercise.id) for exercise in exercises}
    if name is ...:  # The blank of a student's notebook.
        return HandedIn(path=None, text="Nothing was written: give your name.", states=states)
    path = check_path("folder", folder) / f"lesson-{lesson}-{_part_of_path(name)}.json"
    given = {k: _plain(answers_seen[k].seen) for k in states if k in answers_seen}
    if not given:  # An earlier file may have them.
        text = (
            "Nothing was written: this session has no answers to the lesson. Run the notebook from "
            "its start, then this cell."
        )
        return HandedIn(path=None, text=text, states=states)
    check_file(path, "hand_in")
    document = {
        "format": FORMAT,
        "package": __version__,
        "lesson": str(lesson),
        "name": name,
        "answers": given,
    }
    write_file(path, json.dumps(document, ensure_ascii=False) + "\n")
    right = sum(answers_seen[k].is_right for k in given)
    text = f"Written: {path} ({right} of {len(states)} right). Hand in this file."
    return HandedIn(path=path, text=text, states=states)


def _state(exercise: str) -> str:
    if exercise not in answers_seen:
        return "not answered in this session"
    return "right" if answers_seen[exercise].is_right else "not right yet"


def _part_of_path(name: Any) -> str:
    """A name as a part of a file's name."""
    if len(check_text("name", name)) > MOST_LETTERS:
        raise ConfigError(f"name has {len(name)} letters, at most {MOST_LETTERS}")
    letters = "".join(letter if letter.isalnum() else " " for letter in name.lower())
    if not letters.split():
        raise ConfigError(f"name = {name!r} has no letters")
    return "-".join(letters.split())[:60]


def _plain(seen: Seen) -> Any:
    if isinstance(seen, dict):
        return {name: _plain(part) for name, part in seen.items()}
    return seen.tolist() if isinstance(seen, np.ndarray) else seen
