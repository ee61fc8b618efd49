"""Exercises of lesson 2: muscles and equilibrium points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gym_babble.config import Config
from gym_babble.course.answers import Function, Number
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["EXERCISES"]

MUSCLES = Config().body.muscles
TAU_S = MUSCLES.kd / MUSCLES.kp
"""The arm's time constant K_D/K_P [s]."""
FAINT, STRONG = "#9aa5b1", "#1f6fb2"


def _judge_lag(seconds: float) -> Finding:
    if abs(seconds - TAU_S) <= 0.05 * TAU_S:
        return right(
            f"After {seconds:.2f} s a joint has made 63 % of its way. Eq. 2 with negligible "
            f"inertia says K_D/K_P = {TAU_S} s."
        )
    if abs(seconds - TAU_S / 0.05) <= 1:
        return wrong("This is a number of control steps.", "A control step lasts 50 ms.")
    if abs(seconds - 1 / TAU_S) <= 0.05:
        return wrong(f"{seconds:.2f} is K_P/K_D, in 1/s.", "Which quotient is in seconds?")
    if abs(seconds - TAU_S * np.log(2)) <= 0.04:
        return wrong("This is the time for half of the way.", "Look for 1 − 1/e = 63 %.")
    return wrong(
        f"A curve with a time constant of {seconds:.3g} s does not fit the joint's.",
        "When has the joint made 63 % of its way?",
    )


def _draw_lag(seconds: float, axes: Axes) -> None:
    t = np.linspace(0, 4, 200)
    axes.plot(t, 1 - np.exp(-t / TAU_S), color=FAINT, lw=4, label="the joint")
    if seconds > 1e-3:
        axes.plot(t, 1 - np.exp(-t / seconds), color=STRONG, label="your time constant")
    axes.set(xlabel="time [s]", ylabel="share of the way", ylim=(0, 1.05))
    axes.legend(loc="lower right")


def _states() -> list[tuple[float, ...]]:
    """Equilibrium points and angles [rad], and speeds [rad/s]."""
    return [tuple(row) for row in np.random.default_rng(0).uniform(-1, 1, (50, 3)).tolist()]


def _judge_torque(torques: NDArray[np.float64]) -> Finding:
    wanted, angle, speed = np.transpose(_states())
    spring, damper = MUSCLES.kp * (wanted - angle), MUSCLES.kd * speed

    if np.allclose(torques, spring - damper, atol=1e-6):
        return right("Your torque is that of Eq. 2 in 50 random states.")
    mistakes = (
        (spring + damper, "The damping has the wrong sign.", "Damping acts against the speed."),
        (
            -spring - damper,
            "The spring pushes away from the equilibrium point.",
            "The torque is positive where q_des is greater than q.",
        ),
        (spring, "The damping is missing.", "Eq. 2 has two terms."),
        (
            MUSCLES.kd * (wanted - angle) - MUSCLES.kp * speed,
            "K_P and K_D are exchanged.",
            "Which of them multiplies an angle?",
        ),
    )
    return usual_mistake(torques, mistakes, within=1e-6) or wrong(
        f"Your torque is off by up to {np.abs(torques - spring + damper).max():.3g} N·m.",
        f"T = K_P (q_des − q) − K_D q̇, with K_P = {MUSCLES.kp:g} and K_D = {MUSCLES.kd:g}.",
    )


def _ways() -> list[tuple[float, float, float]]:
    """First angles, equilibrium points [deg] and times [s]."""
    starts_and_ends = [(-20.0, 60.0), (90.0, 30.0), (0.0, 5.0)]
    return [(*ends, t) for ends in starts_and_ends for t in (0.0, 0.4, 0.8, 2.0, 10.0)]


