"""The experiences of motor babbling, without learning from them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.agents.base import interface_of
from gym_babble.checks import check_flag, check_seed, check_threads, check_whole

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
    """The experiences of n babbles; row k is babble k."""

    percepts: dict[str, NDArray[np.float32]]
    """What was seen, by the names of the environment's senses: in reaching `eye` (n, 2) and
    `obstacle` (n, 2) before the movement; in grasping `eye` (n, 2) and `fovea` (n, 441) after it,
    `eye` NaN where the hand hides the object."""
    actions: dict[str, NDArray[np.float32]]
    """What was done: in reaching the parameters `b` (n, 2); in grasping the postures `arm` (n, 2),
    as shares of the joint ranges, and `hand` (n, 2), EP = 90° − flexion [deg]."""
    case: dict[str, NDArray[np.float32]]
    """What else was sampled: in grasping the object's `diameter` (n, 1) [m]."""
    learnable: NDArray[np.bool_]
    """Which babbles can be learnt from (n,): the movement was legal, or the hand kept the object in
    sight of the eye. They are those that `HebbBabbling` learns from, in its order."""
    outcome: NDArray[Any]
    """How each ended (n,), as in `info["outcome"]`; in grasping "success" or "lost"."""

    def __len__(self) -> int:
        """Number n of babbles."""
        return len(self.learnable)

    def __getitem__(self, which: Any) -> Experiences:
        """Some of the babbles, as NumPy's index of rows picks them."""
        parts = {
            name: {key: values[which] for key, values in getattr(self, name).items()}
            for name in ("percepts", "actions", "case")
        }
        return Experiences(learnable=self.learnable[which], outcome=self.outcome[which], **parts)


def babble(
    env: EnvLike,
    n: int,
    seed: int = 0,
    *,
    quasi_static: bool = False,
    threads: int | None = None,
) -> Experiences:
    """The first n babbles of a seed.

    Args:
        env: An id or an environment: its task and config are babbled with.
        n: How many.
        seed: Seed of the babbling. Babble k depends on it and on k alone.
        quasi_static: In reaching, without the muscles' lag: faster, and less like the paper.
        threads: Threads that babble; all processors if not given. Results do not depend on it.

    Raises:
        ConfigError: An argument is out of its bounds, or `env` is not an environment of this
            package.
    """
    n, seed = check_whole("n", n, 1, MOST_BABBLES, "babbles"), check_seed(seed)
    fast = check_flag("quasi_static", quasi_static)
    options = json.dumps({"quasi_static": True} if fast else None)
    return experiences_of(interface_of(env), n, seed, options, check_threads(threads))


def experiences_of(
    interface: Interface, n: int, seed: int, options: str, threads: int
) -> Experiences:
    """The first n babbles of a seed; `options` say how they are simulated, as JSON."""
    found = _core.babble(interface.task, n, seed, options, threads)
    return Experiences(
        percepts=found["percepts"],
        actions=found["actions"],
        case=found["case"],
        learnable=found["learnable"],
        outcome=interface.outcomes[found["outcome"]].astype(str),
    )
