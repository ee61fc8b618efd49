"""Noise of senses and muscles: its size, its seed, and that nothing changes without it."""

from __future__ import annotations

import json

import gymnasium as gym
import numpy as np
import pytest
from comparing import TASKS, assert_same

from gym_babble import Config, babble
from gym_babble.config import Noise, config_json
from gym_babble.envs import BabbleVectorEnv
from gym_babble.errors import ConfigError

PATTERN = "BabbleReachPattern-v0"
FREE = {"start": (0.1, 0.25), "target": (-0.25, 0.1), "obstacle": None}
"""A case of reaching whose joints are far from the ends of their ranges."""
ALL = {
    "joint_deg": 1.0,
    "eye_deg": 0.5,
    "sight_deg": 2.0,
    "fovea": 0.05,
    "touch_n": 0.5,
    "motor_deg": 3.0,
}
each_task = pytest.mark.parametrize("task", TASKS)


def batch(n, task="reach", noise=None, threads=1, **options):
    config = {} if noise is None else {"noise": noise}
    return BabbleVectorEnv(n, task=task, config=config, threads=threads, **options)


def joint_range(envs):
    """Widths of the joint ranges [rad]."""
    return np.array(json.loads(envs.interface.task.quantities())["joint_range"])


def still(envs, steps):
    """What is shown (steps, n, k) while nothing is asked of the muscles."""
    action = np.zeros((envs.num_envs, *envs.single_action_space.shape), np.float32)
    return np.array([envs.step(action)[0] for _ in range(steps)])


@each_task
def test_noise_that_is_off_changes_no_bit(task):
    off = dict.fromkeys(ALL, 0.0)
    ours, plain = (batch(3, task, noise, obs="flat") for noise in (off, None))
    assert config_json({"noise": off}) == config_json("paper")
    assert "noise" not in json.loads(Config().to_json())
    for envs in (ours, plain):
        envs.reset(seed=3)
    rng = np.random.default_rng(0)
    for _ in range(30):
        action = rng.uniform(-1, 1, ours.action_space.shape).astype(np.float32)
        assert_same(ours.step(action)[:4], plain.step(action)[:4])
    assert ours.get_state() == plain.get_state()


def test_senses_of_reaching_have_the_stated_errors():
    noise = {"joint_deg": 2.0, "eye_deg": 1.0, "sight_deg": 3.0}
    case = FREE | {"obstacle": (0.02, 0.3, 0.01)}
    shown = []
    for given in (noise, None):
        envs = batch(200, noise=given, obs="flat", control="posture")
        envs.reset(seed=0, options=case)
        shown.append(still(envs, 20))
    errors = shown[0] - shown[1]
    senses = dict(envs.interface.spec.slices)
    width, eye = np.degrees(joint_range(envs)), 130.0
    deviations = {
        "arm": 2.0 / width,
        "stretch": np.radians([2.0, 2.0]),
        "eye": [1.0 / eye] * 2,
        "hand": np.radians([3.0, 3.0]),
        "obstacle": np.radians([3.0, 3.0]),
        "time": [0.0],
    }
    assert deviations.keys() == senses.keys()
    for name, expected in deviations.items():
        found = errors[..., senses[name]].reshape(-1, len(expected))
        # 4,000 draws: the standard errors are .016 of the mean's and .011 of the deviation.
        assert found.std(axis=0) == pytest.approx(expected, rel=0.05), name
        assert (abs(found.mean(axis=0)) <= 4 * np.array(expected) / np.sqrt(len(found))).all(), name
    felt = errors[..., senses["arm"]]
    # One error of a joint, and fresh ones each step.
    assert errors[..., senses["stretch"]] == pytest.approx(-felt * np.radians(width), abs=1e-6)
    assert abs(np.corrcoef(felt[:-1, :, 0].ravel(), felt[1:, :, 0].ravel())[0, 1]) < 0.08


def test_senses_of_grasping_have_the_stated_errors():
    noise = {"joint_deg": 2.0, "eye_deg": 1.0, "fovea": 0.02, "touch_n": 1.0}
    case = {"start": (0.2, 0.8), "object": (0.05, 0.29), "diameter": 0.06}
    shown = []
    for given in (noise, None):
        envs = batch(40, "grasp", given, obs="flat", threads=2)
        envs.reset(seed=0, options=case)
        shown.append(still(envs, 5))
    senses = dict(envs.interface.spec.slices)
    errors = shown[0] - shown[1]
    assert errors[..., senses["eye"]].std() == pytest.approx(1.0 / 130, rel=0.2)
    assert errors[..., senses["stretch"]][..., :2].std() == pytest.approx(np.radians(2), rel=0.2)
    # Cut at 0, which most edges and all forces have: half of a normal distribution, mean s/√2π.
    dark = shown[1][..., senses["fovea"]] == 0
    assert errors[..., senses["fovea"]][dark].mean() == pytest.approx(0.02 / 2.5066, rel=0.1)
    assert errors[..., senses["touch"]].mean() == pytest.approx(1.0 / 20 / 2.5066, rel=0.25)
    assert shown[0].min() >= -np.pi
    assert (shown[0][..., senses["fovea"]] >= 0).all()


