"""Agents that need no learning: random, scripted and oracle."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import Planner
from gym_babble.checks import check_seed, check_threads

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike, Observation

__all__ = ["Oracle", "Random", "ReflexOnly", "Scripted"]


class _Reference(Planner):
    """An agent of the core that needs no learning."""

    _core: _core.Reference
    _name: str

    def __init__(self, env: EnvLike, *, seed: int = 0, threads: int | None = 1) -> None:
        super().__init__(env)
        self._seed, self._threads = check_seed(seed), check_threads(threads)
        self._core = _core.Reference(self._name, self._seed, 0, self._threads)
        self._core.check(self._interface.task)

    def decide(self, observation: Observation) -> NDArray[np.float64]:
        """What it chooses for one observation (k,), or for n of them (n, k).

        In reaching, parameters (b1, b2) of a movement; in grasping, shoulder, elbow, and flexions
        of thumb and finger once the hand closes [rad].

        Raises:
            ConfigError: The random agent of grasping chooses nothing beforehand.
        """
        senses = self._senses(observation)
        chosen = self._core.decide(self._interface.task, np.atleast_2d(senses))
        return chosen if senses.ndim > 1 else chosen[0]

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_choices": self._core.choices()}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        super().__setstate__({k: v for k, v in state.items() if k != "_choices"})
        self._core = _core.Reference(self._name, self._seed, state["_choices"], self._threads)


class Random(_Reference):
    """Acts at random, whatever it sees.

    In reaching it goes on babbling: b1 uniform in its range, b2 = 1 − b1. In grasping it draws each
    action uniformly from [−1, 1]⁴.

    Args:
        env: An id or an environment.
        seed: Seed of its choices; a different one each time if None.

    Raises:
        ConfigError: An argument is out of its bounds, or it is not an environment of this package,
            or one in which it cannot act.
    """

    _name = "random"

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0", *, seed: int | None = None) -> None:
        super().__init__(env, seed=secrets.randbits(64) if seed is None else seed)


class ReflexOnly(_Reference):
    """Grasps by chance and reflex: the arm goes to a random posture, and the hand closes on touch.

    In each episode the posture is uniform in the arm's joint ranges, whatever is seen. On the first
    touch the hand closes as the enclosure reflex does. It shows how much of grasping the reflex
    does alone.

    Args:
        env: An id or an environment of grasping.
        seed: Seed of its choices.

    Raises:
        ConfigError: An argument is out of its bounds, or it is not an environment of grasping, or
            one in which it cannot act.
    """

    _name = "reflex"

    def __init__(self, env: EnvLike = "BabbleGrasp-v0", *, seed: int = 0) -> None:
        super().__init__(env, seed=seed)


class Scripted(_Reference):
    """Does what a person would write down.

    In reaching it bulges towards the shoulder, where the arm folds away from the obstacle:
    |b1 − ½| = ¼. In grasping it goes straight to where the palm meets the object, and closes as the
    enclosure reflex does: it knows the arm's geometry and the eye's, but not the object's size.

    Args:
        env: An id or an environment.

    Raises:
        ConfigError: It is not an environment of this package, or one in which it cannot act.
    """

    _name = "scripted"

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0") -> None:
        super().__init__(env)


class Oracle(_Reference):
    """Tries in simulation before it acts.

    In reaching it simulates up to 99 values of b1 and takes the middle of the longest run that
    succeeds. In grasping it simulates grasps of an object where the eye looks, of each of the
    config's diameters: first the script's, then with other aims and ways around the object; it
    plays the first one that holds all diameters, or else the one that holds most.

    Args:
        env: An id or an environment.
        threads: Threads that simulate; all processors if None. Its choices do not depend on it.

    Raises:
        ConfigError: An argument is out of its bounds, or it is not an environment of this package,
            or one in which it cannot act.
    """

    _name = "oracle"

    def __init__(self, env: EnvLike = "BabbleReachPattern-v0", *, threads: int | None = 1) -> None:
        super().__init__(env, threads=threads)
