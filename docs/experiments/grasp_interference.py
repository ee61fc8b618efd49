"""Do two sizes interfere, in the arm's target and in the hand's posture?

An agent babbles with small objects alone, with big ones alone, or with both. Then it recalls
postures for cases of each size. The table shows the gap from the palm's surface to the object's
(negative: inside), and the hand's equilibrium points. docs/grasping.md has the results.
"""

import argparse
import json
from typing import Any

import gymnasium as gym
import numpy as np

from gym_babble import Config, HebbBabbling, scenarios
from gym_babble.envs import BabbleGraspEnv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=3, help="seeds, from 100 on")
parser.add_argument("--babbles", type=int, default=1_000)
parser.add_argument("--cases", type=int, default=200, help="cases of each seed")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

SMALL, BIG = 0.024, 0.06
# What changes: its name, diameters babbled with, config, the agent's maps and rule.
CHANGES = [
    ("small alone", [SMALL], {}, {}),
    ("big alone", [BIG], {}, {}),
    ("both", [SMALL, BIG], {}, {}),
    ("both, reflex EP 20, 20", [SMALL, BIG], {"body": {"grip": {"reflex_deg": [70, 70]}}}, {}),
    ("both, sigma 1.5", [SMALL, BIG], {}, {"sigma": 1.5}),
    ("both, eta 0.1", [SMALL, BIG], {}, {"rule": {"eta": 0.1}}),
    ("both, xi 0.8", [SMALL, BIG], {}, {"rule": {"xi": 0.8}}),
]


def recall(agent: HebbBabbling, diameter: float, seed: int) -> np.ndarray:
    """Gap between palm and surface [cm], and EPs of thumb and finger [deg], of each case."""
    cases = [
        {**case, "diameter": diameter}
        for case in scenarios("palm_side", arguments.cases, seed, split="validation")
        if case["diameter"] == BIG  # A start that is clear of the big object is clear of both.
    ]
    envs = gym.make_vec("BabbleGrasp-v0", num_envs=len(cases))
    senses, _ = envs.reset(seed=0, options={"scenario": cases})
    recalled = agent.decide(senses)
    low, high = BabbleGraspEnv().interface.quantities["ranges"][:2].T
    arms = low + recalled[:, :2] * (high - low)
    objects = np.array([case["object"] for case in cases])
    arm = Config().body.arm
    # The palm's surface is beside the forearm's line, on its left.
    elbows = arm.upper_arm_m * np.stack([np.cos(arms[:, 0]), np.sin(arms[:, 0])], 1)
    along = arms.sum(axis=1)
    normals = np.stack([-np.sin(along), np.cos(along)], 1)
    gaps = ((objects - elbows) * normals).sum(axis=1) - arm.half_width_m - diameter / 2
    return np.column_stack([100 * gaps, recalled[:, 2:]])


HEADS = ("babbled with", "object", "gap [cm]", "thumb EP [deg]", "finger EP [deg]")
HEADS += ("babbled EPs [deg]", "EPs recalled from the object in the hand [deg]")
rows: list[dict[str, Any]] = []
if not arguments.json:
    print(f"| {' | '.join(HEADS)} |")
    print("| --- " * len(HEADS) + "|")
for name, diameters, config, brain in CHANGES:
    found: dict[float, list[np.ndarray]] = {SMALL: [], BIG: []}
    hands: dict[float, list[np.ndarray]] = {SMALL: [], BIG: []}
    for seed in range(100, 100 + arguments.seeds):
        env = BabbleGraspEnv(diameters=diameters, config={"profile": "paper", **config})
        agent = HebbBabbling(env, seed=seed, brain=brain).learn(arguments.babbles)
        babbled = agent.experiences()
        again = agent.decide(babbled.percepts)[:, 2:]
        for diameter in (SMALL, BIG):
            of_size = babbled.case["diameter"][:, 0] == np.float32(diameter)
            found[diameter].append(recall(agent, diameter, seed))
            hands[diameter].append(np.hstack([babbled.actions["hand"], again])[of_size])
    for diameter in (SMALL, BIG):
        recalled, postures = np.concatenate(found[diameter]), np.concatenate(hands[diameter])
        in_hand = postures.mean(axis=0).tolist() if len(postures) else None
        mean, spread = recalled.mean(axis=0).tolist(), recalled.std(axis=0).tolist()
        row = {"babbled_with": name, "diameter": diameter, "mean": mean, "spread": spread}
        rows.append({**row, "babbled": in_hand and in_hand[:2], "in_hand": in_hand and in_hand[2:]})
        if not arguments.json:
            cells = [f"{x:.2f} ± {s:.2f}" for x, s in zip(mean, spread, strict=True)]
            means = [f"{ep:.1f}" for ep in in_hand] if in_hand else ["–"] * 4
            cells += [", ".join(means[:2]), ", ".join(means[2:])]
            print(f"| {name} | {100 * diameter:g} cm | {' | '.join(cells)} |", flush=True)
if arguments.json:
    print(json.dumps(rows))
