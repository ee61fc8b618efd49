"""Agents of your own that grasp in the phases of the chain."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import Planner
from gym_babble.checks import numbers, shown
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["ChainAgent"]

TARGETS = ("pregrasp", "contact", "hand")
MOST_RAD = 2 * np.pi
"""Largest angle of a target [rad]; degrees are soon beyond it."""


class ChainAgent(Planner):
    """Grasps in the phases of the chain, with targets that a subclass recalls.

    `HebbBabbling(variant="chain")` acts in the same phases. In an episode the agent calls `recall`
    with what it senses, and then plays:

    1. reach: the arm goes to the posture before the grasp, the hand open,
    2. advance: from there, 1.5° a control step, in the direction of the posture at contact and
       beyond it, until the palm touches,
    3. close: the arm stops, and the hand closes.

    If the palm touches on the way, the hand closes at once. If it has touched nothing after 3.5 s
    of advancing, or if the hand has closed for 70 control steps and thumb and fingers, or palm and
    fingers, have not felt the object for more than 10, the agent recalls anew and begins again.

    A state that `predict` has returned tells the phases: `state.phases()` is a list of the names
    above, one for each environment.

    Args:
        env: An id or an environment of grasping, with `posture` or `delta_posture` control.

    Raises:
        ConfigError: It is not such an environment.
    """

    def __init__(self, env: EnvLike = "BabbleGrasp-v0") -> None:
        super().__init__(env)
        _core.check_deciding(self._interface.task, chain=True)

    @abstractmethod
    def recall(
        self, senses: dict[str, NDArray[np.float32]]
    ) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
        """The targets for n observations.

        Args:
            senses: The senses by name, each (n, k), whatever the environment's `obs=` is.

        Returns:
            Shoulder and elbow before the grasp (n, 2), shoulder and elbow at contact (n, 2), and
            the flexions of thumb and finger to which the hand closes (n, 2), all in rad.
        """

    def _targets(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """What is recalled, checked: (n, 6) for flat senses (n, m)."""
        named = {name: senses[:, part] for name, part in self._interface.spec.slices}
        recalled: Any = self.recall(named)
        if not isinstance(recalled, tuple | list) or len(recalled) != len(TARGETS):
            raise ConfigError(f"recall = {shown(recalled)} is not (pregrasp, contact, hand)")
        shape = (len(senses), 2)
        return np.hstack(
            [
                _checked(f"recall: {name}", x, shape)
                for name, x in zip(TARGETS, recalled, strict=True)
            ]
        )

    def _act(
        self, senses: NDArray[np.float32], starts: list[bool], plans: _core.Plans | None
    ) -> tuple[NDArray[np.float32], _core.Plans]:
        task = self._interface.task
        return _core.act_on(task, self._targets, senses, starts, plans, chain=True)


def _checked(name: str, value: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Angles [rad] of a shape.

    Raises:
        ConfigError: They have another shape, or are no angles.
    """
    angles: NDArray[np.float64] = numbers(name, value)
    if angles.shape != shape:
        raise ConfigError(f"{name} has shape {angles.shape}, expected {shape}")
    beyond = np.argwhere(np.abs(angles) > MOST_RAD)
    if len(beyond):
        i, j = beyond[0]
        raise ConfigError(f"{name}[{i}, {j}] = {angles[i, j]:g} is not in [-2π, 2π] rad")
    return angles
