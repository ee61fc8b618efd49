"""Exercises of lesson 4: right answers of several kinds, and the usual wrong ones."""

from __future__ import annotations

import numpy as np
import pytest

from gym_babble import course
from gym_babble.brain import TimeBaseGenerator, place
from gym_babble.course import lesson4
from gym_babble.course.lesson4 import EXERCISES


def rate(c_x, c_y, b1, b2, gamma):
    return gamma * c_x**b1 * (1 - c_x) ** b2, gamma * c_y**b2 * (1 - c_y) ** b1


def placed(start, target, c, *, shift=-np.pi / 4, factor=0.5**0.5, sign=1):
    way = target - start
    a = sign * (np.arctan2(way[1], way[0]) + shift)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    return start + np.hypot(*way) * factor * turn @ c


def by_complex_numbers(start, target, c):
    way = complex(*target) - complex(*start)
    z = complex(*start) + way * complex(*c) / (1 + 1j)
    return [z.real, z.imag]


RIGHT = [
    ("4.1", rate),
    ("4.1", lambda *state: np.array(rate(*state))),
    ("4.2", lambda b1, t: np.pi / (t * np.sin(np.pi * b1))),
    ("4.2", lambda b1, t: np.pi / t / np.cos(np.pi * (b1 - 0.5))),
    ("4.3", placed),
    ("4.3", by_complex_numbers),
    ("4.3", lambda start, target, c: place(start, target, [c])[0]),
    ("4.4", 0.641),
    ("4.4", 0.64),
    ("4.4", np.float32(0.645)),
    ("4.5", (0.8, 0.2)),
    ("4.5", [0.85, 0.15]),
    ("4.5", np.array([0.75, 0.25])),
    ("4.6", 1.8),
    ("4.6", 1.9),
]
WRONG = [
    (
        "4.1",
        lambda x, y, b1, b2, g: (g * x**b1 * (1 - x) ** b2, g * y**b1 * (1 - y) ** b2),
        "exponents of the first",
    ),
    ("4.1", lambda x, y, b1, b2, _: rate(x, y, b1, b2, 1), "γ is missing"),
    ("4.1", lambda x, y, b1, b2, g: rate(x, y, b2, b1, g), "exchanged"),
    ("4.1", lambda x, y, b1, b2, g: (g * b1 * x, g * b2 * y), "It should be"),
    ("4.1", lambda x, _, b1, b2, g: g * x**b1 * (1 - x) ** b2, "shape ()"),
    ("4.2", lambda b1, t: t * np.sin(np.pi * b1) / np.pi, "inverse"),
    ("4.2", lambda b1, _: np.pi / np.sin(np.pi * b1), "1 s"),
    ("4.2", lambda b1, t: np.pi / (t * np.sin(b1)), "takes πb1"),
    ("4.2", lambda b1, t: np.pi / (t * np.sin(np.radians(np.pi * b1))), "in radians already"),
    ("4.2", lambda b1, t: b1 / t, "T = π/γ"),
    ("4.3", lambda *a: placed(*a, shift=0, factor=1), "as printed"),
    ("4.3", lambda *a: placed(*a, shift=0), "45° are missing"),
    ("4.3", lambda *a: placed(*a, factor=1), "√2 too long"),
    ("4.3", lambda start, *a: placed(start, *a) - start, "begins at the origin"),
    ("4.3", lambda *a: placed(*a, sign=-1), "clockwise"),
    ("4.3", lambda *a: placed(*a, shift=np.pi / 4), "add 45°"),
    ("4.3", lambda _, target, __: target, "Try (1, 1) first"),
    ("4.4", 0.359, "right"),
    ("4.4", 0.6, "too little"),
    ("4.4", 0.7, "more than asked"),
    ("4.4", 2, "between .01 and .99"),
    ("4.5", (0.5, 0.5), "collides"),
    ("4.5", (0.2, 0.8), "collides"),
    ("4.5", (0.9, 0.9), "away from the target"),
    ("4.5", 0.8, "shape ()"),
    ("4.5", (0.8, 1.2), "between 0 and 1"),
    ("4.6", 8, "but so is"),
    ("4.6", 1, "cuts the corner"),
    ("4.6", 0.1, "between 0.3 and 30"),
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


def test_the_judges_equations_are_those_of_the_package():
    for start, target, c in lesson4.PLACES:
        assert np.allclose(
            placed(np.array(start), np.array(target), np.array(c)), place(start, target, [c])[0]
        )
    curve = TimeBaseGenerator(0.4, 0.6).curve(20_000)
    gamma = np.pi / np.sin(np.pi * 0.4)  # For a movement of 1 s.
    for k in (4_000, 10_000, 15_000):
        speed = (curve[k + 1] - curve[k - 1]) * 10_000
        assert np.allclose(speed, rate(*curve[k], 0.4, 0.6, gamma), rtol=1e-3)
