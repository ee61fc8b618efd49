"""Exercises of lesson 4: pattern generators."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.brain import TimeBaseGenerator, place
from gym_babble.course.answers import Function, Number, Numbers
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake
from gym_babble.envs import BabbleReachEnv
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

__all__ = ["EXERCISES"]

FAINT, STRONG, RED = "#9aa5b1", "#1f6fb2", "#b42318"
STATES = ((0.1, 0.2, 0.7, 0.3, 1.0), (0.5, 0.5, 0.3, 0.7, 0.4), (0.9, 0.4, 0.6, 0.2, 2.0))
"""c_x, c_y, b1, b2, gamma."""


def _judge_rate(rates: NDArray[np.float64]) -> Finding:
    x, y, b1, b2, gamma = np.transpose(STATES)
    along = gamma * x**b1 * (1 - x) ** b2
    there = np.transpose([along, gamma * y**b2 * (1 - y) ** b1])
    if np.allclose(rates, there, atol=1e-4):
        return right("Your speeds are those of Eq. 5.")
    mistakes = (
        (
            np.transpose([along, gamma * y**b1 * (1 - y) ** b2]),
            "Your second coordinate has the exponents of the first.",
            "In the second line of Eq. 5 b1 and b2 change places.",
        ),
        (there / gamma[:, None], "γ is missing.", "γ multiplies both speeds."),
        (
            np.transpose([gamma * x**b2 * (1 - x) ** b1, gamma * y**b1 * (1 - y) ** b2]),
            "b1 and b2 are exchanged.",
            "c_x has b1 as its own exponent.",
        ),
    )
    return usual_mistake(rates, mistakes, within=1e-4) or wrong(
        f"For (c_x, c_y, b1, b2, γ) = {STATES[1]} you return {rates[1].round(3).tolist()}.",
        f"It should be {there[1].round(3).tolist()}.",
    )


DURATIONS = ((0.5, 8.0), (0.7, 8.0), (0.7, 2.0), (0.1, 5.0))
"""b1 and T [s]."""


def _judge_gamma(gammas: NDArray[np.float64]) -> Finding:
    b1, duration = np.transpose(DURATIONS)
    there = np.pi / (duration * np.sin(np.pi * b1))
    if np.allclose(gammas, there, rtol=1e-3):
        return right("With your γ each movement takes the time that it shall take.")
    mistakes = (
        (1 / there, "This is the inverse.", "A longer movement needs a smaller γ."),
        (
            np.pi / np.sin(np.pi * b1),
            "This is γ for a movement of 1 s.",
            "Solve T = π/(γ sin πb1) for γ.",
        ),
        (
            np.pi / (duration * np.sin(b1)),
            "The sine takes πb1.",
            "For b1 = ½ the sine is 1.",
        ),
        (
            np.pi / (duration * np.sin(np.radians(np.pi * b1))),
            "You convert to radians.",
            "πb1 is in radians already.",
        ),
    )
    return usual_mistake(gammas, mistakes, within=1e-3) or wrong(
        f"For b1 = ½ and T = 8 s you return {gammas[0]:.3g}.", "There T = π/γ."
    )


PLACES: tuple[Any, ...] = (
    ((0.0, 0.0), (1.0, 1.0), (0.2, 0.7)),
    ((0.0, 0.0), (1.0, 0.0), (0.2, 0.7)),
    ((0.1, 0.2), (-0.1, 0.3), (0.5, 0.1)),
    ((0.1, 0.2), (-0.1, 0.3), (1.0, 1.0)),
    ((-0.2, 0.1), (-0.2, -0.1), (0.3, 0.3)),
)
"""Start, target and a point (c_x, c_y)."""


def _inputs_of_place() -> list[tuple[NDArray[np.float64], ...]]:
    return [tuple(np.array(part) for part in parts) for parts in PLACES]


def _turned(shift: float, factor: float, sign: int = 1) -> NDArray[np.float64]:
    """The points, turned by ±(the target's direction + `shift`) and scaled by dist · `factor`."""
    found = []
    for start, target, c in _inputs_of_place():
        way = target - start
        angle = sign * (np.arctan2(way[1], way[0]) + shift)
        cos, sin = np.cos(angle), np.sin(angle)
        turned = np.array([cos * c[0] - sin * c[1], sin * c[0] + cos * c[1]])
        found.append(start + factor * np.hypot(*way) * turned)
    return np.array(found)


def _judge_place(points: NDArray[np.float64]) -> Finding:
    half = np.pi / 4
    there = _turned(-half, 1 / np.sqrt(2))
    if np.allclose(points, there, atol=1e-4):
        return right("Your path begins at the start and ends at the target.")
    starts = np.array([start for start, *_ in _inputs_of_place()])
    mistakes = (
        (
            _turned(0, 1),
            "This is Eq. 6 as printed: (1, 1) does not come to lie on the target.",
            "The diagonal has length √2 and stands at 45° already.",
        ),
        (_turned(0, 1 / np.sqrt(2)), "The 45° are missing.", "Turn by θ − 45°."),
        (_turned(-half, 1), "The path is √2 too long.", "Divide the distance by √2."),
        (
            there - starts,
            "Your path begins at the origin.",
            "Add the start.",
        ),
        (
            _turned(-half, 1 / np.sqrt(2), -1),
            "You turn clockwise.",
            "Counter-clockwise: x' = x cos − y sin, y' = x sin + y cos.",
        ),
        (_turned(half, 1 / np.sqrt(2)), "You add 45°.", "Turn by θ − 45°."),
    )
    return usual_mistake(points, mistakes, within=1e-4) or wrong(
        f"From {PLACES[1][0]} to {PLACES[1][1]} the point {PLACES[1][2]} comes to lie at "
        f"{points[1].round(3).tolist()}.",
        f"It should be {there[1].round(3).tolist()}. Try (1, 1) first: it must be the target.",
    )


def _draw_place(points: NDArray[np.float64], axes: Axes) -> None:
    axes.plot(*_turned(-np.pi / 4, 1 / np.sqrt(2)).T, "o", color=FAINT, ms=10, label="expected")
    axes.plot(*np.clip(points, -2, 2).T, "x", color=STRONG, label="yours")
    axes.set(xlabel="x", ylabel="y", aspect="equal")
    axes.legend()


CLEARANCE = 0.25
LEAST_B1 = 0.01
"""Bound of b1, as in babbling."""


def _path(b1: float) -> NDArray[np.float64]:
    """The path of b1 from (0, 0) to (1, 0)."""
    return place([0, 0], [1, 0], TimeBaseGenerator(b1, 1 - b1).curve(300))


def _clearance(b1: float) -> float:
    """How close the path comes to the point halfway, as a share of the distance."""
    return float(np.linalg.norm(_path(b1) - [0.5, 0], axis=1).min())


@cache
def _least_b1() -> float:
    """The least b1 above ½ whose path keeps clear."""
    low, high = 0.5, 0.9
    while high - low > 1e-4:
        middle = (low + high) / 2
        low, high = (low, middle) if _clearance(middle) >= CLEARANCE else (middle, high)
    return high


def _judge_clearance(b1: float) -> Finding:
    least = _least_b1()
    if abs(b1 - least) <= 0.008:
        return right(f"From b1 = {least:.3f} on the path keeps {CLEARANCE} of the distance away.")
    if abs(1 - b1 - least) <= 0.008:
        return wrong("This path curves to the right.", "To the left means b1 above ½.")
    if not LEAST_B1 <= b1 <= 1 - LEAST_B1:
        return wrong(f"No movement has b1 = {b1:.3g}.", "b1 lies between .01 and .99.")
    said = f"The path of b1 = {b1:.3g} keeps {_clearance(b1):.3f} of the distance away"
    if b1 > least:
        return wrong(f"{said}: more than asked for.", "Try a smaller b1.")
    return wrong(f"{said}: too little.", "Try a greater b1.")


def _draw_clearance(b1: float, axes: Axes) -> None:
    angle = np.linspace(0, 2 * np.pi, 100)
    axes.fill(0.5 + CLEARANCE * np.cos(angle), CLEARANCE * np.sin(angle), color="#e4e7eb")
    if LEAST_B1 <= b1 <= 1 - LEAST_B1:
        axes.plot(*_path(b1).T, color=STRONG, label="yours")
        axes.legend()
    axes.set(aspect="equal", title="start: left, target: right")


@cache
def _cases() -> tuple[dict[str, Any], ...]:
    cases = scenarios("table1", n=18, seed=0)
    return tuple({part: case[part] for part in ("start", "target", "obstacle")} for case in cases)


@cache
def _environment(duration_s: float) -> BabbleReachEnv:
    config = {"reach": {"movement_s": duration_s}}
    return BabbleReachEnv(control="pattern", record=True, config=config)


def _played(
    case: dict[str, Any], b: ArrayLike, duration_s: float = 8.0
) -> tuple[str, NDArray[np.float64]]:
    """How a movement ends, and the way of the hand (k, 2) [m]."""
    env = _environment(duration_s)
    env.reset(options=case)
    action = np.clip(2 * np.asarray(b) - 1, -1, 1).astype(np.float32)
    *_, info = env.step(action)
    (outcome,) = [name for name, is_it in info["outcome"].items() if is_it]
    return outcome, env.trajectory


NARROW, WIDE = 0, 17
"""Cases: one that few movements solve, and one that many do."""


def _judge_around(b: NDArray[np.float64]) -> Finding:
    outcome, path = _played(_cases()[NARROW], b)
    away_m = float(np.linalg.norm(path[-1] - _cases()[NARROW]["target"]))
    said = f"(b1, b2) = ({b[0]:.3g}, {b[1]:.3g})"
    if outcome == "success":
        return right(f"{said} goes around the obstacle and reaches the target.")
    if outcome == "collision":
        return wrong(
            f"{said} collides {away_m * 100:.0f} cm away from the target.",
            "The arm must pass, too, not only the hand. Play many values of b1, with b2 = 1 − b1.",
        )
    if outcome == "joint_limit":
        return wrong(f"{said} asks for a posture that the arm cannot have.", "Curve less.")
    return wrong(
        f"{said} ends {away_m * 100:.0f} cm away from the target.", "Let b2 = 1 − b1: then T = 8 s."
    )


def _draw_case(case: dict[str, Any], path: NDArray[np.float64], axes: Axes) -> None:
    angle, (x, y, radius) = np.linspace(0, 2 * np.pi, 100), case["obstacle"]
    axes.fill(x + radius * np.cos(angle), y + radius * np.sin(angle), color="#4b5563")
    axes.plot(*path.T, color=STRONG, label="the hand")
    axes.plot(*case["target"], "*", color=RED, ms=10)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend()


def _draw_around(b: NDArray[np.float64], axes: Axes) -> None:
    case = _cases()[NARROW]
    _draw_case(case, _played(case, b)[1], axes)


CURVE = (0.25, 0.75)


def _judge_fastest(seconds: float) -> Finding:
    case = _cases()[WIDE]
    if _played(case, CURVE, seconds)[0] != "success":
        return wrong(
            f"A movement of {seconds:.3g} s cuts the corner and hits the obstacle.",
            "The muscles lag by 0.8 s. Give them more time.",
        )
    shorter = seconds - 0.2
    if shorter >= SHORTEST_S and _played(case, CURVE, shorter)[0] == "success":
        return wrong(
            f"{seconds:.3g} s is enough, but so is {shorter:.3g} s.", "Halve the interval again."
        )
    return right(f"{seconds:.3g} s is enough, and {shorter:.3g} s is not.")


SHORTEST_S, LONGEST_S = 0.3, 30.0


def _draw_fastest(seconds: float, axes: Axes) -> None:
    case = _cases()[WIDE]
    _draw_case(case, _played(case, CURVE, seconds)[1], axes)


EXERCISES = (
    Exercise(
        id="4.1",
        asks="a function of c_x, c_y, b1, b2 and gamma that returns both speeds of Eq. 5",
        answer=Function(inputs=lambda: list(STATES), shape=(2,)),
        judge=_judge_rate,
    ),
    Exercise(
        id="4.2",
        asks="a function of b1 and T [s] that returns gamma",
        answer=Function(inputs=lambda: list(DURATIONS)),
        judge=_judge_gamma,
    ),
    Exercise(
        id="4.3",
        asks="a function of start, target and (c_x, c_y) that returns the place of this point",
        answer=Function(inputs=_inputs_of_place, shape=(2,)),
        judge=_judge_place,
        draw=_draw_place,
    ),
    Exercise(
        id="4.4",
        asks="the least b1 above ½ whose path stays a quarter of the distance away",
        answer=Number(),
        judge=_judge_clearance,
        draw=_draw_clearance,
    ),
    Exercise(
        id="4.5",
        asks="(b1, b2) of a movement that solves the case",
        answer=Numbers(shape=(2,), low=0, high=1),
        judge=_judge_around,
        draw=_draw_around,
    ),
    Exercise(
        id="4.6",
        asks="the shortest duration of the movement that still succeeds [s], to 0.2 s",
        answer=Number(unit="s", low=SHORTEST_S, high=LONGEST_S),
        judge=_judge_fastest,
        draw=_draw_fastest,
    ),
)
