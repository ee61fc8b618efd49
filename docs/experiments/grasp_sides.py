"""From which side must the hand come?

An agent that knows the arm's geometry goes straight to the object and closes. Its success depends
on the shoulder's start relative to the object. docs/grasping.md has the results.
"""

import argparse
import json
from itertools import pairwise

import numpy as np

from gym_babble import Scripted, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--cases", type=int, default=2_000, help="cases of the full region")
parser.add_argument("--bins", type=int, default=9)
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

cases = scenarios("full", arguments.cases, split="validation")
agent = Scripted("BabbleGrasp-v0")
result = evaluate(agent, cases=cases, max_episode_steps=240)
polar = np.degrees([np.arctan2(case["object"][1], case["object"][0]) for case in cases])
ahead = polar - np.degrees([case["start"][0] for case in cases])
held, palm = (np.array(result.facts[name]) for name in ("held", "palm_reach"))
edges = np.linspace(-200, 240, arguments.bins + 1)
rows = []
for low, high in pairwise(edges.tolist()):
    chosen = (ahead >= low) & (ahead < high)
    if chosen.any():
        rates = {"palm_reach": palm[chosen].mean(), "held": held[chosen].mean()}
        rows.append({"low": low, "high": high, "cases": int(chosen.sum()), **rates})
total = {"cases": len(cases), "palm_reach": palm.mean(), "held": held.mean()}

if arguments.json:
    print(json.dumps({"rows": rows, "all": total}))
else:
    print("| object's direction minus start shoulder [deg] | cases | palm touches | grasped |")
    print("| --- | --- | --- | --- |")
    for row in (*rows, total):
        angles = f"{row['low']:.0f} to {row['high']:.0f}" if "low" in row else "all"
        print(f"| {angles} | {row['cases']} | {row['palm_reach']:.2f} | {row['held']:.2f} |")
