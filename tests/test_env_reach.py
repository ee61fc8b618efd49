"""BabbleReach as its docstring has it, seen through `gymnasium.make`."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from comparing import CONTROLS, assert_same, drawn_actions

from gym_babble import Scripted
from gym_babble.envs import BabbleReachEnv
from gym_babble.envs.interface import outcome_of

NEAR = {"start": (0.1, 0.25), "target": (0.1, 0.26), "obstacle": None}
BLOCKED = {"start": (0.25, 0.18), "target": (0.05, 0.33)}
HOLD = np.zeros(2, np.float32)


def posture_at(env, point):
    """The action of `posture` control that asks for the posture with the fingertip at `point`."""
    observation, _ = env.reset(options={"start": point, "target": (0.1, 0.25), "obstacle": None})
    return 2 * observation["arm"] - 1


def play(env, action, options):
    """The last step of an episode of one action."""
    env.reset(seed=0, options=options)
    while True:
        result = env.step(action)
        if result[2] or result[3]:
            return result


@pytest.mark.parametrize("control", CONTROLS)
def test_rewards_and_returns_keep_their_bounds(control):
    for reward, lowest, highest in (("progress", -8, 4), ("sparse", 0, 1)):
        env = BabbleReachEnv(control=control, reward=reward)
        env.action_space.seed(3)
        for seed in range(15):
            env.reset(seed=seed)
            total, ended = 0.0, False
            drift = env.action_space.sample() * 1.5
            while not ended:
                _, value, terminated, truncated, info = env.step(drift)
                assert value == pytest.approx(sum(info["reward_terms"].values()))
                total += value
                ended = terminated or truncated
            assert lowest <= total <= highest


# How episodes end.


@pytest.mark.parametrize("control", CONTROLS)
def test_success_terminates(control):
    env = BabbleReachEnv(control=control)
    env.reset(seed=0, options=NEAR)
    action = 2 * env.reset()[0]["arm"] - 1 if control == "posture" else HOLD
    _, reward, terminated, truncated, info = env.step(action)
    assert (terminated, truncated) == (True, False)
    assert outcome_of(info) == "success"
    assert info["is_success"]
    assert info["ever_success"]
    assert info["reward_terms"]["success"] == 1
    assert reward > 0.9


def test_collision_terminates_in_every_control():
    sweep = posture_at(BabbleReachEnv(control="posture"), BLOCKED["target"])
    actions = {"delta_posture": [1, 0], "posture": sweep, "torque": [1, 0], "pattern": [0, 0]}
    for control, action in actions.items():
        env = BabbleReachEnv(control=control)
        _, reward, terminated, truncated, info = play(env, np.array(action), BLOCKED)
        assert (terminated, truncated, outcome_of(info)) == (True, False, "collision"), control
        assert info["reward_terms"]["failure"] == -1
        assert not info["is_success"]
        assert reward < 0


def test_without_an_obstacle_nothing_collides_and_its_angles_are_the_lowest():
    env = BabbleReachEnv(control="pattern")
    observation, _ = env.reset(options={**BLOCKED, "obstacle": None})
    assert observation["obstacle"] == pytest.approx([-np.pi, -np.pi / 2])
    assert outcome_of(env.step(HOLD)[4]) == "success"
    assert env.scenario["obstacle"] is None


def test_a_path_out_of_the_joint_ranges_terminates_in_pattern_control():
    env = BabbleReachEnv(control="pattern")
    outcomes = set()
    for seed in range(40):
        env.reset(seed=seed, options={"obstacle": None})
        _, _, terminated, truncated, info = env.step([1, -1])
        assert (terminated, truncated) == (True, False)
        outcomes.add(outcome_of(info))
    assert "joint_limit" in outcomes
    assert "collision" not in outcomes


@pytest.mark.parametrize("control", ["delta_posture", "posture", "torque"])
def test_the_time_limit_truncates_and_is_named(control):
    env = gymnasium.make("BabbleReach-v0", control=control)
    observation, _ = env.reset(seed=1)
    action = 2 * observation["arm"] - 1 if control == "posture" else HOLD
    for k in range(1, 241):
        observation, _, terminated, truncated, info = env.step(action)
        assert not terminated
        assert truncated == (k == 240)
        assert outcome_of(info) == ("timeout" if truncated else "running")
        assert observation["time"] == np.float32(k / 240)


def test_pattern_control_always_terminates_after_one_step():
    for env_id in ("BabbleReachPattern-v0", "BabbleReach-v0"):
        env = gymnasium.make(env_id, control="pattern")
        outcomes = set()
        for seed in range(30):
            env.reset(seed=seed)
            observation, _, terminated, truncated, info = env.step(env.action_space.sample())
            # Gymnasium's TimeLimit of one step truncates what the environment has ended.
            assert (terminated, truncated) == (True, env.spec.max_episode_steps == 1)
            assert observation["time"] == 1
            outcomes.add(outcome_of(info))
        assert "timeout" in outcomes or "success" in outcomes
        assert "running" not in outcomes


def test_settled_success_waits_for_the_arm_to_rest():
    scenario = {**BLOCKED, "obstacle": None}
    lengths, speeds = {}, {}
    for settled in (False, True):
        env = BabbleReachEnv(control="posture", settled=settled)
        action = posture_at(env, scenario["target"])
        before, _ = env.reset(seed=0, options=scenario)
        lengths[settled] = 0
        while True:
            after, _, terminated, _, info = env.step(action)
            lengths[settled] += 1
            speeds[settled] = np.abs(after["stretch"] - before["stretch"]).max() / 0.05
            before = after
            if terminated:
                break
        assert outcome_of(info) == "success"
    assert lengths[True] > lengths[False]
    assert speeds[True] < 0.06 < speeds[False]


def test_a_collision_in_the_goal_form_holds_the_arm_until_the_time_limit():
    env = gymnasium.make("BabbleReachGoal-v0")
    env.reset(seed=0, options=BLOCKED)
    places = []
    for k in range(240):
        observation, reward, terminated, truncated, info = env.step(np.array([1, 0], np.float32))
        assert reward == -1
        assert not terminated
        assert truncated == (k == 239)
        if outcome_of(info) == "collision":
            places.append(observation["achieved_goal"])
    assert outcome_of(info) == "collision"
    assert len(places) > 100
    assert all((place == places[0]).all() for place in places)


# Goals.


def test_compute_reward_is_the_reward_of_goals():
    env = gymnasium.make("BabbleReachGoal-v0")
    unwrapped = env.unwrapped
    agent, state = Scripted(env), None
    achieved, desired, rewards = [], [], []
    observation, info = env.reset(seed=4, options={"obstacle": None})
    for _ in range(240):
        action, state = agent.predict(observation, state)
        observation, reward, _, _, info = env.step(action)
        assert reward == unwrapped.compute_reward(
            observation["achieved_goal"], observation["desired_goal"], info
        )
        assert info["is_success"] == (reward == 0)
        achieved.append(observation["achieved_goal"])
        desired.append(observation["desired_goal"])
        rewards.append(reward)
    assert set(rewards) == {-1.0, 0.0}
    together = unwrapped.compute_reward(np.array(achieved), np.array(desired), [{}] * 240)
    assert_same(np.array(rewards), together)
    # Relabelled as HER does: with goals reached later in the episode.
    later = np.array(achieved[20:] + achieved[-1:] * 20)
    relabelled = unwrapped.compute_reward(np.array(achieved), later, {})
    distances = np.linalg.norm((np.array(achieved) - later).astype(np.float64), axis=1)
    assert ((relabelled == 0) == (distances <= 0.02)).all()
    assert relabelled[-1] == 0
    one_goal = unwrapped.compute_reward(np.array(achieved), desired[0], {})
    assert_same(one_goal, together)


def test_a_relabelled_episode_has_the_rewards_of_the_environment():
    goal = (0.12, 0.27)
    env = BabbleReachEnv(obs="goal", reward="sparse", control="posture")
    options = {"start": (0.1, 0.2), "target": (0.2, 0.2), "obstacle": None}
    actions = drawn_actions(env.action_space, 100, 5)
    env.reset(options=options)
    reached = [env.step(action)[0]["achieved_goal"] for action in actions]
    goal = reached[60].astype(np.float64)
    env.reset(options={**options, "target": goal})
    rewards = [env.step(action)[1] for action in actions]
    assert 0 in rewards
    assert_same(env.compute_reward(np.array(reached), goal, {}), np.array(rewards))


# Reproducibility.


def test_options_hold_until_a_reset_that_names_others():
    env = gymnasium.make("BabbleReach-v0").unwrapped
    env.reset(seed=0, options={"target": (0.1, 0.25)})
    starts = set()
    for _ in range(5):
        env.reset()
        assert env.scenario["target"] == (0.1, 0.25)
        starts.add(env.scenario["start"])
    assert len(starts) == 5
    env.reset(seed=3)
    assert env.scenario["target"] == (0.1, 0.25)
    env.reset(options={"start": (0.1, 0.25)})
    env.reset()
    assert env.scenario["start"] == (0.1, 0.25)
    assert env.scenario["target"] != (0.1, 0.25)
    env.reset(options={})
    env.reset()
    assert env.scenario["start"] != (0.1, 0.25)


def test_an_obstacle_that_was_placed_stays_and_the_ends_are_drawn_clear_of_it():
    env = BabbleReachEnv()
    env.reset(seed=0, options={"obstacle": (0.12, 0.22)})
    for _ in range(50):
        env.reset()
        assert env.scenario["obstacle"] == (0.12, 0.22, 0.035)
