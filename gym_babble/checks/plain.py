"""A user's values as JSON has them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["plain", "shown"]

MOST_LEVELS = 16
"""Levels of a nested value; a config has five."""
MOST_ITEMS = 1_000
"""Items of a list or dict."""
MOST_LETTERS = 80
"""Letters of a value that an error shows."""


def shown(value: Any) -> str:
    """A value as an error shows it: its `repr`, shortened."""
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001 - a stranger's repr, or an int with too many digits
        return f"a {type(value).__name__}"
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]} …"


def plain(value: Any, path: str, *, kind: str = "") -> Any:
    """A value made of what JSON has: dicts, lists, text, finite numbers, booleans and None.

    NumPy's scalars and arrays become Python's, and tensors too; dataclasses become dicts.

    Args:
        value: The value.
        path: Name of the value; errors continue it to the field in it. A whole document has none.
        kind: What errors put before the path, e.g. "config: ".

    Raises:
        ConfigError: A field is of another kind, not finite, or nested or longer than any value
            should be.
    """
    return _Reader(kind).read(value, path, 0)


class _Reader:
    def __init__(self, kind: str) -> None:
        self._kind = kind

    def read(self, value: Any, path: str, level: int) -> Any:
        if hasattr(value, "__array__"):
            value = self._of_array(np.asarray(value), path)
        if isinstance(value, bool | str | None):
            return value
        if isinstance(value, int | float):
            return self._number(value, path)
        return self._several(value, path, level)

    def _several(self, value: Any, path: str, level: int) -> Any:
        if level == MOST_LEVELS:
            self._refuse(path, f"nested in more than {MOST_LEVELS} levels")
        if is_dataclass(value) and not isinstance(value, type):
            value = {field.name: getattr(value, field.name) for field in fields(value)}
        if not isinstance(value, Mapping | list | tuple):
            self._refuse(path, _not_json(value))
        if len(value) > MOST_ITEMS:
            self._refuse(path, f"{len(value)} items are more than {MOST_ITEMS}")
        if isinstance(value, Mapping):
            return self._dict(value, path, level)
        return [self.read(item, f"{path}[{i}]", level + 1) for i, item in enumerate(value)]

    def _of_array(self, value: NDArray[Any], path: str) -> Any:
        if value.dtype.kind not in "biufU":
            self._refuse(path, f"an array of {value.dtype} is not made of numbers")
        if value.size > MOST_ITEMS:
            self._refuse(path, f"{value.size} items are more than {MOST_ITEMS}")
        return value.tolist()

    def _number(self, value: float, path: str) -> float:
        if isinstance(value, int) and not -(2**63) <= value < 2**64:
            self._refuse(path, f"{shown(value)} is not in [-2^63, 2^64)")
        if not math.isfinite(value):
            self._refuse(path, f"{value} is not finite")
        return value

    def _dict(self, value: Mapping[Any, Any], path: str, level: int) -> dict[str, Any]:
        read = {}
        for name, item in value.items():
            if not isinstance(name, str):
                self._refuse(path, f"{shown(name)} is not the name of a field")
            at = f"{path}.{name}" if path else name
            read[name] = self.read(item, at, level + 1)
        return read

    def _refuse(self, path: str, problem: str) -> NoReturn:
        raise ConfigError(f"{self._kind}{path or 'document'}: {problem}")


def _not_json(value: Any) -> str:
    return (
        f"{shown(value)} is not a number, a text, True, False or None, nor a list or dict of these"
    )
