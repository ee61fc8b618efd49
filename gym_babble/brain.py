"""Neural maps, associations, learning rules and pattern generators, for your own experiments.

    >>> import numpy as np
    >>> from gym_babble import brain
    >>> map_ = brain.PopulationMap(21, low=[0, 0], high=[1, 1])
    >>> g = map_.encode([0.3, 0.6])
    >>> g.shape
    (441,)
    >>> map_.read_out(g).round(2).tolist()
    [0.3, 0.6]

Symbols are those of Caligiore et al. (2008): g are activities of an input map, a those of an output
map, w_ji the weight from input neuron i to output neuron j.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from gym_babble import _core
from gym_babble.checks import (
    check_number,
    check_threads,
    check_whole,
    numbers,
    plain,
    shaped,
    shown,
)
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "RULES",
    "Association",
    "ConjunctiveMap",
    "CovarianceRule",
    "HebbRule",
    "OjaRule",
    "OutstarRule",
    "OwnRule",
    "PopulationMap",
    "RuleLike",
    "TimeBaseGenerator",
    "place",
]

T = TypeVar("T", bound=np.generic)

MOST_NEURONS = 2**24
"""Neurons of a map, and pairs of neurons of two maps."""
MOST_ACTIVITIES = 2**30
"""Activities that are computed at once."""

Floats: TypeAlias = NDArray[np.float32]

OwnRule: TypeAlias = Callable[[Floats, Floats, Floats, Floats, Floats, float, float], Any]
"""A learning rule of your own: `f(a, a_mean, g, g_mean, w, eta, w_max)` returns Δw.

`a` and `a_mean` (n_out,) are the output's activities and their running averages, `g` and `g_mean`
(n_in,) those of the input, `w` (n_out, n_in) the weights before the step, all float32; `eta` and
`w_max` are the rule's numbers. Δw has the shape of `w`.
"""


@dataclass(frozen=True, kw_only=True)
class CovarianceRule:
    """The paper's rule: Δw_ji = η (a_j − ā_j)(g_i − ḡ_i)(w_max − |w_ji|) (Eq. 7)."""

    name: ClassVar[str] = "covariance"
    eta: float = 1.0
    """Learning rate η, 0 < η ≤ 1."""
    w_max: float = 0.2
    """Bound of the weights, > 0."""
    xi: float = 0.2
    """Share ξ of the old value in the running averages, 0 ≤ ξ < 1."""


@dataclass(frozen=True, kw_only=True)
class HebbRule:
    """Hebb's rule, which is Eq. 7 without the averages: Δw_ji = η a_j g_i (w_max − |w_ji|)."""

    name: ClassVar[str] = "hebb"
    eta: float = 1.0
    """Learning rate η, 0 < η ≤ 1."""
    w_max: float = 0.2
    """Bound of the weights, > 0."""
    xi: float = 0.2
    """Share ξ of the old value in the running averages, which the rule does not use."""


@dataclass(frozen=True, kw_only=True)
class OjaRule:
    """Oja's rule, whose decay keeps weights finite: Δw_ji = η a_j (g_i − a_j w_ji)."""

    name: ClassVar[str] = "oja"
    eta: float = 0.1
    """Learning rate η, 0 < η ≤ 1."""
    xi: float = 0.2
    """Share ξ of the old value in the running averages, which the rule does not use."""


@dataclass(frozen=True, kw_only=True)
class OutstarRule:
    """Grossberg's outstar (1968), which has no numbers: Δw_ji = (g_i / u_i)(a_j − w_ji).

    u_i is the use of the input, the sum of its activities so far. So w_ji is the mean of the
    output's activities that the input was paired with. u stands in place of the input's average;
    an input below 1e-4 counts as zero.
    """

    name: ClassVar[str] = "outstar"


RULES = {rule.name: rule for rule in (CovarianceRule, HebbRule, OjaRule, OutstarRule)}
"""The rules of the core by name."""

RuleLike: TypeAlias = str | CovarianceRule | HebbRule | OjaRule | OutstarRule | OwnRule
"""A rule by name, with numbers of its own, or a function (`OwnRule`)."""


