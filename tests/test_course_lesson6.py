"""Lesson 6: right answers are right, and the usual wrong ones have their own message."""

from __future__ import annotations

import numpy as np
import pytest

from gym_babble import course
from gym_babble.course.lesson6 import _table2
from gym_babble.course.palm import approach, forearm_frame


def test_no_ball_is_held_without_the_reflex_and_big_ones_anywhere_with_it():
    places = [2.0, 3.6, 5.0]
    for diameter in (0.024, 0.06):
        np.testing.assert_array_equal(approach(diameter, places, reflex=False), 0)
    np.testing.assert_array_equal(approach(0.06, places), 1)


def test_the_forearms_frame_turns_with_the_arm():
    elbow_bent = np.array([[0.0, np.pi / 2]])  # The forearm points along y from (0.15, 0).
    along, beside = forearm_frame(elbow_bent, [[0.10, 0.13]])
    np.testing.assert_allclose([along[0], beside[0]], [0.13, 0.05], atol=1e-12)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (3.1, ""),
        (np.float64(3.05), ""),
        (0.031, "Give the distance in cm"),
        (31, "Give the distance in cm"),
        (3.0, "Go further out"),
        (3.6, "nearer than 3.6"),
    ],
)
def test_the_edge_is_found_to_a_tenth_of_a_centimetre(answer, said):
    result = course.check("6.1", answer)
    assert result.right == (said == "")
    assert said in repr(result)


def test_held_of_touched_is_a_share_of_big_balls_under_the_palm():
    result = _table2()
    big = result.by_size()["6 cm"]
    share = big.count("held") / big.count("palm_reach")
    for answer, said in (
        (share, ""),
        (100 * share, "per cent"),
        (big.rate("held"), "all tests"),
        (result.rate("held"), "both sizes"),
        (big.count("held") / big.count("reach"), "any part"),
        (1 / share, "Held over touched"),
        (0.123, "not 0.123"),
    ):
        found = course.check("6.2", answer)
        assert found.right == (said == "")
        assert said in repr(found)


def gap(arm, ball, radius):
    forearm = sum(arm)
    x = ball[0] - 0.15 * np.cos(arm[0])
    y = ball[1] - 0.15 * np.sin(arm[0])
    return -x * np.sin(forearm) + y * np.cos(forearm) - 0.01 - radius


def turned(arm, ball, radius):
    elbow = 0.15 * np.exp(1j * arm[0])
    beside = ((complex(*ball) - elbow) * np.exp(-1j * (arm[0] + arm[1]))).imag
    return np.array([beside - 0.01 - radius])


@pytest.mark.parametrize("function", [gap, turned])
def test_the_gap_is_right_however_it_is_written(function):
    assert course.check("6.3", function).right


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda arm, ball, _r: gap(arm, ball, 0), "radius of the ball is missing"),
        (lambda arm, ball, r: gap(arm, ball, r) + 0.01, "half-width of the palm is missing"),
        (lambda arm, ball, r: gap(arm, ball, r) + 0.01 + r, "centres"),
        (lambda arm, ball, r: -gap(arm, ball, r), "sign is wrong"),
        (lambda arm, ball, r: gap(arm, ball, 2 * r), "diameter is subtracted"),
        (lambda arm, ball, r: gap((arm[0], 0), ball, r), "shoulder + elbow"),
        (lambda arm, ball, r: gap(arm, ball, r) * 100, "in metres"),
        (lambda arm, ball, r: forearm_frame(arm, ball)[0] - 0.01 - r, "along the forearm"),
        (lambda _arm, _ball, _r: 0.0, "off by up to"),
        (lambda arm: arm, "TypeError"),
    ],
)
def test_usual_wrong_gaps_are_named(function, said):
    assert said in repr(course.check("6.3", function))


def outstar(w, u, g, a):
    return w + g / (u + g) * (a[:, None] - w)


def in_place(w, u, g, a):
    u += g
    for j in range(len(a)):
        w[j] += g / u * (a[j] - w[j])
    return w


@pytest.mark.parametrize("step", [outstar, in_place])
def test_the_outstar_is_right_however_it_is_written(step):
    assert course.check("6.4", step).right


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (lambda w, u, g, a: w + g / u * (a[:, None] - w), "before the step"),
        (lambda w, u, g, a: outstar(w, u, g, a) - w, "change alone"),
        (lambda w, _u, g, a: w + g * (a[:, None] - w), "use is missing"),
        (lambda w, u, g, a: w + g / (u + g) * a[:, None], "only grow"),
        (lambda w, _u, _g, _a: w, "off by up to"),
        (lambda w, u, g, a: w + g / (u + g) * (a - w), "ValueError"),
    ],
)
def test_usual_wrong_outstars_are_named(step, said):
    assert said in repr(course.check("6.4", step))


def test_the_outstars_weights_are_weighted_means():
    rng = np.random.default_rng(0)
    g, a = rng.uniform(size=(50, 3)), rng.uniform(size=(50, 4))
    w, u = np.zeros((4, 3)), np.zeros(3)
    for one, other in zip(g, a, strict=True):
        w, u = outstar(w, u, one, other), u + one
    np.testing.assert_allclose(w, a.T @ g / g.sum(axis=0))


@pytest.mark.parametrize(
    ("brain", "said"),
    [
        ({"squeeze_deg": 0}, ""),
        ({"squeeze_deg": 0.0, "sizes": 3}, ""),
        ({"reflex": False}, "What must a hand do"),
        ({"squeeze": 0}, "no row of the table"),
        ({"sizes": 1000}, "leaves sizes out"),
        ({"squeeze_deg": "none"}, "No agent has such a brain"),
        ("squeeze_deg", "A dict is expected"),
    ],
)
def test_without_the_squeeze_small_balls_fall(brain, said):
    result = course.check("6.5", brain)
    assert result.right == (said == "")
    assert said in repr(result)
