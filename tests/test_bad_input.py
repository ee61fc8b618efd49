"""What is refused, by which name, and that everything goes on afterwards."""

from __future__ import annotations

import re

import numpy as np
import pytest
from comparing import BATCHES, EACH_CONTROL, TASKS, assert_same
from gymnasium.error import ResetNeeded

from gym_babble import export_mjcf, export_urdf, scenarios
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv, BabbleReachVectorEnv
from gym_babble.errors import (
    ActionError,
    BabbleError,
    ConfigError,
    MissingExtraError,
    ScenarioError,
    SnapshotError,
)

NAN, INF = float("nan"), float("inf")
WIDTH = {"reach": 2, "grasp": 4}
each_task = pytest.mark.parametrize("task", TASKS)


def wide(task, action):
    """A bad pair as a bad action of a task: the numbers of grasping are the pair's, twice."""
    if task == "reach":
        return action
    if isinstance(action, np.ndarray):
        return np.concatenate([action, action], axis=-1 if action.shape[0] == 1 else 0)
    return action * 2 if isinstance(action, list) else action


ACTIONS = {
    "nan": [NAN, 0],
    "second is nan": np.array([0, NAN], np.float32),
    "infinite": [INF, 0],
    "minus infinite": np.array([-INF, 0], np.float64),
    "scalar": 0.5,
    "one": [0.5],
    "three": [0.1, 0.2, 0.3],
    "empty": [],
    "row": np.zeros((1, 2), np.float32),
    "column": np.zeros((2, 1)),
    "ragged": [[1, 2], [3]],
    "none": None,
    "nones": [None, None],
    "text": "up",
    "texts": ["1", "2"],
    "complex": np.zeros(2, complex),
    "booleans": np.zeros(2, bool),
    "objects": np.array([0.0, 1.0], object),
    "too big for any float": [10**400, 0],
    "dict": {"shoulder": 1, "elbow": 0},
    "set": {0, 1},
    "times": np.zeros(2, "datetime64[s]"),
}
each_action = pytest.mark.parametrize("action", ACTIONS.values(), ids=ACTIONS.keys())


@each_action
@pytest.mark.parametrize(
    ("task", "control"),
    [
        ("reach", "delta_posture"),
        ("reach", "pattern"),
        ("grasp", "delta_posture"),
        ("grasp", "torque"),
    ],
)
def test_a_bad_action_is_refused_and_nothing_is_stepped(action, task, control):
    env, action = TASKS[task](control=control), wide(task, action)
    env.reset(seed=0)
    before = env.state_hash()
    with pytest.raises(ActionError, match="action") as caught:
        env.step(action)
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, BabbleError)
    assert env.state_hash() == before
    assert env.step([0.1] * WIDTH[task])[0] in env.observation_space


@each_action
@each_task
def test_a_bad_action_among_many_steps_none_of_them(task, action):
    envs, action, good = BATCHES[task](3, threads=2), wide(task, action), [0] * WIDTH[task]
    envs.reset(seed=0)
    before = envs.call("state_hash")
    for actions in ([good, action, good], action):
        if actions is not action and isinstance(action, np.ndarray) and action.dtype.kind == "b":
            continue  # Among numbers NumPy makes numbers of them.
        with pytest.raises(ActionError):
            envs.step(actions)
    assert envs.call("state_hash") == before
    envs.step(np.zeros((3, WIDTH[task])))


def test_kinds_of_actions_that_are_taken():
    expected = None
    for action in (
        np.array([1, -1], np.float32),
        np.array([1, -1], np.float64),
        np.array([1, -1], np.float16),
        np.array([1, -1], np.int64),
        np.array([1, -1], np.int8),
        np.array([1, -1], ">f4"),
        np.array([1, 9, -1, 9], np.float32)[::2],
        [1, -1],
        (1.0, np.float32(-1)),
        [7, -1e300],  # Clipped.
        np.array([3e38, -3.4e38]),
        [2**100 * 1.0, -(2.0**200)],
    ):
        env = BabbleReachEnv()
        env.reset(seed=0)
        seen = env.step(action)
        expected = expected or seen
        assert_same(seen, expected)


