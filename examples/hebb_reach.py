"""Babble, learn, reach: the paper's agent (Caligiore et al. 2008) in a dozen lines.

python examples/hebb_reach.py            # 20,000 legal movements: the paper's test, about 15 s
"""

import argparse

from gym_babble import HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--movements", type=int, default=20_000, help="legal movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
arguments = parser.parse_args()

agent = HebbBabbling("BabbleReachPattern-v0", variant="paper", seed=0)
agent.learn(arguments.movements, progress_bar=True)
print(f"{agent.learnt_rate:.3f} of {agent.babbled} babbled movements were legal (paper: about .20)")

result = evaluate(agent, cases=scenarios("table1", arguments.cases))
for outcome, paper in (("collision", 0.23), ("joint_limit", 0.10), ("success", 0.67)):
    low, high = result.interval(outcome)
    print(f"{outcome} {result.rate(outcome):.3f} [{low:.3f}, {high:.3f}] (paper: {paper:.2f})")
