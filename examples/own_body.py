"""A body of your own, from a TOML file: does an infant with another body learn as well?

You learn to change any number of the body in a file that holds only what differs, and to babble,
learn and be tested in that body.
"""

import argparse
from pathlib import Path

import gymnasium as gym

from gym_babble import Config, HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
body = Path(__file__).with_name("own_body.toml")
parser.add_argument("--config", type=Path, default=body, help="TOML or JSON file of the body")
parser.add_argument("--movements", type=int, default=5_000, help="legal movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
arguments = parser.parse_args()

for name, config in {"paper": Config(), "own": Config.load(arguments.config)}.items():
    env = gym.make("BabbleReachPattern-v0", config=config)
    agent = HebbBabbling(env, seed=0).learn(arguments.movements)
    # Legal movements of this very body, sampled as the paper sampled its tests.
    cases = scenarios("table1", arguments.cases, config=config)
    result = evaluate(agent, cases=cases)
    elbow = config.body.joints["elbow"]
    print(
        f"{name} body, elbow {elbow.lower_deg:g} to {elbow.upper_deg:g}°: "
        f"legal {agent.learnt_rate:.3f}, success {result.rate('success'):.3f}, "
        f"collision {result.rate('collision'):.3f}, joint_limit {result.rate('joint_limit'):.3f}"
    )
