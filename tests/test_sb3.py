"""The batch behind stable-baselines3's VecEnv, and what stable-baselines3 asks of environments."""

import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest
import torch
from comparing import ALL_CHOICES, ENVIRONMENTS, GRASP_IDS, TASKS, assert_same
from grasping import to_object
from gymnasium.error import ResetNeeded
from stable_baselines3 import PPO, SAC, HerReplayBuffer
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import (
    DummyVecEnv,
    VecFrameStack,
    VecNormalize,
    VecVideoRecorder,
)

from gym_babble import HebbBabbling, scenarios
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import ActionError, ConfigError
from gym_babble.sb3 import BabbleVecEnv

# Two threads of PyTorch on a busy machine wait for each other: 20 s for what takes 1.
torch.set_num_threads(1)


def made(env_id, **kwargs):
    """An environment as `check_env` can take it."""
    env = gym.make(env_id, **kwargs)
    # It looks for compute_reward on a wrapper, which in Gymnasium 1 does not pass it on.
    return env.unwrapped if "achieved_goal" in getattr(env.observation_space, "spaces", {}) else env


@pytest.mark.parametrize("row", ENVIRONMENTS, ids=lambda row: row.id)
def test_checker_passes_every_id(row):
    check_env(made(row.id))


@pytest.mark.parametrize(
    ("env_id", "choices"),
    ALL_CHOICES,
    ids=lambda x: x if isinstance(x, str) else "-".join(x.values()),
)
def test_checker_passes_every_combination(env_id, choices):
    check_env(made(env_id, **choices))


