"""How do the movements of the chain change while it learns?

An agent babbles, and is tested after so many babbles: how many units its reaches have and how
straight they are (`gym_babble.study.movements`), up to the first touch of the object; how often the
palm touches first; how far the arm is from the recalled contact then; how often the hand closes;
how long it takes to hold; and how often it holds objects of each size. Cases are validation cases
of region `palm_side`. docs/beyond-the-paper.md has the results.
"""

import argparse
import json
from typing import Any

import gymnasium as gym
import numpy as np

from gym_babble import HebbBabbling, Joints, scenarios
from gym_babble.study.movements import movement_units, straightness

ENV = "BabbleGrasp-v0"
CLOSING = np.radians(30)  # A thumb that flexes beyond this closes the hand.
OPENED = np.radians(15)  # Below this it is open again.

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--babbles", type=int, nargs="+", default=[0, 10, 30, 100, 300, 1_000])
parser.add_argument("--seeds", type=int, default=3)
parser.add_argument("--cases", type=int, default=60, help="cases of each size")
parser.add_argument("--diameters", type=float, nargs="+", default=[2.4, 4, 6], help="[cm]")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()


def play(agent: HebbBabbling, cases: list[Any]) -> list[dict[str, Any]]:
    """Plays the cases side by side; what is measured of each."""
    n = len(cases)
    envs = gym.make_vec(ENV, n, record=True, autoreset_mode="Disabled")
    step_s = 1 / envs.unwrapped.interface.spec.control_hz
    joints = Joints(envs)
    seen, info = envs.reset(seed=0, options={"scenario": cases})
    recalled = joints.angles(np.pad(agent.decide(seen)[:, 2:4], ((0, 0), (0, 2))))[:, :2]
    tests: list[dict[str, Any]] = [
        {"first": None, "palm_first": None, "off_deg": None, "closings": 0} for _ in cases
    ]
    running, closed, plans = np.ones(n, bool), np.zeros(n, bool), None
    step = 0
    while running.any():
        action, plans = agent.predict(seen, plans)
        seen, _, terminated, truncated, info = envs.step(action)
        step += 1
        posture = joints.posture(seen)
        closes = ~closed & (posture[:, 2] > CLOSING)
        closed = (closed | closes) & (posture[:, 2] > OPENED)
        for i in np.flatnonzero(running):
            tests[i]["closings"] += int(closes[i])
            if tests[i]["first"] is None and info["reach"][i]:
                tests[i]["first"] = step
                tests[i]["palm_first"] = bool(info["palm_reach"][i])
                off = np.degrees(np.abs(posture[i, :2] - recalled[i]).max())
                tests[i]["off_deg"] = float(off)
        ended = running & (terminated | truncated)
        for i in np.flatnonzero(ended):
            path = envs.unwrapped.of_one(int(i), "trajectory")[: (tests[i]["first"] or step) + 1]
            tests[i]["units"] = movement_units(path, step_s)
            tests[i]["straightness"] = straightness(path)
            tests[i]["held"] = bool(info["held"][i])
            tests[i]["seconds"] = step * step_s
        running &= ~ended
        over = terminated | truncated
        if over.any() and running.any():
            # What has ended plays on, which does not count.
            seen, _ = envs.reset(options={"reset_mask": over})
    envs.close()
    return tests


def mean(values: list[Any]) -> float | None:
    """A mean; none without values."""
    return float(np.mean(values)) if values else None


def summary(tests: list[dict[str, Any]], sizes: list[float]) -> dict[str, Any]:
    """Means over tests. Those of a reach are over the tests in which the object was touched."""
    touched = [test for test in tests if test["first"] is not None]
    held = [test for test in tests if test["held"]]
    return {
        "touched": len(touched) / len(tests),
        **{
            name: mean([test[name] for test in touched])
            for name in ("units", "straightness", "palm_first", "off_deg")
        },
        "closings": mean([test["closings"] for test in tests]),
        "seconds_to_hold": mean([test["seconds"] for test in held]),
        "held": {
            f"{size:g} cm": mean(
                [test["held"] for test, of in zip(tests, sizes, strict=True) if of == size]
            )
            for size in arguments.diameters
        },
    }


cases: list[Any] = []
for centimetres in arguments.diameters:
    size = [centimetres / 100]
    cases += scenarios("palm_side", arguments.cases, split="validation", diameters=size)
sizes = np.repeat(arguments.diameters, arguments.cases).tolist()

agents = [HebbBabbling(ENV, variant="chain", seed=seed) for seed in range(arguments.seeds)]
rows = []
for babbles in arguments.babbles:
    tests = []
    for agent in agents:
        agent.learn(babbles - agent.learnt)
        tests += play(agent, cases)
    steps = mean([agent.control_steps for agent in agents])
    found = summary(tests, sizes * len(agents))
    rows.append({"babbles": babbles, "control_steps": steps, "tests": len(tests), **found})
    if not arguments.json:
        print(rows[-1], flush=True)
if arguments.json:
    print(json.dumps(rows))
