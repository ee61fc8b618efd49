"""Exercises of lesson 2: right answers of several kinds, and the usual wrong ones."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

from gym_babble import course
from gym_babble.course.lesson2 import EXERCISES, FOREARM_M, TAU_S


def hand(q1, q2, *, outer=0.246, upper=0.15):
    a, b = np.radians(q1), np.radians(q1 + q2)
    x, y = upper * np.cos(a) + outer * np.cos(b), upper * np.sin(a) + outer * np.sin(b)
    return np.array([x, y])


def by_complex_numbers(q1, q2):
    z = 0.15 * np.exp(1j * np.radians(q1)) + 0.246 * np.exp(1j * np.radians(q1 + q2))
    return [z.real, z.imag]


def in_degrees(q1, q2):
    x = 0.15 * np.cos(q1) + 0.246 * np.cos(q1 + q2)
    return x, 0.15 * np.sin(q1) + 0.246 * np.sin(q1 + q2)


def unturned(q1, q2):
    a, b = np.radians(q1), np.radians(q2)
    return 0.15 * np.cos(a) + 0.246 * np.cos(b), 0.15 * np.sin(a) + 0.246 * np.sin(b)


def integrated(q_0, q_des, t):
    q, steps = q_0, 20_000
    for _ in range(steps):
        q += (q_des - q) / TAU_S * t / steps
    return q


RIGHT = [
    ("2.1", 0.8),
    ("2.1", np.float32(0.81)),
    ("2.1", [0.79]),
    ("2.2", lambda q_des, q, speed: 50 * (q_des - q) - 40 * speed),
    ("2.2", lambda q_des, q, speed: np.array(50 * q_des - 50 * q - 40 * speed)),
    ("2.3", lambda q_0, q_des, t: q_des + (q_0 - q_des) * np.exp(-t / 0.8)),
    ("2.3", lambda q_0, q_des, t: q_0 + (q_des - q_0) * (1 - np.exp(-1.25 * t))),
    ("2.3", integrated),
    ("2.4", 100),
    ("2.4", 100.0),
    ("2.5", hand),
    ("2.5", lambda q1, q2: tuple(hand(q1, q2))),
    ("2.5", by_complex_numbers),
    ("2.6", 0.37),
    ("2.6", 1 / np.sqrt(1 + (np.pi * 0.8) ** 2)),
    ("2.6", 0.36),
]
WRONG = [
    ("2.1", 1.25, "1/s"),
    ("2.1", 16, "control steps"),
    ("2.1", 0.555, "half of the way"),
    ("2.1", 4, "63 %"),
    ("2.2", lambda q_des, q, speed: 50 * (q_des - q) + 40 * speed, "sign"),
    ("2.2", lambda q_des, q, speed: 50 * (q - q_des) - 40 * speed, "away"),
    ("2.2", lambda q_des, q, _: 50 * (q_des - q), "missing"),
    ("2.2", lambda q_des, q, speed: 40 * (q_des - q) - 50 * speed, "exchanged"),
    ("2.2", lambda q_des, q, speed: 5 * (q_des - q) - 4 * speed, "off by"),
    ("2.3", lambda q_0, q_des, t: q_0 + (q_0 - q_des) * np.exp(-t / 0.8), "At t = 0"),
    ("2.3", lambda q_0, q_des, t: q_des + (q_0 - q_des) * np.exp(-t * 0.8), "s²"),
    ("2.3", lambda q_0, q_des, t: q_0 + (q_des - q_0) * np.exp(-t / 0.8), "begins at the end"),
    ("2.3", lambda _, q_des, __: q_des, "37 %"),
    ("2.4", 25, "twice as slow"),
    ("2.4", 200, "four times"),
    ("2.4", 0.4, "K_D/K_P"),
    ("2.5", unturned, "does not turn"),
    ("2.5", lambda q1, q2: hand(q1, q2, outer=0.13), "wrist"),
    ("2.5", lambda q1, q2: hand(q1, -q2), "wrong side"),
    ("2.5", in_degrees, "radians"),
    ("2.5", lambda q1, q2: hand(q1, q2)[::-1], "exchanged"),
    ("2.5", lambda q1, q2: 100 * hand(q1, q2), "centimetres"),
    ("2.5", lambda q1, q2: hand(q1, q2, upper=0.3), "along y"),
    ("2.6", 0.93, "2π"),
    ("2.6", 0.137, "square root"),
    ("2.6", 2.7, "inverse"),
    ("2.6", 7.4, "degrees"),
    ("2.6", 0.6, "regular"),
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


def test_the_judges_numbers_are_those_of_the_environment():
    env = gym.make("BabbleReachGoal-v0", control="posture")
    observation, _ = env.reset(seed=0, options={"target": (-0.35, 0.0), "obstacle": None})
    low, high = np.array([-75, 5]), np.array([180, 130])

    def angles():
        return low + (high - low) * observation["observation"][:2]

    first, wanted = angles(), np.array([60, 60])
    action = 2 * (wanted - low) / (high - low) - 1
    for step in range(1, 60):
        observation, *_ = env.step(action)
        left = np.exp(-0.05 * step / TAU_S)
        assert np.allclose(angles(), wanted + (first - wanted) * left, atol=0.2)
        assert np.allclose(observation["achieved_goal"], hand(*angles()), atol=1e-4)
    assert np.isclose(FOREARM_M, 0.246)
