"""Exercises of lesson 6: grasping."""

from __future__ import annotations

import json
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.config import Config
from gym_babble.course.answers import Function, Number
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake
from gym_babble.course.palm import approach, forearm_frame
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

GRASP = "BabbleGrasp-v0"
SMALL_M = 0.024
BIG, SMALL = "6 cm", "2.4 cm"
PLACES_CM = np.arange(24, 40) / 10
OUT, IN = 4, 3
"""Neurons of the small maps on which a rule is tried."""
SHARE = 0.002
"""How far a share of tests may be off."""


@cache
def _held_at() -> Floats:
    """Share of small balls held at each of the places."""
    return approach(SMALL_M, PLACES_CM)


def _judge_edge(wrist_cm: float) -> Finding:
    edge = float(PLACES_CM[np.flatnonzero(_held_at() < 1)[-1] + 1])
    if abs(wrist_cm - edge) < 0.06:
        return right(f"From {edge:.1f} cm on every small ball is held: a millimetre decides.")
    if abs(100 * wrist_cm - edge) < 0.06 or abs(wrist_cm / 10 - edge) < 0.06:
        return wrong("The number fits another unit.", "Give the distance in cm.")
    if wrist_cm < edge:
        return wrong(
            f"At {wrist_cm:g} cm from the wrist not all small balls are held.", "Go further out."
        )
    return wrong(
        f"They are held nearer than {wrist_cm:g} cm, too.",
        "Try every tenth of a centimetre below: `approach(SMALL, np.arange(2.5, 4, 0.1))`.",
    )


def _draw_edge(wrist_cm: float, axes: Axes) -> None:
    axes.plot(PLACES_CM, _held_at(), "o-", color=LEFT, ms=4)
    axes.axvline(wrist_cm, color=RIGHT, ls=":")
    axes.set(
        xlabel="distance from the wrist [cm] (dotted: yours)", ylabel="share of small balls held"
    )


@cache
def _table2() -> Evaluation:
    """The paper's agent after 100 babbles, in every third test of Table II."""
    agent = HebbBabbling(GRASP, seed=0, threads=1).learn(100)
    cases = scenarios("table2")[::3]
    return evaluate(agent, cases=cases, max_episode_steps=240, threads=1)


def _judge_held_of_touched(share: float) -> Finding:
    result = _table2()
    big = result.by_size()[BIG]
    held, touched, reached = (big.count(name) for name in ("held", "palm_reach", "reach"))
    expected = held / touched
    if abs(share - expected) <= SHARE:
        return right(
            f"{held} of {touched}. From these starts the palm often touches a ball that another "
            "part of the hand has pushed away before."
        )
    mistakes = (
        (100 * expected, "This is the share in per cent.", "Give a share between 0 and 1."),
        (1 / expected, "This is the number touched for each held.", "Held over touched."),
        (big.rate("held"), "This is the share of all tests.", "Divide by those that it touched."),
        (
            held / reached,
            "This is the share of those that any part touched.",
            'Divide by `count("palm_reach")`.',
        ),
        (result.rate("held"), "Balls of both sizes are in this.", "Take those of 6 cm."),
    )
    return usual_mistake(share, mistakes, within=SHARE) or wrong(
        f"The share is not {share:.3f}.",
        'With `big = result.by_size()["6 cm"]` it is `big.count("held")` over '
        '`big.count("palm_reach")`. Run the cell before, which makes `result` from `table2`.',
    )


def _postures() -> list[tuple[Any, ...]]:
    """Arms, balls and radii of 20 tests."""
    rng = np.random.default_rng(6)
    arms = rng.uniform((-1, 0.2), (2, 2), (20, 2))
    balls = rng.uniform(-0.3, 0.3, (20, 2))
    return [*zip(arms, balls, rng.uniform(0.01, 0.04, 20).tolist(), strict=True)]


def _judge_gap(gaps: Floats) -> Finding:
    arms, balls, radii = (np.array(part) for part in zip(*_postures(), strict=True))
    along, beside = forearm_frame(arms, balls)
    width = Config().body.arm.half_width_m
    upper = np.stack([arms[:, 0], np.zeros(20)], axis=1)
    mistakes = (
        (beside - width, "The radius of the ball is missing.", "Measure to its surface."),
        (beside - radii, "The half-width of the palm is missing.", "Measure from its surface."),
        (beside, "This is the distance of the centres.", "Subtract half-width and radius."),
        (width + radii - beside, "The sign is wrong.", "Positive if the ball is before the palm."),
        (100 * (beside - width - radii), "The gap is in cm.", "Give it in metres."),
        (beside - width - 2 * radii, "The diameter is subtracted.", "Subtract the radius."),
        (
            along - width - radii,
            "This is the distance along the forearm.",
            "The palm faces across it: (−sin, cos) of the forearm's direction.",
        ),
        (
            forearm_frame(upper, balls)[1] - width - radii,
            "The hand points along the upper arm.",
            "The forearm's direction is shoulder + elbow.",
        ),
    )
    expected = beside - width - radii
    if np.allclose(gaps, expected, atol=1e-5):
        return right("In 20 random postures your gap is right.")
    return usual_mistake(gaps, mistakes, within=1e-5) or wrong(
        f"Your gap is off by up to {100 * np.abs(gaps - expected).max():.1f} cm.",
        "Place of the elbow: 0.15 (cos, sin) of the shoulder. The palm faces (−sin, cos) of the "
        "forearm. Project ball − elbow on that, and subtract half-width and radius.",
    )


