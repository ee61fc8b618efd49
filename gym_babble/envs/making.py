"""What an environment learns from the `gymnasium.make` that makes it."""

from __future__ import annotations

import inspect
import json
from typing import TYPE_CHECKING, Any

from gymnasium.envs import registration

from gym_babble import _core
from gym_babble.envs.registry import ENVIRONMENTS

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

    from gym_babble.envs.interface import Interface

__all__ = ["Made", "time_limit"]


class Made:
    """The `spec` that Gymnasium gives to an environment or a batch once it is made."""

    _interface: Interface
    _spec: EnvSpec | None = None

    @property
    def spec(self) -> EnvSpec | None:
        """Id and arguments, if `gymnasium.make` or `make_vec` made it."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            if any(row.id == spec.id for row in ENVIRONMENTS):
                _core.check_fixed(spec.id, json.dumps(self._interface.options))
            spec.max_episode_steps = self._max_episode_steps
        self._spec = spec

    @property
    def _max_episode_steps(self) -> int:
        """The time limit in control steps, by the name that other libraries know from TimeLimit."""
        return self._interface.spec.max_episode_steps


def time_limit() -> int | None:
    """The time limit of the `gymnasium.make` that calls the constructor which calls this.

    Gymnasium keeps `max_episode_steps` for its TimeLimit wrapper and does not tell the environment.
    The core has to know it: the sense `time` is a share of it, and at its end the outcome is
    `timeout`.
    """
    frame = inspect.currentframe()
    while frame is not None and frame.f_code.co_name in ("time_limit", "__init__"):
        frame = frame.f_back
    if frame is None or frame.f_code is not registration.make.__code__:
        return None
    names: dict[str, Any] = frame.f_locals
    given = names["max_episode_steps"]
    # −1 leaves the wrapper off.
    limit: int | None = names["env_spec"].max_episode_steps if given in (None, -1) else given
    return limit
