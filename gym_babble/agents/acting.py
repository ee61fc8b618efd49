"""Where an agent acts: found from the agent, and compared with what the caller says."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import gymnasium
from gymnasium.vector import VectorEnv

from gym_babble.agents.base import interface_of
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs import BabbleEnv, BabbleVectorEnv
from gym_babble.envs.interface import Interface
from gym_babble.envs.registry import ENVIRONMENTS, environment, task_entry
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["MARK", "EnvArguments", "arguments_for", "carried", "check_same", "marked"]

MARK = "gym_babble_env"
"""Attribute of a model of stable-baselines3 that says where it learnt; its zip keeps it."""

BINDING = ("control", "enclosure_reflex", "reflex_releases")
"""Options that decide what an action does: an agent acts with its own."""

PICTURE = ("record", "camera", "width", "height")
"""Options that change pictures alone."""


@dataclass(frozen=True, kw_only=True)
class EnvArguments:
    """What an environment is made from."""

    task: str
    """Name of the task."""
    config: dict[str, Any]
    """The whole config, as JSON types."""
    options: dict[str, Any]
    """Options by name; the others have the task's defaults."""

    @classmethod
    def of(cls, interface: Interface) -> EnvArguments:
        """The arguments of an existing environment, without those of its pictures."""
        defaults = interface.entry.defaults
        return cls(
            task=interface.entry.name,
            config=json.loads(interface.task.config()),
            options={
                name: value
                for name, value in interface.options.items()
                if name not in PICTURE and value != defaults.get(name)
            },
        )

    def interface(self) -> Interface:
        """Options, spec and spaces of such an environment."""
        return Interface(self.task, config=self.config, render_mode=None, options=self.options)

    def single(self, render_mode: str | None = None, **picture: Any) -> BabbleEnv:
        """Makes a single environment."""
        return BabbleEnv(render_mode, task=self.task, config=self.config, **self.options, **picture)

    def batch(self, num_envs: int, **batch: Any) -> BabbleVectorEnv:
        """Makes a batch."""
        return BabbleVectorEnv(
            num_envs, task=self.task, config=self.config, **self.options, **batch
        )

    def option(self, name: str) -> Any:
        """An option, given or by default."""
        return self.options.get(name, task_entry(self.task).defaults.get(name))

    @property
    def title(self) -> str:
        """The id with these options, or that of the task's first environment with what differs."""
        rows = [row for row in ENVIRONMENTS if row.task == self.task]
        decided = {name for row in rows for name in row.presets}
        for row in rows:
            if all(self.option(name) == row.options[name] for name in decided):
                return row.id
        differing = {
            name: self.option(name)
            for name in sorted(decided)
            if self.option(name) != rows[0].options[name]
        }
        return f"{rows[0].id} with {', '.join(f'{k}={v!r}' for k, v in differing.items())}"


def carried(agent: Any) -> EnvArguments | None:
    """Where an agent acts, as it says itself; None if it does not.

    Ours have an `interface`. Others have `env`: an id, or an environment. Models of
    stable-baselines3 that `train_tuned` trained say it after loading too.

    Raises:
        ConfigError: Wrappers of its environment change observations or actions.
    """
    interface = getattr(agent, "interface", None)
    if isinstance(interface, Interface):
        return EnvArguments.of(interface)
    env = getattr(agent, "env", None)
    if env is not None:
        try:
            interface = interface_of(env)
        except (ConfigError, gymnasium.error.Error):
            return None
        _check_wrappers(env, interface)
        return EnvArguments.of(interface)
    return _read_mark(getattr(agent, MARK, None), getattr(agent, "_n_updates", None))


def _read_mark(mark: Any, updates: Any) -> EnvArguments | None:
    """What a mark says; None without one, or if the model has learnt on since, maybe elsewhere."""
    if not isinstance(mark, dict) or mark.get("updates") != updates:
        return None
    kinds = {"task": str, "config": dict, "options": dict}
    if not all(isinstance(mark.get(name), kind) for name, kind in kinds.items()):
        return None
    return EnvArguments(**{name: mark[name] for name in kinds})


def marked(arguments: EnvArguments, updates: int) -> dict[str, Any]:
    """The value of `MARK`.

    Args:
        arguments: Where the model learnt.
        updates: The model's `_n_updates`.
    """
    return {**asdict(arguments), "updates": updates}


def arguments_for(
    own: EnvArguments | None,
    env_id: str | None,
    config: ConfigLike | None,
    options: Mapping[str, Any],
) -> EnvArguments:
    """The environment of a test: the agent's own, unless the caller chooses what may differ.

    Args:
        own: Where the agent acts, if it says so.
        env_id: The caller's id. Its rewards, observations and time limit replace the agent's.
        config: The caller's config.
        options: The caller's options; they replace those of agent and id.

    Raises:
        ConfigError: Neither agent nor caller names an environment, or they contradict each other.
    """
    if env_id is None and own is None:
        raise ConfigError(
            "the agent does not say where it acts: name its environment (env_id), or give the "
            "agent an attribute `env`, an id or an environment"
        )
    if env_id is None:
        assert own is not None
        wanted = replace(own, options={**own.options, **options})
    else:
        row = environment(env_id)
        kept = {} if own is None or own.task != row.task else dict(own.options)
        kept.pop("max_episode_steps", None)
        of_ids = {name for one in ENVIRONMENTS if one.task == row.task for name in one.presets}
        by_id = {name: row.options[name] for name in of_ids if name != "obs"} | row.presets
        body = own.config if own is not None else {}
        wanted = EnvArguments(task=row.task, config=body, options={**kept, **by_id, **options})
    if config is not None or own is None:
        given = json.loads(config_json("paper" if config is None else config))
        wanted = replace(wanted, config=given)
    made = EnvArguments.of(wanted.interface())
    if own is not None:
        check_same(own, made)
    return made


def check_same(own: EnvArguments, made: EnvArguments) -> None:
    """Raises `ConfigError` where the caller's environment contradicts the agent's own."""
    acts = f"the agent acts in {own.title}"
    if own.task != made.task:
        raise ConfigError(f"{acts}, and the test is in {made.title}: another task")
    for name in BINDING:
        if own.option(name) != made.option(name):
            raise ConfigError(
                f"{acts}, {name} {own.option(name)!r}, and the test is in {made.title}, {name} "
                f"{made.option(name)!r}: make the agent with the environment that it shall act in"
            )
    field = first_difference(own.config, made.config)
    if field is not None:
        name, here, there = field
        raise ConfigError(
            f"{acts} with {name} = {here!r}, and the test's config has {there!r}: leave config "
            "out, or make the agent with an environment of that config"
        )


def first_difference(one: Any, other: Any, path: str = "config") -> tuple[str, Any, Any] | None:
    """Name of the first field in which two configs differ, and both values."""
    if not (isinstance(one, dict) and isinstance(other, dict)):
        return None if one == other else (path, one, other)
    for name in {**one, **other}:
        found = first_difference(one.get(name), other.get(name), f"{path}.{name}")
        if found is not None:
            return found
    return None


def _check_wrappers(env: Any, interface: Interface) -> None:
    """Raises `ConfigError` for an environment of Gymnasium whose wrappers change its spaces."""
    if isinstance(env, VectorEnv):
        seen = env.single_observation_space, env.single_action_space
    elif isinstance(env, gymnasium.Env):
        seen = env.observation_space, env.action_space
    else:
        return
    if seen != (interface.observation_space, interface.action_space):
        raise ConfigError(
            f"{env} changes observations or actions by a wrapper, and a test has no wrappers: do "
            "it in the agent's predict, and give the agent the environment without the wrapper"
        )
