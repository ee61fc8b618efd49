"""Checks of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks.plain import shown
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["check_finite", "numbers", "shaped"]


def numbers(name: str, value: Any, dtype: Any = np.float64) -> NDArray[Any]:
    """Finite real numbers as an array of `dtype`: from a number, a list, an array or a tensor.

    Raises:
        ConfigError: The value is not made of real numbers, its rows differ in length, or a number
            is not finite.
    """
    try:
        array = np.asarray(value)
    except Exception as error:  # A stranger's __array__ can raise anything.
        raise ConfigError(f"{name} = {shown(value)} is not an array: {error}") from error
    if array.dtype.kind not in "fiu":
        raise ConfigError(f"{name} = {shown(value)} is not made of real numbers")
    with np.errstate(over="ignore"):
        converted = array.astype(dtype)
    check_finite(name, converted, array)
    return converted


def shaped(name: str, value: Any, shape: tuple[int, ...], dtype: Any = np.float32) -> NDArray[Any]:
    """The same, of a given shape.

    Raises:
        ConfigError: As for `numbers`, and for another shape.
    """
    array = numbers(name, value, dtype)
    if array.shape != shape:
        raise ConfigError(f"{name} has shape {array.shape}, expected {shape}")
    return array


def check_finite(name: str, array: NDArray[Any], given: NDArray[Any] | None = None) -> None:
    """Raises `ConfigError` that names the first number of an array that is not finite.

    Args:
        name: Name of the array.
        array: The numbers.
        given: What they were converted from, which the error shows.
    """
    finite = np.isfinite(array)
    if finite.all():
        return
    at = tuple(np.argwhere(~finite)[0].tolist())
    value = (array if given is None else given)[at]
    index = f"[{', '.join(map(str, at))}]" if at else ""
    raise ConfigError(f"{name}{index} = {value} is not finite")
