"""Agents that choose whole movements, and how they act in each control."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import EnvLike, flat_senses, interface_of
from gym_babble.envs.spaces import Spec
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.envs.interface import Interface

__all__ = ["MovementAgent", "Playing"]


class Playing(NamedTuple):
    """Movements under way: one of each environment."""

    plan: NDArray[np.float32]
    """Equilibrium points (n, steps, 2), as shares of the joint ranges."""
    step: NDArray[np.int64]
    """Steps made of each (n,)."""


class MovementAgent(ABC):
    """An agent that decides once per movement.

    In `pattern` control an action is its decision. In `posture` and `delta_posture` control it
    plays the path of the pattern generators open loop: the start from the arm's proprioception,
    the target from the eye's, a posture a control step from inverse kinematics.
    """

    def __init__(self, env: EnvLike) -> None:
        self._interface = interface_of(env, "reach")
        self._spec = Spec.of(self._interface.task)
        self._columns = dict(self._spec.slices)
        if self._interface.options["control"] == "torque":
            raise ConfigError(
                "control = 'torque': this agent plans postures; "
                "use pattern, posture or delta_posture"
            )

    @property
    def interface(self) -> Interface:
        """What the environment of this agent was made with."""
        return self._interface

    @abstractmethod
    def decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Parameters (b1, b2) of movements (n, 2), for flat senses (n, 11)."""

    def predict(
        self,
        observation: Any,
        state: Playing | None = None,
        episode_start: Any = None,
        deterministic: bool = True,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[NDArray[np.float32], Playing | None]:
        """Actions for an observation, or a batch of them, as stable-baselines3's agents give them.

        Args:
            observation: As the environment gives it, of any `obs=`.
            state: What the last call returned; None at first.
            episode_start: Which of the environments have begun a new episode (n,).
            deterministic: Not used: a decision has no randomness.

        Returns:
            Actions (2,) or (n, 2), and the state for the next call.
        """
        del deterministic
        senses = flat_senses(observation, self._columns)
        batch = np.atleast_2d(senses)
        if self._interface.options["control"] == "pattern":
            actions: NDArray[np.float32] = (2.0 * self.decide(batch) - 1.0).astype(np.float32)
            playing = None
        else:
            playing = self._begin(batch, state, episode_start)
            actions, playing = self._play(batch, playing)
        return (actions if senses.ndim == 2 else actions[0]), playing

    def _begin(
        self, senses: NDArray[np.float32], state: Playing | None, episode_start: Any
    ) -> Playing:
        """Movements under way, with new ones for the episodes that have just begun."""
        n = len(senses)
        if state is None or len(state.step) != n:
            starting = np.ones(n, np.bool_)
        else:
            starts = np.zeros(n, np.bool_) if episode_start is None else episode_start
            starting = np.broadcast_to(np.asarray(starts, np.bool_), n)
        if state is not None and not starting.any():
            return state
        new = _core.plan(self._interface.task, senses[starting], self.decide(senses[starting]))
        if starting.all():
            return Playing(new, np.zeros(n, np.int64))
        assert state is not None
        plan, step = state.plan.copy(), state.step.copy()
        plan[starting], step[starting] = new, 0
        return Playing(plan, step)

    def _play(
        self, senses: NDArray[np.float32], playing: Playing
    ) -> tuple[NDArray[np.float32], Playing]:
        last = playing.plan.shape[1] - 1
        share = playing.plan[np.arange(len(senses)), np.minimum(playing.step, last)]
        if self._interface.options["control"] == "posture":
            actions = 2.0 * share - 1.0
        else:
            # From shares to radians; the equilibrium point is angle plus stretch.
            width = self._interface.quantities["joint_range"]
            wanted = (share - senses[:, self._columns["arm"]]) * width
            change = wanted - senses[:, self._columns["stretch"]]
            actions = np.clip(change / self._interface.quantities["delta_posture"], -1.0, 1.0)
        return actions.astype(np.float32), Playing(playing.plan, playing.step + 1)
