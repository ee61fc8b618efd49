"""Conversions between shares, angles, equilibrium points and actions."""

from __future__ import annotations

import numpy as np
import pytest
from comparing import BATCHES, CONTROLS_OF, TASKS
from hypothesis import given
from hypothesis import strategies as st

import gym_babble
from gym_babble.errors import ConfigError

ARM = ("shoulder", "elbow")
CLEAR = {"reach": {"obstacle": None}, "grasp": {}}
PLANNED = [(task, control) for task in TASKS for control in CONTROLS_OF[task][:3]]


@pytest.mark.parametrize("task", TASKS)
def test_ranges_are_the_bodys(task):
    for config in ("paper", "icub"):
        joints = gym_babble.Joints(TASKS[task](config=config))
        named = gym_babble.Config.profile_named(config).body.joints
        ends = [(named[name].lower_deg, named[name].upper_deg) for name in ARM]
        assert np.degrees(joints.ranges[:2]) == pytest.approx(np.array(ends))


@given(st.lists(st.tuples(*[st.floats(0, 1)] * 4), min_size=1, max_size=5))
def test_shares_and_angles_are_inverse_for_rows_of_any_number(shares):
    joints = gym_babble.Joints(JOINTS_OF)
    angles = joints.angles(shares)
    assert angles.shape == (len(shares), 4)
    assert joints.shares(angles) == pytest.approx(np.array(shares), abs=1e-12)
    low, high = joints.ranges.T
    assert ((low <= angles + 1e-12) & (angles <= high + 1e-12)).all()


JOINTS_OF = TASKS["grasp"]()


@pytest.mark.parametrize(("task", "control"), PLANNED)
@pytest.mark.parametrize("obs", ["senses", "flat", "goal"])
def test_actions_bring_the_equilibrium_points_where_they_shall_be(task, control, obs):
    # Catches a unit, an order of joints, and a stretch of another sign.
    reward = "sparse" if obs == "goal" else "progress"
    env = TASKS[task](control=control, obs=obs, reward=reward)
    observation, _ = env.reset(seed=1, options=CLEAR[task])
    joints = gym_babble.Joints(env)
    start = joints.posture(observation)
    assert joints.equilibrium(observation) == pytest.approx(start, abs=1e-6)
    points = start + np.radians([12.0, -9.0, 8.0, 4.0])[: len(start)]
    points = np.clip(points, *joints.ranges.T)
    for _ in range(4):
        observation, *_ = env.step(joints.actions(points, observation))
    if control == "torque":
        toward = (joints.posture(observation) - start) * (points - start)
        assert (toward > 0).all()
    else:
        assert joints.equilibrium(observation) == pytest.approx(points, abs=1e-5)


@pytest.mark.parametrize("task", TASKS)
def test_a_batch_gives_the_rows_of_single_environments(task):
    envs = BATCHES[task](3)
    observation, _ = envs.reset(seed=0)
    joints = gym_babble.Joints(envs)
    points = joints.angles(np.full(len(joints.ranges), 0.4))
    every = joints.actions(points, observation)
    for i in range(3):
        one = {name: sense[i] for name, sense in observation.items()}
        assert joints.actions(points, one).tobytes() == every[i].tobytes()


def test_what_does_not_fit_is_named():
    joints = gym_babble.Joints("BabbleGrasp-v0")
    with pytest.raises(ConfigError, match=r"shares has shape \(3,\), expected \(..., 4\)"):
        joints.angles([0.0, 0.0, 0.0])
    with pytest.raises(ConfigError, match=r"points .+ finite|points\[1\]"):
        joints.actions([0.0, np.nan, 0.0, 0.0], np.zeros(455))
    with pytest.raises(ConfigError, match=r"observation has shape \(7,\), expected \(..., 455\)"):
        joints.posture(np.zeros(7))
    with pytest.raises(ConfigError, match="observation has eye, expected arm"):
        joints.posture({"eye": [0.0, 0.0]})
    pattern = gym_babble.Joints("BabbleReachPattern-v0")
    with pytest.raises(ConfigError, match="pattern"):
        pattern.actions([0.0, 0.5])
