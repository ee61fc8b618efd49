"""BabbleReach as its docstring has it, seen through `gymnasium.make`."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from comparing import CHOICES, CONTROLS, IDS, OBSERVATIONS, assert_same, drawn_actions, rollout
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import (
    FlattenObservation,
    FrameStackObservation,
    NormalizeReward,
    RecordEpisodeStatistics,
    TimeLimit,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from gym_babble import Scripted
from gym_babble.envs import BabbleReachEnv

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


@pytest.mark.parametrize("env_id", IDS)
def test_gymnasiums_checker_is_content_pictures_included(env_id, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(env_id, render_mode="rgb_array", width=64, height=48).unwrapped)


@pytest.mark.parametrize("choices", CHOICES, ids=lambda c: "-".join(c.values()))
def test_gymnasiums_checker_is_content_with_every_choice(choices):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make("BabbleReach-v0", retina_size=36, **choices).unwrapped
        check_env(env, skip_render_check=True)


EXTREMES = st.sampled_from([-1e30, -3.0, -1.0, -1e-40, 0.0, 0.5, 1.0, 2.0, 3e38])
ACTIONS = st.lists(st.tuples(EXTREMES, EXTREMES), min_size=1, max_size=60)


@pytest.mark.parametrize("control", CONTROLS)
@settings(max_examples=25, deadline=None)
@given(actions=ACTIONS, seed=st.integers(0, 10_000), body=st.sampled_from(["paper", "icub"]))
def test_spaces_contain_every_observation(control, actions, seed, body):
    for obs in ("flat", "goal"):
        reward = "sparse" if obs == "goal" else "progress"
        env = BabbleReachEnv(obs=obs, control=control, reward=reward, body=body)
        observation, _ = env.reset(seed=seed)
        assert observation in env.observation_space
        for action in actions:
            for _ in range(4):
                observation, value, terminated, truncated, _ = env.step(np.array(action))
                assert observation in env.observation_space, observation
                assert np.isfinite(value)
                if terminated or truncated:
                    env.reset()


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


@pytest.mark.parametrize("env_id", IDS)
def test_info_has_the_documented_keys(env_id):
    env = gymnasium.make(env_id)
    _, info = env.reset(seed=0)
    stepped = env.step(env.action_space.sample())[4]
    for shown in (info, stepped):
        assert list(shown) == [*env.unwrapped.choices.spec.facts, "outcome", "reward_terms"]
        assert set(shown) == {"is_success", "ever_success", "outcome", "reward_terms"}
        assert type(shown["is_success"]) is bool
        assert type(shown["ever_success"]) is bool
    assert info["outcome"] == "running"


# How episodes end.


@pytest.mark.parametrize("control", CONTROLS)
def test_success_terminates(control):
    env = BabbleReachEnv(control=control)
    env.reset(seed=0, options=NEAR)
    action = 2 * env.reset()[0]["arm"] - 1 if control == "posture" else HOLD
    _, reward, terminated, truncated, info = env.step(action)
    assert (terminated, truncated) == (True, False)
    assert info["outcome"] == "success"
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
        assert (terminated, truncated, info["outcome"]) == (True, False, "collision"), control
        assert info["reward_terms"]["failure"] == -1
        assert not info["is_success"]
        assert reward < 0


def test_without_an_obstacle_nothing_collides_and_its_angles_are_the_lowest():
    env = BabbleReachEnv(control="pattern")
    observation, _ = env.reset(options={**BLOCKED, "obstacle": None})
    assert observation["obstacle"] == pytest.approx([-np.pi, -np.pi / 2])
    assert env.step(HOLD)[4]["outcome"] == "success"
    assert env.scenario["obstacle"] is None


def test_a_path_out_of_the_joint_ranges_terminates_in_pattern_control():
    env = BabbleReachEnv(control="pattern")
    outcomes = set()
    for seed in range(40):
        env.reset(seed=seed, options={"obstacle": None})
        _, _, terminated, truncated, info = env.step([1, -1])
        assert (terminated, truncated) == (True, False)
        outcomes.add(info["outcome"])
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
        assert info["outcome"] == ("timeout" if truncated else "running")
        assert observation["time"] == np.float32(k / 240)


def test_pattern_control_always_terminates_after_one_step():
    for env_id in ("BabbleReachPattern-v0", "BabbleReach-v0"):
        env = gymnasium.make(env_id, control="pattern")
        outcomes = set()
        for seed in range(30):
            env.reset(seed=seed)
            observation, _, terminated, truncated, info = env.step(env.action_space.sample())
            assert (terminated, truncated) == (True, False)
            assert observation["time"] == 1
            outcomes.add(info["outcome"])
        assert "timeout" in outcomes or "success" in outcomes
        assert "running" not in outcomes


def test_every_id_takes_every_control():
    env = gymnasium.make("BabbleReachPattern-v0", control="delta_posture")
    env.reset(seed=0)
    assert env.step(HOLD)[2:4] == (False, False)


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
        assert info["outcome"] == "success"
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
        if info["outcome"] == "collision":
            places.append(observation["achieved_goal"])
    assert info["outcome"] == "collision"
    assert len(places) > 100
    assert all((place == places[0]).all() for place in places)


def test_max_episode_steps_of_make_is_a_wrappers_and_of_the_environment_its_own():
    env = gymnasium.make("BabbleReach-v0", max_episode_steps=10)
    assert isinstance(env, TimeLimit)
    env.reset(seed=1)
    for _ in range(10):
        observation, _, terminated, truncated, info = env.step(HOLD)
    assert (terminated, truncated) == (False, True)
    assert info["outcome"] == "running"
    assert observation["time"] == np.float32(10 / 240)
    env = BabbleReachEnv(max_episode_steps=10)
    env.reset(seed=1)
    for k in range(1, 11):
        observation, _, _, truncated, info = env.step(HOLD)
        assert truncated == (k == 10)
    assert info["outcome"] == "timeout"
    assert observation["time"] == 1


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


def test_one_seed_fixes_all_the_episodes_that_follow():
    for env_id in IDS:
        env = gymnasium.make(env_id)
        actions = drawn_actions(env.action_space, 300, 1)
        env.reset(seed=42)
        first = rollout(env, actions)
        env.reset(seed=7)
        rollout(env, actions[:20])
        env.reset(seed=42)
        assert_same(first, rollout(env, actions))
        again = gymnasium.make(env_id)
        again.reset(seed=42)
        assert_same(first, rollout(again, actions))
    starts = [gymnasium.make(IDS[0]).unwrapped.reset(seed=seed)[0]["arm"] for seed in range(20)]
    assert len({start.tobytes() for start in starts}) == 20


def unseeded_rollout(env_id, seed):
    env = gymnasium.make(env_id)
    actions = drawn_actions(env.action_space, 60, 1)
    env.reset(seed=seed)
    return rollout(env, actions)


def test_another_process_plays_the_same():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        elsewhere = pool.starmap(unseeded_rollout, [(IDS[0], 3), (IDS[3], 3)])
    assert_same(elsewhere[0], unseeded_rollout(IDS[0], 3))
    assert_same(elsewhere[1], unseeded_rollout(IDS[3], 3))


def copies(env):
    yield copy.deepcopy(env)
    yield pickle.loads(pickle.dumps(env))  # noqa: S301 - our own bytes


@pytest.mark.parametrize("obs", OBSERVATIONS)
def test_copies_go_on_as_their_originals_wrapped_or_not(obs):
    reward = "sparse" if obs == "goal" else "progress"
    choices = {"obs": obs, "reward": reward, "retina_size": 36}
    for env in (
        BabbleReachEnv(**choices),
        RecordEpisodeStatistics(gymnasium.make("BabbleReach-v0", **choices)),
    ):
        before, after = (
            drawn_actions(env.action_space, 40, 2)[:7],
            drawn_actions(env.action_space, 300 if obs != "retina" else 30, 3),
        )
        env.reset(seed=9, options={"obstacle": (0.15, 0.2)})
        rollout(env, before, reset=False)
        made = list(copies(env))
        expected = rollout(env, after, reset=False)
        for other in made:
            seen = rollout(other, after, reset=False)
            for a, b in zip(expected, seen, strict=True):
                a[-1].pop("episode", None), b[-1].pop("episode", None)
            assert_same(expected, seen)


def test_a_copy_from_before_the_first_reset_is_as_good_as_new():
    for other in copies(gymnasium.make("BabbleReach-v0", render_mode="rgb_array")):
        with pytest.raises(gymnasium.error.ResetNeeded):
            other.unwrapped.render()
        assert other.reset(seed=1)[0]["eye"].shape == (2,)


@settings(max_examples=30, deadline=None)
@given(
    control=st.sampled_from(CONTROLS),
    goal=st.booleans(),
    seed=st.integers(0, 1000),
    moment=st.integers(0, 120),
)
def test_a_state_continues_to_the_bit_from_any_moment(control, goal, seed, moment):
    choices = {"obs": "goal", "reward": "sparse"} if goal else {}
    env, other = (BabbleReachEnv(control=control, **choices) for _ in range(2))
    actions = drawn_actions(env.action_space, moment + 60, seed)
    env.reset(seed=seed)
    rollout(env, actions[:moment], reset=False)
    state, hash_before = env.get_state(), env.state_hash()
    assert env.get_state() == state
    expected = rollout(env, actions[moment:], reset=False)
    other.reset(seed=seed + 1)
    other.set_state(state)
    assert other.state_hash() == hash_before
    assert_same(expected, rollout(other, actions[moment:], reset=False))
    assert other.state_hash() == env.state_hash() != hash_before


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


def test_what_was_returned_never_changes():
    env = BabbleReachEnv(obs="retina", retina_size=36)
    kept = [env.reset(seed=0)]
    for action in drawn_actions(env.action_space, 30, 0):
        kept.append(env.step(action))
        if kept[-1][2]:
            break
    frozen = copy.deepcopy(kept)
    env.reset()
    for action in drawn_actions(env.action_space, 10, 1):
        env.step(action)
    assert_same(frozen, kept)


# Wrappers.


def test_gymnasiums_wrappers_work():
    env = gymnasium.make("BabbleReach-v0", max_episode_steps=50)
    env = NormalizeReward(
        FrameStackObservation(FlattenObservation(RecordEpisodeStatistics(env)), 3)
    )
    assert env.observation_space.shape == (3, 11)
    for episode in range(3):
        observation, _ = env.reset(seed=episode)
        ended = False
        while not ended:
            assert observation in env.observation_space
            observation, _, terminated, truncated, info = env.step(env.action_space.sample())
            ended = terminated or truncated
        assert info["episode"]["l"] <= 50


def test_flat_is_the_senses_in_the_documented_order():
    actions = drawn_actions(BabbleReachEnv().action_space, 30, 0)
    seen = {}
    for obs in ("senses", "flat"):
        env = BabbleReachEnv(obs=obs)
        env.reset(seed=6)
        seen[obs] = [result[0] for result in rollout(env, actions)]
    order = ("eye", "obstacle", "hand", "arm", "stretch", "time")
    for senses, flat in zip(seen["senses"], seen["flat"], strict=True):
        assert tuple(senses) == order
        assert_same(np.concatenate([senses[name] for name in order]), flat)


def test_the_registry_has_the_ids_with_thresholds_and_limits():
    limits = {env_id: gymnasium.spec(env_id).max_episode_steps for env_id in IDS}
    assert limits == dict(zip(IDS, (240, 240, 240, None), strict=True))
    for env_id in IDS:
        spec = gymnasium.spec(env_id)
        assert spec.reward_threshold is not None
        assert set(spec.kwargs) == {"obs", "control", "reward"}
        assert gymnasium.make(f"gym_babble:{env_id}").unwrapped.spec.id == env_id
