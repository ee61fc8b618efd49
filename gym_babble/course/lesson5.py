"""Exercises of lesson 5: the Hebb rule and Table I."""

from __future__ import annotations

import json
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.course.answers import Function, Number, Numbers
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake
from gym_babble.course.settings import Settings
from gym_babble.errors import BabbleError
from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.style import FAINT, LEFT, RIGHT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from gym_babble.study.outcomes import Evaluation

    Floats = NDArray[np.float64]

__all__ = ["EXERCISES"]

REACH = "BabbleReachPattern-v0"
OUT, IN = 4, 3
"""Neurons of the small maps on which a rule is tried."""
SHARE = 0.002
"""How far a share of cases may be off."""


def _steps() -> list[tuple[Any, ...]]:
    """Activities, means, weights and numbers for 20 steps of a rule."""
    rng = np.random.default_rng(5)
    return [
        (
            *(rng.uniform(0, 1, n).astype(np.float32) for n in (OUT, OUT, IN, IN)),
            rng.uniform(-0.2, 0.2, (OUT, IN)).astype(np.float32),
            float(eta),
            float(w_max),
        )
        for eta, w_max in rng.uniform((0.1, 0.2), (1, 0.4), (20, 2))
    ]


def _each(rule: Any) -> Floats:
    """Changes (20, outputs, inputs) by a rule."""
    return np.stack([rule(*step) for step in _steps()])


def _eq7(  # noqa: PLR0917 - a rule's arguments
    a: Any, a_mean: Any, g: Any, g_mean: Any, w: Any, eta: float, w_max: float
) -> Any:
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


MISTAKES = (
    (
        lambda a, _m, g, _n, w, eta, w_max: eta * np.outer(a, g) * (w_max - abs(w)),
        "This is plain Hebb: the means are missing.",
        "Take each activity minus its mean.",
    ),
    (
        lambda a, m, g, n, w, eta, w_max: eta * np.outer(a - m, g - n) * (w_max - w),
        "Negative weights have no bound.",
        "The bound holds for the size of the weight, |w|: `abs(w)`.",
    ),
    (
        lambda a, m, g, n, _w, eta, _w_max: eta * np.outer(a - m, g - n),
        "The weights have no bound.",
        "The last factor of Eq. 7 is (w_max − |w|).",
    ),
    (
        lambda a, m, g, n, w, _eta, w_max: np.outer(a - m, g - n) * (w_max - abs(w)),
        "The learning rate is missing.",
        "Eq. 7 begins with η.",
    ),
    (
        lambda a, m, g, n, w, eta, w_max: w + eta * np.outer(a - m, g - n) * (w_max - abs(w)),
        "Your function returns the new weights.",
        "Return the change Δw alone; the learner adds it.",
    ),
    (
        lambda a, m, g, _n, w, eta, w_max: eta * np.outer(a - m, g) * (w_max - abs(w)),
        "The mean of the input is missing.",
        "Both activities are compared with their means.",
    ),
    (
        lambda a, _m, g, n, w, eta, w_max: eta * np.outer(a, g - n) * (w_max - abs(w)),
        "The mean of the output is missing.",
        "Both activities are compared with their means.",
    ),
)
"""Usual wrong rules, what is wrong with them, and a hint."""


def _judge_rule(changes: Floats) -> Finding:
    expected = _each(_eq7)
    if np.allclose(changes, expected, atol=1e-5):
        return right("In 20 steps with random activities and weights your Δw is that of Eq. 7.")
    sign = (-expected, "The sign is wrong.", "Two neurons above their means are connected: Δw > 0.")
    mistakes = [*((_each(rule), text, hint) for rule, text, hint in MISTAKES), sign]
    return usual_mistake(changes, mistakes, within=1e-5) or wrong(
        f"Your Δw is off by up to {np.abs(changes - expected).max():.2g}.",
        "Row j, column i of Δw is η (a_j − ā_j)(g_i − ḡ_i)(w_max − |w_ji|): `np.outer(x, y)` has "
        "x_j y_i there.",
    )


@cache
def _learnt(rule: str) -> HebbBabbling:
    """An agent after 2,000 legal movements."""
    return HebbBabbling(REACH, rule=rule, seed=0, threads=1).learn(2_000)


@cache
def _tested(rule: str) -> Evaluation:
    return evaluate(_learnt(rule), cases=scenarios("table1", 1_000), threads=1)


@cache
def _chosen(rule: str) -> Floats:
    """b1 that an agent chooses in the 1,000 cases."""
    cases = scenarios("table1", 1_000)
    envs = gym.make_vec(REACH, len(cases), threads=1)
    observation, _ = envs.reset(seed=0, options={"scenario": cases})
    envs.close()
    b1: Floats = _learnt(rule).decide(observation)[:, 0]
    return b1


