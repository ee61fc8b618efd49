"""From which side must the hand come?

An agent that knows the arm's geometry goes straight to the object and closes. Its success depends
on the shoulder's start relative to the object. docs/grasping.md has the results.
"""

import argparse
from itertools import pairwise

import numpy as np

from gym_babble import Scripted, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--cases", type=int, default=2_000, help="cases of the full region")
parser.add_argument("--bins", type=int, default=9)
arguments = parser.parse_args()

cases = scenarios("full", arguments.cases, split="validation")
agent = Scripted("BabbleGrasp-v0")
result = evaluate(agent, "BabbleGrasp-v0", cases, max_episode_steps=240)
polar = np.degrees([np.arctan2(case["object"][1], case["object"][0]) for case in cases])
ahead = polar - np.degrees([case["start"][0] for case in cases])
held, palm = (np.array(result.facts[name]) for name in ("held", "palm_reach"))
edges = np.linspace(-200, 240, arguments.bins + 1)

print("| object's direction minus start shoulder [deg] | cases | palm touches | grasped |")
print("| --- | --- | --- | --- |")
for low, high in pairwise(edges):
    chosen = (ahead >= low) & (ahead < high)
    if chosen.any():
        rates = f"{palm[chosen].mean():.2f} | {held[chosen].mean():.2f}"
        print(f"| {low:.0f} to {high:.0f} | {chosen.sum()} | {rates} |")
print(f"| all | {len(cases)} | {palm.mean():.2f} | {held.mean():.2f} |")
