"""Kinds of answers: how one is observed, and how its data is read from a file.

Observing an answer may run a student's code: a function is called, an agent acts. It leaves data:
a number, a text, an array, or arrays by name. Judging needs this data alone, so that a handed-in
file is judged again without running anybody's code.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray  # noqa: TC002 - as elsewhere, for who reads annotations

from gym_babble.checks import numbers, shown
from gym_babble.errors import ConfigError

__all__ = [
    "Answer",
    "Choice",
    "Function",
    "Number",
    "Numbers",
    "Observed",
    "Seen",
    "UnansweredError",
    "UnsuitableError",
    "unanswered",
]

Seen: TypeAlias = Any
"""Data of an answer: a float, a str, a float64 array, or a dict of arrays."""

Shape: TypeAlias = tuple[int, ...]

LARGEST = 1e6
"""Bound of the numbers in an answer, unless its kind says otherwise."""


class UnansweredError(Exception):
    """The answer, or a part of it, is still `...`."""


class UnsuitableError(ConfigError):
    """The answer is of another kind than the exercise asks for. The message says of which."""


class Answer(Protocol):
    """A kind of answer."""

    def observe(self, answer: Any) -> Seen:
        """Data of a student's answer.

        Raises:
            UnansweredError: It is `...`, or a function that returns this.
            UnsuitableError: It is of another kind.
            Exception: The student's code raises.
        """
        ...

    def read(self, value: Any) -> Seen:
        """The same data from a handed-in file.

        Raises:
            ConfigError: It is not what `observe` gives.
        """
        ...


def unanswered(answer: Any) -> bool:
    """Whether an answer, or a part of a list, tuple or dict, is `...`."""
    if isinstance(answer, Mapping):
        return any(unanswered(part) for part in answer.values())
    if isinstance(answer, list | tuple):
        return any(unanswered(part) for part in answer)
    return answer is ...


@dataclass(frozen=True, kw_only=True)
class Number:
    """One number."""

    unit: str = ""
    """Unit that errors name, such as "s"."""
    low: float = -LARGEST
    """Lowest number that is accepted as an answer, right or wrong."""
    high: float = LARGEST
    """Highest number."""

    def observe(self, answer: Any) -> float:
        """The number; arrays of one number are accepted."""
        array = _array(answer, self.low, self.high, self.unit)
        if array.size != 1:
            raise UnsuitableError(
                f"Your answer has {array.size} numbers. One number{_in(self.unit)} is expected."
            )
        return float(array.reshape(()))

    read = observe


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """An array of numbers."""

    shape: Shape
    """Shape of the array."""
    unit: str = ""
    """Unit that errors name."""
    low: float = -LARGEST
    """Lowest number that is accepted."""
    high: float = LARGEST
    """Highest number."""

    def observe(self, answer: Any) -> NDArray[np.float64]:
        """The array (`shape`), float64."""
        array = _array(answer, self.low, self.high, self.unit)
        if array.shape != self.shape:
            raise UnsuitableError(
                f"Your answer has shape {array.shape}. Shape {self.shape} is expected."
            )
        return array

    read = observe


class Choice:
    """One of some words.

    Args:
        *choices: The words.
    """

    def __init__(self, *choices: str) -> None:
        self.choices = choices

    def observe(self, answer: Any) -> str:
        """The word as the exercise writes it; capital letters and spaces do not matter."""
        if isinstance(answer, str):
            for choice in self.choices:
                if answer.strip().lower() == choice.lower():
                    return choice
        raise UnsuitableError(
            f"Your answer is {shown(answer)}. One of these is expected: "
            f"{', '.join(map(repr, self.choices))}."
        )

    read = observe


@dataclass(frozen=True, kw_only=True)
class Function:
    """A function, called with inputs of the exercise's; its data are the results."""

    inputs: Callable[[], Sequence[tuple[Any, ...]]]
    """Gives the arguments of each call. The same ones each time, at most 1,000 calls."""
    shape: Shape = ()
    """Shape of a result."""
    low: float = -LARGEST
    """Lowest number in a result that is accepted."""
    high: float = LARGEST
    """Highest number in a result."""

    def observe(self, answer: Any) -> NDArray[np.float64]:
        """Results of all calls (n, *shape). The function gets copies of the inputs."""
        if not callable(answer):
            raise UnsuitableError(
                f"Your answer is {shown(answer)}. A function is expected: give its name without "
                "parentheses."
            )
        results = []
        for arguments in self.inputs():
            result = answer(*deepcopy(arguments))
            if unanswered(result):
                raise UnansweredError
            if result is None:
                raise UnsuitableError("Your function returns None. Does it end with `return`?")
            array = _array(result, self.low, self.high, "", "Your function returns")
            if self.shape == () and array.size == 1:
                array = array.reshape(())
            if array.shape != self.shape:
                raise UnsuitableError(
                    f"Your function returns an array of shape {array.shape}. "
                    f"{_shape_text(self.shape)} is expected."
                )
            results.append(array)
        return np.stack(results)

    def read(self, value: Any) -> NDArray[np.float64]:
        """Results of all calls (n, *shape)."""
        shape = (len(self.inputs()), *self.shape)
        return Numbers(shape=shape, low=self.low, high=self.high).read(value)


@dataclass(frozen=True, kw_only=True)
class Observed:
    """Anything else, such as an agent or an environment: arrays that a function observes."""

    observe_by: Callable[[Any], Mapping[str, Any]]
    """Observes an answer: arrays by name. May raise `UnsuitableError`."""
    parts: Mapping[str, Shape] = field(default_factory=dict)
    """Shape of each array."""
    low: float = -LARGEST
    """Lowest number that is accepted."""
    high: float = LARGEST
    """Highest number."""

    def observe(self, answer: Any) -> dict[str, NDArray[np.float64]]:
        """The arrays by name, float64."""
        return self.read(self.observe_by(answer))

    def read(self, value: Any) -> dict[str, NDArray[np.float64]]:
        """The arrays by name, float64."""
        if not isinstance(value, Mapping) or value.keys() != self.parts.keys():
            raise UnsuitableError(f"Arrays named {', '.join(self.parts)} are expected.")
        return {
            name: Numbers(shape=shape, low=self.low, high=self.high).read(value[name])
            for name, shape in self.parts.items()
        }


def _array(
    value: Any, low: float, high: float, unit: str, what: str = "Your answer is"
) -> NDArray[np.float64]:
    """Finite numbers within bounds."""
    if isinstance(value, str):
        raise UnsuitableError(f"{what} the text {shown(value)}. Write the number without quotes.")
    if callable(value):
        raise UnsuitableError(f"{what} {shown(value)}. Call it, and give its result.")
    try:
        array: NDArray[np.float64] = numbers("answer", value)
    except ConfigError as error:
        problem = str(error).partition(" is ")[2] or str(error)
        raise UnsuitableError(f"{what} {shown(value)}, which is {problem}.") from error
    if array.size and not (low <= array.min() and array.max() <= high):
        worst = array.min() if array.min() < low else array.max()
        raise UnsuitableError(
            f"{what} {worst:g}{unit and ' ' + unit}. "
            f"Numbers between {low:g} and {high:g} are expected."
        )
    return array


def _in(unit: str) -> str:
    return f" in {unit}" if unit else ""


def _shape_text(shape: Shape) -> str:
    return f"Shape {shape}" if shape else "One number"
