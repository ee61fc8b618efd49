"""What holds for the environments of every task, seen through `gymnasium.make`."""

from __future__ import annotations

import copy
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from comparing import (
    ALL_CHOICES,
    ALL_IDS,
    EACH_CONTROL,
    GRASP_IDS,
    OBSERVATIONS,
    REGIONS,
    TASKS,
    assert_same,
    drawn_actions,
    rollout,
)
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import (
    FlattenObservation,
    FrameStackObservation,
    NormalizeReward,
    RecordEpisodeStatistics,
    vector,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from gym_babble.envs.interface import outcome_of

SENSES = {
    "reach": ("arm", "eye", "hand", "obstacle", "stretch", "time"),
    "grasp": ("arm", "eye", "fovea", "hand", "stretch", "time", "touch"),
}
FACTS = {
    "reach": ("is_success", "ever_success"),
    "grasp": ("is_success", "ever_success", "reach", "palm_reach", "held", "in_sight"),
}
each_task = pytest.mark.parametrize("task", TASKS)


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_gymnasiums_checker_is_content_pictures_included(env_id, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(env_id, render_mode="rgb_array", width=64, height=48).unwrapped)


@pytest.mark.parametrize(
    ("env_id", "choices"),
    ALL_CHOICES,
    ids=lambda x: x if isinstance(x, str) else "-".join(x.values()),
)
def test_gymnasiums_checker_is_content_with_every_choice(env_id, choices):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(env_id, retina_size=36, **choices).unwrapped
        check_env(env, skip_render_check=True)


EXTREMES = st.sampled_from([-1e30, -3.0, -1.0, -1e-40, 0.0, 0.5, 1.0, 2.0, 3e38])
ACTIONS = st.lists(st.tuples(*[EXTREMES] * 4), min_size=1, max_size=60)


@pytest.mark.parametrize("of", EACH_CONTROL, ids="-".join)
@settings(max_examples=25)
@given(
    actions=ACTIONS,
    seed=st.integers(0, 10_000),
    config=st.sampled_from(["paper", "icub"]),
    region=st.sampled_from(REGIONS),
)
def test_spaces_contain_every_observation(of, actions, seed, config, region):
    task, control = of
    where = {"region": region} if task == "grasp" else {}
    for obs in ("flat", "goal"):
        reward = "sparse" if obs == "goal" else "progress"
        env = TASKS[task](obs=obs, control=control, reward=reward, config=config, **where)
        observation, _ = env.reset(seed=seed)
        assert observation in env.observation_space
        for action in actions:
            for _ in range(4):
                observation, value, terminated, truncated, _ = env.step(
                    np.array(action[: env.action_space.shape[0]])
                )
                assert observation in env.observation_space, observation
                assert np.isfinite(value)
                if terminated or truncated:
                    env.reset()


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_info_has_the_documented_keys(env_id):
    env = gymnasium.make(env_id)
    _, info = env.reset(seed=0)
    stepped = env.step(env.action_space.sample())[4]
    facts = FACTS["grasp" if env_id in GRASP_IDS else "reach"]
    assert env.unwrapped.interface.spec.facts == facts
    for shown in (info, stepped):
        measures = tuple(one.name for one in env.unwrapped.interface.spec.measures)
        assert tuple(shown) == (*facts, "outcome", "reward_terms", *measures)
        assert all(type(shown[fact]) is bool for fact in facts)
        assert tuple(shown["reward_terms"]) == env.unwrapped.interface.spec.reward_terms
    assert outcome_of(info) == "running"
    assert [fact for fact in facts if info[fact]] == [fact for fact in facts if fact == "in_sight"]


# Reproducibility.


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_one_seed_fixes_all_the_episodes_that_follow(env_id):
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
    flat = gymnasium.make(env_id, obs="flat", reward="sparse")
    assert len({flat.reset(seed=seed)[0].tobytes() for seed in range(20)}) == 20


def copies(env):
    yield copy.deepcopy(env)
    yield pickle.loads(pickle.dumps(env))  # noqa: S301 - our own bytes


@pytest.mark.parametrize("obs", OBSERVATIONS)
@each_task
def test_copies_go_on_as_their_originals_wrapped_or_not(task, obs):
    reward = "sparse" if obs == "goal" else "progress"
    choices = {"obs": obs, "reward": reward, "retina_size": 36}
    for env in (
        TASKS[task](**choices),
        RecordEpisodeStatistics(gymnasium.make(f"Babble{task.title()}-v0", **choices)),
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


@each_task
def test_a_copy_from_before_the_first_reset_is_as_good_as_new(task):
    for other in copies(gymnasium.make(f"Babble{task.title()}-v0", render_mode="rgb_array")):
        with pytest.raises(gymnasium.error.ResetNeeded):
            other.unwrapped.render()
        assert other.reset(seed=1)[0]["eye"].shape == (2,)


@settings(max_examples=40)
@given(
    of=st.sampled_from(EACH_CONTROL),
    goal=st.booleans(),
    seed=st.integers(0, 1000),
    moment=st.integers(0, 120),
)
def test_a_state_continues_to_the_bit_from_any_moment(of, goal, seed, moment):
    task, control = of
    choices = {"obs": "goal", "reward": "sparse"} if goal else {}
    env, other = (TASKS[task](control=control, **choices) for _ in range(2))
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


@each_task
def test_what_was_returned_never_changes(task):
    env = TASKS[task](obs="retina", retina_size=36)
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


# Wrappers and the registry.


@each_task
def test_gymnasiums_wrappers_work(task):
    env = gymnasium.make(f"Babble{task.title()}-v0", max_episode_steps=50)
    size = gymnasium.spaces.flatdim(env.observation_space)
    env = NormalizeReward(
        FrameStackObservation(FlattenObservation(RecordEpisodeStatistics(env)), 3)
    )
    assert env.observation_space.shape == (3, size)
    for episode in range(3):
        observation, _ = env.reset(seed=episode)
        ended = False
        while not ended:
            assert observation in env.observation_space
            observation, _, terminated, truncated, info = env.step(env.action_space.sample())
            ended = terminated or truncated
        assert info["episode"]["l"] <= 50


def as_flat(env_id, observation):
    return observation["observation"] if "Goal" in env_id else observation


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_flat_is_what_gymnasium_makes_of_the_senses(env_id):
    """Catches a policy that was trained behind FlattenObservation and sees permuted numbers."""
    form = "goal" if "Goal" in env_id else "flat"
    flat = gymnasium.make(env_id, obs=form)
    flattened = FlattenObservation(gymnasium.make(env_id, obs="senses"))
    assert as_flat(env_id, flat.observation_space) == flattened.observation_space
    flat_batch = gymnasium.make_vec(env_id, num_envs=2, obs=form)
    flattened_batch = vector.FlattenObservation(
        gymnasium.make_vec(env_id, num_envs=2, obs="senses")
    )
    named = gymnasium.make(env_id, obs="senses")
    assert tuple(named.reset(seed=6)[0]) == SENSES["grasp" if env_id in GRASP_IDS else "reach"]
    for ours, theirs in ((flat, flattened), (flat_batch, flattened_batch)):
        shown = as_flat(env_id, ours.reset(seed=6)[0])
        assert_same(theirs.reset(seed=6)[0], shown)
        for action in drawn_actions(ours.action_space, 30, 0):
            shown = as_flat(env_id, ours.step(action)[0])
            stepped = theirs.step(action)
            assert_same(stepped[0], shown)
            if np.any(stepped[2]):  # The goal form goes on.
                break


def test_the_registry_has_the_ids_with_thresholds_and_limits():
    for env_id in ALL_IDS:
        spec = gymnasium.spec(env_id)
        assert (spec.reward_threshold is None) == (env_id in GRASP_IDS[2:])
        assert gymnasium.make(f"gym_babble:{env_id}").unwrapped.spec.id == env_id