def test_a_step_outside_of_an_episode_needs_a_reset():
    for env in (BabbleReachEnv(), BabbleReachEnv(control="pattern")):
        with pytest.raises(ResetNeeded):
            env.step([0, 0])
    env.reset(seed=0)
    env.step([0, 0])
    before = env.state_hash()
    with pytest.raises(ResetNeeded):
        env.step([0, 0])
    assert env.state_hash() == before
    env.reset()
    env.step([0, 0])


def test_grasping_needs_a_reset_before_the_first_step_and_after_each_end():
    env = BabbleGraspEnv(max_episode_steps=2)
    with pytest.raises(ResetNeeded):
        env.step([0] * 4)
    for _ in range(2):
        env.reset(seed=0)
        assert not env.step([0] * 4)[3]
        assert env.step([0] * 4)[3]
        before = env.state_hash()
        with pytest.raises(ResetNeeded):
            env.step([0] * 4)
        assert env.state_hash() == before


@pytest.mark.parametrize(("task", "control"), [("reach", "pattern"), ("grasp", "posture")])
def test_a_batch_needs_resets_too(task, control):
    envs = BATCHES[task](2, control=control, autoreset_mode="Disabled", max_episode_steps=1)
    action = np.zeros(envs.action_space.shape, np.float32)
    with pytest.raises(ResetNeeded):
        envs.step(action)
    envs.reset(seed=0, options={"reset_mask": np.array([True, False])})
    with pytest.raises(ResetNeeded, match="1"):
        envs.step(action)
    envs.reset(options={"reset_mask": np.array([False, True])})
    envs.step(action)
    before = envs.call("state_hash")
    with pytest.raises(ResetNeeded):
        envs.step(action)
    assert envs.call("state_hash") == before


REACH = {"start": (0.1, 0.2), "target": (0.2, 0.25), "obstacle": None}
OPTIONS = [
    ({"Start": (0, 0)}, ConfigError, "Start.*did you mean 'start'"),
    ({"obstacles": (0, 0.2)}, ConfigError, "did you mean 'obstacle'"),
    ({"object": (0.1, 0.2)}, ConfigError, "object.*start, target, obstacle"),
    ("table1", ConfigError, "options"),
    ([1, 2], ConfigError, "options"),
    ({"scenario": "table1"}, ScenarioError, "scenario"),
    ({"scenario": 4}, ScenarioError, "scenario"),
    ({"scenario": {**REACH, "speed": 2}}, ConfigError, "speed"),
    ({"start": 3}, ScenarioError, "start"),
    ({"start": (1, 2, 3)}, ScenarioError, "start"),
    ({"start": "ab"}, ScenarioError, "start"),
    # Python would take their letters, bytes and keys for numbers.
    ({"start": "12"}, ScenarioError, "start = '12'"),
    ({"start": b"12"}, ScenarioError, "start"),
    ({"target": {0.1, 0.2}}, ScenarioError, "target"),
    ({"target": {0.1: 1, 0.2: 2}}, ScenarioError, "target"),
    ({"target": (True, False)}, ScenarioError, "target"),
    ({"target": [[0.1, 0.2]]}, ScenarioError, r"target.*shape \(1, 2\)"),
    ({"target": (10**400, 0.1)}, ScenarioError, "target"),
    ({"start": (NAN, 0)}, ScenarioError, r"start\[0\] = nan is not finite"),
    ({"target": (INF, 0.1)}, ScenarioError, "target"),
    ({"target": (9, 9)}, ScenarioError, "target.*reach"),
    ({"target": (0.0, -0.38)}, ScenarioError, "target.*joint ranges"),
    ({"start": (0.0, 0.0)}, ScenarioError, "start"),
    ({"obstacle": (0.1,)}, ScenarioError, "obstacle"),
    ({"obstacle": "none"}, ScenarioError, "obstacle"),
    ({"obstacle": (0.1, NAN)}, ScenarioError, "obstacle"),
    ({"obstacle": (0.1, 0.2, -1)}, ScenarioError, "obstacle"),
    ({"obstacle": (0, 0, 1)}, ScenarioError, "no legal movement"),
    ({**REACH, "obstacle": (0.1, 0.2)}, ScenarioError, "obstacle.*start"),
    ({"start": (0.1, 0.2), "obstacle": (0.1, 0.2)}, ScenarioError, "obstacle.*start"),
]


