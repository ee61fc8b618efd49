"""An exercise: what it asks for, how an answer is judged, and a picture of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from gym_babble.course.answers import Answer, Seen

__all__ = ["Exercise", "Finding", "right", "wrong"]


@dataclass(frozen=True)
class Finding:
    """What a judge says of an answer."""

    is_right: bool
    """Whether it is right."""
    text: str
    """What is right or wrong about it, in one or two sentences."""
    hint: str = ""
    """What helps after a wrong answer."""


def right(text: str) -> Finding:
    """The answer is right.

    Args:
        text: What the answer shows.
    """
    return Finding(True, text)  # noqa: FBT003 - the first field


def wrong(text: str, hint: str) -> Finding:
    """The answer is wrong.

    Args:
        text: What is wrong about it.
        hint: What to try next.
    """
    return Finding(False, text, hint)  # noqa: FBT003 - the first field


@dataclass(frozen=True, kw_only=True)
class Exercise:
    """An exercise of a lesson."""

    id: str
    """Its number "N.M": exercise M of lesson N."""
    asks: str
    """What is asked for, without a full stop: "the arm's time constant [s]"."""
    answer: Answer
    """The kind of answer."""
    judge: Callable[[Seen], Finding]
    """Judges what was observed of an answer. It sees data alone and shall raise nothing."""
    draw: Callable[[Seen, Axes], None] | None = None
    """Draws what was observed of an answer beside what is expected."""

    def find(self, seen: Seen) -> Finding:
        """What the judge says. Should it raise, the answer is wrong, and the finding says why."""
        try:
            return self.judge(seen)
        except Exception as error:  # noqa: BLE001 - one answer must not end a notebook or a class
            return wrong(
                f"This answer cannot be judged: {type(error).__name__}: {error}",
                "Try an answer that is nearer to what is asked for.",
            )
