"""Online goal babbling (Rolf, Steil & Gienger 2011), for both tasks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gym_babble import _core
from gym_babble.agents.deciding import Learning
from gym_babble.agents.local_maps import LocalMaps
from gym_babble.agents.practising import Practice, stream
from gym_babble.checks import check_number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["GoalBabbling"]

FIELD_RAD = np.radians(30.0)
"""Angle of the obstacle that counts as far as all of the eye's range."""
DRIFT = {"reach": 1.0, "grasp": 0.1}
"""Change of the exploration from one movement to the next, over its size: in reaching each movement
is of another case, and in grasping they follow each other."""
HOME = 0.1
"""Probability that a babble begins at home."""
POSTURES = 3
"""Postures that the arm moves to in a babble of grasping."""
DEFAULTS = {
    "reach": {"radius": 0.2, "rate": 0.3, "noise": 0.2},
    "grasp": {"radius": 0.2, "rate": 0.9, "noise": 0.1},
}


class GoalBabbling(Learning):
    """Tries to reach goals with its own inverse estimate and noise, and learns from what happened.

    The estimate g from goals x to actions q is made of local linear maps that learn online. A trial
    has a goal x*, executes q = g(x*) + A x* + c, where the numbers of A and c explore as a random
    walk whose variance stays the same, observes the outcome x, and learns (x, q) with a weight w.

    In reaching, a movement ends at the target whatever its form, so the paper's outcomes, places of
    the hand, are not at hand. A goal here is a case, "reach this target around this obstacle": x*
    is what eye and obstacle show, and q is b1 of the movement (b1, 1 − b1), which babbling makes
    too. A success has the goal itself as its outcome, so w = 1. A movement that collides or leaves
    the joint ranges leads to no goal, so w = 0. Cases do not lie on a path, so there are no weights
    of direction and efficiency. Home is the straight movement, b1 = ½.

    In grasping it babbles with the object in the hand, as `HebbBabbling` does, but chooses where
    the arm goes. Goals are directions in which the eye sees objects of sampled cases; a babble
    moves in three equal steps from the last goal to a new one. What is learnt is the arm's posture
    q as it is, and where the eye finds the object in the hand, x. The weights are the paper's, at
    most 1: with a dash for the step before, w = ½ (1 + cos(x* − x*', x − x')) |x − x'| / |q − q'|,
    but 0 if the hand lost or hid the object. Some babbles begin at home, the middle of the arm's
    ranges, with w = 1. The hand does not learn: it closes as the reflex does.

    `learn(babbles)` counts all movements, or babbles, that it makes; `learnt` those with a weight.

    Args:
        env: An id or an environment; it decides the task, and its control how the agent acts.
        radius: Radius of a local map, over the eye's range.
        rate: Learning rate.
        noise: Standard deviation of the numbers in A and c, over the range of the actions.
        seed: Seed of goals and exploration.

    Raises:
        ConfigError: An argument is out of its bounds, or the agent cannot act there.
    """

    KIND = "goal_babbling"
    TASKS = ("reach", "grasp")
    ARRAYS = ("_places", "_maps", "_exploration", "_goal")

    def __init__(
        self,
        env: EnvLike = "BabbleReachPattern-v0",
        *,
        radius: float | None = None,
        rate: float | None = None,
        noise: float | None = None,
        seed: int = 0,
    ) -> None:
        super().__init__(env, seed, {})
        given = {"radius": radius, "rate": rate, "noise": noise}
        numbers = DEFAULTS[self._interface.entry.name]
        self._settings = {
            name: check_number(name, numbers[name] if value is None else value, 0.0, 10.0, "")
            for name, value in given.items()
        }
        reaching = self._interface.entry.name == "reach"
        self._home = np.full(1 if reaching else 2, 0.5)
        self._goal = np.full(4 if reaching else 2, 0.5, np.float32)
        maps = self._estimate()
        self._places, self._maps = maps.places, maps.maps
        size = (len(self._home), len(self._goal) + 1)
        first = np.random.default_rng([self._seed, 2**32]).standard_normal(size)
        self._exploration = (self._settings["noise"] * first).astype(np.float32)

    def _estimate(self) -> LocalMaps:
        """The inverse estimate g as it is."""
        maps = LocalMaps(
            self._settings["radius"], self._settings["rate"], self._home, len(self._goal)
        )
        if hasattr(self, "_maps"):
            maps.places, maps.maps = self._places, self._maps
        return maps

    def _percept(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Goals x (n, 4) or (n, 2) that flat senses show."""
        eye = self._percepts(senses, "eye")
        if self._interface.entry.name == "grasp":
            return eye
        return np.hstack([eye, self._percepts(senses, "obstacle") / FIELD_RAD])

    def _decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        estimate = self._estimate()
        chosen = np.stack([estimate(x) for x in self._percept(senses)]).clip(0.0, 1.0)
        if self._interface.entry.name == "reach":
            return np.hstack([chosen, 1.0 - chosen])
        ranges, reflex = (self._interface.quantities[name] for name in ("ranges", "reflex"))
        low, high = ranges[:2].T
        return np.hstack([low + chosen * (high - low), np.tile(reflex, (len(chosen), 1))])

    def _learn(self, babbles: int) -> None:
        estimate = self._estimate()
        practice = Practice(self._learns_in(), self._seed)
        trial = self._move if self._interface.entry.name == "reach" else self._carry
        for _ in range(babbles):
            senses = practice.see(self._babbled)
            goal = self._percept(senses[None])[0]
            self._learnt += trial(estimate, practice, goal, stream(self._seed, self._babbled))
            self._babbled += 1
            self._places, self._maps = estimate.places, estimate.maps

    def _move(
        self,
        estimate: LocalMaps,
        practice: Practice,
        goal: NDArray[np.float64],
        random: np.random.Generator,
    ) -> bool:
        """One movement in reaching; whether it was learnt from."""
        chosen = self._explore(estimate, goal, random)
        weight = practice.move(float(chosen[0]))
        estimate.learn(goal, chosen, weight)
        return weight > 0

    def _carry(
        self,
        estimate: LocalMaps,
        _practice: Practice,
        goal: NDArray[np.float64],
        random: np.random.Generator,
    ) -> bool:
        """One babble in grasping; whether it was learnt from."""
        goals = np.linspace(self._goal, goal, POSTURES + 1)[1:].astype(np.float64)
        self._goal = goal.astype(np.float32)
        actions = np.stack([self._explore(estimate, x, random) for x in goals])
        home = random.uniform() < HOME
        if home:
            actions[0] = self._home
        found = _core.babble_to(
            self._learns_in().task, self._seed, self._babbled, actions.reshape(1, -1), 1
        )
        seen = found["percepts"]["eye"].astype(np.float64)
        arms = found["actions"]["arm"].astype(np.float64)
        weights = _weights(goals, seen, arms) * found["learnable"]
        weights[0] = float(home and found["learnable"][0])
        for x, q, weight in zip(seen, arms, weights, strict=True):
            estimate.learn(x, q, float(weight))
        return bool(weights.any())

    def _explore(
        self, estimate: LocalMaps, goal: NDArray[np.float64], random: np.random.Generator
    ) -> NDArray[np.float64]:
        """The action for a goal, with exploration, which drifts on."""
        size, drift = self._settings["noise"], DRIFT[self._interface.entry.name]
        moved = self._exploration + drift * size * random.standard_normal(self._exploration.shape)
        self._exploration = (moved / np.sqrt(1 + drift**2)).astype(np.float32)
        noise = self._exploration @ np.append(goal, 1.0)
        action: NDArray[np.float64] = np.clip(estimate(goal) + noise, 0.0, 1.0)
        return action


def _weights(
    goals: NDArray[np.float64], seen: NDArray[np.float64], actions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Weights of direction and efficiency of the steps of a babble (n,); 0 for the first."""
    weights = np.zeros(len(goals))
    meant, came, moved = (np.diff(points, axis=0) for points in (goals, seen, actions))
    for i, (wanted, outcome, effort) in enumerate(zip(meant, came, moved, strict=True), 1):
        lengths = [float(np.linalg.norm(step)) for step in (wanted, outcome, effort)]
        if np.isfinite(lengths).all() and min(lengths) > 0:
            cosine = float(wanted @ outcome) / (lengths[0] * lengths[1])
            weights[i] = 0.5 * (1.0 + cosine) * min(lengths[1] / lengths[2], 1.0)
    return weights