GRASP = {"start": (-0.8, 0.5), "object": (0.0, 0.2), "diameter": 0.04, "obstacle": None}
GRASP_OPTIONS = [
    ({"target": (0.1, 0.2)}, ConfigError, "target.*start, object, diameter, goal, obstacle"),
    ("table2", ConfigError, "options"),
    ({"scenario": 4}, ScenarioError, "scenario"),
    ({"scenario": {**GRASP, "speed": 2}}, ConfigError, "speed"),
    ({"start": 3}, ScenarioError, r"start = 3 .*rad"),
    ({"start": (1, 2, 3)}, ScenarioError, "start.*expected 2"),
    ({"start": "ab"}, ScenarioError, "start"),
    ({"start": (NAN, 0)}, ScenarioError, r"start\[0\] = nan is not finite"),
    ({"start": (0, INF)}, ScenarioError, r"start\[1\] = inf is not finite"),
    ({"start": (0, 3.0)}, ScenarioError, "start.*171.9°.*joint ranges"),
    ({"object": 3}, ScenarioError, r"object = 3 .*\[m\]"),
    ({"object": (1, 2, 3)}, ScenarioError, "object.*expected 2"),
    ({"object": (NAN, 0.2)}, ScenarioError, r"object\[0\] = nan"),
    ({"object": (0.3, INF)}, ScenarioError, "object.*inf"),
    ({"object": (0.3, 0.3)}, ScenarioError, r"object: \[0.3, 0.3\] m.*reach of 0.396 m"),
    ({"object": (0.0, 0.0)}, ScenarioError, "object: the arm at the start is"),
    ({**GRASP, "object": (0.1, -0.1)}, ScenarioError, "object.*at least 0.005 m"),
    ({"diameter": 0}, ScenarioError, r"diameter: 0 m.*\[0.005, 0.2\]"),
    ({"diameter": -0.04}, ScenarioError, "diameter: -0.04"),
    ({"diameter": 0.21}, ScenarioError, "diameter: 0.21"),
    ({"diameter": NAN}, ScenarioError, "diameter = nan is not finite"),
    ({"diameter": INF}, ScenarioError, "diameter = inf is not finite"),
    ({"diameter": "big"}, ScenarioError, "diameter = 'big'"),
    ({"diameter": "0.04"}, ScenarioError, "diameter = '0.04'"),
    ({"diameter": True}, ScenarioError, "diameter"),
    ({"diameter": [0.04]}, ScenarioError, "diameter.*expected a number"),
    ({"diameter": (0.03, 0.04)}, ScenarioError, "diameter"),
    ({"obstacle": (0.1,)}, ScenarioError, "obstacle"),
    ({"obstacle": "none"}, ScenarioError, "obstacle"),
    ({"obstacle": (0.1, NAN)}, ScenarioError, r"obstacle\[1\] = nan"),
    ({"obstacle": (0.1, 0.2, -1)}, ScenarioError, "obstacle.*-1 m.*0.0001"),
    ({"obstacle": (0.0, 0.0)}, ScenarioError, "obstacle: it is -0.0450 m from the arm"),
    ({**GRASP, "obstacle": (0.05, -0.05)}, ScenarioError, "obstacle: it is -0.* m from the arm"),
    ({**GRASP, "obstacle": (0.0, 0.24)}, ScenarioError, "obstacle.*-0.0150 m from the object"),
    ({"goal": (0.1, 0.2)}, ScenarioError, 'goal.*obs = "goal"'),
]
ALL_OPTIONS = [("reach", *row) for row in OPTIONS] + [("grasp", *row) for row in GRASP_OPTIONS]
GOOD = {"reach": REACH, "grasp": GRASP}
each_option = pytest.mark.parametrize(
    ("task", "options", "error", "named"), ALL_OPTIONS, ids=lambda x: str(x)[:40]
)


