"""A chain of babbles that learns to grasp: an agent of your own in NumPy, on the public API.

A babble begins with the object in the hand. The reflex closes the hand; the arm carries the object
to a random posture; the hand opens; the arm withdraws, looks, comes back a little beside where it
was, and advances until the palm touches the object; the hand closes. A babble that ends with the
object in the hand is learnt from: what the eye saw is linked to the arm before the approach, to the
arm at the touch, and to the closed hand. There are no gradients and no inverse kinematics.
`gym_babble.ChainAgent` then acts on what is recalled: it reaches, advances, and closes the hand.
"""

import argparse
import json
from typing import Any

import gymnasium as gym
import numpy as np

import gym_babble
from gym_babble import brain

ENVS = 50
STEP = np.radians(1.5)  # How far the arm advances in a control step.
BEYOND = 1.6  # How far it advances in a babble, in ways of its withdrawal.
OPEN = np.zeros(2)
DISTANCE = np.hypot(*np.mgrid[-10:11, -10:11]).ravel()  # Of the fovea's blocks from its middle.


class Chain(gym_babble.ChainAgent):
    """What is seen recalls an arm before and after the approach, and a hand."""

    env = "BabbleGrasp-v0"

    def __init__(self, seed: int = 0) -> None:
        super().__init__(self.env)
        self.envs = gym.make_vec(
            self.env, ENVS, control="posture", max_episode_steps=500, enclosure_reflex=True,
            reflex_releases=True, support_stays=True,
        )  # fmt: skip
        self.joints = gym_babble.Joints(self.envs)
        self.reflex = self.interface.quantities["reflex"]
        low, high = self.joints.ranges.T
        margin = (high - low)[:2] / 8  # The maps extend two neurons past each joint limit.
        where = brain.PopulationMap(21, low=[0, 0], high=[1, 1])
        size = brain.PopulationMap(3, low=[1.5], high=[7.5])
        self.sight = brain.ConjunctiveMap(where, size)
        arm = brain.PopulationMap(21, low=low[:2] - margin, high=high[:2] + margin)
        self.maps = [arm, arm, brain.PopulationMap(21, low=low[2:], high=high[2:])]
        self.weights = [np.zeros((len(one), len(self.sight)), np.float32) for one in self.maps]
        self.use = np.full(len(self.sight), 1e-9, np.float32)
        self.random = np.random.default_rng(seed)
        self.babbled = self.learnt = 0

    def see(self, seen: Any) -> Any:
        """Activities (n, N) for the place of an object, and its size: how far out its edges are."""
        edges = seen["fovea"]
        size = edges @ DISTANCE / np.maximum(edges.sum(-1), 1e-6)
        return self.sight.encode(seen["eye"], np.clip(size, 1.5, 7.5)[:, None])

    def recall(self, senses: Any) -> Any:
        """The postures [rad] that the senses call up; the hand closes 20° further than babbled."""
        g = self.see(senses)
        before, after, hand = (
            one.read_out(g @ w.T) for one, w in zip(self.maps, self.weights, strict=True)
        )
        return before, after, np.minimum(hand + np.radians(20), self.reflex)

    def learn(self, babbles: int) -> "Chain":
        """Babbles until so many are learnt from: Δw = η g (a − w), η = 1 / use of the synapse."""
        while self.learnt < babbles:
            kept, seen, *postures = self.babble()
            self.babbled += ENVS
            for i in np.flatnonzero(kept)[: babbles - self.learnt]:
                g = self.see({name: sense[i : i + 1] for name, sense in seen.items()})[0]
                self.use += g
                for one, w, posture in zip(self.maps, self.weights, postures, strict=True):
                    a = one.encode(posture[i])[:, None]
                    np.add(w, g / self.use * (a - w), out=w)
                self.learnt += 1
        return self

    def move(self, arm: Any, hand: Any, steps: int) -> Any:
        """The muscles pull to a posture; what is sensed then, and the arm (n, 2)."""
        actions = self.joints.actions(np.hstack([arm, np.tile(hand, (ENVS, 1))]))
        for _ in range(steps):
            senses = self.envs.step(actions)[0]
        return senses, self.joints.posture(senses)[:, :2]

    def turn(self, joint: int, low: float, high: float) -> Any:
        """Turns (n, 2) of one joint by random angles between two [deg]."""
        turns = np.zeros((ENVS, 2))
        turns[:, joint] = np.radians(self.random.uniform(low, high, ENVS))
        return turns

    def babble(self) -> Any:
        """A babble in each environment: which ones are kept, what was seen, and three postures."""
        low, high = self.joints.ranges[:2].T
        seed = int(self.random.integers(2**31))
        senses, _ = self.envs.reset(seed=seed, options={"in_hand": True})
        self.move(self.joints.posture(senses)[:, :2], self.reflex, 45)
        _, grasped = self.move(self.random.uniform(low, high, (ENVS, 2)), self.reflex, 50)
        self.move(grasped, OPEN, 40)
        way = self.turn(1, 10, 40)
        self.move(grasped - way, OPEN, 40)
        seen, _ = self.move(grasped - way - self.turn(0, 30, 70), OPEN, 40)
        _, before = self.move(grasped - way + self.turn(0, -12, 12), OPEN, 50)
        after, touched = before.copy(), np.zeros((ENVS, 1), bool)
        for step in range(60):
            advance = np.minimum(STEP * step / way[:, 1:], BEYOND)
            senses, arm = self.move(np.where(touched, after, before + advance * way), OPEN, 1)
            new = ~touched & (senses["touch"][:, :1] > 0)
            after, touched = np.where(new, arm, after), touched | new
        senses, _ = self.move(after, self.reflex, 45)
        kept = touched[:, 0] & feels(senses)
        return kept, seen, before, after, self.joints.posture(senses)[:, 2:]


def feels(senses: Any) -> Any:
    """Whether fingers and palm, or fingers and thumb, feel an object (n,)."""
    palm, thumb, fingers = (senses["touch"] > 0).T
    return fingers & (palm | thumb)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--babbles", type=int, default=1000, help="babbles to learn from")
    parser.add_argument("--cases", type=int, default=300, help="test cases of each size")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    rows = []
    for seed in range(arguments.seeds):
        chain = Chain(seed).learn(arguments.babbles)
        for cm in (2.4, 4, 6):  # 4 cm was never babbled.
            cases = gym_babble.scenarios("palm_side", arguments.cases, 2000, diameters=[cm / 100])
            held = gym_babble.evaluate(chain, cases=cases).rate("held")
            rows.append({"seed": seed, "babbled": chain.babbled, "cm": cm, "held": held})
    if arguments.json:
        print(json.dumps(rows))
    else:
        for row in rows:
            print("seed {seed}, {babbled} babbles, {cm} cm: held {held:.3f}".format(**row))