def same(a, b):
    """Whether two observations are equal to the bit."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    return a.dtype == b.dtype and np.array_equal(a, b)


def without_clock(info):
    """An info with what can be compared: no clock time, no observation."""
    kept = {k: v for k, v in info.items() if k not in ("terminal_observation", "episode")}
    if "episode" in info:
        kept["episode"] = (info["episode"]["r"], info["episode"]["l"])
    return kept


def dummy(env_id, n, **kwargs):
    """The same environments one by one, as stable-baselines3 makes them."""
    kwargs = {**gym.spec(env_id).kwargs, **kwargs}
    kind = TASKS["grasp" if env_id in GRASP_IDS else "reach"]
    return DummyVecEnv([lambda: Monitor(kind(**kwargs))] * n)


@pytest.mark.parametrize(
    ("env_id", "kwargs", "steps"),
    [
        ("BabbleReach-v0", {"max_episode_steps": 60}, 300),
        ("BabbleReach-v0", {"obs": "flat", "control": "torque"}, 300),
        ("BabbleReach-v0", {"obs": "retina", "retina_size": 36, "max_episode_steps": 5}, 20),
        ("BabbleReachGoal-v0", {"max_episode_steps": 60}, 200),
        ("BabbleReachPattern-v0", {}, 20),
        ("BabbleGrasp-v0", {"max_episode_steps": 60}, 150),
        ("BabbleGraspFull-v0", {"obs": "flat", "control": "torque"}, 501),
        ("BabbleGrasp-v0", {"obs": "retina", "retina_size": 36, "max_episode_steps": 5}, 20),
        ("BabbleGraspGoal-v0", {"max_episode_steps": 60}, 130),
    ],
)
def test_equals_dummy_vec_env(env_id, kwargs, steps):
    batch, singles = BabbleVecEnv(env_id, 4, **kwargs), dummy(env_id, 4, **kwargs)
    assert batch.observation_space == singles.observation_space
    assert batch.action_space == singles.action_space
    batch.seed(7)
    singles.seed(7)
    assert same(batch.reset(), singles.reset())
    assert_same(batch.reset_infos, singles.reset_infos)
    random = np.random.default_rng(0)
    ends = 0
    for _ in range(steps):
        actions = random.uniform(-1.0, 1.0, (4, *batch.action_space.shape)).astype(np.float32)
        ours, theirs = batch.step(actions), singles.step(actions)
        assert all(same(a, b) for a, b in zip(ours[:3], theirs[:3], strict=True))
        assert_same(batch.reset_infos, singles.reset_infos)
        for our, their in zip(ours[3], theirs[3], strict=True):
            assert_same(without_clock(our), without_clock(their))
            assert ("terminal_observation" in our) == ("terminal_observation" in their)
            if "terminal_observation" in our:
                ends += 1
                assert same(our["terminal_observation"], their["terminal_observation"])
    assert ends >= 4


def test_observations_of_earlier_steps_stay():
    env = BabbleVecEnv("BabbleReach-v0", 2, obs="flat")
    first = env.reset()
    copy = first.copy()
    env.step(np.ones((2, 2), np.float32))
    assert np.array_equal(first, copy)


def test_options_go_to_each_environment_and_hold():
    cases = scenarios("table1", 3)
    env = BabbleVecEnv("BabbleReachPattern-v0", 3)
    env.set_options([{"scenario": case} for case in cases])
    starts = env.reset()["arm"]
    again = env.step(np.zeros((3, 2), np.float32))[0]["arm"]
    assert np.array_equal(starts, again)
    env.set_options([{}, {"start": (0.1, 0.2)}, {}])
    mixed = env.reset()["arm"]
    assert np.array_equal(mixed[[0, 2]], starts[[0, 2]])
    assert not np.array_equal(mixed[1], starts[1])
    assert [case["target"] for case in env.get_attr("scenario", [0, 2])] == [
        pytest.approx(cases[0]["target"]),
        pytest.approx(cases[2]["target"]),
    ]
    env.set_options({"scenario": None})
    assert not np.array_equal(env.reset()["arm"], starts)


def test_options_of_grasping_go_to_each_environment_and_hold():
    env = BabbleVecEnv("BabbleGraspSparse-v0", 2, max_episode_steps=2)
    cases = [{"object": (0.0, 0.2), "diameter": 0.03}, {"start": (-0.8, 0.5)}]
    env.set_options(cases)
    env.reset()
    for _ in range(5):
        for case, played in zip(cases, env.get_attr("scenario"), strict=True):
            assert case.items() <= played.items()
        env.step(np.zeros((2, 4), np.float32))


class OneOf:
    """Environment i of a batch, as far as the hand needs it."""

    def __init__(self, env, i):
        self.unwrapped = self
        self.interface, self.scenario = (
            env.get_attr("interface", i)[0],
            env.get_attr("scenario", i)[0],
        )


def test_a_grasp_succeeds_in_the_batch_and_its_facts_are_told():
    env = BabbleVecEnv("BabbleGrasp-v0", 3, control="posture")
    env.seed(0)
    env.reset()
    infos, ends = env.reset_infos, {}
    for _ in range(160):
        hands = [to_object(OneOf(env, i), infos[i]) for i in range(3)]
        _, _, dones, infos = env.step(np.stack(hands))
        for i in np.flatnonzero(dones):
            ends.setdefault(int(i), infos[i])
        infos = [env.reset_infos[i] if dones[i] else infos[i] for i in range(3)]
    assert len(ends) == 3
    for info in ends.values():
        assert info["is_success"]
        assert info["held"]
        assert outcome_of(info) == "success"
        assert info["episode"]["l"] < 160
        assert not info["TimeLimit.truncated"]


def test_usable_after_an_unknown_option():
    env = BabbleVecEnv("BabbleReach-v0", 2)
    env.set_options({"goal": (0.1, 0.2)})
    with pytest.raises(ConfigError, match="goal"):
        env.reset()
    env.reset()


def test_usable_after_a_bad_action():
    env = BabbleVecEnv("BabbleReach-v0", 2)
    with pytest.raises(ResetNeeded):
        env.step(np.zeros((2, 2), np.float32))
    env.reset()
    with pytest.raises(ActionError):
        env.step(np.full((2, 2), np.nan, np.float32))
    env.step(np.zeros((2, 2), np.float32))


def test_other_autoreset_modes_are_refused():
    with pytest.raises(ConfigError, match="autoreset_mode"):
        BabbleVecEnv("BabbleReach-v0", 2, autoreset_mode="NextStep")


def test_attributes_and_methods():
    env = BabbleVecEnv("BabbleReach-v0", 3)
    env.reset()
    assert env.get_attr("interface")[0].options["control"] == "delta_posture"
    assert env.get_attr("observation_space", 1) == [env.observation_space]
    assert env.has_attr("scenario")
    assert not env.has_attr("absent")
    assert len(env.env_method("get_state", indices=[0, 2])) == 2
    assert len(set(env.env_method("state_hash"))) == 3
    env.set_attr("note", "all")
    assert env.get_attr("note") == ["all"] * 3
    env.set_attr("note", np.zeros(2), indices=1)
    assert_same(env.get_attr("note"), ["all", np.zeros(2), "all"])
    for name, value in (("num_envs", 7), ("step", None), ("render_mode", "rgb_array")):
        with pytest.raises(AttributeError, match=name):
            env.set_attr(name, value)
    with pytest.raises(AttributeError, match="batch"):
        env.env_method("reset")
    assert env.env_is_wrapped(Monitor, [0]) == [True]
    assert env.env_is_wrapped(gym.wrappers.TimeLimit) == [False] * 3


@pytest.mark.parametrize("make", [BabbleVecEnv, dummy])
@pytest.mark.parametrize("env_id", ["BabbleReachGoal-v0", "BabbleGraspGoal-v0"])
def test_goal_rewards_can_be_computed_anew(make, env_id):
    env = make(env_id, 2)
    env.seed(3)
    env.reset()
    random = np.random.default_rng(0)
    for _ in range(50):
        actions = random.uniform(-1, 1, (2, *env.action_space.shape)).astype(np.float32)
        observation, rewards, dones, _ = env.step(actions)
        if not dones.any():
            goals = (observation["achieved_goal"], observation["desired_goal"])
            (computed,) = env.env_method("compute_reward", *goals, [{}] * 2, indices=[0])
            assert np.array_equal(computed, rewards)


@pytest.mark.parametrize("make", [BabbleVecEnv, dummy])
@pytest.mark.parametrize("control", ["pattern", "delta_posture"])
def test_evaluate_policy_takes_the_hebb_agent(make, control):
    kwargs = {"control": control, "reward": "sparse"}
    env = make("BabbleReach-v0", 20, **kwargs)
    env.seed(1)
    agent = HebbBabbling(env, seed=0).learn(500)
    mean, _ = evaluate_policy(agent, env, n_eval_episodes=60)
    assert mean > 0.5


def test_ppo_learns_saves_and_loads(tmp_path):
    env = BabbleVecEnv("BabbleReach-v0", 8)
    model = PPO("MultiInputPolicy", env, n_steps=64, batch_size=128, n_epochs=1, device="cpu")
    model.learn(3 * 512)
    assert len(model.ep_info_buffer) > 0
    assert len(model.ep_success_buffer) == len(model.ep_info_buffer)
    model.save(tmp_path / "model")
    loaded = PPO.load(tmp_path / "model", env=BabbleVecEnv("BabbleReach-v0", 8), device="cpu")
    observation = env.reset()
    expected, _ = model.predict(observation, deterministic=True)
    assert np.array_equal(loaded.predict(observation, deterministic=True)[0], expected)
    loaded.learn(512)


def test_ppo_learns_on_grasping():
    env = BabbleVecEnv("BabbleGrasp-v0", 4, max_episode_steps=40)
    model = PPO("MultiInputPolicy", env, n_steps=64, batch_size=128, n_epochs=1, device="cpu")
    model.learn(512)
    assert len(model.ep_info_buffer) >= 8
    assert len(model.ep_success_buffer) == len(model.ep_info_buffer)


def test_ppo_is_the_same_on_the_batch_and_on_singles():
    def trained(env):
        env.seed(5)
        model = PPO("MultiInputPolicy", env, n_steps=80, batch_size=64, seed=5, device="cpu")
        return model.learn(320).get_parameters()["policy"]

    ours = trained(BabbleVecEnv("BabbleReach-v0", 4, max_episode_steps=30))
    theirs = trained(dummy("BabbleReach-v0", 4, max_episode_steps=30))
    assert all(bool((ours[name] == theirs[name]).all()) for name in ours)


@pytest.mark.parametrize(
    ("make", "env_id"),
    [
        (BabbleVecEnv, "BabbleReachGoal-v0"),
        (dummy, "BabbleReachGoal-v0"),
        (BabbleVecEnv, "BabbleGraspGoal-v0"),
    ],
)
def test_hindsight_replay(make, env_id):
    env = make(env_id, 2, max_episode_steps=30)
    model = SAC(
        "MultiInputPolicy",
        env,
        replay_buffer_class=HerReplayBuffer,
        learning_starts=64,
        batch_size=32,
        device="cpu",
    )
    model.learn(100)
    sample = model.replay_buffer.sample(200)
    assert set(sample.rewards.unique().tolist()) <= {-1.0, 0.0}


def test_vec_normalize_and_frame_stack():
    env = VecNormalize(BabbleVecEnv("BabbleReach-v0", 2, max_episode_steps=5))
    env.reset()
    for _ in range(6):
        observation, _, _, infos = env.step(np.zeros((2, 2), np.float32))
    assert set(observation) == set(env.observation_space)
    stacked = VecFrameStack(BabbleVecEnv("BabbleReach-v0", 2, obs="flat", max_episode_steps=5), 3)
    stacked.reset()
    for _ in range(5):
        observation, _, dones, infos = stacked.step(np.zeros((2, 2), np.float32))
    assert observation.shape == (2, 33)
    assert dones.all()
    assert infos[0]["terminal_observation"].shape == (33,)


def test_pictures_and_videos(tmp_path):
    env = BabbleVecEnv(
        "BabbleReach-v0", 2, render_mode="rgb_array", width=64, height=48, max_episode_steps=6
    )
    assert env.metadata["render_fps"] == 20
    video = VecVideoRecorder(env, str(tmp_path), lambda step: step in (0, 7), video_length=4)
    video.reset()
    assert env.render().shape == (96, 64, 3)
    assert [picture.shape for picture in env.get_images()] == [(48, 64, 3)] * 2
    for _ in range(14):
        video.step(np.ones((2, 2), np.float32))
    video.close()
    assert len(list(tmp_path.glob("*.mp4"))) == 2


@pytest.mark.parametrize("module", ["sb3", "study.trainers.sb3"])
def test_names_the_extra_that_is_missing(module):
    script = f"""
import sys
sys.modules["stable_baselines3"] = None
import gym_babble.{module}
"""
    done = subprocess.run(
        [sys.executable, "-c", script], check=False, capture_output=True, text=True, timeout=60
    )
    assert "MissingExtraError" in done.stderr
    assert "gym-babble[sb3]" in done.stderr
