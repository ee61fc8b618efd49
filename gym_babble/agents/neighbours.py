"""Random babbling with a nearest-neighbour inverse model."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from gym_babble import _core
from gym_babble.agents.deciding import Learning
from gym_babble.checks import check_choice, check_threads, check_whole

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["NearestNeighbours"]

BABBLINGS = ("paper", "chain")
PERCEPTS = {"reach": ("eye", "obstacle"), "grasp": ("eye", "fovea"), "chain": ("eye", "fovea")}
ACTIONS = {"reach": ("b",), "grasp": ("arm", "hand"), "chain": ("pregrasp", "arm", "hand")}
WIDTHS = {"reach": (4, 2), "grasp": (443, 4), "chain": (3, 6)}
PERIOD_S = {"reach": None, "grasp": 2.0, "chain": None}
DISTANCE = np.hypot(*np.mgrid[-10:11, -10:11]).ravel()
"""Distances of the fovea's blocks from its middle, in blocks."""


class NearestNeighbours(Learning):
    """Babbles at random and remembers all; what is seen recalls what was done in the nearest cases.

    It babbles as `HebbBabbling` does, in the same sequence, and learns from the same babbles. In
    the paper's grasping it remembers three moments of each, at the ends of its three movements.

    In reaching it looks for the k nearest of all (eye, obstacle), each number divided by its
    standard deviation among those remembered. In grasping, as in the paper, the eye's posture
    recalls the arm's (the same distance), and the fovea's edges recall the hand's (Euclidean
    distance of the 441 activities), which then closes further by what `HebbBabbling` adds.

    With `babbling="chain"` it remembers the babbles of `HebbBabbling(variant="chain")`. Eye and
    size, the mean distance of the fovea's edges from its middle, recall the arm before the grasp
    and at contact, and the hand; it acts in the phases of the chain.

    Of the k actions it takes the one whose distances to the others have the least sum (the medoid).
    A mean of movements to the left and to the right of an obstacle would go straight into it.

    `learn(babbles)` counts legal movements, or objects kept in the hand.

    Args:
        env: An id or an environment; it decides the task, and its control how the agent acts.
        k: Neighbours, 1 or more.
        babbling: "paper", or in grasping "chain".
        seed: Seed of the babbling.
        threads: Threads that babble; all processors if not given. Results do not depend on it.

    Raises:
        ConfigError: An argument is out of its bounds, or the agent cannot act there.
    """

    KIND = "nearest_neighbours"
    TASKS = ("reach", "grasp")
    ARRAYS = ("_seen", "_done")

    def __init__(
        self,
        env: EnvLike = "BabbleReachPattern-v0",
        *,
        k: int = 9,
        babbling: str = "paper",
        seed: int = 0,
        threads: int | None = None,
    ) -> None:
        settings = {
            "k": check_whole("k", k, 1, 1_000, "neighbours"),
            "babbling": check_choice("babbling", babbling, BABBLINGS),
        }
        super().__init__(env, seed, settings, chain=babbling == "chain")
        self._k, self._threads = int(k), check_threads(threads)
        seen, done = WIDTHS[self._kind]
        self._seen = np.zeros((0, seen), np.float32)
        self._done = np.zeros((0, done), np.float32)

    @property
    def _kind(self) -> str:
        """The task, or "chain"."""
        return "chain" if self._chain else self._interface.entry.name

    def _learn(self, babbles: int) -> None:
        found, self._babbled, self._learnt = _core.learnable_babbles(
            self._learns_in().task,
            babbles,
            self._seed,
            self._babbled,
            self._learnt,
            self._babbling,
            PERIOD_S[self._kind],
            self._threads,
        )
        seen = self._sight(found["percepts"]).astype(np.float32)
        done = np.hstack([found["actions"][name] for name in ACTIONS[self._kind]])
        self._seen, self._done = np.vstack([self._seen, seen]), np.vstack([self._done, done])

    def _sight(self, percepts: Mapping[str, NDArray[np.float32]]) -> NDArray[np.float64]:
        """The numbers (n, m) that experiences are compared by."""
        first, second = (percepts[name].astype(np.float64) for name in PERCEPTS[self._kind])
        return np.hstack([first, _sizes(second) if self._chain else second])

    def _decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        slices = dict(self._interface.spec.slices)
        wanted = self._sight({name: senses[:, slices[name]] for name in PERCEPTS[self._kind]})
        if not len(self._seen):
            return self._middle(len(wanted))
        if self._kind == "grasp":
            spread, edges = _spread(self._seen[:, :2]), self._seen[:, 2:]
            where = self._seen[:, :2] / spread
            arms = np.stack([self._recall(where, x[:2] / spread, 0, 2) for x in wanted])
            hands = np.stack([self._recall(edges, x[2:], 2, 4) for x in wanted])
            return self._posture(arms, hands)
        spread = _spread(self._seen)
        near = [(self._seen / spread, x / spread) for x in wanted]
        if self._kind == "reach":
            return np.stack([self._recall(*pair, 0, 2) for pair in near])
        arms = np.stack([self._recall(*pair, 0, 4) for pair in near])
        hands = np.stack([self._recall(*pair, 4, 6) for pair in near])
        return self._posture(arms, hands)

    def _recall(
        self, seen: NDArray[np.float32], wanted: NDArray[np.float64], first: int, last: int
    ) -> NDArray[np.float64]:
        """Numbers `first` to `last` of the medoid of the actions nearest to a percept."""
        distance = np.square(seen - wanted.astype(np.float32)).sum(axis=1)
        nearest = np.argsort(distance, kind="stable")[: self._k]
        actions = self._done[nearest, first:last].astype(np.float64)
        apart = np.linalg.norm(actions[:, None] - actions[None], axis=2)
        medoid: NDArray[np.float64] = actions[np.argmin(apart.sum(axis=1))]
        return medoid

    def _middle(self, n: int) -> NDArray[np.float64]:
        """What it does before it has learnt: a straight movement, or the middle of all ranges."""
        if self._kind == "reach":
            return np.full((n, 2), 0.5)
        arm, hand = np.split(self._interface.quantities["ranges"].mean(axis=1), 2)
        return np.tile(np.hstack([arm, arm, hand] if self._chain else [arm, hand]), (n, 1))

    def _posture(
        self, arms: NDArray[np.float64], hands: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Postures [rad] from shares of the arm's ranges and equilibrium points of the hand."""
        ranges, reflex = (self._interface.quantities[name] for name in ("ranges", "reflex"))
        low, high = np.tile(ranges[:2].T, arms.shape[1] // 2)
        variant = "chain" if self._chain else "paper"
        squeeze = json.loads(_core.brain_json("grasp", variant))["squeeze_deg"]
        closed = np.minimum(np.radians(90.0 - hands + squeeze), reflex)
        return np.hstack([low + arms * (high - low), closed])


def _spread(seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """Standard deviation of each number; 1 where all are the same."""
    spread = seen.std(axis=0, dtype=np.float64).astype(np.float32)
    return np.where(spread > 0, spread, np.float32(1))


def _sizes(fovea: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean distances (n, 1) of edges (n, 441) from the middle; 0 without edges."""
    total = fovea.sum(axis=1, keepdims=True)
    return np.where(total > 0, fovea @ DISTANCE[:, None] / np.maximum(total, 1e-9), 0.0)