class PopulationMap:
    """A grid of neurons with Gaussian tuning, for d numbers at once (Eq. 3 and 4).

    Neurons stand evenly from `low` to `high`, ends included. The first axis runs fastest: with two
    axes, neuron j stands in column j % n (first number) and row j // n (second number).

    Args:
        neurons: Neurons along each axis, or one number for all axes; at least 2.
        low: Preferred value of the first neuron of each axis (d,).
        high: Preferred value of the last neuron of each axis (d,).
        sigma: Width σ of the tuning curves, in spacings of neurons; the paper's 0.7.

    Raises:
        ConfigError: An argument is out of its bounds, or of another number of axes.
    """

    def __init__(
        self,
        neurons: int | ArrayLike,
        low: ArrayLike,
        high: ArrayLike,
        sigma: float = 0.7,
    ) -> None:
        lows = _axes("low", low)
        counts = _counts(neurons, len(lows))
        sigma = check_number("sigma", sigma, 0.0, 1e6, "spacings of neurons")
        self._core = _core.PopulationMap(counts, lows, _axes("high", high), sigma)
        self.shape: tuple[int, ...] = tuple(counts[::-1])
        """Neurons along each axis, the last axis first: `g.reshape(map.shape)` is a picture of
        g."""

    def __len__(self) -> int:
        """Number N of neurons."""
        return len(self._core)

    @property
    def preferred(self) -> NDArray[np.float64]:
        """Preferred values (N, d)."""
        return self._core.preferred()

    def encode(self, x: ArrayLike) -> Floats:
        """Activities (N,) for a value (d,), or (n, N) for values (n, d) (Eq. 3).

        g_j = exp(−|x_j − x|² / (2 σ²)), with lengths in spacings of neurons.
        """
        return _each(self._core.encode, "x", x, np.float64, width=len(self))

    def read_out(self, a: ArrayLike) -> NDArray[np.float64]:
        """The mean (d,) of the preferred values, weighted with activities (N,) (Eq. 4).

        For activities (n, N), values (n, d). A silent map reads its middle.
        """
        return _each(self._core.read_out, "a", a, np.float32)

    def read_out_peak(self, a: ArrayLike, radius: int = 2) -> NDArray[np.float64]:
        """The same mean, over the neurons within `radius` places of the strongest one.

        Given two peaks, this reads the higher one; the mean over all neurons lies between them.
        """
        radius = check_whole("radius", radius, 0, 1024, "neurons")
        return _each(lambda a: self._core.read_out(a, radius), "a", a, np.float32)


class ConjunctiveMap:
    """All pairs of the neurons of two maps, each the product of their activities.

    Goes beyond the paper. The activities of all pairs sum to one. Neuron j pairs neuron j % n of
    `inner`, which has n neurons, with neuron j // n of `outer`.

    Raises:
        ConfigError: They are not two maps, or have more than 2^24 pairs.
    """

    def __init__(self, inner: PopulationMap, outer: PopulationMap) -> None:
        for name, part in (("inner", inner), ("outer", outer)):
            if not isinstance(part, PopulationMap):
                raise ConfigError(f"{name} = {shown(part)} is not a PopulationMap")
        check_whole("len(inner) * len(outer)", len(inner) * len(outer), 1, MOST_NEURONS, "neurons")
        self._core = _core.ConjunctiveMap(inner._core, outer._core)  # noqa: SLF001 - of this module
        self.shape: tuple[int, ...] = (*outer.shape, *inner.shape)
        """Neurons along each axis, those of `outer` first."""

    def __len__(self) -> int:
        """Number N of pairs."""
        return len(self._core)

    def encode(self, inner: ArrayLike, outer: ArrayLike) -> Floats:
        """Activities (N,) for a value of each map, or (n, N) for n values of each."""
        second = _rows("outer", outer, np.float64)
        return _each(
            lambda x: self._core.encode(x, second), "inner", inner, np.float64, width=len(self)
        )


