"""Exercises of lesson 1: right answers of several kinds, and the usual wrong ones."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

import gym_babble
from gym_babble import course
from gym_babble.course.lesson1 import EXERCISES, success_rate
from gym_babble.course.movements import held_out, outcomes

BABBLES = gym_babble.babble("BabbleReachPattern-v0", 2_000, seed=0)


def wilson(k, n):
    z, p = 1.96, k / n
    centre = (p + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    return np.array([centre - half, centre + half])


def normal(k, n, z=1.96):
    p = k / n
    return p - z * np.sqrt(p * (1 - p) / n), p + z * np.sqrt(p * (1 - p) / n)


def play(seed, *, seed_actions=True, seed_world=True):
    env = gym.make("BabbleReach-v0")
    observation, _ = env.reset(seed=seed if seed_world else 0)
    if seed_actions:
        env.action_space.seed(seed if seed_world else 0)
    for _ in range(20):
        observation, _, terminated, truncated, _ = env.step(env.action_space.sample())
        if terminated or truncated:
            break
    return observation["hand"]


def play_with_numpy(seed):
    rng = np.random.default_rng(seed)
    env = gym.make("BabbleReach-v0")
    observation, _ = env.reset(seed=seed)
    for _ in range(20):
        observation, _, terminated, *_ = env.step(rng.uniform(-1, 1, 2))
        if terminated:
            break
    return [*observation["hand"]]


RIGHT = [
    ("1.1", lambda b1: (2 * b1 - 1, 1 - 2 * b1)),
    ("1.1", lambda b1: 2 * np.array([b1, 1 - b1]) - 1),
    ("1.1", lambda b1: np.float32([2 * b1 - 1, 1 - 2 * b1])),
    ("1.2", BABBLES.learnable.mean()),
    ("1.2", float((BABBLES.outcome == "success").sum() / 2_000)),
    ("1.2", gym_babble.babble("BabbleReachPattern-v0", 2_000, seed=7).learnable.mean()),
    ("1.3", wilson),
    ("1.3", lambda k, n: [*wilson(k, n)]),
    ("1.4", 0.25),
    ("1.4", 0.2),
    ("1.4", 0.75),
    ("1.4", np.float64(0.72)),
    ("1.5", play),
    ("1.5", play_with_numpy),
]
WRONG = [
    ("1.1", lambda b1: (b1, 1 - b1), "itself"),
    ("1.1", lambda b1: (2 * b1 - 1, 2 * b1 - 1), "second is not"),
    ("1.1", lambda b1: (1 - 2 * b1, 2 * b1 - 1), "wrong order"),
    ("1.1", lambda b1: (b1 - 0.5, 0.5 - b1), "Which action gives"),
    ("1.1", lambda b1: 2 * b1 - 1, "shape ()"),
    ("1.2", 100 * BABBLES.learnable.mean(), "per cent"),
    ("1.2", 1 - BABBLES.learnable.mean(), "fails"),
    ("1.2", BABBLES.learnable.sum(), "mean"),
    ("1.2", BABBLES.learnable, "not made of real numbers"),
    ("1.3", normal, "1.96 standard errors"),
    ("1.3", lambda k, n: normal(k, n, 1), "one standard error"),
    ("1.3", lambda k, n: wilson(k, n)[::-1], "wrong order"),
    ("1.3", lambda k, n: (k / n - 0.1, k / n + 0.1), "brackets"),
    ("1.4", 0.5, "almost straight"),
    ("1.4", 0.36, "grid"),
    ("1.4", -0.5, "between 0 and 1"),
    ("1.5", lambda seed: play(seed, seed_actions=False), "action_space"),
    ("1.5", lambda seed: play(seed, seed_world=False), "Seeds 3 and 4"),
]


@pytest.mark.parametrize(("exercise", "answer"), RIGHT)
def test_right_answers_are_right(exercise, answer):
    result = course.check(exercise, answer)
    assert result.right, result


@pytest.mark.parametrize(("exercise", "answer", "said"), WRONG)
def test_usual_wrong_answers_have_a_message_that_helps(exercise, answer, said):
    result = course.check(exercise, answer)
    assert result.state == "wrong"
    assert said in repr(result)
    assert result.hint


def test_each_exercise_has_both_kinds_of_answers():
    ids = [exercise.id for exercise in EXERCISES]
    assert sorted({k for k, _ in RIGHT}) == sorted({k for k, *_ in WRONG}) == ids


@pytest.mark.parametrize("b1", [0.05, 0.25, 0.5, 0.8])
def test_judges_play_movements_as_the_environment_does(b1):
    cases = held_out(40)
    env = gym.make("BabbleReachPattern-v0")
    ends = []
    for case in cases:
        env.reset(options={"scenario": case})
        info = env.step(np.array([2 * b1 - 1, 1 - 2 * b1], np.float32))[-1]
        ends += [name for name, is_it in info["outcome"].items() if is_it]
    assert outcomes(cases, (b1, 1 - b1)).tolist() == ends
    assert success_rate(cases, (b1, 1 - b1)) == ends.count("success") / len(cases)
