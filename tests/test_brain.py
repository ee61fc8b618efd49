"""Maps, generators and the covariance rule against a few lines of NumPy and SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import beta, betainc

from gym_babble import _core
from gym_babble.errors import ConfigError


def learn(w, g_bar, a_bar, g, a, *, eta, w_max, xi):
    """Eq. 7; xi is the share of the old value in the averages, which move on afterwards."""
    w += (eta * (a - a_bar))[:, None] * (g - g_bar)[None, :] * (w_max - abs(w))
    g_bar[:] = xi * g_bar + (1 - xi) * g
    a_bar[:] = xi * a_bar + (1 - xi) * a


@pytest.mark.parametrize("eta", [0.25, 1.0])
def test_the_rule_is_five_lines_of_numpy(eta):
    random = np.random.default_rng(0)
    n_in, n_out, w_max, xi = 30, 20, np.float32(0.2), np.float32(0.2)
    rule = _core.Association(n_in, n_out, eta, w_max, xi)
    w = np.zeros((n_out, n_in), np.float32)
    g_bar, a_bar = np.zeros(n_in, np.float32), np.zeros(n_out, np.float32)
    for _ in range(200):
        g = random.random(n_in).astype(np.float32)
        a = random.random(n_out).astype(np.float32)
        learn(w, g_bar, a_bar, g, a, eta=np.float32(eta), w_max=w_max, xi=xi)
        rule.learn(g, a)
        assert np.abs(rule.weights - w).max() < 1e-6
    assert np.abs(w).max() > 0.05
    g = random.random(n_in).astype(np.float32)
    assert rule.recall(g) == pytest.approx(np.tanh(w @ g).clip(0), abs=1e-5)


@settings(max_examples=60)
@given(b1=st.floats(0.02, 0.98), b2=st.floats(0.02, 0.98))
def test_generators_follow_the_incomplete_beta_function(b1, b2):
    # Eq. 5: the derivative of c_x over time is gamma c_x^b1 (1 - c_x)^b2, so that time over T is
    # the regularised incomplete beta function of c_x; c_y has b1 and b2 swapped. Towards an end
    # with b near 1 this function jumps where a float64 has no numbers left.
    curve = _core.generator_curve(b1, b2, 50)
    share = np.arange(51) / 50
    assert curve.shape == (51, 2)
    for c, (p, q) in zip(curve.T, ((1 - b1, 1 - b2), (1 - b2, 1 - b1)), strict=True):
        fine = (c > 1e-12) & (c < 1 - 1e-9)
        assert betainc(p, q, c[fine]) == pytest.approx(share[fine], abs=2e-5)
    assert (np.diff(curve, axis=0) >= 0).all()
    assert curve[0] == pytest.approx([0, 0])
    assert curve[-1] == pytest.approx([1, 1])


@given(b1=st.floats(0.02, 0.98))
@settings(max_examples=40)
def test_babbled_movements_are_point_symmetric(b1):
    # For b2 = 1 - b1: T = pi / (gamma sin(pi b1)), and c_y(s) = 1 - c_x(1 - s).
    assert beta(1 - b1, b1) == pytest.approx(np.pi / np.sin(np.pi * b1))
    x, y = _core.generator_curve(b1, 1 - b1, 40).T
    assert y == pytest.approx(1 - x[::-1], abs=1e-6)


def test_maps_encode_and_read_out():
    map_ = _core.PopulationMap((21, 21), (0.0, 0.0), (1.0, 1.0), 0.7)
    x = (0.33, 0.71)
    g = map_.encode(x).reshape(21, 21)
    assert np.unravel_index(g.argmax(), g.shape) == (14, 7)  # Rows are the second value.
    # Eq. 3 with sigma in neuron spacings.
    columns, rows = np.meshgrid(np.arange(21), np.arange(21))
    distance2 = (columns - 20 * x[0]) ** 2 + (rows - 20 * x[1]) ** 2
    assert g == pytest.approx(np.exp(-distance2 / (2 * 0.7**2)), abs=1e-6)
    assert map_.read_out(g.ravel()) == pytest.approx(x, abs=1e-3)


def test_what_the_brain_refuses():
    for b1, b2 in ((0.0, 0.5), (1.0, 0.5), (0.5, float("nan")), (-1, 2)):
        with pytest.raises(ConfigError):
            _core.generator_curve(b1, b2, 10)
    rule = _core.Association(3, 2)
    before = rule.weights
    for g, a in ((np.zeros(2), np.zeros(2)), (np.zeros(3), np.zeros(3))):
        with pytest.raises(ConfigError):
            rule.learn(g.astype(np.float32), a.astype(np.float32))
    for bad in (np.nan, np.inf, -0.1, 1.1):
        with pytest.raises(ConfigError):
            rule.learn(np.full(3, bad, np.float32), np.zeros(2, np.float32))
    assert (rule.weights == before).all()
    for options in ({"eta": -1.0}, {"w_max": 0.0}, {"xi": 2.0}, {"eta": float("nan")}):
        with pytest.raises(ConfigError, match=next(iter(options))):
            _core.Association(3, 2, **options)
    with pytest.raises(ConfigError):
        _core.PopulationMap((1, 0), (0.0, 0.0), (1.0, 1.0), 0.7)
    with pytest.raises(ConfigError):
        _core.PopulationMap((5, 5), (0.0, 1.0), (1.0, 0.0), 0.7)
    map_ = _core.PopulationMap((5, 5), (0.0, 0.0), (1.0, 1.0), 0.7)
    with pytest.raises(ConfigError):
        map_.read_out(np.zeros(7, np.float32))
