"""Networks that were trained elsewhere and exported: they act without PyTorch."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.agents.acting import EnvArguments, check_same
from gym_babble.agents.base import Planner, interface_of
from gym_babble.errors import AgentFileError
from gym_babble.files import read_agent, write_file

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from gym_babble._core import Plans
    from gym_babble.agents.base import EnvLike

__all__ = ["PolicyNetwork"]


class PolicyNetwork(Planner):
    """A network that `gym-babble export-policy` wrote, as one of PPO.

    It decides each step by itself. The file says where it acts: task, config, and the options that
    decide what an action does.

    Args:
        data: The bytes of the file.
        env: Environment to act in; one as the file says if not given.

    Raises:
        AgentFileError: The bytes are cut short, altered, or not such a network.
        ConfigError: It cannot act in the environment.
    """

    KEY = "gym_babble.policy"
    """What such a file is called in its header."""

    def __init__(self, data: bytes, env: EnvLike | None = None) -> None:
        try:
            self._network = _core.PolicyNetwork.load(data)
        except ValueError as error:
            raise AgentFileError(str(error)) from error
        self._about: dict[str, Any] = json.loads(self._network.about())
        own = EnvArguments(**{name: self._about[name] for name in ("task", "config", "options")})
        super().__init__(own.single() if env is None else env)
        if env is not None:
            check_same(own, EnvArguments.of(interface_of(env)))

    @classmethod
    def load(cls, path: str | Path, env: EnvLike | None = None) -> PolicyNetwork:
        """The network in a file.

        Raises:
            FileNotFoundError: There is no such file.
            AgentFileError: The file is cut short, altered, or not such a network.
            ConfigError: It cannot act in the environment.
        """
        try:
            return cls(read_agent(path), env)
        except AgentFileError as error:
            raise AgentFileError(f"{path}: {error}") from error

    @property
    def algorithm(self) -> str:
        """What trained it, as "PPO"."""
        return str(self._about["algorithm"])

    def to_bytes(self) -> bytes:
        """The file that `load` reads."""
        return self._network.save()

    def save(self, path: str | Path) -> None:
        """Writes the file that `load` reads."""
        write_file(path, self.to_bytes())

    def _act(
        self, senses: NDArray[np.float32], starts: list[bool], plans: Plans | None
    ) -> tuple[NDArray[np.float32], Plans]:
        return self._network.predict(senses, starts, plans)

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_network": self.to_bytes()}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        super().__setstate__(state)
        self._network = _core.PolicyNetwork.load(state["_network"])
