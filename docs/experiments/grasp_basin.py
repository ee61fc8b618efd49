"""Where along the palm must a ball lie, so that the hand holds it?

The arm approaches each ball with the elbow alone, 1.5° a control step, until the palm touches; then
the arm stops and the enclosure reflex closes the hand. Where the ball meets the palm, as a distance
from the wrist, is the only thing that differs between the rows of a size. docs/beyond-the-paper.md
has the results.

python docs/experiments/grasp_basin.py --figure docs/images/basin.png    # about a minute
"""

import argparse
import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

import gym_babble
from gym_babble.config import Config
from gym_babble.files import check_file
from gym_babble.viz.style import INK, row_of_axes, save, styled

ENV = "BabbleGrasp-v0"
STEPS = 260
STEP = np.radians(1.5)
WITHDRAWN = np.radians(30)  # How far the elbow is extended at the start.
ELBOW_DEG = (50, 100)  # Range of the elbow at contact: all sizes are clear of the upper arm.
SHOULDER_DEG = (-60, 150)
BODY = Config().body


def before_the_palm(arm: Any, wrist_m: float, radius: float) -> tuple[float, float]:
    """Centre of a ball that lies against the palm of an arm (2,) [rad], so far from the wrist."""
    along = BODY.arm.forearm_m + wrist_m
    side = BODY.arm.half_width_m + radius
    shoulder, both = arm[0], arm.sum()
    upper = BODY.arm.upper_arm_m * np.array([np.cos(shoulder), np.sin(shoulder)])
    forearm, palm = np.array([np.cos(both), np.sin(both)]), np.array([-np.sin(both), np.cos(both)])
    x, y = upper + along * forearm + side * palm
    return float(x), float(y)


def held(diameter: float, wrist_m: float, trials: int) -> float:
    """Share of trials in which the hand holds the ball without support."""
    low, high = np.radians([SHOULDER_DEG, ELBOW_DEG]).T
    contact = np.random.default_rng(0).uniform(low, high, (trials, 2))
    start = contact - [0.0, WITHDRAWN]
    cases = [
        {
            "start": tuple(before.tolist()),
            "object": before_the_palm(arm, wrist_m, diameter / 2),
            "diameter": diameter,
        }
        for before, arm in zip(start, contact, strict=True)
    ]
    envs = gym.make_vec(
        ENV, trials, control="posture", max_episode_steps=STEPS, autoreset_mode="Disabled"
    )
    joints = gym_babble.Joints(envs)
    reflex = envs.unwrapped.interface.quantities["reflex"]
    seen, _ = envs.reset(seed=0, options={"scenario": cases})
    touched, running, success = (np.zeros(trials, bool) for _ in range(3))
    running[:] = True
    arm, stopped = start.copy(), start.copy()
    while running.any():
        felt = joints.posture(seen)[:, :2]
        new = ~touched & (seen["touch"][:, 0] > 0)
        stopped[new], touched = felt[new], touched | new
        arm[:, 1] += STEP
        closed = touched[:, None]
        points = np.hstack([np.where(closed, stopped, arm), np.where(closed, reflex, 0.0)])
        seen, _, terminated, truncated, info = envs.step(joints.actions(points))
        ended = running & (terminated | truncated)
        success |= ended & info["held"]
        running &= ~ended
        over = terminated | truncated
        if over.any() and running.any():
            # What has ended plays on, which does not count.
            seen, _ = envs.reset(options={"reset_mask": over})
    envs.close()
    return float(success.mean())


@styled
def draw(rows: list[dict[str, float]]) -> Any:
    """The shares over the distance from the wrist, and where a ball in the hand is put."""
    figure, (axes,) = row_of_axes((5.6, 2.6), 1)
    palm = 100 * BODY.hand.palm_m
    for size, colour in zip(arguments.diameters, ("#3d7fc1", "#d1702a", "#3d9970"), strict=False):
        of_size = [row for row in rows if row["diameter_cm"] == size]
        x, y = ([row[name] for row in of_size] for name in ("wrist_cm", "held"))
        axes.plot(x, y, "o-", color=colour, markersize=3, label=f"{size:g} cm")
    put = palm / 2 + 0.12 * palm  # The pocket of the hand, where babbling puts objects.
    axes.axvline(put, color=INK, linestyle=":", linewidth=1)
    axes.text(put + 0.05, 0.04, "where babbling\nputs objects", fontsize=8)
    axes.set(
        xlabel="distance of the ball from the wrist [cm]", ylabel="share held", xlim=(1.5, palm)
    )
    axes.legend(loc="center right", title="diameter")
    return figure


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--trials", type=int, default=20, help="balls of each size at each place")
parser.add_argument("--diameters", type=float, nargs="+", default=[2.4, 4, 6], help="[cm]")
parser.add_argument("--places", type=float, nargs=3, default=[1.6, 5.4, 0.1], help="from, to, by")
parser.add_argument("--figure", type=Path, help="file for a picture")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()
if arguments.figure:
    check_file(arguments.figure, "--figure")

first, last, by = arguments.places
rows = [
    {
        "diameter_cm": size,
        "wrist_cm": round(float(place), 2),
        "trials": arguments.trials,
        "held": held(size / 100, place / 100, arguments.trials),
    }
    for size in arguments.diameters
    for place in np.arange(first, last + by / 2, by)
]
if arguments.figure:
    save(draw(rows), arguments.figure)
if arguments.json:
    print(json.dumps(rows))
else:
    print("| diameter [cm] | from the wrist [cm] | held |\n| --- | --- | --- |")
    for row in rows:
        print(f"| {row['diameter_cm']:g} | {row['wrist_cm']:g} | {row['held']:.2f} |")