@each_option
def test_bad_options_are_refused_and_forgotten(task, options, error, named):
    env = TASKS[task]()
    env.reset(seed=0, options=GOOD[task])
    before = env.state_hash()
    with pytest.raises(error, match=named) as caught:
        env.reset(options=options)
    assert isinstance(caught.value, ValueError)
    assert env.state_hash() == before
    env.step([0] * WIDTH[task])
    env.reset()
    assert env.scenario == GOOD[task]


@each_option
def test_bad_options_for_one_of_many_leave_all_as_they_were(task, options, error, named):
    envs, good = BATCHES[task](3, threads=2), GOOD[task]
    envs.reset(seed=0, options=good)
    before = envs.call("state_hash")
    with pytest.raises(error, match=named):
        envs.reset(options=options)
    if isinstance(options, dict) and "scenario" not in options:
        with pytest.raises(error, match=named):
            envs.reset(options={"scenario": [good, options, good]})
    assert envs.call("state_hash") == before
    envs.step(np.zeros((3, WIDTH[task])))
    envs.reset()
    assert envs.get_attr("scenario") == (good,) * 3


@pytest.mark.parametrize(
    ("goal", "named"),
    [
        (3, "goal = 3"),
        ((1, 2, 3), "goal.*expected 2"),
        ((NAN, 0.2), r"goal\[0\] = nan is not finite"),
        ((0.1, INF), r"goal\[1\] = inf is not finite"),
        ("12", "goal = '12'"),
        ({0.1, 0.2}, "goal"),
        ((0.3, 0.3), "goal.*reach of 0.396 m"),
    ],
    ids=str,
)
def test_bad_goals_are_refused_and_forgotten(goal, named):
    env = BabbleGraspEnv(obs="goal", reward="sparse")
    env.reset(seed=0, options={**GRASP, "goal": (0.1, 0.2)})
    before = env.state_hash()
    with pytest.raises(ScenarioError, match=named):
        env.reset(options={"goal": goal})
    assert env.state_hash() == before
    env.reset()
    assert env.scenario == {**GRASP, "goal": (0.1, 0.2)}


def test_lists_of_a_wrong_length_and_masks_of_a_wrong_kind():
    envs = BabbleReachVectorEnv(3)
    envs.reset(seed=0)
    before = envs.call("state_hash")
    cases = scenarios("table1", 2)
    for arguments, named in (
        ({"options": {"scenario": cases}}, "scenario"),
        ({"options": {"scenario": []}}, "scenario"),
        ({"seed": [1, 2]}, "seed"),
        ({"options": {"reset_mask": np.array([True, False])}}, "reset_mask"),
        ({"options": {"reset_mask": np.zeros(3, bool)}}, "reset_mask"),
        ({"options": {"reset_mask": np.ones(3)}}, "reset_mask"),
        ({"options": {"reset_mask": None}}, "reset_mask"),
        ({"options": {"reset_mask": [[True], [True, False]]}}, "reset_mask"),
    ):
        with pytest.raises(ConfigError, match=named):
            envs.reset(**arguments)
    for seed in (1.5, "123", b"123", {1, 2, 3}, object()):
        with pytest.raises(ConfigError, match="seed"):
            envs.reset(seed=seed)
    for seed in (-1, 2**64, 2**64 - 1, [1, -2, 3], [1, 2, 2**64], [1, None, True]):
        with pytest.raises(ConfigError, match=r"seed = .* is not a whole number in \[0, 2\^64\)"):
            envs.reset(seed=seed)
    for seed in (-1, 2**64, 0.5, "1"):
        with pytest.raises(ConfigError, match="seed"):
            BabbleReachEnv().reset(seed=seed)
    with pytest.raises(ConfigError, match="states"):
        envs.set_state(envs.get_state()[:2])
    assert envs.call("state_hash") == before


