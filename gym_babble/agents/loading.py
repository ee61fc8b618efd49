"""Agents by name, from a file, or your own by `module:Class`."""

from __future__ import annotations

import importlib
import inspect
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.agents.acting import EnvArguments, arguments_for, carried
from gym_babble.agents.base import interface_of, predictor
from gym_babble.agents.deciding import Learning, key_of
from gym_babble.agents.goal_babbling import GoalBabbling
from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.models import fitted, is_model, load_model, load_normalizer
from gym_babble.agents.neighbours import NearestNeighbours
from gym_babble.agents.network import PolicyNetwork
from gym_babble.agents.reference import Oracle, Random, ReflexOnly, Scripted
from gym_babble.agents.reward_hebb import RewardHebb
from gym_babble.agents.trained import TRAINED, trained_file
from gym_babble.envs.registry import environment
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.files import read_agent

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gym_babble.agents.base import Agent, EnvLike
    from gym_babble.config import ConfigLike

__all__ = [
    "REFERENCES",
    "LoadedAgent",
    "acting_agent",
    "load_agent",
    "named_agent",
    "own_agent",
    "own_class",
]

REFERENCES = ("random", "scripted", "oracle", "reflex-only")
IN_FILES: dict[str, Any] = {
    PolicyNetwork.KEY: PolicyNetwork,
    **{key_of(cls.KIND): cls for cls in (NearestNeighbours, GoalBabbling, RewardHebb)},
}
"""Exported networks, and agents that learn in Python, by what their files' headers call them."""
PATTERN = "BabbleReachPattern-v0"
# Where an agent from a file acts unless told, by its task.
ACTS_IN = {"reach": PATTERN, "grasp": "BabbleGrasp-v0"}


@dataclass(frozen=True)
class LoadedAgent:
    """An agent and where it acts."""

    agent: Agent
    arguments: EnvArguments


def load_agent(path: str | Path, env: EnvLike | None = None) -> HebbBabbling | Learning | Any:
    """The agent in a file that `save` wrote, or one that comes with the package.

    The file has an agent that learns by babbling, of any kind and either task, or a network that
    `gym-babble export-policy` wrote. Of those that come with the package some are models of
    stable-baselines3.

    Args:
        path: The file, or one of `gym_babble.agents.trained.TRAINED`, as "reach.hebb-paper".
        env: Environment to act in; if not given, one of its task with the config that it babbled
            with, or that a trained model learnt in.

    Raises:
        FileNotFoundError: There is no such file.
        AgentFileError: The file is cut short, altered, or not an agent.
        ConfigError: It cannot act in the environment.
        MissingExtraError: It needs stable-baselines3, which is not installed.
    """
    if isinstance(path, str) and path in TRAINED:
        path = trained_file(path)
        if path.suffix == ".zip":
            return _model(path, env)
    data = read_agent(path)
    try:
        keys = _core.tensor_keys(data)
    except ValueError as error:
        raise AgentFileError(f"{path}: {error}") from error
    cls = next((IN_FILES[key] for key in keys if key in IN_FILES), HebbBabbling)
    return cls.load(path, env)


def _model(path: Path, env: EnvLike | None) -> Any:
    """A model that acts where it learnt, or in an environment of the same control and body."""
    model = load_model(path)
    if env is not None:
        given = EnvArguments.of(interface_of(env))
        fitted(model, given, any_obs=False)
        arguments_for(carried(model), None, given.config, given.options)
    return model


def acting_agent(
    agent: Agent | str,
    env_id: str | None = None,
    config: ConfigLike | None = None,
    options: Mapping[str, Any] | None = None,
) -> LoadedAgent:
    """An agent, or the one of a name, and where it acts: as it says itself, or as you say.

    Args:
        agent: An agent, or the name of one for `named_agent`.
        env_id: Environment to act in; needed if the agent does not say where it acts.
        config: Config of body and task; the agent's own if not given.
        options: Further options of the environment.

    Raises:
        ConfigError: The environment is not named, contradicts the agent's own, or does not fit it.
    """
    options = options or {}
    if isinstance(agent, str):
        return named_agent(agent, env_id=env_id, config=config, options=options)
    return _acting(agent, env_id, config, options)


def named_agent(
    name: str,
    *,
    env_id: str | None = None,
    config: ConfigLike | None = None,
    seed: int = 0,
    options: Mapping[str, Any] | None = None,
    vec_normalize: str | Path | None = None,
) -> LoadedAgent:
    """An agent by name, from a file, or your own.

    Args:
        name: "random", "scripted", "oracle" or "reflex-only"; one of
            `gym_babble.agents.trained.TRAINED`; a file that `save` of an agent that babbles wrote
            ("./random" if it is called like one of these agents); a zip that stable-baselines3
            wrote, which holds pickled Python: load only those you trust; or "module:Class", a class
            of your own, found from the current folder (see `own_agent`).
        env_id: Environment to act in. If not given, BabbleReachPattern-v0, or BabbleGrasp-v0 for an
            agent that has learnt to grasp. A class of your own needs it unless it has an attribute
            `env`; a zip needs it, and the option `control`, unless `train_tuned` trained the model.
        config: Config of body and task; the one it learnt on, or "paper", if not given.
        seed: Seed of an agent that takes one.
        options: Further options of the environment.
        vec_normalize: For a zip, the file of the `VecNormalize` that the model learnt behind.
            Pickled Python too.

    Raises:
        FileNotFoundError: There is neither such a name nor such a file.
        AgentFileError: The file is not an agent.
        ConfigError: There is no such environment, config, module or class, the agent cannot act
            there, or it says itself that it acts elsewhere.
    """
    if env_id is not None:
        environment(env_id)
    options = options or {}
    path = trained_file(name) if name in TRAINED else Path(name)
    is_zip = path.is_file() and zipfile.is_zipfile(path)
    if vec_normalize is not None and not is_zip:
        raise ConfigError(f"{name} is not a zip of stable-baselines3: VecNormalize is for these")
    if name in REFERENCES:
        return _reference(name, env_id, config, seed, options)
    if ":" in name and not path.exists():
        return _own(name, env_id, config, seed, options)
    if not path.is_file():
        raise FileNotFoundError(
            f"{name}: no such file; agents by name are {', '.join((*REFERENCES, *TRAINED))}, "
            "and one of your own is module:Class"
        )
    if not is_zip:
        return _hebb(path, env_id, config, options)
    normalizer = None if vec_normalize is None else Path(vec_normalize)
    try:
        return _acting(load_model(path), env_id, config, options, normalizer)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error


