"""Hebbian learning that a reward modulates."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.deciding import Learning
from gym_babble.agents.practising import Practice, stream
from gym_babble.brain import ConjunctiveMap, PopulationMap
from gym_babble.checks import check_number

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["RewardHebb"]

OUTPUTS = 21
W_MAX = 0.2
"""Bound of the weights, as in Eq. 7."""
VALUE_RATE = 0.1
"""Learning rate η_R of the expected reward."""
SILENT = 1e-4
"""Inputs below this share of the strongest one do not learn."""


class RewardHebb(Learning):
    """Learns to reach by trial and reward: a Hebb rule with a third factor.

    The rule is that of Legenstein, Chase, Schwartz & Maass (2010), which compares what the output
    did with what it was expected to do. Eye and obstacle are encoded in the maps of
    `HebbBabbling`'s variant "conjunctive". They recall 21 output neurons for b1, which are read out
    around the strongest one; noise is added, and the movement (b1, 1 − b1) is made in an episode of
    its own. The environment rewards it: R = 1 for success, else 0. Then

        Δw_ji = η (R − R̄)(a_j − ā_j) g_i (w_max − |w_ji|),

    where a is the code of the b1 that was made and ā that of the b1 that was read out; a silent
    output makes a random movement, with ā = 0. R̄ is the reward that such inputs had so far: a
    linear function of g with ΔR̄_i = η_R (R − R̄) g_i / Σ g².

    `learn(babbles)` counts all movements that it makes: it learns from failures too.

    Args:
        env: An id or an environment of reaching; its control decides how the agent acts.
        eta: Learning rate η.
        noise: Standard deviation of the exploration of b1.
        seed: Seed of cases and exploration.

    Raises:
        ConfigError: An argument is out of its bounds, or the agent cannot act there.
    """

    KIND = "reward_hebb"
    TASKS = ("reach",)
    ARRAYS = ("_weights", "_value")

    def __init__(
        self,
        env: EnvLike = "BabbleReachPattern-v0",
        *,
        eta: float = 1.0,
        noise: float = 0.3,
        seed: int = 0,
    ) -> None:
        settings = {
            "eta": check_number("eta", eta, 0.0, 100.0, ""),
            "noise": check_number("noise", noise, 0.0, 1.0, ""),
        }
        super().__init__(env, seed, settings)
        self._make_maps()
        self._weights = np.zeros((OUTPUTS, len(self._input)), np.float32)
        self._value = np.zeros(len(self._input), np.float32)

    def __getstate__(self) -> dict[str, Any]:
        maps = ("_input", "_output")
        return {k: v for k, v in super().__getstate__().items() if k not in maps}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        super().__setstate__(state)
        self._make_maps()

    def _make_maps(self) -> None:
        self._range = json.loads(self._config)["reach"]["b_range"]
        field = np.radians(30.0)
        obstacle = PopulationMap(11, [-field, -field], [field, field])
        self._input = ConjunctiveMap(obstacle, PopulationMap(5, [0, 0], [1, 1]))
        self._output = PopulationMap(OUTPUTS, [0.0], [1.0])

    @property
    def weights(self) -> NDArray[np.float32]:
        """A copy of the weights w_ji (21, inputs)."""
        return self._weights.copy()

    def _encode(self, senses: NDArray[np.float32]) -> NDArray[np.float32]:
        """Activities g (n, inputs)."""
        return self._input.encode(self._percepts(senses, "obstacle"), self._percepts(senses, "eye"))

    def _read_out(self, g: NDArray[np.float32]) -> tuple[float, bool]:
        """The b1 that an input recalls, and whether any output neuron is active."""
        a = np.maximum(np.tanh(self._weights @ g), 0.0)
        return float(self._output.read_out_peak(a)[0]), bool(a.any())

    def _decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        chosen = np.array([self._read_out(g)[0] for g in self._encode(senses)])
        return np.stack([chosen, 1.0 - chosen], axis=1)

    def _learn(self, babbles: int) -> None:
        practice = Practice(self._learns_in(), self._seed)
        for _ in range(babbles):
            self._try(practice)

    def _try(self, practice: Practice) -> None:
        """Makes one movement and learns from its reward."""
        k, numbers = self._babbled, self._settings
        g = self._encode(practice.see(k)[None])[0]
        random = stream(self._seed, k)
        expected, active = self._read_out(g)
        low, high = self._range
        b1 = expected + numbers["noise"] * random.standard_normal()
        b1 = float(np.clip(b1, low, high)) if active else float(random.uniform(low, high))
        surprise = practice.move(b1) - float(self._value @ g)
        change = self._output.encode([b1])
        if active:
            change = change - self._output.encode([expected])
        near = np.flatnonzero(g > SILENT * g.max())
        w, rate = self._weights[:, near], numbers["eta"] * surprise
        self._weights[:, near] = w + rate * np.outer(change, g[near]) * (W_MAX - np.abs(w))
        self._value[near] += VALUE_RATE * surprise * g[near] / float(g @ g)
        self._babbled, self._learnt = k + 1, k + 1
