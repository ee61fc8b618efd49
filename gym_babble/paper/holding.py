"""How many objects the enclosure reflex holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.checks import check_flag, check_number, check_whole, numbers, processors
from gym_babble.config import config_json
from gym_babble.progress import track
from gym_babble.study.outcomes import wilson

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.config import ConfigLike

__all__ = ["HOLD_DIAMETERS_M", "hold_rates"]

HOLD_DIAMETERS_M = (0.024, 0.03, 0.04, 0.05, 0.06)
"""Diameters tested by default [m]."""


def hold_rates(
    trials: int = 100,
    config: ConfigLike = "paper",
    diameters: Sequence[float] = HOLD_DIAMETERS_M,
    *,
    progress_bar: bool = False,
) -> list[dict[str, Any]]:
    """Counts the objects that the reflex holds through 10 s of arm motion without support.

    The reflex closes on an object at the palm for 3 s. Then the support is removed, and the arm
    moves to a random posture every half second.

    Args:
        trials: Trials for each diameter.
        config: Body and task.
        diameters: Diameters of the objects [m].
        progress_bar: Show a bar with the time left.

    Returns:
        For each diameter a dict: counts, rate, Wilson interval, deepest penetration, and the mean
        flexion of thumb and finger.

    Raises:
        ConfigError: A number is out of bounds, or the config is invalid.
    """
    trials = check_whole("trials", trials, 1, 1_000_000, "trials")
    sizes = numbers("diameters", diameters).ravel().tolist()
    sizes = [check_number("diameters", size, 0.005, 0.2, "m") for size in sizes]
    show = check_flag("progress_bar", progress_bar)
    task = _core.Task("grasp", config_json(config), "{}")
    rates = []
    total = trials * len(sizes)
    parts = track([trials] * len(sizes), "holding", total=total, show=show)
    for diameter, _ in zip(sizes, parts, strict=True):
        held, penetration, flexion = _core.hold(task, diameter, trials, processors())
        low, high = wilson(held, trials)
        rates.append(
            {
                "diameter": diameter,
                "trials": trials,
                "held": held,
                "rate": held / trials,
                "low": low,
                "high": high,
                "penetration_mm": 1000 * penetration,
                "flexion_deg": np.degrees(flexion).tolist(),
            }
        )
    return rates