ARGUMENTS = [
    ({"obs": "pixels"}, "pixels"),
    ({"obs": None}, "obs"),
    ({"control": "wish"}, "wish"),
    ({"control": "Pattern"}, "Pattern"),
    ({"control": None}, "control"),
    ({"reward": "dense"}, "dense"),
    ({"reward": 1}, "reward"),
    ({"obs": "goal", "reward": "progress"}, "reward"),
    ({"render_mode": "ansi"}, "ansi"),
    ({"camera": "left"}, "left"),
    ({"width": 3}, "width"),
    ({"height": 100_000}, "height"),
    ({"width": 64.5}, "width"),
    ({"width": "wide"}, "width"),
    ({"width": NAN}, "width: nan is not finite"),
    ({"width": b"64"}, "width"),
    ({"width": {64}}, "width"),
    ({"width": 10**30}, "width"),
    ({"camera": {"left"}}, "camera"),
    ({"obs": b"senses"}, "obs"),
    ({"render_mode": ["human"]}, "render_mode"),
    ({"record": "no"}, "record"),
    ({"speed": 1}, "speed"),
    ({"config": "\ud800"}, "config"),
    ({"max_episode_steps": 0}, "max_episode_steps"),
    ({"max_episode_steps": 2**40}, "max_episode_steps"),
    ({"max_episode_steps": 1.5}, "max_episode_steps"),
    ({"max_episode_steps": True}, "max_episode_steps"),
    ({"max_episode_steps": "240"}, "max_episode_steps"),
    ({"obs": "retina", "retina_size": 8}, "retina_size"),
    ({"obs": "retina", "retina_size": "big"}, "retina_size"),
]


REACH_ARGUMENTS = [
    ({"max_episode_steps": None}, "max_episode_steps"),
    ({"obs": "goal", "reward": "sparse", "settled": True}, "settled"),
    ({"settled": "no"}, 'settled = "no"'),
]
GRASP_ARGUMENTS = [
    ({"control": "pattern"}, "pattern.*delta_posture, posture, torque"),
    ({"region": "left"}, "left.*palm_side, full"),
    ({"region": "Full"}, "Full"),
    ({"region": None}, "region"),
    ({"diameters": []}, "diameters = .. is not a list"),
    ({"diameters": 0.03}, "diameters = 0.03"),
    ({"diameters": ["thin"]}, "diameters"),
    ({"diameters": [None]}, "diameters"),
    ({"diameters": [0.03, NAN]}, "diameters.*nan.*finite"),
    ({"diameters": [INF]}, "diameters.*inf"),
    ({"diameters": [0.03, 0]}, r"diameters = .0.03,0. is not.*\[0.005, 0.2\]"),
    ({"diameters": [-0.03]}, "-0.03"),
    ({"diameters": [0.3]}, r"0.3.*\[0.005, 0.2\]"),
    ({"diameters": [0.03] * 1001}, "diameters: 1001 items are more than 1000"),
    ({"diameters": np.zeros(10**7)}, "diameters: 10000000 items are more than 1000"),
    ({"diameters": {0.03, 0.04}}, "diameters"),
    ({"diameters": "0.03"}, "diameters"),
    ({"any_diameter_between": "no"}, 'any_diameter_between = "no"'),
    ({"any_diameter_between": None}, "any_diameter_between"),
    ({"enclosure_reflex": "no"}, 'enclosure_reflex = "no"'),
    ({"enclosure_reflex": 1}, "enclosure_reflex = 1"),
    ({"in_hand_starts": 1.5}, r"in_hand_starts = 1.5.*a number in .0, 1"),
    ({"in_hand_starts": "half"}, 'in_hand_starts = "half"'),
]
ALL_ARGUMENTS = [
    *((task, *row) for task in TASKS for row in ARGUMENTS),
    *(("reach", *row) for row in REACH_ARGUMENTS),
    *(("grasp", *row) for row in GRASP_ARGUMENTS),
]


