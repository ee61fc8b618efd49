"""`rgb_array_list`: every frame of a batch comes once and in order, over autoresets too."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from comparing import BATCHES, TASKS
from gymnasium.vector import SyncVectorEnv

from gym_babble.envs import member

SMALL = {"width": 24, "height": 16, "render_mode": "rgb_array_list"}
# Episodes of three steps, and those that are one movement of many frames.
KINDS = [
    ("reach", {"max_episode_steps": 3}),
    ("grasp", {"max_episode_steps": 3, "control": "posture"}),
    ("reach", {"control": "pattern"}),
]
MODES = ("NextStep", "SameStep", "Disabled")
N, STEPS = 2, 11
each_kind = pytest.mark.parametrize(("task", "options"), KINDS, ids=str)
each_mode = pytest.mark.parametrize("mode", MODES)


def actions(env):
    random = np.random.default_rng(0)
    size = (STEPS, *env.single_action_space.shape)
    return np.repeat(random.uniform(-1, 1, size).astype(np.float32)[:, None], N, axis=1)


def by_hand(task, options, mode):
    """All frames of each environment, of single environments that are rendered at each moment."""
    played = []
    for i in range(N):
        env = TASKS[task](**SMALL, **options)
        env.reset(seed=5 + i)
        frames, ended = list(env.render()), False
        for action in actions(BATCHES[task](N, **options))[:, i]:
            if ended and mode == "NextStep":
                env.reset()
                ended = False
            else:
                if ended:
                    env.reset()
                    frames += env.render()
                ended = any(env.step(action)[2:4])
            frames += env.render()
        if ended and mode == "SameStep":
            env.reset()
            frames += env.render()
        played.append(frames)
    return played


def in_a_batch(envs, mode, every, between=lambda envs: envs):
    """All frames of each environment of a batch that is rendered at every so many steps."""
    played = [[] for _ in range(N)]

    def render():
        for frames, new in zip(played, envs.render(), strict=True):
            frames.extend(new)

    envs.reset(seed=5)
    ended = np.zeros(N, np.bool_)
    for k, action in enumerate(actions(envs)):
        if mode == "Disabled" and ended.any():
            render()  # A reset drops what was not fetched.
            envs.reset(options={"reset_mask": ended})
        _, _, terminated, truncated, _ = envs.step(action)
        ended = terminated | truncated
        envs = between(envs)
        if k % every == 0:
            render()
    render()
    return played


def same(one, other):
    return len(one) == len(other) and all((a == b).all() for a, b in zip(one, other, strict=True))


@each_mode
@each_kind
@pytest.mark.parametrize("every", [1, 2, 7, STEPS])
def test_a_batch_gives_each_frame_once_however_often_it_is_rendered(task, options, mode, every):
    envs = BATCHES[task](N, autoreset_mode=mode, **SMALL, **options)
    expected = by_hand(task, options, mode)
    for one, other in zip(in_a_batch(envs, mode, every), expected, strict=True):
        assert same(one, other)


@each_kind
def test_a_batch_gives_the_frames_that_gymnasiums_batch_gives(task, options):
    # With SameStep its environments are reset before anybody can fetch their last frames.
    ours = BATCHES[task](N, **SMALL, **options)
    theirs = SyncVectorEnv([lambda: TASKS[task](**SMALL, **options)] * N)
    for one, other in zip(
        in_a_batch(ours, "NextStep", 1), in_a_batch(theirs, "NextStep", 1), strict=True
    ):
        assert same(one, other)


@pytest.mark.parametrize("mode", MODES[:2])
def test_copies_have_the_frames_that_wait(mode):
    task, options = KINDS[0]

    def copied(envs):
        return pickle.loads(pickle.dumps(copy.deepcopy(envs)))  # noqa: S301

    envs = BATCHES[task](N, autoreset_mode=mode, **SMALL, **options)
    expected = by_hand(task, options, mode)
    for one, other in zip(in_a_batch(envs, mode, STEPS, copied), expected, strict=True):
        assert same(one, other)


def test_a_reset_and_a_state_drop_the_frames_that_wait():
    envs = BATCHES["reach"](N, autoreset_mode="SameStep", max_episode_steps=2, **SMALL)
    still = np.zeros(envs.action_space.shape, np.float32)
    for drop, left in (
        (envs.reset, 1),
        (lambda: envs.set_state(envs.get_state()), 0),
    ):
        envs.reset(seed=0)
        for _ in range(5):
            envs.step(still)
        drop()
        assert [len(frames) for frames in envs.render()] == [left] * N
    envs.reset(seed=0)
    for _ in range(5):
        envs.step(still)
    envs.reset(options={"reset_mask": np.array([True, False])})
    assert [len(frames) for frames in envs.render()] == [1, 8]


def test_frames_that_nobody_fetches_take_limited_memory(monkeypatch):
    monkeypatch.setattr(member, "MOST_KEPT", 3)
    envs = BATCHES["reach"](1, autoreset_mode="SameStep", max_episode_steps=1, **SMALL)
    envs.reset(seed=0)
    for _ in range(10):
        envs.step(np.zeros((1, 2), np.float32))
    # Two frames of each of three ended episodes, and one of the new one.
    assert len(envs.render()[0]) == 7
