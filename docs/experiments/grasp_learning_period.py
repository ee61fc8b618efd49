"""When should the rule learn: once in a babble, or along the movement, and how often?

For each period the table has Table II's rate of reaching and its learned equilibrium points, small
and big, and Fig. 8's mean weight by distance from the peak. docs/grasping.md has the results.
"""

import argparse
import json
from time import process_time

import numpy as np

from gym_babble import HebbBabbling, evaluate, scenarios
from gym_babble.paper.fig8 import weights_by_distance
from gym_babble.paper.table2 import recalled_hands

PERIODS_S = (None, 0.5, 0.2, 0.1, 0.05)

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--first", type=int, default=0, help="first seed of the babbling")
parser.add_argument("--seeds", type=int, default=3)
parser.add_argument("--babbles", type=int, default=1_000)
parser.add_argument("--every", type=int, default=1, help="play each n-th test of Table II")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

tests = scenarios("table2")[:: arguments.every]
sizes = sorted({case["diameter"] for case in tests})
rows = []
if not arguments.json:
    heads = ["period [s]", "reach small", "big", "EPs small", "big", "weight at 0"]
    heads += ["1", "2", "4", "7", "15 neurons", "CPU [s]"]
    print(f"| {' | '.join(heads)} |")
    print("| --- " * len(heads) + "|")
for period_s in PERIODS_S:
    brain = {"learning_period_s": period_s}
    reach, hands, hats, seconds = [], [], [], []
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        began = process_time()
        agent = HebbBabbling("BabbleGrasp-v0", seed=seed, brain=brain).learn(arguments.babbles)
        seconds.append(process_time() - began)
        hats.append(weights_by_distance(agent))
        of_size = [[case for case in tests if case["diameter"] == size] for size in sizes]
        played = [evaluate(agent, cases=cases, max_episode_steps=240) for cases in of_size]
        reach.append([float(np.mean(result.facts["reach"])) for result in played])
        hands.append([recalled_hands(agent, cases).mean(axis=0).tolist() for cases in of_size])
    hat = np.mean([weights[:16] for weights in hats], axis=0)
    means = np.mean(reach, axis=0), np.mean(hands, axis=0)
    rows.append(
        {
            "period_s": period_s,
            "reach": means[0].tolist(),
            "reach_by_seed": reach,
            "hands": means[1].tolist(),
            "weights_by_distance": hat.tolist(),
            "cpu_seconds": float(np.mean(seconds)),
        }
    )
    if not arguments.json:
        cells = [f"{rate:.3f}" for rate in means[0]]
        cells += [", ".join(f"{ep:.1f}" for ep in hand) for hand in means[1]]
        cells += [f"{hat[d]:.3f}" for d in (0, 1, 2, 4, 7, 15)]
        cells += [f"{np.mean(seconds):.1f}"]
        print(f"| {period_s or 'once'} | {' | '.join(cells)} |", flush=True)
if arguments.json:
    print(json.dumps(rows))