@pytest.mark.parametrize(("task", "arguments", "named"), ALL_ARGUMENTS, ids=str)
@pytest.mark.parametrize("kinds", [TASKS, BATCHES], ids=["single", "batch"])
def test_arguments_that_are_not_ones_there_are(kinds, task, arguments, named):
    with pytest.raises(ConfigError, match=named):
        kinds[task](**arguments)


def test_numpys_truth_is_taken_for_true():
    env = BabbleGraspEnv(enclosure_reflex=np.True_, any_diameter_between=np.False_)
    assert env.reset(seed=0)[0] in env.observation_space


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"num_envs": 0}, "num_envs"),
        ({"num_envs": -2}, "num_envs"),
        ({"num_envs": 10**7}, "num_envs"),
        ({"num_envs": 10**12}, r"num_envs = 1000000000000 .*\[1, 1000000\]"),
        ({"num_envs": 2.5}, "num_envs"),
        ({"num_envs": "2"}, "num_envs"),
        ({"num_envs": True}, "num_envs"),
        ({"num_envs": 10**6, "obs": "retina"}, "num_envs.*retina_size = 84: at most 202899"),
        ({"num_envs": 1000, "obs": "retina", "retina_size": 2048}, "at most 341"),
        ({"threads": 0}, "threads"),
        ({"threads": 10**6}, "threads"),
        ({"threads": 1.5}, "threads"),
        ({"threads": "2"}, "threads"),
        ({"autoreset_mode": "Never"}, "autoreset_mode"),
        ({"autoreset_mode": None}, "autoreset_mode"),
        ({"autoreset_mode": {1}}, "autoreset_mode"),
        ({"render_mode": "human"}, "human"),
    ],
    ids=str,
)
@each_task
def test_arguments_of_the_batch_that_are_not_ones_there_are(task, arguments, named):
    with pytest.raises(ConfigError, match=named):
        BATCHES[task](**arguments)


