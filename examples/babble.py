"""An infant babbles, and you watch its weights and its success grow.

You learn the paper's agent (Caligiore et al. 2008): random movements, of which the legal ones are
learnt from by a Hebb rule (Eq. 7), and what its weights say: a row of `weights` is a neuron of the
movement map, a column a neuron of the map of what the eye sees.

python examples/babble.py --movements 20000    # the paper's number: it has a success of .67
"""

import argparse

import numpy as np

from gym_babble import HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--movements", type=int, default=2_000, help="legal movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
parser.add_argument("--picture", help="file for a picture of the weights; needs matplotlib")
arguments = parser.parse_args()

cases = scenarios("table1", arguments.cases)
agent = HebbBabbling("BabbleReachPattern-v0", seed=0)
moments = {}


def watch(agent: HebbBabbling) -> None:
    """Tests the agent, and keeps the weights of the input neuron that has learnt most."""
    weights = agent.weights["weights"]  # (movement neurons, obstacle neurons)
    column = weights[:, np.abs(weights).sum(0).argmax()]
    moments[agent.learnt] = column.reshape(21, 21)
    success, size = evaluate(agent, cases=cases).rate("success"), abs(weights).mean()
    print(f"{agent.learnt:6,} of {agent.babbled:7,}: mean |w| {size:.4f}, success {success:.3f}")


agent.learn(arguments.movements, callback=watch, callback_every=max(1, arguments.movements // 4))
if arguments.picture:
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, len(moments), figsize=(3 * len(moments), 3))
    for panel, (learnt, weights) in zip(panels, moments.items(), strict=True):
        most = abs(weights).max()
        panel.imshow(weights, origin="lower", cmap="RdBu_r", vmin=-most, vmax=most)
        panel.set(title=f"{learnt:,} movements", xlabel="b1", ylabel="b2", xticks=[], yticks=[])
    figure.savefig(arguments.picture)
result = evaluate(agent, cases=cases)
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
