"""Exercises of lesson 3: right answers of several kinds, and the usual wrong ones."""

from __future__ import annotations

import numpy as np
import pytest

from gym_babble import course
from gym_babble.brain import PopulationMap
from gym_babble.course import lesson3
from gym_babble.course.lesson3 import EXERCISES, PREFERRED
from gym_babble.envs import BabbleReachEnv


def centroid(image):
    r, g, b = np.moveaxis(image.astype(float), -1, 0)
    rows, columns = np.nonzero((r > 2 * g) & (r > 2 * b))
    return columns.mean(), rows.mean()


def by_weights(image):
    image = image.astype(int)
    red = (image[..., 0] > 2 * image[..., 1]) & (image[..., 0] > 2 * image[..., 2])
    rows, columns = np.indices(red.shape)
    return np.array([np.average(columns, weights=red), np.average(rows, weights=red)])


def overflowing(image):
    r, g, b = np.moveaxis(image, -1, 0)
    rows, columns = np.nonzero((r > g * np.uint8(2)) & (r > b * np.uint8(2)))
    return columns.mean(), rows.mean()


def all_pixels(image):
    return (image.shape[1] - 1) / 2, (image.shape[0] - 1) / 2


def gaze(x, y, height=0.25, ahead=0.10):
    y = y - ahead
    return np.degrees([np.arctan2(x, np.hypot(y, height)), np.arctan2(y, height)])


def fick(x, y):
    y = y - 0.10
    return np.degrees([np.arctan2(x, y), np.arctan2(-0.25, np.hypot(x, y))])


def gaze_by_arctan(x, y):
    return [
        np.rad2deg(np.arctan(x / np.sqrt((y - 0.1) ** 2 + 0.25**2))),
        np.rad2deg(np.arctan((y - 0.1) / 0.25)),
    ]


def gauss(x, sigma, preferred):
    return np.exp(-((preferred - x) ** 2) / (2 * sigma**2))


def by_the_package(x, sigma, preferred):
    return PopulationMap(len(preferred), low=[-3], high=[3], sigma=sigma).encode([x])


RIGHT = [
    ("3.1", centroid),
    ("3.1", by_weights),
    ("3.2", 6),
    ("3.2", np.int64(6)),
    ("3.2", 6.0),
    ("3.3", gaze),
    ("3.3", gaze_by_arctan),
    ("3.4", gauss),
    ("3.4", by_the_package),
    ("3.4", lambda x, sigma, preferred: [gauss(x, sigma, p) for p in preferred]),
    ("3.5", lambda a, x: a @ x / a.sum()),
    ("3.5", lambda a, x: np.average(x, weights=a)),
    ("3.5", lambda a, x: sum(p * q for p, q in zip(a, x, strict=True)) / sum(a)),
    ("3.6", 0.9),
    ("3.6", 1),
    ("3.6", np.float32(0.8)),
]
WRONG = [
    ("3.1", lambda image: centroid(image)[::-1], "exchanged"),
    ("3.1", all_pixels, "middle"),
    ("3.1", lambda image: np.subtract(centroid(image), 83.5), "subtracted"),
    ("3.1", overflowing, "uint8"),
    ("3.1", lambda image: image[..., 0] > 100, "not made of real numbers"),
    ("3.2", 1, "same angle"),
    ("3.2", 5, "Off by one"),
    ("3.2", 7, "Off by one"),
    ("3.2", 20, "tan"),
    ("3.3", lambda x, y: np.radians(gaze(x, y)), "radians"),
    ("3.3", lambda x, y: gaze(x, y)[::-1], "exchanged"),
    ("3.3", lambda x, y: gaze(x, y) * [1, -1], "sign"),
    ("3.3", fick, "Fick"),
    ("3.3", lambda x, y: gaze(x, y, ahead=0), "above the shoulder"),
    ("3.3", lambda x, y: np.degrees(np.arctan([x / 0.25, (y - 0.1) / 0.25])), "pan is not"),
    ("3.3", lambda x, y: gaze(x, y, height=0.5), "height"),
    ("3.4", lambda x, s, p: np.exp(-np.abs(p - x) / (2 * s**2)), "not squared"),
    ("3.4", lambda x, s, p: np.exp(-((p - x) ** 2) / s**2), "factor 2"),
    ("3.4", lambda x, s, p: np.exp(-((p - x) ** 2) / (2 * s)), "σ is not squared"),
    ("3.4", lambda x, s, p: np.exp(-((p - x) ** 2) / 2 * s**2), "brackets"),
    ("3.4", lambda x, s, p: gauss(x, s, p) / gauss(x, s, p).sum(), "sum to one"),
    ("3.4", lambda x, s, p: np.exp((p - x) ** 2 / (2 * s**2)), "Numbers between"),
    ("3.4", lambda x, s, p: gauss(x, 2 * s, p), "middle neuron"),
    ("3.5", lambda a, x: x[a.argmax()], "strongest"),
    ("3.5", lambda a, x: a @ x, "divide"),
    ("3.5", lambda a, x: np.mean(a * x), "number of neurons"),
    ("3.5", lambda _, x: x.mean(), "Eq. 4 reads"),
    ("3.6", 0.3, "wider"),
    ("3.6", 3, "narrower"),
    ("3.6", 0, "between 0.05 and 10"),
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


def test_the_judges_gaze_is_that_of_the_environments_eye():
    env = BabbleReachEnv()
    for seed in range(20):
        observation, _ = env.reset(seed=seed)
        gaze_deg = 130 * observation["eye"] - 65
        assert np.allclose(lesson3._gaze(np.array([env.scenario["target"]])), gaze_deg, atol=0.3)


def test_the_judges_code_is_that_of_the_package():
    for (x, sigma), activities in zip(lesson3.CODES, lesson3._activities(), strict=True):
        assert np.allclose(activities, by_the_package(x, sigma, PREFERRED), atol=1e-6)


def test_the_reflex_of_eq_1_has_the_gain_that_the_docs_state():
    errors = lesson3._steps()
    assert np.isclose(1 - errors[-1] / errors[-2], 0.605, atol=0.001)
