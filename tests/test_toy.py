"""The toy task of development builds: one folder and one line of the registry make a whole task."""

from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import gym_babble
from gym_babble.envs import BabbleEnv
from gym_babble.envs.interface import outcome_of
from gym_babble.envs.registry import TASKS
from gym_babble.errors import ConfigError

TOY = "BabbleToy-v0"
installed = "site-packages" in Path(gym_babble.__file__).parts
of_the_toy = pytest.mark.skipif(installed, reason="an installed wheel has no toy task")


def test_development_builds_alone_have_the_toy_task():
    assert ("toy" in TASKS) != installed
    assert (TOY in gymnasium.registry) != installed


def towards_target(observation):
    return np.clip(10 * (observation["target"] - observation["position"]), -1, 1)


@of_the_toy
def test_gymnasiums_checker_is_content_with_it():
    check_env(gymnasium.make(TOY).unwrapped, skip_render_check=True)


@of_the_toy
def test_it_plays_by_itself_and_in_a_batch_alike():
    """Catches a face that knows only the tasks that it was written for."""
    envs = gymnasium.make_vec(TOY, num_envs=3, autoreset_mode="Disabled")
    seen, _ = envs.reset(seed=5)
    singles = [gymnasium.make(TOY) for _ in range(3)]
    shown = [env.reset(seed=5 + i)[0] for i, env in enumerate(singles)]
    for _ in range(5):
        actions = -towards_target(seen).astype(np.float32)
        seen, rewards, *_ = envs.step(actions)
        for i, env in enumerate(singles):
            shown[i], reward, *_ = env.step(actions[i])
            assert reward == rewards[i]
            assert all((shown[i][name] == seen[name][i]).all() for name in seen)


@of_the_toy
def test_its_episodes_end_at_the_target_or_in_time():
    env = gymnasium.make(TOY, render_mode="rgb_array")
    observation, _ = env.reset(seed=1, options={"target": (0.5, -0.5)})
    assert observation["target"].tolist() == [0.5, -0.5]
    assert env.unwrapped.scenario == {"target": (0.5, -0.5)}
    ended, steps = False, 0
    while not ended:
        observation, reward, ended, _, info = env.step(towards_target(observation))
        steps += 1
    assert (reward, outcome_of(info), info["is_success"]) == (1.0, "success", True)
    assert env.unwrapped.trajectory.shape == (steps + 1, 2)
    assert env.render().shape == (480, 480, 3)
    core = env.unwrapped._batch
    assert core.one_goals() == []
    assert not {"achieved_goal", "desired_goal"} & set(core.all())
    still = BabbleEnv(task="toy", max_episode_steps=2)
    still.reset(seed=0, options={"target": (0.9, 0.9)})
    assert still.step([0, 0])[2:4] == (False, False)
    assert still.step([0, 0])[2:4] == (False, True)


@of_the_toy
def test_a_state_continues_and_foreign_options_are_named():
    env, other = BabbleEnv(task="toy"), BabbleEnv(task="toy")
    env.reset(seed=3)
    env.step([1, 0])
    other.set_state(env.get_state())
    assert other.state_hash() == env.state_hash()
    with pytest.raises(ConfigError, match='unknown option "settled"'):
        BabbleEnv(task="toy", settled=True)
    with pytest.raises(ConfigError, match='did you mean "record"'):
        BabbleEnv(task="toy", recod=True)
