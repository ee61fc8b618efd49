"""What has to work on each Python: .ci/wheel_tests.py runs this with each one."""

from __future__ import annotations

import copy
import importlib
import pickle
import pkgutil
import warnings

import gymnasium
import numpy as np
import pytest
from comparing import ALL_IDS
from gymnasium.utils.env_checker import check_env

import gym_babble
from gym_babble.errors import MissingExtraError


@pytest.mark.parametrize(
    "name", [module.name for module in pkgutil.walk_packages(gym_babble.__path__, "gym_babble.")]
)
def test_each_module_imports(name):
    try:
        importlib.import_module(name)
    except MissingExtraError as missing:
        assert "pip install 'gym-babble[" in str(missing)  # noqa: PT017 - not all extras are here.


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_gymnasiums_checker_accepts_each_id(env_id):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(env_id).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_a_copy_from_a_pickle_and_a_batch_play_alike(env_id):
    env = gymnasium.make(env_id).unwrapped
    batch = gymnasium.make_vec(env_id, num_envs=2)
    env.reset(seed=3)
    batch.reset(seed=[3, 4])
    twins = [env, copy.deepcopy(env), pickle.loads(pickle.dumps(env))]  # noqa: S301 - our own.
    action = np.zeros(env.action_space.shape, np.float32)
    rewards = [twin.step(action)[1] for twin in twins]
    rewards.append(batch.step(np.stack([action, action]))[1][0])
    assert len(set(rewards)) == 1


def test_an_agent_learns_and_is_saved(tmp_path):
    env = gymnasium.make("BabbleReachPattern-v0")
    observation, _ = env.reset(seed=0)
    agent = gym_babble.HebbBabbling(env).learn(200)
    agent.save(tmp_path / "agent")
    again = gym_babble.HebbBabbling.load(tmp_path / "agent")
    assert np.array_equal(agent.predict(observation)[0], again.predict(observation)[0])
