"""Usual wrong answers, each with its own message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.course.exercise import Finding, wrong

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Mistake", "usual_mistake"]

Mistake = tuple[Any, str, str]
"""A wrong answer (a number or an array), what is wrong with it, and a hint."""


def usual_mistake(seen: Any, mistakes: Iterable[Mistake], *, within: float) -> Finding | None:
    """The finding for the first mistake that an answer is equal to, or None.

    Args:
        seen: The answer: a number or an array.
        mistakes: Usual wrong answers.
        within: How far each number may be off.
    """
    for value, text, hint in mistakes:
        if np.allclose(seen, value, rtol=0, atol=within):
            return wrong(text, hint)
    return None
