"""Which input, rule and readout let an agent reach.

Each network learns from the same babbled movements and is read out in several ways. docs/model.md
has the results. The settings were chosen on validation cases, and the tests here are others.
"""

import argparse
import json
from typing import Any

import gymnasium as gym

from gym_babble import HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--bodies", nargs="+", default=["paper", "icub"], help="profiles")
parser.add_argument("--networks", nargs="+", help="some of the networks by name; all if not given")
parser.add_argument("--movements", type=int, nargs="+", default=[250, 20_000], help="legal ones")
parser.add_argument("--seeds", type=int, default=5, help="seeds of learning, from 20 on")
parser.add_argument(
    "--tests", type=int, default=1_000, help="cases of each seed, from seed 1,000 on"
)
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

PATTERN = "BabbleReachPattern-v0"
HEBB = {"name": "hebb", "eta": 1.0}
EYE = {"obstacle_neurons": 2, "obstacle_field_deg": 180.0, "target_neurons": 11}
"""An obstacle's map so coarse that it tells nothing."""
FINE = {"obstacle_neurons": 41, "obstacle_field_deg": 40.0}
EARLY = {"rule": HEBB | {"w_max": 0.02}, "input_gain": 200.0}
"""Learns from few movements."""
NETWORKS: dict[str, tuple[str, dict[str, Any]]] = {
    "obstacle, Eq. 7": ("paper", {}),
    "obstacle, Hebb": ("paper", {"rule": HEBB}),
    "fine obstacle, Hebb": ("paper", {"rule": HEBB | {"eta": 0.1}, **FINE}),
    "eye, Eq. 7": ("conjunctive", EYE),
    "eye, Hebb": ("conjunctive", EYE | EARLY),
    "obstacle x eye, Eq. 7": ("conjunctive", {}),
    "obstacle x eye, Hebb": ("conjunctive", EARLY),
}
"""Variant and numbers of the brain."""
READOUTS = {
    "mean": {"readout": "population"},
    "peak": {"readout": "peak", "peak_radius": 2},
}


def read_out(learnt: HebbBabbling, env: gym.Env, readout: dict[str, Any]) -> HebbBabbling:
    """The same network with another readout."""
    brain = {name: value for name, value in learnt.brain.items() if name != "variant"}
    agent = HebbBabbling(env, learnt.variant, seed=learnt.seed, brain=brain | readout)
    agent.weights = learnt.weights
    return agent


rows = []
for body in arguments.bodies:
    env = gym.make(PATTERN, config=body)
    of_seeds = range(arguments.seeds)
    tests = [scenarios("table1", arguments.tests, 1_000 + k, config=body) for k in of_seeds]
    for network in arguments.networks or NETWORKS:
        variant, brain = NETWORKS[network]
        agents = [HebbBabbling(env, variant, seed=20 + k, brain=brain) for k in of_seeds]
        for movements in sorted(arguments.movements):
            for agent in agents:
                agent.learn(movements - agent.learnt)
            for readout, numbers in READOUTS.items():
                read = [read_out(agent, env, numbers) for agent in agents]
                results = [
                    evaluate(one, cases=cases) for one, cases in zip(read, tests, strict=True)
                ]
                rates = [result.rate("success") for result in results]
                row = {"body": body, "network": network, "readout": readout, "movements": movements}
                fails = {
                    name: sum(result.rate(name) for result in results) / len(results)
                    for name in ("collision", "joint_limit", "timeout")
                }
                row |= {"success": sum(rates) / len(rates), "by_seed": rates, **fails}
                rows.append(row)
                if not arguments.json:
                    each = ", ".join(f"{rate:.3f}" for rate in rates)
                    named = f"| {body} | {network} | {readout} | {movements:,} |"
                    print(f"{named} {row['success']:.3f} | {each} |", flush=True)
if arguments.json:
    print(json.dumps(rows))
