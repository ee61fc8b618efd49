"""Measures of a reach, as studies of infants report them.

A path is the hand's places (k, 2) [m], one after each time step, from rest to the end of the reach;
with `record=True`, `env.trajectory` is the one of an episode.

>>> import numpy as np
>>> corner = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]])
>>> round(straightness(corner), 3)
1.414
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks import check_number, numbers
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["movement_units", "speeds", "straightness"]

RISE_M_S = 0.01
"""How much the speed rises and falls in a movement unit [m/s]."""


def speeds(path: ArrayLike, step_s: float) -> NDArray[np.float64]:
    """The hand's mean speed in each time step (k − 1,) [m/s].

    Args:
        path: Places (k, 2) [m].
        step_s: Time between two of them [s].

    Raises:
        ConfigError: The path has another shape or is not of finite numbers, or the time is not
            positive.
    """
    step_s = check_number("step_s", step_s, 1e-6, 1e6, "s")
    moved: NDArray[np.float64] = np.linalg.norm(np.diff(_places(path), axis=0), axis=1)
    return moved / step_s


def movement_units(path: ArrayLike, step_s: float, *, rise_m_s: float = RISE_M_S) -> int:
    """Number of movement units: accelerations, each with the deceleration after it.

    Infants' first reaches consist of several, and those of adults of one or two (von Hofsten 1991,
    Journal of Motor Behavior 23). A unit is counted as Clifton, Rochat, Robin & Berthier (1994,
    Journal of Experimental Psychology: Human Perception and Performance 20) do: a peak of the speed
    that is at least 1 cm/s above the lowest speed on both sides, up to the next such peak. Before
    and after the path the hand is taken to be at rest: a reach that a touch ends at full speed has
    a last unit too.

    Args:
        path: Places (k, 2) [m].
        step_s: Time between two of them [s].
        rise_m_s: The least rise and fall [m/s].

    Raises:
        ConfigError: As for `speeds`, or the rise is not positive.
    """
    rise = check_number("rise_m_s", rise_m_s, 1e-9, 1e6, "m/s")
    units, lowest, highest, rising = 0, 0.0, 0.0, False
    for speed in (*speeds(path, step_s).tolist(), 0.0):
        if rising:
            highest = max(highest, speed)
            if speed <= highest - rise:
                units, lowest, rising = units + 1, speed, False
        else:
            lowest = min(lowest, speed)
            if speed >= lowest + rise:
                highest, rising = speed, True
    return units


def straightness(path: ArrayLike) -> float:
    """Length of a path over the distance of its ends: 1 for a straight one, NaN without a distance.

    Infants' reaches become straighter with age (von Hofsten 1991; Berthier & Keen 2006,
    Experimental Brain Research 169).

    Args:
        path: Places (k, 2) [m].

    Raises:
        ConfigError: As for `speeds`.
    """
    places = _places(path)
    distance = float(np.linalg.norm(places[-1] - places[0]))
    length = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())
    return length / distance if distance else float("nan")


def _places(path: ArrayLike) -> NDArray[Any]:
    places = numbers("path", path)
    if places.ndim != 2 or places.shape[1] != 2 or len(places) < 2:
        raise ConfigError(f"path has shape {places.shape}, expected (k, 2) with k of at least 2")
    return places
