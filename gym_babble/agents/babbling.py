"""The experiences of motor babbling, without learning from them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.agents.base import interface_of
from gym_babble.checks import check_flag, check_number, check_seed, check_threads, check_whole

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike
    from gym_babble.envs.interface import Interface

__all__ = ["Experiences", "babble", "experiences_of"]

MOST_BABBLES = 1_000_000
"""Babbles whose experiences are kept at once."""


@dataclass(frozen=True, kw_only=True)
class Experiences:
    """The experiences of some babbles, in their order; a row is one moment of a babble.

    A babble has one row, at its end; in grasping, with `learning_period_s`, one row after each such
    period while the arm moves.
    """

    percepts: dict[str, NDArray[np.float32]]
    """What was seen, by the names of the environment's senses: in reaching `eye` (n, 2) and
    `obstacle` (n, 2) before the movement; in grasping `eye` (n, 2) and `fovea` (n, 441) after it,
    `eye` NaN where the hand hides the object."""
    actions: dict[str, NDArray[np.float32]]
    """What was done: in reaching the parameters `b` (n, 2); in grasping the postures `arm` (n, 2),
    as shares of the joint ranges, and `hand` (n, 2), EP = 90° − flexion [deg]."""
    case: dict[str, NDArray[np.float32]]
    """What else was sampled: in grasping the object's `diameter` (n, 1) [m]."""
    babble: NDArray[np.uint64]
    """Which babble each row is of (n,), counted from 0."""
    learnable: NDArray[np.bool_]
    """Which rows can be learnt from (n,): the movement was legal, or the hand kept the object, in
    sight of the eye at that moment. They are those that `HebbBabbling` learns from, in its
    order."""
    outcome: NDArray[Any]
    """How the babble of each row ended (n,), by the names in `info["outcome"]`; in grasping
    "success" or "lost"."""

    def __len__(self) -> int:
        """Number n of rows."""
        return len(self.learnable)

    def __getitem__(self, which: Any) -> Experiences:
        """Some of the rows, as NumPy's index of rows picks them."""
        parts = {
            name: {key: values[which] for key, values in getattr(self, name).items()}
            for name in ("percepts", "actions", "case")
        }
        return Experiences(
            babble=self.babble[which],
            learnable=self.learnable[which],
            outcome=self.outcome[which],
            **parts,
        )


def babble(
    env: EnvLike,
    n: int,
    seed: int = 0,
    *,
    quasi_static: bool = False,
    learning_period_s: float | None = None,
    threads: int | None = None,
) -> Experiences:
    """The first n babbles of a seed.

    Args:
        env: An id or an environment: its task and config are babbled with.
        n: How many.
        seed: Seed of the babbling. Babble k depends on it and on k alone.
        quasi_static: In reaching, without the muscles' lag: faster, and less like the paper.
        learning_period_s: In grasping, time between two rows of a babble [s]; one row, at its end,
            if not given.
        threads: Threads that babble; all processors if not given. Results do not depend on it.

    Raises:
        ConfigError: An argument is out of its bounds, or `env` is not an environment of this
            package.
    """
    n, seed = check_whole("n", n, 1, MOST_BABBLES, "babbles"), check_seed(seed)
    fast, threads = check_flag("quasi_static", quasi_static), check_threads(threads)
    options = json.dumps({"quasi_static": True} if fast else None)
    interface, period_s = interface_of(env), learning_period_s
    if period_s is not None:
        period_s = check_number("learning_period_s", period_s, 0.0, 1_000.0, "s")
    return experiences_of(interface, n, seed, options, period_s=period_s, threads=threads)


def experiences_of(
    interface: Interface,
    n: int,
    seed: int,
    options: str,
    *,
    period_s: float | None,
    threads: int,
) -> Experiences:
    """The first n babbles of a seed; `options` say how they are simulated, as JSON."""
    found = _core.babble(interface.task, n, seed, options, period_s, threads)
    return Experiences(
        percepts=found["percepts"],
        actions=found["actions"],
        case=found["case"],
        babble=found["babble"],
        learnable=found["learnable"],
        outcome=interface.outcomes[found["outcome"]].astype(str),
    )
