"""Checks of single arguments."""

from __future__ import annotations

import math
import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.checks.plain import shown
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = [
    "check_choice",
    "check_flag",
    "check_number",
    "check_path",
    "check_seed",
    "check_text",
    "check_threads",
    "check_whole",
    "processors",
]

MOST_THREADS = 1024


def processors() -> int:
    """Processors that this process may use: by its affinity, and by a container's quota."""
    return _core.processors()


def check_whole(name: str, value: Any, low: int, high: int, unit: str) -> int:
    """A whole number within its bounds; NumPy's integers are whole numbers.

    Raises:
        ConfigError: It is another kind of value, or out of bounds.
    """
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not low <= value <= high:
        raise ConfigError(
            f"{name} = {shown(value)} is not a whole number in [{low}, {high}] {unit}"
        )
    return int(value)


def check_number(name: str, value: Any, low: float, high: float, unit: str) -> float:
    """A number within its bounds.

    Raises:
        ConfigError: It is another kind of value, not finite, or out of bounds.
    """
    number = isinstance(value, int | float | np.integer | np.floating)
    if not number or isinstance(value, bool) or not low <= value <= high:
        raise ConfigError(f"{name} = {shown(value)} is not a number in [{low}, {high}] {unit}")
    if not math.isfinite(value):
        raise ConfigError(f"{name} = {shown(value)} is not finite")
    return float(value)


def check_seed(seed: Any) -> int:
    """A seed of the core.

    Raises:
        ConfigError: It is not a whole number of 64 bits.
    """
    whole = isinstance(seed, int | np.integer) and not isinstance(seed, bool)
    if not whole or not 0 <= seed < 2**64:
        raise ConfigError(f"seed = {shown(seed)} is not a whole number in [0, 2^64)")
    return int(seed)


def check_threads(threads: Any) -> int:
    """A number of threads; all processors for None.

    Raises:
        ConfigError: It is neither None nor a whole number within its bounds.
    """
    if threads is None:
        return min(processors(), MOST_THREADS)
    return check_whole("threads", threads, 1, MOST_THREADS, "threads")


def check_path(name: str, value: Any) -> Path:
    """A path.

    Raises:
        ConfigError: It is another kind of value, or no system has such a path.
    """
    if not isinstance(value, str | PathLike):
        raise ConfigError(f"{name} = {shown(value)} is not a path")
    path = Path(value)
    try:
        os.fsencode(path)
    except UnicodeEncodeError as error:
        raise ConfigError(f"{name} = {shown(value)} is not a path: {error}") from error
    return path


def check_flag(name: str, value: Any) -> bool:
    """True or False; NumPy's booleans are booleans.

    Raises:
        ConfigError: It is another kind of value.
    """
    if not isinstance(value, bool | np.bool_):
        raise ConfigError(f"{name} = {shown(value)} is not True or False")
    return bool(value)


def check_text(name: str, value: Any) -> str:
    """A text.

    Raises:
        ConfigError: It is another kind of value.
    """
    if not isinstance(value, str):
        raise ConfigError(f"{name} = {shown(value)} is not a text")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise ConfigError(f"{name} = {shown(value)}: {error}") from error
    return value


def check_choice(name: str, value: Any, known: Iterable[str]) -> str:
    """One of some names.

    Raises:
        ConfigError: It is another value.
    """
    names = tuple(known)
    if not isinstance(value, str) or value not in names:
        raise ConfigError(f"{name} = {shown(value)} is not one of {', '.join(names)}")
    return value
