"""Compares the tuned settings as rl-zoo3 reads them with ours: `make frameworks`."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
from rl_zoo3.exp_manager import ExperimentManager

import gym_babble  # noqa: F401 - registers the ids
from gym_babble.study.tuned import ALGORITHMS, FOLDER, converted, tuned_ids, tuned_settings


def read_by_rl_zoo3(algorithm: str, env_id: str) -> dict[str, Any]:
    """What rl-zoo3 makes a model with, and what it took out of the settings before."""
    manager = ExperimentManager(
        args=SimpleNamespace(),
        algo=algorithm,
        env_id=env_id,
        log_folder="",
        config=str(FOLDER / f"{algorithm}.yml"),
        verbose=0,
        device="cpu",
    )
    hyperparams, _ = manager.read_hyperparameters()
    found, *_ = manager._preprocess_hyperparams(hyperparams)  # noqa: SLF001 - the step to test
    env = gym.make(env_id, **manager.env_kwargs)
    found = manager._preprocess_action_noise(found, {}, env)  # noqa: SLF001
    return found | {"n_timesteps": manager.n_timesteps, "n_envs": manager.n_envs}


def plain(value: Any) -> Any:
    """A schedule as its values at the start, in the middle and at the end."""
    return [value(left) for left in (1.0, 0.5, 0.0)] if callable(value) else value


def ours(algorithm: str, env_id: str) -> dict[str, Any]:
    """The settings as our reader has them."""
    settings = converted(tuned_settings(algorithm, env_id))
    settings.pop("env_kwargs", None)
    if settings.pop("noise_type", None):
        settings["noise_std"] = [settings["noise_std"]]
    return settings


def main() -> None:
    """Ends with an error at the first difference."""
    for algorithm in ALGORITHMS:
        for env_id in tuned_ids(algorithm):
            theirs = read_by_rl_zoo3(algorithm, env_id)
            noise = theirs.pop("action_noise", None)
            if noise is not None:
                theirs["noise_std"] = sorted(set(noise._sigma.tolist()))  # noqa: SLF001
            expected = ours(algorithm, env_id)
            differing = {
                name: (theirs.get(name), expected.get(name))
                for name in theirs.keys() | expected.keys()
                if not same(theirs.get(name), expected.get(name))
            }
            if differing:
                sys.exit(f"{algorithm}, {env_id}: rl-zoo3's settings and ours: {differing}")
            print(f"{algorithm}, {env_id}: {len(theirs)} settings are the same")


def same(theirs: Any, ours: Any) -> bool:
    """Whether two settings are equal; rl-zoo3 makes a schedule of each number."""
    if isinstance(theirs, type) or not callable(theirs):
        return bool(theirs == ours)
    if not callable(ours):
        return bool(plain(theirs) == [ours] * 3)
    return bool(plain(theirs) == plain(ours))


if __name__ == "__main__":
    main()