def _judge_angle(angles: NDArray[np.float64]) -> Finding:
    first, wanted, t = np.transpose(_ways())
    left = np.exp(-t / TAU_S)

    if np.allclose(angles, wanted + (first - wanted) * left, atol=0.2):
        return right("In equal times the rest of the way shrinks by equal factors.")
    mistakes = (
        (
            first + (first - wanted) * left,
            "At t = 0 your joint is not where it begins.",
            "What is left of the way shrinks: q − q_des = (q0 − q_des) · ...",
        ),
        (
            wanted + (first - wanted) * np.exp(-t * TAU_S),
            "Your exponent has the unit s².",
            "Divide t by the time constant.",
        ),
        (
            first + (wanted - first) * left,
            "Your joint begins at the end.",
            "e^(−t/τ) is the share of the way that is left.",
        ),
    )
    return usual_mistake(angles, mistakes, within=0.2) or wrong(
        f"After {t[2]} s on the way from {first[2]:g}° to {wanted[2]:g}° you return "
        f"{angles[2]:.4g}°.",
        f"After one time constant, {TAU_S} s, 37 % of the way is left.",
    )


def _draw_angle(angles: NDArray[np.float64], axes: Axes) -> None:
    _, _, t = np.transpose(_ways()[:5])
    dense = np.linspace(0, 10, 200)
    axes.plot(dense, 60 - 80 * np.exp(-dense / TAU_S), color=FAINT, lw=4, label="Eq. 2")
    axes.plot(t, angles[:5], "o", color=STRONG, label="yours")
    axes.set(xlabel="time [s]", ylabel="angle [°]")
    axes.legend(loc="lower right")


def _judge_stiffness(kp: float) -> Finding:
    wanted = 2 * MUSCLES.kp
    if abs(kp - wanted) <= 1:
        return right(f"K_D/K_P = {MUSCLES.kd:g}/{wanted:g} = {MUSCLES.kd / wanted:g} s.")
    if abs(kp - MUSCLES.kp / 2) <= 1:
        return wrong(
            f"With K_P = {kp:.3g} the time constant is {MUSCLES.kd / kp:.2g} s: twice as slow.",
            "A stiff spring pulls harder.",
        )
    if abs(kp - 4 * MUSCLES.kp) <= 1:
        return wrong(
            f"With K_P = {kp:.3g} the arm is four times as fast.",
            "Without inertia there is no square root in the time constant.",
        )
    return wrong(f"K_P = {kp:.3g} does not halve the time constant.", "It is K_D/K_P.")


BODY = Config().body
ARM = BODY.arm
FOREARM_M = ARM.forearm_m + BODY.hand.palm_m + sum(BODY.hand.finger_m)
"""From the elbow to the tip of the stretched hand."""


def _postures() -> list[tuple[float, float]]:
    """Shoulder and elbow [deg]."""
    return [(0.0, 10.0), (0.0, 90.0), (90.0, 90.0), (45.0, 30.0), (-60.0, 120.0), (120.0, 60.0)]


def _hand(
    shoulder: NDArray[np.float64], outer: NDArray[np.float64], m: float
) -> NDArray[np.float64]:
    """The fingertip (n, 2), `m` away from an elbow whose link points to `outer` [rad]."""
    upper = ARM.upper_arm_m
    return np.transpose(
        [
            upper * np.cos(shoulder) + m * np.cos(outer),
            upper * np.sin(shoulder) + m * np.sin(outer),
        ]
    )


def _judge_hand(hands: NDArray[np.float64]) -> Finding:
    shoulder, elbow = np.radians(np.transpose(_postures()))
    there = _hand(shoulder, shoulder + elbow, FOREARM_M)
    if np.allclose(hands, there, atol=2e-3):
        return right("Your hand is where the arm's is, in six postures.")
    in_degrees = np.transpose(_postures())
    mistakes = (
        (
            _hand(shoulder, elbow, FOREARM_M),
            "Your forearm does not turn with the upper arm.",
            "The elbow's angle is between the two. Which direction has the forearm?",
        ),
        (
            _hand(shoulder, shoulder + elbow, ARM.forearm_m),
            "This is the wrist.",
            "The stretched hand adds 11.6 cm.",
        ),
        (
            _hand(shoulder, shoulder - elbow, FOREARM_M),
            "The elbow bends to the wrong side.",
            "Both angles count counter-clockwise.",
        ),
        (
            _hand(in_degrees[0], in_degrees.sum(axis=0), FOREARM_M),
            "NumPy's sin and cos take radians.",
            "Use np.radians.",
        ),
        (there[:, ::-1], "x and y are exchanged.", "With both angles 0 the arm points along x."),
        (100 * there, "This is in centimetres.", "Return metres."),
    )
    return usual_mistake(hands, mistakes, within=2e-3) or wrong(
        f"With shoulder 0° and elbow 90° you return {hands[1].round(3).tolist()}.",
        "The upper arm then lies along x, and forearm and hand along y.",
    )