class Association:
    """All-to-all connections between two maps, learnt by a rule.

    Args:
        n_in: Neurons of the input map.
        n_out: Neurons of the output map.
        rule: A rule of this module, its name, or a function of your own (see `OwnRule`).
        numbers: `eta`, `w_max` and `xi`, where they differ from the rule's; a function is given
            η = 1, w_max = 0.2 and averages with ξ = 0.2.
        threads: Threads that learn; all processors for None. The bits do not depend on them.

    Raises:
        ConfigError: An argument is out of its bounds.
    """

    def __init__(
        self,
        n_in: int,
        n_out: int,
        rule: RuleLike = "covariance",
        *,
        threads: int | None = 1,
        **numbers: float,
    ) -> None:
        n_in = check_whole("n_in", n_in, 1, MOST_ACTIVITIES, "neurons")
        self._core = _core.Association(
            n_in, check_whole("n_out", n_out, 1, MOST_ACTIVITIES // n_in, "neurons")
        )
        self._own: Any = rule if is_own(rule) else None
        self._numbers = rule_numbers(rule)
        for name, value in numbers.items():
            if name not in self._numbers:
                raise ConfigError(f"{name}: the rule has {', '.join(self._numbers)}")
            self._numbers[name] = check_number(name, value, 0.0, 3e38, "for a rule")
        self._threads = check_threads(threads)

    def learn(self, g: ArrayLike, a: ArrayLike) -> None:
        """Learns from activities g (n_in,) and a (n_out,), or from m of each in their order.

        For each, the weights change by the rule, and then the averages move on:
        ā_j ← ξ ā_j + (1 − ξ) a_j, and so ḡ_i.

        Raises:
            ConfigError: Activities of another shape or outside of [0, 1], or the result of a
                function of your own is not a Δw. Nothing is learnt then.
            BusyError: Another thread uses the association.
        """
        gs, as_ = _rows("g", g, np.float32), _rows("a", a, np.float32)
        if self._own is None:
            self._core.learn(json.dumps(self._numbers), gs, as_, self._threads)
            return
        learn = teach(self._own, self._numbers)
        with self._core:
            weights, a_mean, g_mean = learn(self.weights, self.a_mean, self.g_mean, gs, as_)
            self._core.set_weights(weights)
            self._core.set_means(a_mean, g_mean)

    def recall(self, g: ArrayLike) -> Floats:
        """Activities a_j = max(tanh(Σ_i w_ji g_i), 0) that activities g call up.

        (n_out,) for g (n_in,), or (m, n_out) for g (m, n_in).
        """
        return _each(self._core.recall, "g", g, np.float32, width=len(self.a_mean))

    @property
    def weights(self) -> Floats:
        """A copy of the weights w_ji (n_out, n_in); assign to set them."""
        return self._core.weights()

    @weights.setter
    def weights(self, weights: ArrayLike) -> None:
        self._core.set_weights(shaped("weights", weights, self.weights.shape))

    @property
    def a_mean(self) -> Floats:
        """A copy of the running averages ā of the output (n_out,); assign to set them."""
        return self._core.means()[0]

    @a_mean.setter
    def a_mean(self, a_mean: ArrayLike) -> None:
        with self._core:
            means = shaped("a_mean", a_mean, self.a_mean.shape)
            self._core.set_means(means, self.g_mean)

    @property
    def g_mean(self) -> Floats:
        """A copy of the running averages ḡ of the input (n_in,); assign to set them."""
        return self._core.means()[1]

    @g_mean.setter
    def g_mean(self, g_mean: ArrayLike) -> None:
        with self._core:
            means = shaped("g_mean", g_mean, self.g_mean.shape)
            self._core.set_means(self.a_mean, means)


class TimeBaseGenerator:
    """Two time base generators with mirrored parameters, which draw one curved movement (Eq. 5).

    ċx = γ cx^b1 (1 − cx)^b2 and ċy = γ cy^b2 (1 − cy)^b1, from (0, 0) to (1, 1). With b2 = 1 − b1,
    b1 > ½ curves to the left of the straight line.

    Args:
        b1: Parameter of cx, between 0 and 1.
        b2: Parameter of cy, between 0 and 1.

    Raises:
        ConfigError: A parameter is not a number between 0 and 1.
    """

    def __init__(self, b1: float, b2: float) -> None:
        self.b1 = check_number("b1", b1, 0.0, 1.0, "")
        self.b2 = check_number("b2", b2, 0.0, 1.0, "")
        self.curve(1)

    def curve(self, n: int) -> NDArray[np.float64]:
        """(cx, cy) at the times k T/n, k = 0 … n (n + 1, 2); T is the duration of the movement.

        Raises:
            ConfigError: n is not a whole number in [1, 1000000].
        """
        return _core.generator_curve(self.b1, self.b2, check_whole("n", n, 1, 1_000_000, "times"))


def place(start: ArrayLike, target: ArrayLike, curve: ArrayLike) -> NDArray[np.float64]:
    """A curve (n, 2) of a generator, moved, turned and scaled between two points (n, 2) (Eq. 6).

    Args:
        start: Where (0, 0) comes to lie (2,), in any unit of length.
        target: Where (1, 1) comes to lie (2,).
        curve: The curve.

    Raises:
        ConfigError: An argument has another shape, or is not made of finite numbers.
    """
    (x0, y0), (x1, y1) = (
        shaped(name, point, (2,), np.float64).tolist()
        for name, point in (("start", start), ("target", target))
    )
    points = numbers("curve", curve)
    if points.ndim != 2:
        raise ConfigError(f"curve has shape {points.shape}, expected (n, 2)")
    return _core.place_curve((x0, y0), (x1, y1), points)


def is_own(rule: Any) -> bool:
    """Whether a rule is a function of the user's own."""
    return callable(rule) and not isinstance(rule, type)


def rule_numbers(rule: Any) -> dict[str, Any]:
    """The name and numbers of a rule of the core, or the numbers that a function is given.

    Raises:
        ConfigError: There is no such rule, or a number of it is not finite.
    """
    if is_own(rule):
        return dict(json.loads(_core.rule_json()))
    if isinstance(rule, str) and rule in RULES:
        return dict(json.loads(_core.rule_json(rule)))
    if isinstance(rule, CovarianceRule | HebbRule | OjaRule | OutstarRule):
        return {"name": rule.name, **plain(asdict(rule), "rule")}
    raise ConfigError(
        f"rule = {shown(rule)} is not a function, a rule of gym_babble.brain, or one of "
        f"{', '.join(RULES)}"
    )


def teach(
    rule: OwnRule, numbers: dict[str, Any]
) -> Callable[[Floats, Floats, Floats, Floats, Floats], tuple[Floats, Floats, Floats]]:
    """A function that learns m movements, one after the other, by a rule of the user's own.

    It takes weights (n_out, n_in), averages ā (n_out,) and ḡ (n_in,), and activities g (m, n_in)
    and a (m, n_out); it returns the first three as they are after the movements.
    """
    eta, w_max = float(numbers["eta"]), float(numbers["w_max"])
    xi = np.float32(numbers["xi"])

    def learn(
        w: Floats, a_mean: Floats, g_mean: Floats, gs: Floats, as_: Floats
    ) -> tuple[Floats, Floats, Floats]:
        if len(gs) != len(as_) or gs.shape[1:] != g_mean.shape or as_.shape[1:] != a_mean.shape:
            raise ConfigError(
                f"activities have shapes {gs.shape} and {as_.shape}, "
                f"expected (m, {len(g_mean)}) and (m, {len(a_mean)})"
            )
        for g, a in zip(gs, as_, strict=True):
            for array in (w, a_mean, g_mean, g, a):
                array.setflags(write=False)  # A rule returns the change and makes none.
            change = np.asarray(rule(a, a_mean, g, g_mean, w, eta, w_max))
            _check_change(change, w)
            w = w + change.astype(np.float32)
            a_mean = xi * a_mean + (1 - xi) * a
            g_mean = xi * g_mean + (1 - xi) * g
        return w, a_mean, g_mean

    return learn


def _check_change(change: NDArray[Any], w: Floats) -> None:
    if change.shape != w.shape:
        raise ConfigError(f"rule: Δw has shape {change.shape}, expected {w.shape}")
    if change.dtype.kind not in "fiu":
        raise ConfigError(f"rule: Δw is made of {change.dtype}, expected numbers")
    if not np.isfinite(change).all():
        j, i = np.argwhere(~np.isfinite(change))[0]
        raise ConfigError(f"rule: Δw[{j}, {i}] = {change[j, i]} is not finite")


def _counts(neurons: Any, axes: int) -> list[int]:
    """Neurons along each axis."""
    given = neurons.tolist() if isinstance(neurons, np.ndarray) else neurons
    if isinstance(given, list | tuple):
        return [check_whole(f"neurons[{i}]", n, 2, 1024, "neurons") for i, n in enumerate(given)]
    return [check_whole("neurons", given, 2, 1024, "neurons")] * axes


def _axes(name: str, ends: Any) -> list[float]:
    """One end of each axis."""
    array = np.atleast_1d(numbers(name, ends))
    if array.ndim > 1:
        raise ConfigError(f"{name} has shape {array.shape}, expected (d,)")
    found: list[float] = array.tolist()
    return found


def _rows(name: str, values: Any, kind: Any) -> NDArray[Any]:
    """One row of numbers, or several, as rows (n, k)."""
    array = np.atleast_2d(numbers(name, values, kind))
    if array.ndim > 2:
        raise ConfigError(f"{name} has shape {array.shape}, expected (k,) or (n, k)")
    return np.ascontiguousarray(array)


def _each(
    function: Callable[[Any], NDArray[T]], name: str, values: Any, kind: Any, *, width: int = 1
) -> NDArray[T]:
    """Applies a function that takes a batch to one value or to a batch.

    Raises:
        ConfigError: The values are not finite numbers, or their results, `width` numbers each,
            would fill the memory.
    """
    rows = _rows(name, values, kind)
    if len(rows) * width > MOST_ACTIVITIES:
        raise ConfigError(
            f"{name} has {len(rows)} rows, at most {MOST_ACTIVITIES // width} at once"
        )
    found = function(rows)
    row: NDArray[T] = found if np.ndim(values) > 1 else found[0]
    return row
