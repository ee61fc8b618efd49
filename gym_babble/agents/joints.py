"""Conversions between shares, angles, equilibrium points and actions of the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.base import interface_of
from gym_babble.checks import numbers
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from gym_babble.agents.base import EnvLike, Observation

__all__ = ["Joints"]


class Joints:
    """What observations and actions of an environment say about its k joints.

    In grasping these are shoulder, elbow, thumb and finger (k = 4), in reaching shoulder and elbow
    (k = 2). Every method takes values of one environment (k,) or of many (..., k), and returns
    arrays of the same shape.

    >>> import gym_babble
    >>> joints = gym_babble.Joints("BabbleGrasp-v0")
    >>> joints.angles([0.0, 0.5, 0.0, 1.0]).round(2).tolist()
    [-1.31, 1.18, 0.0, 1.57]

    Args:
        env: An environment of this package, a batch, or an id. Its config and control count.

    Raises:
        ConfigError: It is not an environment of this package, or a task without joints.
    """

    def __init__(self, env: EnvLike) -> None:
        interface = interface_of(env)
        quantities = interface.quantities
        if "ranges" not in quantities:
            raise ConfigError(f"env: {interface.entry.title} has no joints")
        self._slices = dict(interface.spec.slices)
        self._control = str(interface.options["control"])
        self._unit = float(quantities["delta_posture"])
        self._stiffness, self._torque_max = quantities["muscles"].T
        self.ranges: NDArray[np.float64] = quantities["ranges"]
        """Lowest and highest angle of each joint (k, 2) [rad]."""

    def angles(self, shares: ArrayLike) -> NDArray[np.float64]:
        """Angles [rad] at shares of the joint ranges: 0 is the lowest angle, 1 the highest."""
        low, high = self.ranges.T
        angles: NDArray[np.float64] = low + self._rows("shares", shares) * (high - low)
        return angles

    def shares(self, angles: ArrayLike) -> NDArray[np.float64]:
        """Shares of the joint ranges at angles [rad]."""
        low, high = self.ranges.T
        shares: NDArray[np.float64] = (self._rows("angles", angles) - low) / (high - low)
        return shares

    def posture(self, observation: Observation) -> NDArray[np.float64]:
        """Angles [rad] that an observation shows, of any `obs=`."""
        parts = [self._sense(observation, "arm")]
        if len(self.ranges) > 2:  # In reaching the sense `hand` is a place.
            parts.append(self._sense(observation, "hand"))
        return self.angles(np.concatenate(parts, axis=-1))

    def equilibrium(self, observation: Observation) -> NDArray[np.float64]:
        """Equilibrium points of the muscles [rad] that an observation shows: angle plus stretch.

        Raises:
            ConfigError: The observation has no sense `stretch`.
        """
        return self.posture(observation) + self._sense(observation, "stretch")

    def actions(self, points: ArrayLike, observation: Observation = None) -> NDArray[np.float32]:
        """The actions that bring the equilibrium points as near to `points` [rad] as they can.

        In `posture` control one action sets them. In `delta_posture` an action moves each by its
        unit at most (5° by default), so a longer way takes several steps. In `torque` control it is
        the torque with which the muscles would pull to `points`: K_P (point − angle), Eq. 2.

        Args:
            points: Equilibrium points [rad].
            observation: What the environment showed last; not needed in `posture` control.

        Returns:
            Actions in [−1, 1].

        Raises:
            ConfigError: `pattern` control, in which an action is a whole movement.
        """
        points = self._rows("points", points)
        if self._control == "posture":
            asked = 2.0 * self.shares(points) - 1.0
        elif self._control == "delta_posture":
            asked = (points - self.equilibrium(observation)) / self._unit
        elif self._control == "torque":
            torque = self._stiffness * (points - self.posture(observation))
            asked = torque / self._torque_max
        else:
            raise ConfigError("control = 'pattern': an action is a whole movement")
        return np.clip(asked, -1.0, 1.0).astype(np.float32)

    def _rows(self, name: str, value: ArrayLike) -> NDArray[np.float64]:
        array = numbers(name, value)
        if array.shape[-1:] != (len(self.ranges),):
            raise ConfigError(f"{name} has shape {array.shape}, expected (..., {len(self.ranges)})")
        return array

    def _sense(self, observation: Observation, name: str) -> NDArray[np.float64]:
        """A sense (..., m) of an observation."""
        if name not in self._slices:
            raise ConfigError(f"observation: the environment has no sense {name!r}")
        flat: Any = observation
        if isinstance(observation, dict):
            if name in observation:
                return numbers(f"observation[{name!r}]", observation[name])
            if "observation" not in observation:
                raise ConfigError(
                    f"observation has {', '.join(map(str, observation))}, expected {name}"
                )
            flat = observation["observation"]
        senses = numbers("observation", flat)
        width = max(part.stop for part in self._slices.values())
        if senses.shape[-1:] != (width,):
            raise ConfigError(f"observation has shape {senses.shape}, expected (..., {width})")
        return senses[..., self._slices[name]]