def _draw_hand(hands: NDArray[np.float64], axes: Axes) -> None:
    shoulder, elbow = np.radians(np.transpose(_postures()))
    for q1, tip in zip(shoulder, _hand(shoulder, shoulder + elbow, FOREARM_M), strict=True):
        joint = ARM.upper_arm_m * np.array([np.cos(q1), np.sin(q1)])
        axes.plot(*np.transpose([(0, 0), joint, tip]), color=FAINT, lw=3)
    axes.plot(*np.clip(hands, -0.6, 0.6).T, "o", color=STRONG, label="your hand")
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend()


PERIOD_S = 2.0


def _gain(period_s: float) -> float:
    return float(1 / np.hypot(1, 2 * np.pi * TAU_S / period_s))


def _judge_gain(gain: float) -> Finding:
    truth = _gain(PERIOD_S)
    if abs(gain - truth) <= 0.02:
        return right(f"1/√(1 + (2πτ/P)²) = {truth:.3f}. The arm is a low-pass filter.")
    if abs(gain - 1 / np.hypot(1, TAU_S / PERIOD_S)) <= 0.01:
        return wrong("The 2π is missing.", "The angular frequency is ω = 2π/P.")
    if abs(gain - truth**2) <= 0.01:
        return wrong("The square root is missing.", "Gain: 1/√(1 + (ωτ)²).")
    if abs(gain - 1 / truth) <= 0.05:
        return wrong("This is the inverse.", "The arm swings less than its equilibrium point.")
    if abs(gain - 20 * truth) <= 0.4:
        return wrong("This is an amplitude in degrees.", "Divide by that of the equilibrium point.")
    return wrong(
        f"{gain:.3g} is not what the arm does.",
        "Wait until the swing is regular. Then divide its height by that of the equilibrium point.",
    )


def _draw_gain(gain: float, axes: Axes) -> None:
    periods = np.geomspace(0.5, 20, 100)
    axes.semilogx(periods, [_gain(p) for p in periods], color=FAINT, lw=4, label="Eq. 2")
    axes.plot([PERIOD_S], [np.clip(gain, 0, 1.2)], "o", color=STRONG, label="yours")
    axes.set(xlabel="period [s]", ylabel="gain", ylim=(0, 1.25))
    axes.legend()


EXERCISES = (
    Exercise(
        id="2.1",
        asks="the time constant of the arm's joints [s]",
        answer=Number(unit="s"),
        judge=_judge_lag,
        draw=_draw_lag,
    ),
    Exercise(
        id="2.2",
        asks="a function of q_des, q and the speed that returns the torque of Eq. 2 [N·m]",
        answer=Function(inputs=_states),
        judge=_judge_torque,
    ),
    Exercise(
        id="2.3",
        asks="a function of q0, q_des [°] and t [s] that returns the angle at t [°]",
        answer=Function(inputs=_ways),
        judge=_judge_angle,
        draw=_draw_angle,
    ),
    Exercise(
        id="2.4",
        asks="the K_P [N·m/rad] with which the arm is twice as fast",
        answer=Number(unit="N·m/rad"),
        judge=_judge_stiffness,
    ),
    Exercise(
        id="2.5",
        asks="a function of shoulder and elbow [°] that returns (x, y) of the fingertip [m]",
        answer=Function(inputs=_postures, shape=(2,)),
        judge=_judge_hand,
        draw=_draw_hand,
    ),
    Exercise(
        id="2.6",
        asks="the gain at a period of 2 s",
        answer=Number(),
        judge=_judge_gain,
        draw=_draw_gain,
    ),
)
