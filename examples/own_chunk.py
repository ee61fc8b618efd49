"""A chunk of your own, added to the chain that grasps: a hand that missed tries beside.

You learn to wrap an agent, to keep a state for each environment of a batch, and to give the muscles
equilibrium points yourself. When the hand has closed and felt nothing, the chain begins anew at
once, with the palm at the ball, and often closes in the same place. The chunk opens the hand,
extends the elbow, and returns with the shoulder a little off.
"""

import argparse
import json
from statistics import fmean
from typing import Any

import numpy as np

from gym_babble import HebbBabbling, Joints, evaluate, scenarios

BACK = np.radians([0, 25])  # How the arm withdraws: the elbow extends, as in a babble.
STEPS = 30  # Control steps that it withdraws.
BESIDE = 12.0  # Most that the shoulder is off when the arm returns [deg], as in a babble.


class Persistent:
    """An agent that acts in the phases of the chain, and a chunk behind it."""

    env = "BabbleGrasp-v0"

    def __init__(self, chain: HebbBabbling, seed: int = 0) -> None:
        self.chain, self.joints = chain, Joints(self.env)
        self.random = np.random.default_rng(seed)

    def predict(self, observation: Any, state: Any, episode_start: Any, _: Any = None) -> Any:
        """As the chain, unless the hand has closed and missed."""
        arm = self.joints.posture(observation)[:, :2]
        n, start = len(arm), np.asarray(episode_start, bool)
        if state is None:
            state = (None, np.full(n, ""), np.zeros(n, int), arm, np.zeros((n, 2)))
        # The chain's state and phases, steps left to withdraw, where to, and how far off then.
        plans, phases, left, home, off = state
        off = np.where(start[:, None], 0.0, off)
        # An arm that feels turned by an angle goes beside its target by this angle.
        turned = observation | {"arm": observation["arm"] - off.astype(np.float32)}
        actions, plans = self.chain.predict(turned, plans, start | (left == 1))
        left = np.where(start, 0, np.maximum(left - 1, 0))
        now = np.array(plans.phases())
        missed = (phases == "close") & (now == "reach") & (left == 0) & ~start
        left, home = np.where(missed, STEPS, left), np.where(missed[:, None], arm - BACK, home)
        beside = np.radians(self.random.uniform(-BESIDE, BESIDE, n)) / np.ptp(self.joints.ranges[0])
        off = np.where(missed[:, None], np.outer(beside, [1, 0]), off)
        away = self.joints.actions(np.hstack([home, np.zeros((n, 2))]), observation)  # Hand open.
        return np.where(left[:, None] > 0, away, actions), (plans, now, left, home, off)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--babbles", type=int, default=100, help="babbles to learn from")
    parser.add_argument("--cases", type=int, default=200, help="test cases of each seed")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    cases = scenarios("palm_side", arguments.cases, 2000, diameters=[0.024])
    held: dict[str, list[float]] = {"chain": [], "chunk": []}
    for seed in range(arguments.seeds):
        chain = HebbBabbling("BabbleGrasp-v0", "chain", seed=seed).learn(arguments.babbles)
        for name, agent in (("chain", chain), ("chunk", Persistent(chain, seed))):
            result = evaluate(agent, cases=cases, max_episode_steps=400)
            held[name].append(result.rate("held"))
    rows = {name: {"held": fmean(rates), "by_seed": rates} for name, rates in held.items()}
    if arguments.json:
        print(json.dumps(rows))
    else:
        for name, row in rows.items():
            each = ", ".join(f"{rate:.3f}" for rate in row["by_seed"])
            print(f"{name}: held {row['held']:.3f} ({each})")
