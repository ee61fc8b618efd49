"""Agents by name, from a file, or your own by `module:Class`."""

from __future__ import annotations

import importlib
import inspect
import json
import sys
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
from gymnasium import spaces

from gym_babble.agents.base import predictor
from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.reference import Oracle, Random, Scripted
from gym_babble.envs.registry import environment
from gym_babble.errors import AgentFileError, ConfigError, MissingExtraError

if TYPE_CHECKING:
    from gym_babble.agents.base import Agent, EnvLike
    from gym_babble.config import ConfigLike

__all__ = ["REFERENCES", "LoadedAgent", "load_agent", "named_agent", "own_agent"]

REFERENCES = ("random", "scripted", "oracle")
PATTERN = "BabbleReachPattern-v0"
# Where an agent from a file acts unless told, by its task.
ACTS_IN = {"reach": PATTERN, "grasp": "BabbleGrasp-v0"}


@dataclass(frozen=True)
class LoadedAgent:
    """An agent and where it acts."""

    agent: Agent
    env_id: str
    config: ConfigLike
    env_kwargs: dict[str, Any] = field(default_factory=dict)


def load_agent(path: str | Path, env: EnvLike | None = None) -> HebbBabbling:
    """The agent in a file that `HebbBabbling.save` wrote, of either task.

    Args:
        path: The file.
        env: Environment to act in; if not given, one of its task with the config that it babbled
            with.

    Raises:
        FileNotFoundError: There is no such file.
        AgentFileError: The file is cut short, altered, or not an agent.
        ConfigError: It cannot act in the environment.
    """
    return HebbBabbling.load(path, env)


def named_agent(
    name: str, *, env_id: str | None = None, config: ConfigLike | None = None, seed: int = 0
) -> LoadedAgent:
    """An agent by name, from a file, or your own.

    Args:
        name: "random", "scripted" or "oracle"; a file that `HebbBabbling.save` wrote ("./random" if
            it is called like one of these agents); a zip that stable-baselines3 wrote, which holds
            pickled Python: load only those you trust; or "module:Class", a class of your own, found
            from the current folder (see `own_agent`).
        env_id: Environment to act in; BabbleReachPattern-v0, or BabbleGrasp-v0 for an agent that
            has learnt to grasp, if not given, but a zip needs one.
        config: Config of body and task; the one it learnt on, or "paper", if not given.
        seed: Seed of an agent that takes one.

    Raises:
        FileNotFoundError: There is neither such a name nor such a file.
        AgentFileError: The file is not an agent.
        ConfigError: There is no such environment, config, module or class, or the agent cannot act.
    """
    if env_id is not None:
        environment(env_id)
    if name in REFERENCES:
        return _reference(name, env_id or PATTERN, "paper" if config is None else config, seed)
    path = Path(name)
    if ":" in name and not path.exists():
        env_id, config = env_id or PATTERN, "paper" if config is None else config
        agent = own_agent(name, gymnasium.make(env_id, config=config), seed=seed)
        return LoadedAgent(agent, env_id, config)
    if not path.is_file():
        raise FileNotFoundError(
            f"{name}: no such file; agents by name are {', '.join(REFERENCES)}, "
            "and one of your own is module:Class"
        )
    if zipfile.is_zipfile(path):
        return _stable_baselines(path, env_id, "paper" if config is None else config)
    return _hebb(path, env_id, config)


def own_agent(name: str, env: EnvLike, *, seed: int = 0) -> Agent:
    """An agent of your own class.

    Args:
        name: "module:Class". The module is found as Python finds modules, or in the current folder.
        env: Given to the class, if it takes an argument.
        seed: Given to the class, if it takes an argument of this name.

    Raises:
        ConfigError: There is no such module or class, or it has no `predict(observation)`.
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
    agent = _made(cls, env, seed)
    predictor(agent)
    return agent  # type: ignore[no-any-return]


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


def _reference(name: str, env_id: str, config: ConfigLike, seed: int) -> LoadedAgent:
    env = gymnasium.make(env_id, config=config)
    agent: Agent
    if name == "random":
        agent = Random(env, seed=seed)
    elif name == "scripted":
        agent = Scripted(env)
    else:
        agent = Oracle(env, threads=None)
    return LoadedAgent(agent, env_id, config)


def _hebb(path: Path, env_id: str | None, config: ConfigLike | None) -> LoadedAgent:
    agent = load_agent(path)
    env_id = env_id or ACTS_IN[agent.interface.entry.name]
    if config is None:
        config = json.loads(agent.interface.task.config())
    return LoadedAgent(load_agent(path, gymnasium.make(env_id, config=config)), env_id, config)


def _stable_baselines(path: Path, env_id: str | None, config: ConfigLike) -> LoadedAgent:
    if env_id is None:
        raise ConfigError(f"{path}: name the environment it learnt in with --env-id")
    try:
        import stable_baselines3
        import torch
    except ImportError as error:
        raise MissingExtraError("stable-baselines3", "sb3") from error
    torch.set_num_threads(1)  # These networks are too small for a second one to help.
    algorithm = getattr(stable_baselines3, _algorithm(path))
    try:
        model = algorithm.load(path, device="cpu")
    except Exception as error:  # Unpickling can raise anything.
        raise AgentFileError(f"{path}: {error}") from error
    for obs in (environment(env_id).presets.get("obs", "senses"), "flat"):
        space = gymnasium.make(env_id, obs=obs, config=config).observation_space
        if _shapes(space) == _shapes(model.observation_space):
            return LoadedAgent(model, env_id, config, {"obs": obs})
    raise ConfigError(f"{path}: it has learnt from other observations than {env_id} gives")


def _shapes(space: spaces.Space[Any]) -> Any:
    """Shapes by name; the bounds may differ, as they do between bodies."""
    if isinstance(space, spaces.Dict):
        return {name: part.shape for name, part in space.items()}
    return space.shape


def _algorithm(path: Path) -> str:
    """Which of stable-baselines3's algorithms for continuous actions wrote a zip."""
    try:
        with zipfile.ZipFile(path) as archive:
            data = json.loads(archive.read("data"))
        module = data["policy_class"]["__module__"]
    except (KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise AgentFileError(f"{path}: not a model of stable-baselines3") from error
    if module.startswith("stable_baselines3.sac."):
        return "SAC"
    if module.startswith("stable_baselines3.td3."):
        return "TD3"
    return "PPO" if "n_epochs" in data else "A2C"
