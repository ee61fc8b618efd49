"""Change one number of the body and see its effect on babbling and reaching.

How much does the muscles' damping K_D matter, and with it their lag K_D/K_P? You can change every
number of `gym_babble.Config` like this, or in a TOML file.
"""

import argparse
from dataclasses import replace

import gymnasium as gym

from gym_babble import Config, HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--movements", type=int, default=5_000, help="legal movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
parser.add_argument("--kd", type=float, nargs="+", default=[10, 40, 80], help="K_D [N·m·s/rad]")
arguments = parser.parse_args()

paper = Config.profile_named("paper")
for kd in arguments.kd:
    muscles = replace(paper.body.muscles, kd=kd)
    config = replace(paper, body=replace(paper.body, muscles=muscles))
    env = gym.make("BabbleReachPattern-v0", config=config)
    agent = HebbBabbling(env, seed=0).learn(arguments.movements)
    cases = scenarios("table1", arguments.cases, config=config)
    result = evaluate(agent, cases=cases)
    print(
        f"K_D {kd:g}: lag {kd / muscles.kp:.2f} s, legal {agent.learnt_rate:.3f}, "
        f"success {result.rate('success'):.3f}, collision {result.rate('collision'):.3f}, "
        f"joint_limit {result.rate('joint_limit'):.3f}"
    )