def _judge_rate(share: float) -> Finding:
    hebb, eq7 = (_tested(rule).rate("success") for rule in ("hebb", "covariance"))
    if abs(share - hebb) <= SHARE:
        return right(
            f"Plain Hebb solves {hebb:.3f} of the cases, Eq. 7 {eq7:.3f}. After fewer movements "
            "plain Hebb is better: it gets worse as it learns."
        )
    collisions = _tested("hebb").rate("collision")
    mistakes = (
        (100 * hebb, "This is the share in per cent.", "Give a share between 0 and 1."),
        (1_000 * hebb, "This is the number of cases.", "Divide by the number of cases."),
        (eq7, "This is the share of Eq. 7.", 'Test `agents["plain Hebb"]`.'),
        (collisions, "This is the share of collisions.", 'Ask for `rate("success")`.'),
    )
    return usual_mistake(share, mistakes, within=SHARE) or wrong(
        f"The share is not {share:.3f}.",
        'Use all 1,000 `cases`, and `agents["plain Hebb"]` after 2,000 legal movements: '
        '`gym_babble.evaluate(agent, cases=cases).rate("success")`.',
    )


def _judge_straight(share: float) -> Finding:
    hebb, eq7 = (_chosen(rule) for rule in ("hebb", "covariance"))
    straight, others = (float(np.mean(np.abs(b1 - 0.5) < 0.1)) for b1 in (hebb, eq7))
    if abs(share - straight) <= SHARE:
        return right(
            f"Plain Hebb moves nearly straight in {straight:.2f} of the cases, Eq. 7 in "
            f"{others:.2f}. The obstacle stands halfway."
        )
    mistakes = (
        (1 - straight, "This is the share of curved movements.", "Straight: |b1 − ½| < 0.1."),
        (others, "This is the share of Eq. 7.", 'Take `b1["plain Hebb"]`.'),
        (
            np.mean(hebb - 0.5 < 0.1),
            "All movements to the right are in it, too.",
            "Take the size: `abs(b1 - 0.5)`.",
        ),
    )
    return usual_mistake(share, mistakes, within=SHARE) or wrong(
        f"The share is not {share:.3f}.",
        "Count the cases with |b1 − ½| < 0.1, and divide by the number of cases. The mean of truth "
        "values is the share that is true.",
    )


def _draw_straight(_share: float, axes: Axes) -> None:
    for rule, colour, name in (("hebb", RIGHT, "plain Hebb"), ("covariance", LEFT, "Eq. 7")):
        axes.hist(
            _chosen(rule), np.linspace(0, 1, 41).tolist(), histtype="step", color=colour, label=name
        )
    axes.axvspan(0.4, 0.6, color=FAINT, alpha=0.3, lw=0)
    axes.set(xlabel="b1 (grey: nearly straight)", ylabel="cases")
    axes.legend()


FREE = {"readout", "peak_radius", "sigma", "obstacle_field_deg", "input_gain"}
"""Numbers of the brain that exercise 5.4 may change, beside those of the rule."""


@lru_cache(maxsize=8)
def _with_brain(text: str) -> Evaluation:
    agent = HebbBabbling(REACH, rule="hebb", seed=0, brain=json.loads(text), threads=1)
    return evaluate(agent.learn(2_000), cases=scenarios("table1", 500), threads=1)


def _judge_brain(text: str) -> Finding:
    brain = json.loads(text)
    rule = brain.get("rule", {})
    if "rule" in brain and not (isinstance(rule, dict) and rule.keys() <= {"eta", "w_max", "xi"}):
        return wrong("The rule must stay plain Hebb.", "Change how the map is read out.")
    if odd := brain.keys() - FREE - {"rule"}:
        return wrong(
            f"{', '.join(map(repr, sorted(odd)))}: this exercise leaves that as it is.",
            f"Change one of {', '.join(sorted(FREE))}.",
        )
    try:
        result = _with_brain(text)
    except BabbleError as error:
        return wrong(f"No agent has such a brain: {error}.", "All numbers are in `agent.brain`.")
    success = result.rate("success")
    if success >= 0.6:
        return right(
            f"So plain Hebb solves {success:.2f} of 500 cases. What it learnt was there before."
        )
    return wrong(
        f"So plain Hebb solves {success:.2f} of 500 cases.",
        "The mean over the whole map lies between two hills. Which read-out chooses one of them?",
    )


def _draw_brain(text: str, axes: Axes) -> None:
    try:
        result = _with_brain(text)
    except BabbleError:
        return
    names = ("Eq. 4", "yours")
    rates = (_tested("hebb").rate("success"), result.rate("success"))
    axes.barh(names, rates, color=(FAINT, LEFT))
    axes.axvline(0.6, color=RIGHT, ls=":")
    axes.set(xlim=(0, 1), xlabel="success of plain Hebb (dotted: asked for)")
    axes.invert_yaxis()


AXIS = np.linspace(0, 1, 21)
B1, B2 = np.tile(AXIS, 21), np.repeat(AXIS, 21)


def _read_out(activity: Floats, preferred: Floats) -> Floats:
    """Eq. 4 for activities (outputs, n): what is read out (n,), ½ where nothing is active."""
    total = activity.sum(axis=0)
    known: Floats = np.where(total != 0, preferred @ activity / np.where(total, total, 1), 0.5)
    return known


