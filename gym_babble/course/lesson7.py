"""Exercises of lesson 7: PPO, and a fair comparison."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.course.answers import Function, Number, Numbers
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake
from gym_babble.course.published import published
from gym_babble.study.outcomes import wilson
from gym_babble.viz.style import FAINT, LEFT, RIGHT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["EXERCISES"]

CASES = 1_000
"""Test cases of each seed of the published study."""


def _batch() -> list[tuple[float, float, float]]:
    """Ratios, advantages and ε of 40 trials."""
    rng = np.random.default_rng(7)
    rows = rng.uniform((0.4, -1, 0.1), (1.6, 1, 0.3), (40, 3))
    return [(ratio, advantage, epsilon) for ratio, advantage, epsilon in rows.tolist()]


def _objective(ratio: Any, advantage: Any, epsilon: Any) -> Any:
    return np.minimum(ratio * advantage, _clipped(ratio, advantage, epsilon))


def _clipped(ratio: Any, advantage: Any, epsilon: Any) -> Any:
    return np.clip(ratio, 1 - epsilon, 1 + epsilon) * advantage


def _judge_objective(values: Floats) -> Finding:
    ratio, advantage, epsilon = np.transpose(_batch())
    plain, clipped = ratio * advantage, _clipped(ratio, advantage, epsilon)
    expected = _objective(ratio, advantage, epsilon)
    if np.allclose(values, expected, atol=1e-6):
        return right("In 40 trials your L is PPO's objective.")
    mistakes = (
        (plain, "The clip is missing.", "L is the smaller of two products."),
        (clipped, "The minimum is missing.", "L is the smaller of two products."),
        (np.maximum(plain, clipped), "This is the greater of the two.", "PPO takes the smaller."),
        (-expected, "The sign is that of a loss.", "PPO maximises L: keep the sign of r A."),
        (
            np.minimum(ratio, np.clip(ratio, 1 - epsilon, 1 + epsilon)) * advantage,
            "The minimum is taken before the product.",
            "For a negative advantage this is another number: multiply first.",
        ),
    )
    return usual_mistake(values, mistakes, within=1e-6) or wrong(
        f"Your L is off by up to {np.abs(values - expected).max():.2g}.",
        "`np.clip(ratio, 1 - epsilon, 1 + epsilon)` cuts r; `np.minimum` takes the smaller.",
    )


@cache
def _babbled() -> tuple[int, int, int]:
    """Movements learnt from and made, and control steps, of 2,000 legal movements."""
    agent = HebbBabbling("BabbleReachPattern-v0", seed=0, threads=1).learn(2_000)
    return agent.learnt, agent.babbled, agent.control_steps


def _judge_steps(steps: float) -> Finding:
    learnt, babbled, control_steps = _babbled()
    if abs(steps - control_steps) < 1:
        return right(
            f"{babbled:,} movements were made for {learnt:,} that could be learnt from: "
            f"{control_steps:,} control steps."
        )
    each = control_steps // babbled
    mistakes = (
        (
            each * learnt,
            "Only legal movements are counted.",
            "A movement that hit the obstacle took its time, too.",
        ),
        (babbled, "This is the number of movements.", f"Each takes {each} control steps."),
        (learnt, "This is the number of legal movements.", "Count all, and in control steps."),
        (control_steps * 0.05, "These are seconds.", "Give control steps."),
    )
    return usual_mistake(steps, mistakes, within=0.5) or wrong(
        f"It is not {steps:,.0f}.", f"All movements made, times {each} control steps."
    )


CLAIMS = (
    (0, "They do not see the same: `hebb-paper` is not told where the target is."),
    (1, "Same cases, same input, same budget."),
    (0, "20,000 are the legal movements alone. It made about five times as many."),
    (1, "Same input, same budget, and failures count."),
    (0, "The best seed of one is compared with the worst seed of the other."),
    (0, "The settings were chosen on the test cases. Choose on other cases, and equally hard."),
    (1, "One thing differs, so the difference is due to it (five seeds give its interval)."),
)
"""For each conclusion of exercise 7.3 whether it is fair, and why."""


def _judge_claims(fair: Floats) -> Finding:
    if not np.isin(fair, (0, 1)).all():
        return wrong("Not all numbers are 0 or 1.", "1 is fair, and 0 is not.")
    wanted = np.array([one for one, _ in CLAIMS])
    if not (off := np.flatnonzero(fair != wanted)).size:
        return right("You would be a strict reviewer.")
    if off.size == len(CLAIMS):
        return wrong("All seven are the other way round.", "1 is fair, and 0 is not.")
    first = int(off[0])
    return wrong(
        f"Not right: {off.size} of 7. Look at number {first + 1}.",
        "Ask for each: same cases? same input? all movements counted? seeds not chosen? settings "
        "not chosen on the test cases? one difference only?"
        if off.size > 1
        else CLAIMS[first][1],
    )


def _scores() -> Floats:
    return published("reach")["td3"].success


@cache
def _bootstrap() -> tuple[float, float]:
    scores = _scores()
    draws = np.random.default_rng(1).choice(scores, (100_000, len(scores)))
    low, high = np.quantile(draws.mean(axis=1), [0.025, 0.975]).tolist()
    return low, high


def _judge_interval(interval: Floats) -> Finding:
    scores, expected = _scores(), np.array(_bootstrap())
    if np.allclose(interval, expected, rtol=0, atol=0.02):
        return right(
            f"From {interval[0]:.2f} to {interval[1]:.2f}: five seeds say little about an "
            "algorithm that either succeeds or does not."
        )
    mean, n = scores.mean(), len(scores)
    half = 1.96 * scores.std(ddof=1) / np.sqrt(n)
    mistakes = (
        (expected[::-1], "The ends are exchanged.", "Give (low, high)."),
        (
            wilson(round(mean * CASES * n), CASES * n),
            "This is an interval over cases.",
            "Cases of one seed share its agent. Draw seeds, not cases.",
        ),
        (
            (mean - half, mean + half),
            "This supposes that seeds are normally distributed.",
            "They are not: some succeed and some do not. Draw seeds with replacement.",
        ),
        (np.quantile(scores, [0.025, 0.975]), "This is where seeds lie.", "Take means of draws."),
        ((scores.min(), scores.max()), "This is the range of the seeds.", "Take means of draws."),
    )
    return usual_mistake(interval, mistakes, within=0.012) or wrong(
        f"The interval is not {interval[0]:.3f} to {interval[1]:.3f}.",
        "`rng.choice(scores, (10_000, len(scores)))` draws with replacement. Take the mean of each "
        "row, and of these the quantiles 0.025 and 0.975.",
    )


def _draw_interval(interval: Floats, axes: Axes) -> None:
    axes.plot(_scores(), np.zeros(len(_scores())), "o", color=FAINT, label="seeds")
    axes.plot(interval, [1, 1], "-", lw=3, color=LEFT, label="yours")
    axes.plot(_bootstrap(), [2, 2], "-", lw=3, color=RIGHT, label="over seeds")
    axes.set(xlabel="success", yticks=[], ylim=(-1, 4.5))
    axes.legend(loc="upper left", ncols=3)


def _judge_ratio(ratio: float) -> Finding:
    steps = {name: agent.steps_to(0.9) for name, agent in published("reach").items()}
    ppo, hebb = steps["ppo-eye-obstacle"], steps["hebb-conjunctive"]
    expected = float(np.median(ppo) / np.median(hebb))
    if abs(ratio - expected) <= 0.1:
        return right(
            f"The median seeds need {np.median(ppo):,.0f} and {np.median(hebb):,.0f} steps."
        )
    mistakes = (
        (1 / expected, "This is Hebb over PPO.", "PPO's steps over those of the Hebb agent."),
        (np.median(ppo) - np.median(hebb), "This is a difference.", "Divide."),
        (np.mean(ppo) / np.mean(hebb), "These are means.", "Take the median seed of each."),
        (np.min(ppo) / np.min(hebb), "These are the best seeds.", "Take the median seed of each."),
        (
            np.median(steps["sac"]) / np.median(hebb),
            "This is SAC.",
            "Take `ppo-eye-obstacle`, which sees the same as the Hebb agent.",
        ),
    )
    return usual_mistake(ratio, mistakes, within=0.02) or wrong(
        f"It is not {ratio:.3g}.", "`np.median(reach[name].steps_to(0.9))`, of both agents."
    )


EXERCISES = (
    Exercise(
        id="7.1",
        asks="a function of ratio, advantage and epsilon that returns PPO's clipped objective",
        answer=Function(inputs=_batch),
        judge=_judge_objective,
    ),
    Exercise(
        id="7.2",
        asks="the control steps of all movements that were made for 2,000 legal ones",
        answer=Number(high=1e9),
        judge=_judge_steps,
    ),
    Exercise(
        id="7.3",
        asks="a list of 7 numbers: 1 for each fair conclusion, 0 for the others",
        answer=Numbers(shape=(7,)),
        judge=_judge_claims,
    ),
    Exercise(
        id="7.4",
        asks="the 95 % bootstrap interval (low, high) of the mean success of td3 over seeds",
        answer=Numbers(shape=(2,)),
        judge=_judge_interval,
        draw=_draw_interval,
    ),
    Exercise(
        id="7.5",
        asks="steps to .90 of ppo-eye-obstacle over those of hebb-conjunctive, median seeds",
        answer=Number(high=1e9),
        judge=_judge_ratio,
    ),
)
