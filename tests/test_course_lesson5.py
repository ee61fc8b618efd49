"""Lesson 5: right answers are right, and the usual wrong ones have their own message."""

from __future__ import annotations

import numpy as np
import pytest

from gym_babble import course
from gym_babble.course.lesson5 import B1, B2, _chosen, _learnt


def eq7(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


def by_neuron(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    change = np.zeros_like(w)
    for j in range(len(a)):
        for i in range(len(g)):
            bound = w_max - abs(w[j, i])
            change[j, i] = eta * (a[j] - a_mean[j]) * (g[i] - g_mean[i]) * bound
    return change


def broadcast(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    return (eta * (a - a_mean)[:, None] * (g - g_mean)[None, :] * (w_max - np.abs(w))).tolist()


@pytest.mark.parametrize("rule", [eq7, by_neuron, broadcast])
def test_eq7_is_right_however_it_is_written(rule):
    assert course.check("5.1", rule).right


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        (lambda a, _m, g, _n, w, e, b: e * np.outer(a, g) * (b - abs(w)), "plain Hebb"),
        (lambda a, m, g, n, w, e, b: e * np.outer(a - m, g - n) * (b - w), "abs(w)"),
        (lambda a, m, g, n, _w, e, _b: e * np.outer(a - m, g - n), "no bound"),
        (lambda a, m, g, n, w, _e, b: np.outer(a - m, g - n) * (b - abs(w)), "begins with η"),
        (lambda a, m, g, n, w, e, b: w + eq7(a, m, g, n, w, e, b), "Δw alone"),
        (lambda a, m, g, _n, w, e, b: e * np.outer(a - m, g) * (b - abs(w)), "mean of the input"),
        (lambda a, _m, g, n, w, e, b: e * np.outer(a, g - n) * (b - abs(w)), "mean of the output"),
        (lambda a, m, g, n, w, e, b: -eq7(a, m, g, n, w, e, b), "sign"),
        (lambda a, m, g, n, w, e, b: 2 * eq7(a, m, g, n, w, e, b), "off by"),
        (lambda a, m, g, n, _w, e, _b: e * np.outer(g - n, a - m), "shape (3, 4)"),
        (lambda a, m, g, n, _w, _e, _b: (a - m) * (g - n), "ValueError"),
    ],
)
def test_usual_wrong_rules_are_named(rule, said):
    assert said in repr(course.check("5.1", rule))


@pytest.mark.parametrize(
    ("exercise", "answer", "said"),
    [
        ("5.2", 0.1, ""),
        ("5.2", np.float64(0.1), ""),
        ("5.2", 10, "per cent"),
        ("5.2", 100, "Divide by the number"),
        ("5.2", 0.716, "share of Eq. 7"),
        ("5.2", 0.898, "collisions"),
        ("5.2", 0.5, "The share is not 0.500"),
        ("5.3", 0.789, ""),
        ("5.3", [0.789], ""),
        ("5.3", 0.211, "curved"),
        ("5.3", 0.04, "share of Eq. 7"),
        ("5.3", 0.4, "The share is not 0.400"),
    ],
)
def test_shares_are_judged_by_what_the_agents_do(exercise, answer, said):
    result = course.check(exercise, answer)
    assert result.right == (said == "")
    assert said in repr(result)


def test_movements_to_the_right_are_not_all_straight():
    share = np.mean(_chosen("hebb") - 0.5 < 0.1)
    assert "abs(b1 - 0.5)" in repr(course.check("5.3", share))


@pytest.mark.parametrize(
    "brain", [{"readout": "peak"}, {"readout": "peak", "peak_radius": np.int64(3), "sigma": 0.8}]
)
def test_a_readout_that_chooses_makes_plain_hebb_good(brain):
    assert course.check("5.4", brain).right


@pytest.mark.parametrize(
    ("brain", "said"),
    [
        ({}, "solves 0.1"),
        ({"rule": {"name": "covariance"}}, "must stay plain Hebb"),
        ({"rule": "covariance"}, "must stay plain Hebb"),
        ({"output_neurons": 5}, "'output_neurons'"),
        ({"readout": "mean"}, "No agent has such a brain"),
        ({"readout": "peak", "peak_radius": -1}, "No agent has such a brain"),
        ('{"readout": "peak"}', "A dict is expected"),
        ({"readout": object()}, "no setting"),
        ({"sigma": float("nan")}, "no setting"),
        ({"readout": "peak" * 1000}, "more than 2,000 letters"),
    ],
)
def test_other_brains_are_named(brain, said):
    result = course.check("5.4", brain)
    assert not result.right
    assert said in repr(result)


def read_out(activity, preferred=B1):
    total = activity.sum(axis=0)
    return np.where(total > 0, preferred @ activity / np.maximum(total, 1e-12), 0.5)


def uncut(w):
    a = np.tanh(w.astype(float))
    total = a.sum(axis=0)
    return np.where(total != 0, B1 @ a / np.where(total == 0, 1, total), 0.5)


def weights():
    return _learnt("covariance").weights["weights"]


def test_eq4_for_one_neuron_is_right_as_a_product_and_as_a_loop():
    w = weights()
    active = np.maximum(np.tanh(w), 0)
    assert course.check("5.5", read_out(active)).right
    loop = []
    for i in range(441):
        a = np.clip(np.tanh(w[:, i]), 0, None)
        loop.append(0.5 if a.sum() == 0 else sum(B1[j] * a[j] for j in range(441)) / a.sum())
    assert course.check("5.5", loop).right


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda w: read_out(np.maximum(np.tanh(w), 0), B2), "This is b2"),
        (lambda w: read_out(np.maximum(np.tanh(w.T), 0)), "W[:, i]"),
        (uncut, "cuts them"),
        (lambda w: B1[np.tanh(w).argmax(axis=0)], "nearly Eq. 4"),
        (lambda _w: np.full(441, 0.5), "is another"),
        (lambda _w: np.full((21, 21), 0.5), "Shape (441,)"),
    ],
)
def test_usual_wrong_readouts_are_named(wrong, said):
    assert said in repr(course.check("5.5", wrong(weights())))


@pytest.mark.parametrize("eye", [(0, -0.2, 0.25), [0.15, 0.0, 0.25], np.array([0, -0.3, 0.25])])
def test_an_eye_behind_or_beside_the_body_is_right(eye):
    assert course.check("5.6", eye).right


@pytest.mark.parametrize(
    ("eye", "said"),
    [
        ((0, 0.1, 0.25), "the rule solves 0.6"),
        ((0, 0.1, 0.75), "the rule solves 0."),
        ((0, 10, 25), "too far away"),
        ((0, 0.1, -0.1), "z > 0"),
        ((0, 0.1), "Shape (3,)"),
    ],
)
def test_other_places_of_the_eye_are_wrong(eye, said):
    result = course.check("5.6", eye)
    assert not result.right
    assert said in repr(result)
