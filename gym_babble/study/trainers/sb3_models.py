"""Models of stable-baselines3 from settings, untrained."""

from __future__ import annotations

import inspect
from io import BytesIO
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.models import load_model
from gym_babble.checks import check_choice
from gym_babble.envs.registry import environment
from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.sb3 import ChosenSenses
from gym_babble.study.tuned import converted

try:
    from stable_baselines3 import PPO, SAC, TD3, HerReplayBuffer
    from stable_baselines3.common.noise import NormalActionNoise
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from gym_babble.sb3 import BabbleVecEnv

__all__ = ["check_control", "made_model", "setting_names", "without_learning"]

CLASSES = {"ppo": PPO, "sac": SAC, "td3": TD3}

OURS = ("n_envs", "senses", "noise_type", "noise_std", "learning_options")
"""Settings that are not arguments of stable-baselines3's classes."""

DECIDED = ("env", "seed", "device", "verbose", "tensorboard_log", "_init_setup_model")
"""Arguments of stable-baselines3's classes that the trainer decides."""


def setting_names(algorithm: str) -> list[str]:
    """The settings that an algorithm has."""
    arguments = inspect.signature(CLASSES[algorithm]).parameters
    return [name for name in (*arguments, *OURS) if name not in DECIDED]


def check_control(env_id: str, tuned: Mapping[str, Any], given: Mapping[str, Any]) -> None:
    """An action is a whole movement in `pattern` control alone: the others' settings do not fit."""
    usual = {**environment(env_id).options, **tuned}["control"]
    control = given.get("control", usual)
    if (control == "pattern") != (usual == "pattern"):
        raise ConfigError(
            f"control = {control!r}: the tuned settings for {env_id} are for {usual!r}; name an "
            "environment with that control instead"
        )


def made_model(algorithm: str, env: BabbleVecEnv, settings: dict[str, Any], seed: int) -> Any:
    """The untrained model."""
    made = CLASSES[algorithm]
    settings = converted(settings)
    senses = settings.pop("senses", None)
    if senses is not None:
        settings["policy_kwargs"] = settings.get("policy_kwargs", {}) | {
            "features_extractor_class": ChosenSenses,
            "features_extractor_kwargs": {"senses": tuple(senses)},
        }
    noise_type = settings.pop("noise_type", None)
    if noise_type is not None:
        check_choice("settings.noise_type", noise_type, ("normal",))
        (width,) = env.action_space.shape or ()
        noise = NormalActionNoise(np.zeros(width), np.full(width, settings.pop("noise_std")))
        settings["action_noise"] = noise
    _check_goals(env, settings)
    try:
        model = made(env=env, seed=seed, device="cpu", **settings)
    except (AssertionError, TypeError, ValueError) as error:
        raise ConfigError(f"settings of {algorithm}: {error}") from error
    # The model has seeded environment i with seed + i, so nearby seeds would share most cases.
    env.seed(seed * env.num_envs)
    return model


def _check_goals(env: BabbleVecEnv, settings: Mapping[str, Any]) -> None:
    """Raises `ConfigError` for hindsight replay without goals."""
    goals = "desired_goal" in getattr(env.observation_space, "spaces", {})
    if settings.get("replay_buffer_class") is HerReplayBuffer and not goals:
        raise ConfigError(
            "replay_buffer_class = HerReplayBuffer needs goals: learn in BabbleReachGoal-v0 or "
            "BabbleGraspGoal-v0"
        )


def without_learning(path: Path) -> bytes:
    """The zip of a model that acts the same, in less than half of the size.

    It lacks what only going on with learning needs: what the optimizers have gathered, and the last
    observations.
    """
    model = load_model(path)
    for name in model.get_parameters():
        if name.endswith("optimizer"):
            attrgetter(name)(model).state.clear()
    buffer = BytesIO()
    model.save(buffer, exclude=["_last_obs", "_last_original_obs", "_last_episode_starts"])
    return buffer.getvalue()
