"""Learning in environments on a server: stable-baselines3's checker, HER, and PPO's weights."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from comparing import ALL_IDS, assert_same
from serving import served
from stable_baselines3 import PPO, SAC, HerReplayBuffer
from stable_baselines3.common.env_checker import check_env
from test_sb3 import same, without_clock

from gym_babble.remote import RemoteEnv
from gym_babble.sb3 import BabbleVecEnv

torch.set_num_threads(1)


@pytest.fixture(scope="module")
def url():
    with served() as server:
        yield server.url


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_stable_baselines3s_checker_is_content(env_id, url):
    env = RemoteEnv(env_id, url=url)
    check_env(env)
    env.close()


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGraspGoal-v0"])
def test_the_vec_env_gives_what_a_local_one_gives(env_id, url):
    remote, local = (BabbleVecEnv(env_id, 3, url=at, max_episode_steps=9) for at in (url, None))
    for envs in (remote, local):
        envs.seed(4)
    assert same(remote.reset(), local.reset())
    random = np.random.default_rng(0)
    for _ in range(30):
        actions = random.uniform(-1.0, 1.0, (3, *local.action_space.shape)).astype(np.float32)
        ours, theirs = remote.step(actions), local.step(actions)
        assert all(same(a, b) for a, b in zip(ours[:3], theirs[:3], strict=True))
        for our, their in zip(ours[3], theirs[3], strict=True):
            assert_same(without_clock(our), without_clock(their))
    assert_same(remote.env_method("get_state"), local.env_method("get_state"))
    remote.close()


def weights(env_id, url, steps):
    env = BabbleVecEnv(env_id, 8, url=url)
    env.seed(0)
    model = PPO("MultiInputPolicy", env, n_steps=64, batch_size=64, n_epochs=4, seed=0)
    model.learn(steps)
    env.close()
    return {name: value.numpy() for name, value in model.policy.state_dict().items()}


@pytest.mark.parametrize(
    ("env_id", "steps"),
    [
        ("BabbleReach-v0", 512),
        pytest.param("BabbleReach-v0", 20_480, marks=pytest.mark.slow),
        pytest.param("BabbleGrasp-v0", 20_480, marks=pytest.mark.slow),
    ],
)
def test_ppo_learns_the_same_weights_as_locally(env_id, steps, url):
    assert_same(weights(env_id, url, steps), weights(env_id, None, steps))


def test_hindsight_replay_asks_for_rewards(url):
    made = {"replay_buffer_class": HerReplayBuffer, "learning_starts": 50, "seed": 0}
    learnt = []
    for at in (url, None):
        env = BabbleVecEnv("BabbleReachGoal-v0", 2, url=at, max_episode_steps=20)
        model = SAC("MultiInputPolicy", env, batch_size=32, **made)
        model.learn(60)
        learnt.append({name: value.numpy() for name, value in model.policy.state_dict().items()})
        env.close()
    assert_same(*learnt)
