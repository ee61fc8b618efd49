"""Maps, generators and the covariance rule against a few lines of NumPy and SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import beta, betainc

from gym_babble import brain
from gym_babble.errors import ConfigError

ETA, W_MAX, XI = np.float32(0.25), np.float32(0.2), np.float32(0.3)


def covariance(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's arguments
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


def hebb(a, _a_mean, g, _g_mean, w, eta, w_max):
    return eta * np.outer(a, g) * (w_max - abs(w))


def oja(a, _a_mean, g, _g_mean, w, eta, _w_max):
    return eta * a[:, None] * (g[None, :] - a[:, None] * w)


TWINS = {"covariance": covariance, "hebb": hebb, "oja": oja}
NUMBERS = {"eta": 0.25, "xi": 0.3}
SIZES = (30, 20)


def activities(n):
    random = np.random.default_rng(0)
    return [random.random((n, size)).astype(np.float32) for size in SIZES]


def test_the_outstar_learns_what_each_input_was_paired_with_on_average():
    assert set(brain.RULES) == {*TWINS, "outstar"}
    gs, as_ = activities(200)
    gs[gs < 0.5] = 0
    ours = brain.Association(*SIZES, brain.OutstarRule())
    ours.learn(gs, as_)
    used = gs.sum(0)
    assert ours.g_mean == pytest.approx(used, rel=1e-5)
    assert ours.weights == pytest.approx(as_.T @ gs / used, abs=1e-5)


@pytest.mark.parametrize("name", TWINS)
def test_each_rule_is_a_line_of_numpy(name):
    gs, as_ = activities(200)
    ours = brain.Association(*SIZES, name, **NUMBERS)
    w, a_mean, g_mean = (np.zeros(n, np.float32) for n in (SIZES[::-1], SIZES[1], SIZES[0]))
    for g, a in zip(gs, as_, strict=True):
        w = w + TWINS[name](a, a_mean, g, g_mean, w, ETA, W_MAX)
        a_mean, g_mean = XI * a_mean + (1 - XI) * a, XI * g_mean + (1 - XI) * g
        ours.learn(g, a)
        assert np.abs(ours.weights - w).max() < 1e-5
    assert np.abs(w).max() > 0.05
    assert ours.a_mean == pytest.approx(a_mean, abs=1e-6)
    assert ours.g_mean == pytest.approx(g_mean, abs=1e-6)
    # In one batch the same bits; as a rule of one's own and by its class the same weights.
    whole = brain.Association(*SIZES, name, threads=2, **NUMBERS)
    whole.learn(gs, as_)
    assert (whole.weights == ours.weights).all()
    own = brain.Association(*SIZES, TWINS[name], **NUMBERS)
    own.learn(gs, as_)
    assert np.abs(own.weights - w).max() < 1e-5
    by_class = brain.Association(*SIZES, brain.RULES[name](**NUMBERS))
    by_class.learn(gs, as_)
    assert (by_class.weights == ours.weights).all()


def test_recall_is_equation_4():
    gs, as_ = activities(9)
    association = brain.Association(*SIZES)
    association.learn(gs, as_)
    expected = np.tanh(gs @ association.weights.T).clip(0)
    assert association.recall(gs) == pytest.approx(expected, abs=1e-5)
    assert (association.recall(gs[3]) == association.recall(gs)[3]).all()


def test_weights_and_averages_can_be_set():
    gs, as_ = activities(20)
    whole, rebuilt = brain.Association(*SIZES), brain.Association(*SIZES)
    whole.learn(gs, as_)
    rebuilt.weights = whole.weights
    rebuilt.a_mean, rebuilt.g_mean = whole.a_mean, whole.g_mean
    whole.learn(gs, as_)
    rebuilt.learn(gs, as_)
    assert (rebuilt.weights == whole.weights).all()
    for name, bad in (
        ("weights", np.zeros((3, 3))),
        ("weights", np.full(SIZES[::-1], np.nan)),
        ("a_mean", np.full(SIZES[1], 2.0)),
        ("g_mean", np.zeros(7)),
    ):
        with pytest.raises(ConfigError, match=name):
            setattr(rebuilt, name, bad)
    assert (rebuilt.weights == whole.weights).all()


@pytest.mark.parametrize(
    ("rule", "match"),
    [
        (lambda *_: np.zeros((2, 2)), r"shape \(2, 2\), expected \(20, 30\)"),
        (lambda *_: np.full(SIZES[::-1], np.nan), r"Δw\[0, 0\] = nan"),
        (lambda *_: None, "shape"),
        (lambda *_: np.full(SIZES[::-1], "x"), "expected numbers"),
    ],
)
def test_a_rule_that_returns_no_change_is_named_and_nothing_is_learnt(rule, match):
    association = brain.Association(*SIZES, rule)
    with pytest.raises(ConfigError, match=match):
        association.learn(*activities(3))
    assert (association.weights == 0).all()
    assert (association.a_mean == 0).all()


def test_a_rule_cannot_change_the_weights_by_itself():
    def in_place(*arguments):
        arguments[4][:] += 1

    with pytest.raises(ValueError, match="read-only"):
        brain.Association(*SIZES, in_place).learn(*activities(1))


@settings(max_examples=60)
@given(b1=st.floats(0.02, 0.98), b2=st.floats(0.02, 0.98))
def test_generators_follow_the_incomplete_beta_function(b1, b2):
    # Eq. 5: the derivative of c_x over time is gamma c_x^b1 (1 - c_x)^b2, so that time over T is
    # the regularised incomplete beta function of c_x; c_y has b1 and b2 swapped. Towards an end
    # with b near 1 this function jumps where a float64 has no numbers left.
    curve = brain.TimeBaseGenerator(b1, b2).curve(50)
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
    x, y = brain.TimeBaseGenerator(b1, 1 - b1).curve(40).T
    assert y == pytest.approx(1 - x[::-1], abs=1e-6)


def test_a_placed_curve_joins_start_and_target():
    curve = brain.TimeBaseGenerator(0.7, 0.3).curve(40)
    placed = brain.place([0.1, 0.2], [0.3, -0.1], curve)
    assert placed[[0, -1]] == pytest.approx(np.array([[0.1, 0.2], [0.3, -0.1]]))
    along = placed[-1] - placed[0]
    off = placed[20] - (placed[0] + placed[-1]) / 2
    assert along[0] * off[1] - along[1] * off[0] > 0  # b1 > 1/2 curves to the left.


def test_maps_encode_and_read_out():
    map_ = brain.PopulationMap(21, (0.0, 0.0), (1.0, 1.0))
    x = (0.33, 0.71)
    g = map_.encode(x).reshape(map_.shape)
    assert np.unravel_index(g.argmax(), g.shape) == (14, 7)  # Rows are the second value.
    # Eq. 3 with sigma in neuron spacings.
    columns, rows = np.meshgrid(np.arange(21), np.arange(21))
    distance2 = (columns - 20 * x[0]) ** 2 + (rows - 20 * x[1]) ** 2
    assert g == pytest.approx(np.exp(-distance2 / (2 * 0.7**2)), abs=1e-6)
    assert map_.read_out(g.ravel()) == pytest.approx(x, abs=1e-3)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_maps_of_any_number_of_axes_take_batches(axes):
    neurons, high = np.array([7, 6, 5])[:axes], np.array([1, 2, 3])[:axes]
    map_ = brain.PopulationMap(neurons, [0] * axes, high, sigma=0.6)
    assert len(map_) == np.prod(neurons)
    assert map_.shape == tuple(neurons[::-1])
    x = np.array([0.4, 0.9, 1.4])[:axes] + 0.1 * np.arange(4)[:, None]
    g = map_.encode(x)
    spacing = high / (neurons - 1)
    away = (map_.preferred[None] - x[:, None]) / spacing
    assert g == pytest.approx(np.exp(-(away**2).sum(-1) / (2 * 0.6**2)), abs=1e-6)
    assert g[2] == pytest.approx(map_.encode(x[2]))
    expected = g.astype(float) @ map_.preferred / g.sum(1, keepdims=True)
    assert map_.read_out(g) == pytest.approx(expected, abs=1e-6)
    two = map_.encode(map_.preferred[0]) + 1.1 * map_.encode(map_.preferred[-1])
    near = np.abs((map_.read_out_peak(two, 1) - map_.preferred[-1]) / spacing)
    assert (near < 0.5).all()


def test_a_conjunctive_map_is_the_normalised_product():
    inner, outer = brain.PopulationMap(4, [0, 0], [1, 1]), brain.PopulationMap(3, 0, 1)
    both = brain.ConjunctiveMap(inner, outer)
    x, y = np.array([[0.2, 0.7], [0.5, 0.1]]), np.array([[0.3], [0.8]])
    g = both.encode(x, y)
    assert g.shape == (2, len(both)) == (2, 48)
    product = np.einsum("ni,nj->nij", outer.encode(y), inner.encode(x)).reshape(2, -1)
    assert g == pytest.approx(product / product.sum(1, keepdims=True), abs=1e-6)
    assert both.encode(x[1], y[1]) == pytest.approx(g[1])


def test_what_the_brain_refuses():
    for b1, b2 in ((0.0, 0.5), (1.0, 0.5), (0.5, float("nan")), (-1, 2)):
        with pytest.raises(ConfigError):
            brain.TimeBaseGenerator(b1, b2)
    association = brain.Association(3, 2)
    for g, a in ((np.zeros(2), np.zeros(2)), (np.zeros(3), np.zeros(3)), (np.ones((2, 3)), [0, 1])):
        with pytest.raises(ConfigError):
            association.learn(g, a)
    for bad in (np.nan, np.inf, -0.1, 1.1):
        with pytest.raises(ConfigError):
            association.learn(np.full(3, bad), np.zeros(2))
    assert (association.weights == 0).all()
    for options in ({"eta": -1.0}, {"w_max": 0.0}, {"xi": 2.0}, {"eta": float("nan")}, {"mu": 1}):
        with pytest.raises(ConfigError, match=next(iter(options))):
            brain.Association(3, 2, **options).learn(np.ones(3), np.ones(2))
    for rule in ("modern", 3, None):
        with pytest.raises(ConfigError, match="covariance, hebb, oja"):
            brain.Association(3, 2, rule)
    for neurons, low, high in ((1, [0, 0], [1, 1]), (5, [0, 1], [1, 0]), (5, [0], [1, 1])):
        with pytest.raises(ConfigError):
            brain.PopulationMap(neurons, low, high)
    map_ = brain.PopulationMap(5, [0, 0], [1, 1])
    for wrong in (lambda: map_.read_out(np.zeros(7)), lambda: map_.encode(0.5)):
        with pytest.raises(ConfigError):
            wrong()