def _judge_read_out(b1: Floats) -> Finding:
    weights = _learnt("covariance").weights["weights"].astype(float)
    active = np.maximum(np.tanh(weights), 0)
    counts = active.sum(axis=0) > 1e-3  # Elsewhere rounding decides.
    expected = _read_out(active, B1)

    if np.allclose(b1[counts], expected[counts], atol=5e-3):
        left = int((expected[counts] > 0.5).sum())
        return right(f"{left} of {counts.sum()} input neurons that have learnt favour the left.")
    nearly = ("This is nearly Eq. 4.", "It has a tanh, and takes the mean over all output neurons.")
    transposed = np.maximum(np.tanh(weights.T), 0)
    mistakes = (
        (_read_out(active, B2), "This is b2.", "Use the preferred values `B1`."),
        (
            _read_out(transposed, B1),
            "These are the weights to each output neuron.",
            "The weights of input neuron i are the column `W[:, i]`.",
        ),
        (
            _read_out(np.tanh(weights), B1),
            "Negative activities count.",
            "Eq. 4 cuts them: max(tanh(…), 0).",
        ),
        (_read_out(np.maximum(weights, 0), B1), *nearly),
        (B1[active.argmax(axis=0)], *nearly),
    )
    of_taught = ((value[counts], text, hint) for value, text, hint in mistakes)
    off = np.mean(np.abs(b1 - expected)[counts] > 5e-3)
    return usual_mistake(b1[counts], of_taught, within=5e-3) or wrong(
        f"In {off:.0%} of the neurons that have learnt b1 is another.",
        "First a_j = max(tanh(w_ji), 0) for all j and i, then b1 = Σ y_j a_j / Σ a_j over j.",
    )


def _draw_read_out(b1: Floats, axes: Axes) -> None:
    picture = axes.imshow(
        b1.reshape(21, 21), origin="lower", extent=(-60, 60, -60, 60), cmap="RdBu", vmin=0, vmax=1
    )
    axes.set(xlabel="azimuth of the obstacle [°]", ylabel="elevation [°]", title="your b1")
    axes.figure.colorbar(picture, ax=axes)


EYE = np.array([0.0, 0.1, 0.25])


@lru_cache(maxsize=8)
def _with_eye(position: tuple[float, ...]) -> Evaluation:
    config = {"profile": "paper", "body": {"eye": {"position_m": list(position)}}}
    agent = HebbBabbling(gym.make(REACH, config=config), seed=0, threads=1).learn(1_000)
    return evaluate(agent, cases=scenarios("table1", 300, config=config), threads=1)


def _judge_eye(position: Floats) -> Finding:
    if np.abs(position - EYE).max() > 0.5 + 1e-9:
        return wrong(
            "The eye is too far away.", "At most 0.5 m from where it was, in each direction."
        )
    try:
        success = _with_eye(tuple(position.tolist())).rate("success")
    except BabbleError as error:
        return wrong(
            f"From there the arm cannot be watched: {error}.", "Leave the eye above the arm: z > 0."
        )
    if success >= 0.8:
        return right(f"From there the same rule solves {success:.2f} of 300 cases.")
    return wrong(
        f"From there the rule solves {success:.2f} of 300 cases.",
        "Straight below the eye the image has no direction that points away from the body. Let the "
        "eye look at the arm from the side of the body.",
    )


def _draw_eye(position: Floats, axes: Axes) -> None:
    turn = np.linspace(0, 2 * np.pi, 100)
    axes.fill(0.396 * np.cos(turn), 0.396 * np.sin(turn), color=FAINT, alpha=0.2, label="reach")
    axes.plot(0, 0, "s", color=FAINT, label="shoulder")
    axes.plot(*EYE[:2], "o", mfc="none", color=LEFT, label="eye, before")
    axes.plot(*position[:2], "o", color=LEFT, label="eye, yours")
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))


EXERCISES = (
    Exercise(
        id="5.1",
        asks="a function of a, a_mean, g, g_mean, w, eta and w_max that returns Δw by Eq. 7",
        answer=Function(inputs=_steps, shape=(OUT, IN)),
        judge=_judge_rule,
    ),
    Exercise(
        id="5.2",
        asks="the share of the 1,000 cases that plain Hebb solves after 2,000 legal movements",
        answer=Number(),
        judge=_judge_rate,
    ),
    Exercise(
        id="5.3",
        asks="the share of the 1,000 cases in which plain Hebb chooses |b1 − ½| < 0.1",
        answer=Number(),
        judge=_judge_straight,
        draw=_draw_straight,
    ),
    Exercise(
        id="5.4",
        asks="a dict for `brain` with which plain Hebb solves at least 60 % of the cases",
        answer=Settings(),
        judge=_judge_brain,
        draw=_draw_brain,
    ),
    Exercise(
        id="5.5",
        asks="b1 that Eq. 4 reads out if one input neuron alone is active, for each of them (441,)",
        answer=Numbers(shape=(441,)),
        judge=_judge_read_out,
        draw=_draw_read_out,
    ),
    Exercise(
        id="5.6",
        asks="a position (x, y, z) [m] of the eye from which Eq. 7 solves at least 80 %",
        answer=Numbers(shape=(3,), unit="m"),
        judge=_judge_eye,
        draw=_draw_eye,
    ),
)