@pytest.mark.parametrize(("task", "control"), EACH_CONTROL)
def test_broken_and_foreign_states_are_refused(task, control):
    kind = TASKS[task]
    env = kind(control=control)
    env.reset(seed=0)
    before, good = env.state_hash(), env.get_state()
    foreign = kind(control=control, config="icub")
    foreign.reset(seed=0)
    broken = [b"", b"state", good[:4], good[: len(good) // 2], good[:-1], good + b"\0"]
    broken += [foreign.get_state(), kind(control=control, reward="sparse").get_state()]
    # A state of reaching is short enough for each of its bytes.
    for at in range(0, len(good), max(1, len(good) // 250)):
        altered = bytearray(good)
        altered[at] ^= 1 << (at % 8)
        broken.append(bytes(altered))
    for state in broken:
        with pytest.raises(SnapshotError) as caught:
            env.set_state(state)
        assert isinstance(caught.value, ValueError)
    for state in (None, 3, "state"):
        with pytest.raises(SnapshotError, match="expected bytes"):
            env.set_state(state)
    assert env.state_hash() == before
    env.step([0] * WIDTH[task])


@each_task
def test_one_broken_state_among_many_leaves_all_as_they_were(task):
    envs = BATCHES[task](3)
    envs.reset(seed=0)
    other = BATCHES[task](3)
    other.reset(seed=1)
    before = envs.call("state_hash")
    for bad in (b"", None):
        with pytest.raises(SnapshotError):
            envs.set_state([other.get_state()[0], other.get_state()[1], bad])
        assert envs.call("state_hash") == before


@each_task
def test_goals_of_a_wrong_shape_are_refused(task):
    env = TASKS[task](obs="goal", reward="sparse")
    for achieved, desired in (
        (np.zeros(3), np.zeros(3)),
        (np.zeros((4, 2)), np.zeros((3, 2))),
        (0.0, 0.0),
        ("here", "there"),
        (None, None),
        (b"12", b"12"),
        ({1, 2}, {1, 2}),
        (np.zeros(2, bool), np.zeros(2, bool)),
        ([[1, 2], [3]], [1, 2]),
        (np.zeros((2, 0)), np.zeros((2, 0))),
    ):
        with pytest.raises(ConfigError, match="goal"):
            env.compute_reward(achieved, desired, {})


@each_task
def test_goals_that_are_not_finite_are_refused_and_their_place_is_named(task):
    # A relabelled goal of NaN would be a reward like any other.
    env = TASKS[task](obs="goal", reward="sparse")
    good, bad = np.zeros((4, 2), np.float32), np.zeros((4, 2))
    bad[3, 1] = NAN
    named = r"\[3, 1\] = nan is not finite"
    with pytest.raises(ConfigError, match=f"achieved_goal{named}"):
        env.compute_reward(bad, good, {})
    with pytest.raises(ConfigError, match=f"desired_goal{named}"):
        env.compute_reward(good, bad, {})
    with pytest.raises(ConfigError, match=r"desired_goal\[0\] = -inf"):
        env.compute_reward([0, 0], [-INF, 0], {})
    # Beyond single precision, in which goals are.
    with pytest.raises(ConfigError, match=r"achieved_goal\[1\] = 1e\+300 is not finite"):
        env.compute_reward([0, 1e300], [0, 0], {})
    envs = BATCHES[task](2, obs="goal", reward="sparse")
    with pytest.raises(ConfigError, match=f"achieved_goal{named}"):
        envs.compute_reward(bad, good, {})


@pytest.mark.parametrize(
    ("export", "arguments", "error", "named"),
    [
        (export_mjcf, {"task": "walk"}, ConfigError, "task = 'walk' is not one of reach, grasp"),
        (export_urdf, {"task": "walk"}, ConfigError, "task = 'walk' is not one of reach, grasp"),
        (export_urdf, {"config": "nobody"}, ConfigError, "nobody"),
        (export_mjcf, {"config": {"body": {"arm": 1}}}, ConfigError, "arm"),
        (export_mjcf, {"timestep": 0}, ConfigError, "timestep = 0 is not above 0"),
        (
            export_mjcf,
            {"timestep": 0.051},
            ConfigError,
            "timestep = 0.051 is not a number in [0.0, 0.05] s",
        ),
        (export_mjcf, {"timestep": NAN}, ConfigError, "timestep = nan"),
        (export_mjcf, {"timestep": "5 ms"}, ConfigError, "timestep = '5 ms'"),
        (export_mjcf, {"options": {"start_": 1}}, ConfigError, "start_"),
        (export_mjcf, {"options": {"object": (9, 9)}}, ScenarioError, "object"),
    ],
)
def test_what_cannot_be_exported_is_named(export, arguments, error, named):
    with pytest.raises(error, match=re.escape(named)):
        export(**arguments)


@each_task
def test_a_missing_extra_is_named(task, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pygame", None)
    env = TASKS[task](render_mode="human")
    with pytest.raises(MissingExtraError, match=r"gym-babble\[human\]") as caught:
        env.reset(seed=0)
    assert isinstance(caught.value, ImportError)