def _steps() -> list[tuple[Any, ...]]:
    """Weights, use and activities of 20 steps of the outstar."""
    rng = np.random.default_rng(7)
    shapes = ((OUT, IN), (IN,), (IN,), (OUT,))
    return [tuple(rng.uniform(0.05, 1, shape) for shape in shapes) for _ in range(20)]


def _outstar(w: Any, u: Any, g: Any, a: Any) -> Any:
    return w + g / (u + g) * (a[:, None] - w)


MISTAKES = (
    (
        lambda w, u, g, a: w + g / u * (a[:, None] - w),
        "The use is that before the step.",
        "u counts the activity of this step, too: divide by u + g.",
    ),
    (
        lambda w, u, g, a: _outstar(w, u, g, a) - w,
        "Your function returns the change alone.",
        "Return the weights after the step, w + Δw.",
    ),
    (
        lambda w, _u, g, a: w + g * (a[:, None] - w),
        "The use is missing: every step counts as if it were the first.",
        "Divide g by the sum of all its activities so far.",
    ),
    (
        lambda w, u, g, a: w + g / (u + g) * a[:, None],
        "The weights only grow.",
        "The last factor is a_j − w_ji.",
    ),
)
"""Usual wrong steps, what is wrong with them, and a hint."""


def _judge_outstar(weights: Floats) -> Finding:
    def results(step: Any) -> Floats:
        return np.stack([step(*arguments) for arguments in _steps()])

    expected = results(_outstar)
    if np.allclose(weights, expected, atol=1e-6):
        return right("In 20 steps your weights are those of the outstar: running means.")
    mistakes = ((results(step), text, hint) for step, text, hint in MISTAKES)
    return usual_mistake(weights, mistakes, within=1e-6) or wrong(
        f"Your weights are off by up to {np.abs(weights - expected).max():.2g}.",
        "w has a row for each output: `a[:, None] - w` is a_j − w_ji, and `g / (u + g)` the share "
        "of each input.",
    )


PARTS = {"reflex", "advance", "targets", "sizes", "squeeze_deg", "babble"}
"""Options of the chain that exercise 6.5 may change."""


@lru_cache(maxsize=8)
def _without(text: str) -> dict[str, float]:
    """Shares held of each size, by the chain after 100 babbles with this brain."""
    agent = HebbBabbling(GRASP, variant="chain", seed=0, brain=json.loads(text), threads=1)
    result = evaluate(agent.learn(100), cases=scenarios("palm_side", 60), threads=1)
    return {size: of_size.rate("held") for size, of_size in result.by_size().items()}


def _judge_part(text: str) -> Finding:
    brain = json.loads(text)
    if odd := brain.keys() - PARTS:
        return wrong(
            f"{', '.join(map(repr, sorted(odd)))} is in no row of the table.",
            "Take an option of the table.",
        )
    if brain.get("sizes", 1) not in [1, 2, 3]:
        return wrong("The table leaves sizes out.", "With `sizes` 1 the eye alone is the input.")
    try:
        held = _without(text)
    except BabbleError as error:
        return wrong(f"No agent has such a brain: {error}.", "Copy a row of the table.")
    said = f"So it holds {held[SMALL]:.2f} of the small balls and {held[BIG]:.2f} of the big ones"
    if held[SMALL] < 0.1 and held[BIG] > 0.9:
        return right(
            f"{said}. The recalled hand lies between those of both sizes: too open for a small "
            "ball, while a big one is in its way and is pressed all the same."
        )
    return wrong(
        f"{said}.",
        "What must a hand do, beside being in the right posture, to carry a ball without support?",
    )


def _draw_part(text: str, axes: Axes) -> None:
    try:
        held = _without(text)
    except BabbleError:
        return
    axes.bar(list(held), list(held.values()), color=(LEFT, RIGHT), width=0.5)
    axes.axhline(0.1, color=FAINT, ls=":")
    axes.axhline(0.9, color=FAINT, ls=":")
    axes.set(ylim=(0, 1.05), ylabel="share held", xlabel="diameter")


EXERCISES = (
    Exercise(
        id="6.1",
        asks="the smallest distance from the wrist [cm] at which small balls are always held",
        answer=Number(unit="cm"),
        judge=_judge_edge,
        draw=_draw_edge,
    ),
    Exercise(
        id="6.2",
        asks="the share of big balls that are held, of those that the palm touched",
        answer=Number(),
        judge=_judge_held_of_touched,
    ),
    Exercise(
        id="6.3",
        asks="a function of arm, ball and radius that returns the gap from palm to ball [m]",
        answer=Function(inputs=_postures),
        judge=_judge_gap,
    ),
    Exercise(
        id="6.4",
        asks="a function of w, u, g and a that returns the weights after one step of the outstar",
        answer=Function(inputs=_steps, shape=(OUT, IN)),
        judge=_judge_outstar,
    ),
    Exercise(
        id="6.5",
        asks="a dict for `brain` without which small balls fall and big ones are held",
        answer=Settings(),
        judge=_judge_part,
        draw=_draw_part,
    ),
)