def test_muscles_have_the_stated_errors_through_their_lag():
    """Errors e of every control period T through a lag L: q' = k q + (1 - k) e, k = exp(-T/L).

    In the long run q has the variance s² (1 - k)/(1 + k), where s is the errors' deviation.
    """
    envs = batch(1000, noise={"motor_deg": 4.0}, obs="flat", control="posture")
    envs.reset(seed=0, options=FREE)
    q = still(envs, 150)[-1][:, :2] * joint_range(envs)
    k = np.exp(-0.05 / 0.8)
    expected = np.radians(4.0) * np.sqrt((1 - k) / (1 + k))
    assert q.std(axis=0) == pytest.approx([expected] * 2, rel=0.1)
    middle = joint_range(envs) / 2
    assert (abs(q.mean(axis=0) - middle) < 5 * expected / np.sqrt(1000)).all()


@each_task
@pytest.mark.parametrize("control", ["delta_posture", "posture", "torque", "pattern"])
def test_noise_depends_on_the_seed_alone(task, control):
    if (task, control) == ("grasp", "pattern"):
        pytest.skip("grasping has no patterns")
    options = {"noise": ALL, "obs": "flat", "control": control}
    short = {} if control == "pattern" else {"max_episode_steps": 12}
    one, two = (batch(9, task, threads=threads, **options, **short) for threads in (1, 2))
    alone = TASKS[task](config={"noise": ALL}, obs="flat", control=control, **short)
    first = [envs.reset(seed=5)[0] for envs in (one, two)]
    assert_same(first[0], first[1])
    assert_same(alone.reset(seed=5 + 4)[0], first[0][4])
    rng = np.random.default_rng(1)
    for step in range(10):
        action = rng.uniform(-1, 1, one.action_space.shape).astype(np.float32)
        shown = one.step(action)
        assert_same(shown[:4], two.step(action)[:4])
        if step == 0:
            assert_same(alone.step(action[4])[0], shown[0][4])
    # A state has all that the noise to come depends on.
    three = batch(9, task, **options, **short)
    three.set_state(one.get_state())
    for _ in range(5):
        assert_same(one.step(action)[:4], three.step(action)[:4])


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("value", [-0.1, 1e9, float("nan"), "much"])
def test_a_deviation_out_of_bounds_is_named(name, value):
    with pytest.raises(ConfigError, match=rf"noise.*{name}|{name}"):
        config_json({"noise": {name: value}})


def test_noise_comes_from_file_dict_and_dataclass(tmp_path):
    (tmp_path / "noisy.toml").write_text("[noise]\nmotor_deg = 1.5\n")
    document = config_json(Config(noise=Noise(motor_deg=1.5)))
    assert config_json({"noise": {"motor_deg": 1.5}}) == document
    assert config_json(tmp_path / "noisy.toml") == document
    assert Config.from_json(document).noise == Noise(motor_deg=1.5)
    with pytest.raises(ConfigError, match=r"noise\.motor.*motor_deg"):
        config_json({"noise": {"motor": 1}})


def test_babbles_of_reaching_have_the_noise():
    plain = babble(PATTERN, 600, 1)
    noisy = babble(gym.make(PATTERN, config={"noise": {"sight_deg": 2.0}}), 600, 1)
    assert_same(noisy.actions, plain.actions)
    assert_same(noisy.outcome, plain.outcome)
    seen = plain.percepts["obstacle"]
    assert (noisy.percepts["obstacle"] - seen).std() == pytest.approx(np.radians(2), rel=0.1)
    shaky = gym.make(PATTERN, config={"noise": {"motor_deg": 20.0}})
    some, again = (babble(shaky, 300, 1, threads=threads) for threads in (1, 2))
    assert_same(vars(some), vars(again))
    assert (some.outcome != plain.outcome[:300]).any()


def test_babbles_of_grasping_have_no_noise():
    plain, noisy = (
        babble(gym.make("BabbleGrasp-v0", config=config), 6, 1)
        for config in ("paper", {"noise": ALL})
    )
    assert_same(vars(noisy), vars(plain))
