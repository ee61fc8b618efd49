"""A learning rule of your own, in NumPy: Eq. 7 of the paper beside plain Hebb, and Oja's rule.

You learn that a rule is a function of activities and weights, which returns the weights' changes.
Eq. 7 gets the paper's success. Without its averages, every input neuron is tied to every movement
that was ever legal.

python examples/own_rule.py --movements 2000    # 20,000 if not given: about a minute each
"""

import argparse
import json

import numpy as np

from gym_babble import HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--movements", type=int, default=20_000, help="legal movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
parser.add_argument("--variant", default="paper", choices=["paper", "conjunctive"])
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()


Array = np.ndarray


def covariance(  # noqa: PLR0917 - a rule's arguments
    a: Array, a_mean: Array, g: Array, g_mean: Array, w: Array, eta: float, w_max: float
) -> Array:
    """Eq. 7: what deviates from its average together is connected, up to a bound."""
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


def hebb(
    a: Array, _a_mean: Array, g: Array, _g_mean: Array, w: Array, eta: float, w_max: float
) -> Array:
    """Hebb's rule: what is active together is connected."""
    return eta * np.outer(a, g) * (w_max - abs(w))


cases = scenarios("table1", arguments.cases)
rates = {}
for rule in (hebb, "oja", covariance):
    name = rule if isinstance(rule, str) else rule.__name__
    agent = HebbBabbling("BabbleReachPattern-v0", arguments.variant, rule=rule, seed=0)
    agent.learn(arguments.movements, progress_bar=True)
    result = evaluate(agent, cases=cases)
    rates[name] = result.rate("success")
    if not arguments.json:
        low, high = result.interval("success")
        print(f"{name}: success {rates[name]:.3f} [{low:.3f}, {high:.3f}]")
if arguments.json:
    print(json.dumps(rates))
