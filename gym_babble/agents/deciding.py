"""What agents of this package share that decide and learn in Python."""

from __future__ import annotations

import json
from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from typing_extensions import Self

from gym_babble import _core
from gym_babble.agents.base import Planner, interface_of
from gym_babble.agents.practising import LEARNS_IN
from gym_babble.checks import check_seed, check_whole, shown
from gym_babble.envs.interface import Interface
from gym_babble.envs.registry import task_entry
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.files import read_agent, write_file
from gym_babble.progress import track

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike, Observation

__all__ = ["Learning", "key_of"]

VERSION = 1
L = TypeVar("L", bound="Learning")


def key_of(kind: str) -> str:
    """What a file of such an agent is called in its header."""
    return f"gym_babble.{kind}"


class Learning(Planner):
    """An agent that learns, decides once an episode, and acts on the decision as the core does.

    A subclass has `_decide` and `_learn`, and names the arrays of its state in `ARRAYS`. What it
    learns depends on seed, config and settings, and not on how often `learn` is called.
    """

    KIND: ClassVar[str]
    """Its name in files."""
    TASKS: ClassVar[tuple[str, ...]]
    """The tasks that it can learn."""
    ARRAYS: ClassVar[tuple[str, ...]]
    """Attributes that learning changes, float32 arrays: they and the counts are all of it."""

    def __init__(
        self, env: EnvLike, seed: int, settings: Mapping[str, Any], *, chain: bool = False
    ) -> None:
        """With `chain`, in grasping, it babbles and acts by the chain, not as in the paper."""
        super().__init__(env)
        self._chain = chain
        task = self._interface.entry.name
        if task not in self.TASKS:
            raise ConfigError(
                f"{type(self).__name__} learns in {' and '.join(self.TASKS)}, and "
                f"{shown(env)} is {task_entry(task).title}"
            )
        _core.check_deciding(self._interface.task, chain=chain)
        self._config = self._interface.task.config()
        self._seed, self._settings = check_seed(seed), dict(settings)
        self._babbled = self._learnt = 0

    @property
    def seed(self) -> int:
        """Seed of learning."""
        return self._seed

    @property
    def settings(self) -> dict[str, Any]:
        """Its settings by name."""
        return dict(self._settings)

    @property
    def babbled(self) -> int:
        """Movements or babbles made."""
        return self._babbled

    @property
    def learnt(self) -> int:
        """Movements or babbles learnt from."""
        return self._learnt

    @property
    def learnt_rate(self) -> float:
        """Share of them that were learnt from; NaN before the first."""
        return self._learnt / self._babbled if self._babbled else float("nan")

    @property
    def steps_per_babble(self) -> int:
        """Control steps that a movement or babble takes."""
        return _core.babble_steps(self._learns_in().task, self._babbling)

    @property
    def _babbling(self) -> str:
        """How babbles are simulated, as JSON."""
        if not self._chain:
            return "null"
        return json.dumps(json.loads(_core.brain_json("grasp", "chain"))["babble"])

    @property
    def control_steps(self) -> int:
        """Control steps of all movements or babbles, whether learnt from or not."""
        return self._babbled * self.steps_per_babble

    def learn(
        self,
        babbles: int,
        *,
        progress_bar: bool = False,
        callback: Callable[[Self], bool | None] | None = None,
        callback_every: int = 50,
    ) -> Self:
        """Learns from so many more movements or babbles (see the class for which ones count).

        Interrupted by Ctrl-C, the agent is as after its last call of `callback`, and can go on.

        Args:
            babbles: How many.
            progress_bar: Show a bar with the time left.
            callback: Called with the agent as it learns. It returns None to go on, or a truth
                value, of which a false one stops.
            callback_every: After how many babbles it is called, from 1 on.

        Returns:
            The agent itself.

        Raises:
            ConfigError: An argument is out of its bounds, or the agent acts in another config than
                it was made with.
            ScenarioError: Hardly any babble can be learnt from.
        """
        babbles = check_whole("babbles", babbles, 0, 100_000_000, "babbles")
        every = check_whole("callback_every", callback_every, 1, 100_000, "babbles")
        if callback is not None and not callable(callback):
            raise ConfigError(f"callback = {shown(callback)} is not a function")
        if self._interface.task.config() != self._config:
            raise ConfigError("config: an agent learns only on the config that it was made with")
        chunks = (min(every, babbles - done) for done in range(0, babbles, every))
        for chunk in track(chunks, "learning", total=babbles, show=progress_bar):
            self._whole_or_not(chunk)
            go_on = None if callback is None else callback(self)
            if go_on is not None and not go_on:
                break
        return self

    def _whole_or_not(self, babbles: int) -> None:
        """Learns from some babbles, or leaves the agent as it was."""
        before = self._state()
        try:
            self._learn(babbles)
        except BaseException:
            self.__dict__.update(before)
            raise

    def _state(self) -> dict[str, Any]:
        """Copies of all that learning changes."""
        arrays = {name: getattr(self, name).copy() for name in self.ARRAYS}
        return {**arrays, "_babbled": self._babbled, "_learnt": self._learnt}

    @abstractmethod
    def _learn(self, babbles: int) -> None:
        """Learns from so many more babbles."""

    @abstractmethod
    def _decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Decisions (n, k) for flat senses (n, m)."""

    def decide(self, observation: Observation) -> NDArray[np.float64]:
        """What it chooses for one observation (k,), or for n of them (n, k).

        In reaching, parameters (b1, b2) of a movement; in grasping, shoulder, elbow, and flexions
        of thumb and finger once the hand closes [rad]. In the chain, shoulder and elbow before the
        grasp, shoulder and elbow at contact, and the flexions [rad].
        """
        senses = self._senses(observation)
        chosen = self._decide(np.atleast_2d(senses))
        return chosen if senses.ndim > 1 else chosen[0]

    def _act(
        self, senses: NDArray[np.float32], starts: list[bool], plans: _core.Plans | None
    ) -> tuple[NDArray[np.float32], _core.Plans]:
        task = self._interface.task
        return _core.act_on(task, self._decide, senses, starts, plans, chain=self._chain)

    def _learns_in(self) -> Interface:
        """An environment of the config and control that it learns in."""
        task = self._interface.entry.name
        config = json.loads(self._config)
        return Interface(task, config=config, render_mode=None, options=LEARNS_IN[task])

    def _percepts(self, senses: NDArray[np.float32], *names: str) -> NDArray[np.float64]:
        """Some of the senses (n, k) of flat ones (n, m)."""
        slices = dict(self._interface.spec.slices)
        return np.hstack([senses[:, slices[name]] for name in names]).astype(np.float64)

    def to_bytes(self) -> bytes:
        """The bytes of the file that `save` writes."""
        metadata = {
            "version": VERSION,
            "task": self._interface.entry.name,
            "config": json.loads(self._config),
            "seed": self._seed,
            "babbled": self._babbled,
            "learnt": self._learnt,
            "settings": self._settings,
        }
        arrays = [(name.lstrip("_"), getattr(self, name)) for name in self.ARRAYS]
        return _core.write_tensors(key_of(self.KIND), json.dumps(metadata), arrays)

    def save(self, path: str | Path) -> None:
        """Writes the agent: arrays as safetensors, all else as JSON in its metadata.

        An earlier file is replaced once the new one is complete.

        Raises:
            OSError: The file cannot be written; an earlier one is whole.
        """
        write_file(path, self.to_bytes())

    @classmethod
    def load(cls, path: str | Path, env: EnvLike | None = None) -> Self:
        """Reads an agent.

        Args:
            path: The file.
            env: Environment to act in; if not given, one of its task with the config that it
                learnt in, in reaching with `pattern` control. With another config it acts, but does
                not learn on.

        Raises:
            FileNotFoundError: There is no such file.
            AgentFileError: The file is cut short, altered, or not such an agent.
            ConfigError: It cannot act in the environment.
        """
        data = read_agent(path)
        names = [name.lstrip("_") for name in cls.ARRAYS]
        try:
            text, arrays = _core.read_tensors(key_of(cls.KIND), data, names)
            agent = cls._from_file(json.loads(text), arrays)
        except (KeyError, TypeError, ValueError) as error:
            raise AgentFileError(f"{path}: {error}") from error
        if env is not None:
            interface = interface_of(env)
            if interface.entry.name != agent._interface.entry.name:  # noqa: SLF001 - its own
                title = agent._interface.entry.title  # noqa: SLF001 - its own
                raise ConfigError(f"{shown(env)} is not a Babble environment for {title}")
            _core.check_deciding(interface.task, chain=agent._chain)  # noqa: SLF001 - its own
            agent._interface = interface  # noqa: SLF001 - its own
        return agent

    @classmethod
    def _from_file(cls, found: dict[str, Any], arrays: dict[str, Any]) -> Self:
        if found["version"] != VERSION:
            raise AgentFileError(f"version {found['version']} is not {VERSION}")
        task = found["task"]
        options = {**LEARNS_IN[task], "obs": "senses"}
        where = Interface(task, config=found["config"], render_mode=None, options=options)
        agent = cls(_Place(where), seed=found["seed"], **found["settings"])
        babbled = check_whole("babbled", found["babbled"], 0, 10**12, "babbles")
        learnt = check_whole("learnt", found["learnt"], 0, babbled, "babbles")
        agent._babbled, agent._learnt = babbled, learnt
        for name in cls.ARRAYS:
            given, own = arrays[name.lstrip("_")], getattr(agent, name)
            if given.ndim != own.ndim or given.shape[1:] != own.shape[1:]:
                raise AgentFileError(f"{name.lstrip('_')} has shape {given.shape}")
            if not np.isfinite(given).all():
                raise AgentFileError(f"{name.lstrip('_')} has numbers that are not finite")
            setattr(agent, name, given)
        return agent


class _Place:
    """What names an interface, as an environment does."""

    def __init__(self, interface: Interface) -> None:
        self.interface = interface
