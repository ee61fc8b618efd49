"""Which of the numbers missing in the paper decide Table I?

For each change of one number, an agent babbles and is tested on cases of the validation split.
docs/model.md has the results.
"""

import argparse
import json
from statistics import fmean
from typing import Any

from gym_babble import HebbBabbling, evaluate, scenarios
from gym_babble.envs import BabbleReachEnv

FICK = {"frame": "fick", "pan_deg": [-180.0, 180.0], "tilt_deg": [-90.0, 0.0]}
# What changes: its name, the config, the agent's maps and rule, legal movements.
CHANGES: list[tuple[str, dict[str, Any], dict[str, Any], int]] = [
    ("none", {}, {}, 20_000),
    ("camera frame fick", {"body": {"eye": FICK}}, {}, 20_000),
    ("movement time 5 s", {"reach": {"movement_s": 5.0}}, {}, 20_000),
    ("movement time 12 s", {"reach": {"movement_s": 12.0}}, {}, 20_000),
    ("movement time 60 s", {"reach": {"movement_s": 60.0}}, {}, 20_000),
    ("obstacle radius 3.2 cm", {"body": {"obstacle": {"radius_m": 0.032}}}, {}, 20_000),
    ("obstacle radius 3.8 cm", {"body": {"obstacle": {"radius_m": 0.038}}}, {}, 20_000),
    ("distance up to 30 cm", {"reach": {"distance_m": [0.08, 0.30]}}, {}, 20_000),
    ("sigma 0.5", {}, {"sigma": 0.5}, 20_000),
    ("sigma 1.0", {}, {"sigma": 1.0}, 20_000),
    ("obstacle map over 45 deg", {}, {"obstacle_field_deg": 45.0}, 20_000),
    ("obstacle map over 90 deg", {}, {"obstacle_field_deg": 90.0}, 20_000),
    ("eta 0.1", {}, {"rule": {"eta": 0.1}}, 20_000),
    ("xi 0.8", {}, {"rule": {"xi": 0.8}}, 20_000),
    ("2,000 movements", {}, {}, 2_000),
]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=2, help="seeds, from 100 on")
parser.add_argument("--cases", type=int, default=1_000, help="cases for each seed")
parser.add_argument("--movements", type=int, help="legal movements, for all rows")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

OUTCOMES = ("success", "collision", "joint_limit")
rows: list[dict[str, Any]] = []
if not arguments.json:
    print("| change | success | collision | joint limit | legal |")
    print("| --- | --- | --- | --- | --- |")
for name, changes, brain, movements in CHANGES:
    config = {"profile": "paper", **changes}
    tests, legal = [], []
    for seed in range(100, 100 + arguments.seeds):
        env = BabbleReachEnv(control="pattern", reward="sparse", config=config)
        agent = HebbBabbling(env, seed=seed, brain=brain)
        agent.learn(arguments.movements or movements)
        cases = scenarios("table1", arguments.cases, seed, split="validation", config=config)
        tests.append(evaluate(agent, cases=cases))
        legal.append(agent.learnt_rate)
    rates = {outcome: fmean(test.rate(outcome) for test in tests) for outcome in OUTCOMES}
    rates["legal_rate"] = fmean(legal)
    rows.append({"change": name, **rates})
    if not arguments.json:
        print(f"| {name} | {' | '.join(f'{rate:.3f}' for rate in rates.values())} |", flush=True)
if arguments.json:
    print(json.dumps(rows))
