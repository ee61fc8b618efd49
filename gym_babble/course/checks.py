"""`check`, and what it has seen in this session."""

from __future__ import annotations

import sysconfig
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.course.answers import UnansweredError, UnsuitableError, unanswered
from gym_babble.course.lessons import exercise_named
from gym_babble.course.results import Result
from gym_babble.errors import MissingExtraError
from gym_babble.viz.style import row_of_axes, styled

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gym_babble.course.answers import Seen
    from gym_babble.course.exercise import Exercise

__all__ = ["Checked", "answers_seen", "check"]

OTHERS = tuple(str(Path(sysconfig.get_path(name)).resolve()) for name in ("stdlib", "purelib"))
OURS = str(Path(__file__).resolve().parents[1])
SIZE = (5.2, 3.1)
"""Inches of a picture."""


@dataclass(frozen=True, kw_only=True)
class Checked:
    """An answer that was judged in this session."""

    seen: Seen
    """Data of the answer."""
    is_right: bool
    """Whether it is right."""


answers_seen: dict[str, Checked] = {}
"""For each exercise the last right answer, or the last answer if none was right. It is lost when
the session ends: run the notebook from its start before handing in."""


def check(exercise: str, answer: Any) -> Result:
    """Checks an answer to an exercise.

    A wrong answer, or an answer whose code raises, gives a result that says so.

    Args:
        exercise: Id of the exercise, such as "2.1".
        answer: The answer: a number, an array, a word, a function, an agent, ..., as the exercise
            asks; `...` if there is none yet.

    Returns:
        A result whose `repr` says what is right or wrong. In a notebook it shows a picture, too.

    Raises:
        ConfigError: There is no such exercise. It is a `ValueError`.
    """
    found = exercise_named(exercise)
    try:
        seen = _observed(found, answer)
    except UnansweredError:
        return Result(exercise=found.id, state="unanswered", text=f"Asked for: {found.asks}.")
    except UnsuitableError as error:
        return Result(
            exercise=found.id, state="wrong", text=str(error), hint=f"Asked for: {found.asks}."
        )
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a student's code raises anything
        return Result(
            exercise=found.id,
            state="wrong",
            text=f"Your code raises {type(error).__name__}: {error}",
            hint=f"Look at {_place(error)}.",
        )
    finding = found.find(seen)
    _keep(found.id, Checked(seen=seen, is_right=finding.is_right))
    figure, note = _drawn(found, seen)
    return Result(
        exercise=found.id,
        state="right" if finding.is_right else "wrong",
        text=finding.text,
        hint=finding.hint,
        note=note,
        figure=figure,
    )


def _observed(exercise: Exercise, answer: Any) -> Seen:
    if unanswered(answer):
        raise UnansweredError
    return exercise.answer.observe(answer)


def _keep(exercise: str, checked: Checked) -> None:
    earlier = answers_seen.get(exercise)
    if checked.is_right or earlier is None or not earlier.is_right:
        answers_seen[exercise] = checked


def _drawn(exercise: Exercise, seen: Seen) -> tuple[Figure | None, str]:
    """The picture, or why there is none."""
    if exercise.draw is None:
        return None, ""
    try:
        return _figure(exercise.draw, seen), ""
    except MissingExtraError as missing:
        return None, f"No picture: {missing}"
    except Exception as error:  # noqa: BLE001 - a picture must not cost the answer
        return None, f"No picture: {type(error).__name__}: {error}"


@styled
def _figure(draw: Callable[[Seen, Axes], None], seen: Seen) -> Figure:
    figure, (axes,) = row_of_axes(SIZE, 1)
    draw(seen, axes)
    return figure


def _place(error: BaseException) -> str:
    """The last line of the student's own code that an error went through."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if _is_own(frame.filename)]
    if not own:
        return "the arguments that your code gives"
    line = f": {own[-1].line}" if own[-1].line else ""
    return f"line {own[-1].lineno} of {own[-1].name}{line}"


def _is_own(file: str) -> bool:
    return not file.startswith((OURS, *OTHERS, "<frozen"))
