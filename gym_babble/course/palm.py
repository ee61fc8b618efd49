"""Where along the palm a ball must lie: an experiment on the hand alone, for lesson 6."""

from __future__ import annotations

from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np

from gym_babble.agents import Joints
from gym_babble.config import Config

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["approach", "forearm_frame"]

CONTACT_DEG = ((-60, 50), (150, 100))
"""Ranges of shoulder and elbow at contact: all balls are clear of the upper arm."""
WITHDRAWN = np.radians([0, 30])
"""How far the joints are away from that at the start."""
STEP = np.radians([0, 1.5])
"""How far the elbow flexes in a control step."""
STEPS = 150


def forearm_frame(arm: ArrayLike, points: ArrayLike) -> tuple[Floats, Floats]:
    """Places of points as seen from the forearm.

    Args:
        arm: Shoulder and elbow (n, 2) [rad].
        points: Points (n, 2) in the plane of motion [m].

    Returns:
        Distances along the forearm from the elbow (n,), and to the side that the palm faces from
        the forearm's middle line (n,) [m].
    """
    elbow, along, facing = _forearm(np.asarray(arm, float))
    away = np.asarray(points, float) - elbow
    return (away * along).sum(-1), (away * facing).sum(-1)


def approach(
    diameter: float, wrist_cm: ArrayLike, *, reflex: bool = True, trials: int = 4
) -> Floats:
    """How often the hand holds a ball that meets the palm at some place.

    The arm comes to the ball with the elbow alone, 1.5° a control step, until the palm touches, and
    stops. Its commands keep the hand open, so only the enclosure reflex closes it.

    Args:
        diameter: Diameter of the ball [m].
        wrist_cm: Distances (n,) of the ball from the wrist, along the palm [cm].
        reflex: Whether the enclosure reflex closes the hand.
        trials: Postures of the arm that try each distance; the same ones each time.

    Returns:
        The share of trials (n,) in which the hand holds the ball without support.
    """
    places = np.repeat(np.atleast_1d(np.asarray(wrist_cm, float)), trials)
    rng = np.random.default_rng(0)
    low, high = np.radians(CONTACT_DEG)
    contact = np.tile(rng.uniform(low, high, (trials, 2)), (len(places) // trials, 1))
    held = _played(
        contact, _at_the_palm(contact, places / 100, diameter / 2), diameter, reflex=reflex
    )
    shares: Floats = held.reshape(-1, trials).mean(axis=1)
    return shares


def _played(contact: Floats, balls: Floats, diameter: float, *, reflex: bool) -> NDArray[np.bool_]:
    """Whether each ball is held in the end (n,)."""
    n = len(contact)
    envs = gym.make_vec(
        "BabbleGrasp-v0",
        n,
        control="posture",
        enclosure_reflex=reflex,
        max_episode_steps=STEPS,
        autoreset_mode="Disabled",
    )
    joints, arm = Joints(envs), contact - WITHDRAWN
    cases = [
        {"start": tuple(start), "object": tuple(ball), "diameter": diameter}
        for start, ball in zip(arm.tolist(), balls.tolist(), strict=True)
    ]
    seen, _ = envs.reset(seed=0, options={"scenario": cases})
    touched, running, held = np.zeros(n, bool), np.ones(n, bool), np.zeros(n, bool)
    while running.any():
        new = ~touched & (seen["touch"][:, 0] > 0)
        touched |= new
        arm = np.where(touched[:, None], arm, arm + STEP)
        arm = np.where(new[:, None], joints.posture(seen)[:, :2], arm)
        seen, _, terminated, truncated, info = envs.step(
            joints.actions(np.hstack([arm, np.zeros((n, 2))]))
        )
        over = terminated | truncated
        held |= running & over & info["held"]
        running &= ~over
        if over.any() and running.any():
            # What has ended plays on, which does not count.
            seen, _ = envs.reset(options={"reset_mask": over})
    envs.close()
    return held


def _at_the_palm(arm: Floats, wrist_m: Floats, radius: float) -> Floats:
    """Centres (n, 2) of balls that lie against the palm of an arm (n, 2), so far from the wrist."""
    body = Config().body
    elbow, along, facing = _forearm(arm)
    out, side = body.arm.forearm_m + wrist_m, body.arm.half_width_m + radius
    centres: Floats = elbow + out[:, None] * along + side * facing
    return centres


def _forearm(arm: Floats) -> tuple[Floats, Floats, Floats]:
    """The elbow, and unit vectors along the forearm and in the direction that the palm faces."""
    shoulder, forearm = arm[..., 0], arm.sum(-1)
    upper = np.stack([np.cos(shoulder), np.sin(shoulder)], -1)
    along = np.stack([np.cos(forearm), np.sin(forearm)], -1)
    facing = np.stack([-np.sin(forearm), np.cos(forearm)], -1)
    return Config().body.arm.upper_arm_m * upper, along, facing
