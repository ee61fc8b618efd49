"""Which objects can this hand hold, and which can the fovea tell apart?

The paper prints diameters of 30 and 12 cm. Here the reflex closes on spheres of many sizes, and the
eye looks at them. docs/grasping.md has the results.
"""

import argparse
import json

import numpy as np

from gym_babble.envs import BabbleGraspEnv
from gym_babble.paper.holding import hold_rates

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--trials", type=int, default=100, help="trials of holding for each size")
parser.add_argument(
    "--diameters", type=float, nargs="+", default=[1.5, 2, 2.4, 3, 4, 5, 6, 7, 8, 9, 10, 12]
)
parser.add_argument("--engine", default="tree", choices=["tree", "rapier"])
parser.add_argument("--reflex", type=float, nargs=2, help="flexion of thumb, finger [deg]")
parser.add_argument("--fingers", default="virtual", choices=["virtual", "independent"])
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

grip = {"fingers": arguments.fingers}
grip |= {"reflex_deg": arguments.reflex} if arguments.reflex else {}
config = {"body": {"engine": arguments.engine, "grip": grip}}
rows = []
if not arguments.json:
    print("| diameter [cm] | held | 95 % | flexion thumb, finger [deg] | edges in the fovea |")
    print("| --- | --- | --- | --- | --- |")
for centimetres in arguments.diameters:
    diameter = centimetres / 100
    (rate,) = hold_rates(arguments.trials, config, diameters=[diameter])
    env = BabbleGraspEnv(diameters=[diameter])
    senses, _ = env.reset(seed=0, options={"object": (0.0, 0.24), "start": (-1.0, 0.5)})
    edges = int(np.sum(senses["fovea"] > 0.02))
    rows.append({**rate, "edges": edges})
    if not arguments.json:
        thumb, finger = rate["flexion_deg"]
        print(
            f"| {centimetres:g} | {rate['rate']:.2f} | {rate['low']:.2f}–{rate['high']:.2f} "
            f"| {thumb:.0f}, {finger:.0f} | {edges} of 441 |",
            flush=True,
        )
if arguments.json:
    print(json.dumps(rows))
