"""An object of your own: a ball of another size, weight and friction.

You learn to set them, to babble with the ball in the hand, and to test on cases with it. Beside the
agent that babbles with your ball (the chain), the paper's agent tries, which comes with the package
and babbled with balls of 2.4 and 6 cm.
"""

import argparse

import gymnasium as gym

from gym_babble import HebbBabbling, evaluate, load_agent, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--diameter", type=float, default=4.0, help="of the ball [cm]")
parser.add_argument("--density", type=float, default=1000.0, help="[kg/m³]: this one sinks")
parser.add_argument("--friction", type=float, default=0.5, help="between ball and hand")
parser.add_argument("--babbles", type=int, default=100, help="babbles to learn from")
parser.add_argument("--cases", type=int, default=200, help="held-out cases of region palm_side")
arguments = parser.parse_args()

size = [arguments.diameter / 100]
ball = {"density_kg_m3": arguments.density, "friction": arguments.friction}
config = {"body": {"object": ball}}
env = gym.make("BabbleGrasp-v0", diameters=size, config=config)
cases = scenarios("palm_side", arguments.cases, diameters=size, config=config)
agents = {
    "the paper's, other balls": load_agent("grasp.hebb-paper", env),
    "the chain, this ball": HebbBabbling(env, "chain", seed=0).learn(arguments.babbles),
}
for name, agent in agents.items():
    result = evaluate(agent, cases=cases)
    low, high = result.interval("held")
    print(f"{name}: held {result.rate('held'):.3f} [{low:.3f}, {high:.3f}]")
