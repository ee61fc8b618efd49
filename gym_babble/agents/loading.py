"""Agents from the command line: by name, or from a file."""

from __future__ import annotations

import json
import os
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
from gymnasium import spaces

from gym_babble.agents import (
    GraspRandom,
    GraspScripted,
    HebbBabbling,
    HebbGrasping,
    Oracle,
    RandomBabbling,
    Scripted,
)
from gym_babble.envs.registry import ENVIRONMENTS
from gym_babble.errors import AgentFileError, ConfigError, MissingExtraError
from gym_babble.study.tasks import REACH, task_of

if TYPE_CHECKING:
    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = ["REFERENCES", "LoadedAgent", "load_agent"]

REFERENCES = ("random", "scripted", "oracle")
PATTERN = "BabbleReachPattern-v0"
GRASPING = "BabbleGrasp-v0"
# Safetensors begins with its metadata, and the core writes what kind of agent it is as their key.
GRASPING_KEY = b'"gym_babble.grasp"'
KEY_WITHIN = 64


@dataclass(frozen=True)
class LoadedAgent:
    """An agent and where it acts."""

    agent: Agent
    env_id: str
    config: ConfigLike
    env_kwargs: dict[str, Any] = field(default_factory=dict)


def load_agent(
    name: str, *, env_id: str | None = None, config: ConfigLike | None = None, seed: int = 0
) -> LoadedAgent:
    """An agent by name, or from a file.

    Args:
        name: "random", "scripted", "oracle" (of reaching alone), a file that a Hebb agent's `save`
            wrote, or a zip that stable-baselines3 wrote. The latter holds pickled Python: load only
            those you trust.
        env_id: Environment to act in; BabbleReachPattern-v0, or BabbleGrasp-v0 for an agent that
            has learnt to grasp, if not given, but a zip needs one.
        config: Body and task; the one it learnt on, or "paper", if not given.
        seed: Seed of the random agent.

    Raises:
        FileNotFoundError: There is neither such a name nor such a file.
        AgentFileError: The file is not an agent.
        ConfigError: There is no such environment or body, or the agent cannot act in it.
    """
    if env_id is not None:
        task_of(env_id)
    if name in REFERENCES:
        return _reference(name, env_id or PATTERN, "paper" if config is None else config, seed)
    path = Path(name)
    if not path.is_file():
        raise FileNotFoundError(f"{name}: no such file; agents by name are {', '.join(REFERENCES)}")
    if zipfile.is_zipfile(path):
        return _stable_baselines(path, env_id, "paper" if config is None else config)
    return _hebb(path, env_id, config)


def _reference(name: str, env_id: str, config: ConfigLike, seed: int) -> LoadedAgent:
    env = gymnasium.make(env_id, config=config)
    of_reaching = task_of(env_id) == REACH
    agent: Agent
    if name == "random":
        agent = RandomBabbling(env, seed=seed) if of_reaching else GraspRandom(env, seed=seed)
    elif name == "scripted":
        agent = Scripted(env) if of_reaching else GraspScripted(env)
    else:
        agent = Oracle(env, threads=os.cpu_count() or 1)
    return LoadedAgent(agent, env_id, config)


def _hebb(path: Path, env_id: str | None, config: ConfigLike | None) -> LoadedAgent:
    grasps = GRASPING_KEY in path.read_bytes()[:KEY_WITHIN]
    kind: type[HebbBabbling | HebbGrasping] = HebbGrasping if grasps else HebbBabbling
    env_id = env_id or (GRASPING if grasps else PATTERN)
    agent = kind.load(path)
    if config is None:
        config = json.loads(agent.interface.task.config())
    return LoadedAgent(kind.load(path, gymnasium.make(env_id, config=config)), env_id, config)


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
    registered = next(row.options["obs"] for row in ENVIRONMENTS if row.id == env_id)
    for obs in (registered, "senses", "flat"):
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
