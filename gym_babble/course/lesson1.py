"""Exercises of lesson 1: the environments and a random infant."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gym_babble.agents import babble
from gym_babble.course.answers import Function, Number
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.movements import held_out, success_rate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["EXERCISES"]

CURVES = (0.01, 0.3, 0.5, 0.72, 0.99)
"""Values of b1 that the exercise asks an action for."""


def _judge_action(actions: NDArray[np.float64]) -> Finding:
    b1 = np.array(CURVES)
    first, second = 2 * b1 - 1, 1 - 2 * b1
    if np.allclose(actions, np.transpose([first, second]), atol=1e-6):
        return right("An action of 0 is b = ½, and −1 … 1 is 0 … 1.")
    if np.allclose(actions, np.transpose([b1, 1 - b1]), atol=1e-6):
        return wrong(
            "You return (b1, b2) itself.",
            "The environment computes b = ½ + action/2. Solve for it.",
        )
    if np.allclose(actions[:, 0], first, atol=1e-6):
        return wrong("The first number is right, the second is not.", "b2 = 1 − b1.")
    if np.allclose(actions, np.transpose([second, first]), atol=1e-6):
        return wrong("The two numbers are in the wrong order.", "The action is for (b1, b2).")
    return wrong(
        f"For b1 = {b1[1]} you return {actions[1].round(3).tolist()}.",
        "The environment computes b = ½ + action/2. Which action gives b = ½? Which gives b = 1?",
    )


@cache
def _legal_share() -> float:
    return float(babble("BabbleReachPattern-v0", 5_000, seed=100).learnable.mean())


def _judge_share(share: float) -> Finding:
    truth = _legal_share()
    # 2,000 babbles: five standard errors.
    if abs(share - truth) <= 5 * np.sqrt(truth * (1 - truth) / 2_000):
        return right(f"Of 5,000 other babbles {truth:.3f} are legal. The paper says about 1 in 5.")
    if abs(share - 100 * truth) <= 5:
        return wrong("This is in per cent.", "Give a share between 0 and 1.")
    if abs(share - (1 - truth)) <= 0.05:
        return wrong("This is the share that fails.", "Which babbles can the infant learn from?")
    return wrong(
        f"A share of {share:.3g} is not what 2,000 babbles of any seed give.",
        "`babbles.learnable` has True for each legal babble. What is its mean?",
    )


Z = 1.96
"""Quantile of the normal distribution for an interval of 95 %."""
COUNTS = ((0, 10), (5, 10), (10, 10), (340, 1_000), (731, 1_000))
"""Successes and movements."""


def _wilson() -> NDArray[np.float64]:
    k, n = np.transpose(COUNTS).astype(float)
    p = k / n
    centre = (p + Z**2 / (2 * n)) / (1 + Z**2 / n)
    half = Z / (1 + Z**2 / n) * np.sqrt(p * (1 - p) / n + Z**2 / (4 * n**2))
    return np.transpose([centre - half, centre + half])


def _judge_interval(intervals: NDArray[np.float64]) -> Finding:
    k, n = np.transpose(COUNTS).astype(float)
    p, found = k / n, np.abs(intervals - _wilson()).max()
    error = np.sqrt(p * (1 - p) / n)
    if found <= 2e-3:
        return right("Your interval is Wilson's, also where all or none succeeded.")
    for width, name in ((Z, "p ± 1.96 standard errors"), (1, "p ± one standard error")):
        if np.allclose(intervals, np.transpose([p - width * error, p + width * error]), atol=2e-3):
            return wrong(
                f"This is {name}: after 0 of 10 it says that success is impossible.",
                "Use Wilson's formula, with its two terms in z².",
            )
    if np.allclose(intervals[:, ::-1], _wilson(), atol=2e-3):
        return wrong("The two ends are in the wrong order.", "Return the lower end first.")
    return wrong(
        f"For 5 of 10 you return {intervals[1].round(3).tolist()}.",
        f"Wilson's interval is {_wilson()[1].round(3).tolist()}. Check brackets and squares.",
    )


def _draw_intervals(intervals: NDArray[np.float64], axes: Axes) -> None:
    places = np.arange(len(COUNTS))
    for shift, values, colour, name in (
        (-0.12, intervals, "#1f6fb2", "yours"),
        (0.12, _wilson(), "#9aa5b1", "Wilson's"),
    ):
        axes.vlines(places + shift, values[:, 0], values[:, 1], color=colour, lw=4, label=name)
    axes.set_xticks(places, [f"{k} of {n}" for k, n in COUNTS])
    axes.set(ylabel="success rate", ylim=(-0.1, 1.1))
    axes.legend()


GRID = tuple(np.linspace(0.02, 0.98, 25).tolist())


@cache
def _rates() -> NDArray[np.float64]:
    """Success of each constant b1 of the grid on held-out cases."""
    return np.array([success_rate(held_out(300), (b1, 1 - b1)) for b1 in GRID])


def _judge_constant(b1: float) -> Finding:
    rate = success_rate(held_out(300), (b1, 1 - b1))
    left, right_hand = (_rates()[np.less(GRID, 0.5) == side].max() for side in (False, True))
    best = left if b1 > 0.5 else right_hand
    said = f"On 300 other cases b1 = {b1:.3g} succeeds in {rate:.2f}"
    if not 0 <= b1 <= 1:
        return wrong(f"{said}: it is cut to [.01, .99].", "b1 lies between 0 and 1.")
    if rate >= best - 0.06:  # Two standard errors of such a rate.
        return right(
            f"{said}. The best constants reach {left:.2f} to the left of the straight path "
            f"(b1 above ½) and {right_hand:.2f} to the right."
        )
    if abs(b1 - 0.5) <= 0.1:
        return wrong(f"{said}: the path is almost straight.", "What stands halfway to the target?")
    return wrong(f"{said}; others reach {best:.2f}.", "Try values on a grid.")


def _draw_constant(b1: float, axes: Axes) -> None:
    axes.plot(GRID, _rates(), color="#9aa5b1", label="all constants")
    axes.plot(
        [np.clip(b1, 0, 1)],
        [success_rate(held_out(300), (b1, 1 - b1))],
        "o",
        color="#1f6fb2",
        label="yours",
    )
    axes.set(xlabel="b1", ylabel="success rate", ylim=(0, 1), title="300 held-out cases")
    axes.legend()


def _judge_seeds(played: NDArray[np.float64]) -> Finding:
    first, again, other = played
    if not np.array_equal(first, again):
        return wrong(
            "Two calls with seed 3 end with the hand in two directions.",
            "The environment has the seed. Which random numbers does your function draw besides? "
            "`env.action_space` has a method `seed`, too.",
        )
    if np.array_equal(first, other):
        return wrong("Seeds 3 and 4 end alike.", "Give the seed to `env.reset`.")
    return right("The same seed gives the same episode to the last bit, and seed 4 another one.")


EXERCISES = (
    Exercise(
        id="1.1",
        asks="a function of b1 that returns the action for (b1, 1 − b1)",
        answer=Function(inputs=lambda: [(b1,) for b1 in CURVES], shape=(2,)),
        judge=_judge_action,
    ),
    Exercise(
        id="1.2",
        asks="the share of legal babbles among 2,000",
        answer=Number(),
        judge=_judge_share,
    ),
    Exercise(
        id="1.3",
        asks="a function of successes and movements that returns the ends of Wilson's interval",
        answer=Function(inputs=lambda: list(COUNTS), shape=(2,)),
        judge=_judge_interval,
        draw=_draw_intervals,
    ),
    Exercise(
        id="1.4",
        asks="the constant b1 that succeeds in most cases",
        answer=Number(),
        judge=_judge_constant,
        draw=_draw_constant,
    ),
    Exercise(
        id="1.5",
        asks="a function of a seed that plays 20 random steps and returns the last `hand`",
        answer=Function(inputs=lambda: [(3,), (3,), (4,)], shape=(2,)),
        judge=_judge_seeds,
    ),
)
