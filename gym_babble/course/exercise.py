"""An exercise: what it asks for, how an answer is judged, and a picture of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from gym_babble.course.answers import Answer, Seen

__all__ = ["Exercise", "Finding", "mistake_in", "right", "wrong"]


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


def mistake_in(
    seen: ArrayLike, mistakes: Iterable[tuple[ArrayLike, str, str]], atol: float
) -> Finding | None:
    """The first of the usual mistakes that an answer has.

    Args:
        seen: The answer.
        mistakes: What an answer with a mistake is, what is wrong about it, and a hint.
        atol: How far the answer may be off from it.
    """
    for other, text, hint in mistakes:
        if np.allclose(seen, other, rtol=0, atol=atol):
            return wrong(text, hint)
    return None


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
    """Judges what was observed of an answer. It sees data alone and raises nothing."""
    draw: Callable[[Seen, Axes], None] | None = None
    """Draws what was observed of an answer beside what is expected."""