def _acting(
    agent: Agent,
    env_id: str | None,
    config: ConfigLike | None,
    options: Mapping[str, Any],
    normalizer: Path | None = None,
) -> LoadedAgent:
    own = carried(agent)
    if own is None and is_model(agent) and (env_id is None or "control" not in options):
        raise ConfigError(
            "the model does not say where it learnt, and models of several controls look alike: "
            "name the environment and its control (--env-id and --control, or env_id and control)"
        )
    arguments = arguments_for(own, env_id, config, options)
    if not is_model(agent):
        return LoadedAgent(agent, arguments)
    found = None if normalizer is None else load_normalizer(normalizer, arguments)
    return LoadedAgent(*fitted(agent, arguments, found, any_obs="obs" not in options))


def own_agent(name: str, env: EnvLike, *, seed: int = 0) -> Agent:
    """An agent of your own class.

    Args:
        name: "module:Class". The module is found as Python finds modules, or in the current folder.
        env: Given to the class, if it takes an argument.
        seed: Given to the class, if it takes an argument of this name.

    Raises:
        ConfigError: There is no such module or class, or it has no `predict(observation)`.
    """
    agent = _made(own_class(name), env, seed)
    predictor(agent)
    return agent  # type: ignore[no-any-return]


def own_class(name: str) -> type:
    """The class of "module:Class".

    Raises:
        ConfigError: There is no such module or class.
    """
    module_name, _, class_name = name.partition(":")
    here = str(Path.cwd())
    sys.path.insert(0, here)
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name is None or not module_name.startswith(error.name):
            raise
        raise ConfigError(
            f"{name}: there is no module {module_name!r}, neither installed nor in {here}"
        ) from error
    except ValueError as error:
        raise ConfigError(f"{name} is not of the form module:Class") from error
    finally:
        sys.path.remove(here)
    cls = getattr(module, class_name, None)
    if not isinstance(cls, type):
        classes = [key for key, value in vars(module).items() if isinstance(value, type)]
        raise ConfigError(
            f"{name}: module {module_name!r} has no class {class_name!r}; "
            f"it has {', '.join(classes) or 'none'}"
        )
    return cls


def _made(cls: type, env: EnvLike, seed: int) -> Any:
    if cls.__init__ is object.__init__:  # type: ignore[misc]
        return cls()
    parameters = inspect.signature(cls).parameters
    seeded = {"seed": seed} if "seed" in parameters else {}
    takes_env = any(
        p.kind in {p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD, p.VAR_POSITIONAL}
        and p.name != "seed"
        for p in parameters.values()
    )
    return cls(env, **seeded) if takes_env else cls(**seeded)


def _own(
    name: str,
    env_id: str | None,
    config: ConfigLike | None,
    seed: int,
    options: Mapping[str, Any],
) -> LoadedAgent:
    env_id = env_id or getattr(own_class(name), "env", None)
    if not isinstance(env_id, str):
        raise ConfigError(
            f"{name}: name the environment (--env-id, or env_id), or give the class an attribute "
            "`env`, an id"
        )
    arguments = arguments_for(None, env_id, config, options)
    return LoadedAgent(own_agent(name, arguments.single(), seed=seed), arguments)


def _reference(
    name: str,
    env_id: str | None,
    config: ConfigLike | None,
    seed: int,
    options: Mapping[str, Any],
) -> LoadedAgent:
    where = env_id or ("BabbleGrasp-v0" if name == "reflex-only" else PATTERN)
    arguments = arguments_for(None, where, config, options)
    env = arguments.single()
    agent: Random | ReflexOnly | Scripted | Oracle
    if name == "random":
        agent = Random(env, seed=seed)
    elif name == "reflex-only":
        agent = ReflexOnly(env, seed=seed)
    elif name == "scripted":
        agent = Scripted(env)
    else:
        agent = Oracle(env, threads=None)
    return LoadedAgent(agent, arguments)


def _hebb(
    path: Path, env_id: str | None, config: ConfigLike | None, options: Mapping[str, Any]
) -> LoadedAgent:
    agent = load_agent(path)
    learnt = EnvArguments.of(agent.interface)
    if env_id is not None or options:
        # The file says task and config; the control is the caller's.
        env_id = env_id or ACTS_IN[learnt.task]
        agent = load_agent(path, arguments_for(None, env_id, learnt.config, options).single())
    return LoadedAgent(agent, arguments_for(EnvArguments.of(agent.interface), None, config, {}))
