"""A chain of babbles that learns to grasp: an agent of your own in NumPy, on the public API.

A babble begins with the object in the hand. The reflex closes the hand; the arm carries the object
to a random posture; the hand opens; the arm withdraws, looks, comes back a little beside where it
was, and advances until the palm touches the object; the hand closes. A babble that ends with the
object in the hand is learnt from: what the eye saw is linked to the arm before the approach, to the
arm at the touch, and to the closed hand. There are no gradients and no inverse kinematics.
"""

import argparse
import time
from typing import Any

import gymnasium as gym
import numpy as np

import gym_babble
from gym_babble import brain

ENVS = 50
STEP = np.radians(1.5)  # How far the arm advances in a control step.
NEAR = np.radians(12)  # So near its posture the arm begins to advance.
BEYOND = 1.6  # How far it advances, in ways that were babbled.
OPEN = np.zeros(2)
DISTANCE = np.hypot(*np.mgrid[-10:11, -10:11]).ravel()  # Of the fovea's blocks from its middle.


class Chain:
    """What is seen recalls an arm before and after the approach, and a hand."""

    env = "BabbleGrasp-v0"

    def __init__(self, seed: int = 0) -> None:
        self.joints = gym_babble.Joints(self.env)
        self.reflex = gym.make(self.env).unwrapped.interface.quantities["reflex"]
        low, high = self.joints.ranges.T
        margin = (high - low)[:2] / 8  # The maps extend two neurons past each joint limit.
        where = brain.PopulationMap(21, low=[0, 0], high=[1, 1])
        size = brain.PopulationMap(5, low=[1.5], high=[7.5])
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

    def recall(self, seen: Any) -> Any:
        """The postures [rad] that an observation calls up: arm before and after, hand."""
        g = self.see(seen)
        return [one.read_out(g @ w.T) for one, w in zip(self.maps, self.weights, strict=True)]

    def learn(self, babbles: int) -> "Chain":
        """Babbles until so many are learnt from: Δw = η g (a − w), η = 1 / use of the synapse."""
        envs = gym.make_vec(
            self.env, ENVS, control="posture", max_episode_steps=500, enclosure_reflex=True,
            reflex_releases=True, support_stays=True,
        )  # fmt: skip
        while self.learnt < babbles:
            kept, seen, *postures = self.babble(envs)
            self.babbled += ENVS
            for i in np.flatnonzero(kept)[: babbles - self.learnt]:
                g = self.see({name: sense[i : i + 1] for name, sense in seen.items()})[0]
                self.use += g
                for one, w, posture in zip(self.maps, self.weights, postures, strict=True):
                    a = one.encode(posture[i])[:, None]
                    np.add(w, g / self.use * (a - w), out=w)
                self.learnt += 1
        return self

    def babble(self, envs: Any) -> Any:
        """A babble in each environment: which ones are kept, what was seen, and three postures."""

        def move(arm: Any, hand: Any, steps: int) -> Any:
            for _ in range(steps):
                points = np.hstack([arm, np.broadcast_to(hand, (ENVS, 2))])
                seen = envs.step(joints.actions(points))[0]
            return seen, self.joints.posture(seen)[:, :2]

        def drawn(low: float, high: float, joint: int) -> Any:
            turn = np.zeros((ENVS, 2))
            turn[:, joint] = np.radians(self.random.uniform(low, high, ENVS))
            return turn

        joints = gym_babble.Joints(envs)
        low, high = joints.ranges[:2].T
        seen, _ = envs.reset(seed=int(self.random.integers(2**31)), options={"in_hand": True})
        move(self.joints.posture(seen)[:, :2], self.reflex, 45)
        _, grasped = move(self.random.uniform(low, high, (ENVS, 2)), self.reflex, 50)
        move(grasped, OPEN, 40)
        way = drawn(10, 40, 1)
        move(grasped - way, OPEN, 40)
        away, _ = move(grasped - way - drawn(30, 70, 0), OPEN, 40)
        _, before = move(grasped - way + drawn(-6, 6, 0), OPEN, 50)
        after, touched = before.copy(), np.zeros(ENVS, bool)
        for step in range(60):
            advance = np.minimum(STEP * step / way[:, 1:], BEYOND)
            seen, arm = move(np.where(touched[:, None], after, before + advance * way), OPEN, 1)
            new = ~touched & (seen["touch"][:, 0] > 0)
            after[new], touched = arm[new], touched | new
        felt, _ = move(after, self.reflex, 45)
        force = felt["touch"] > 0
        kept = touched & force[:, 2] & (force[:, 0] | force[:, 1])
        return kept, away, before, after, self.joints.posture(felt)[:, 2:]

    def predict(self, observation: Any, state: Any, episode_start: Any, _: Any = None) -> Any:
        """Goes to the recalled arm, advances until the palm touches, and closes the hand."""
        seen = {name: np.atleast_2d(sense) for name, sense in observation.items()}
        arm, felt = self.joints.posture(seen)[:, :2], seen["touch"][:, 0] > 0
        if state is None:
            names = {"before": 2, "way": 2, "hand": 2, "steps": 1, "touched": 1, "stopped": 2}
            state = {name: np.zeros((len(arm), n)) for name, n in names.items()}
        new = np.flatnonzero(episode_start)
        if len(new):
            before, after, hand = self.recall({name: sense[new] for name, sense in seen.items()})
            state["before"][new], state["way"][new] = before, after - before
            state["hand"][new] = np.minimum(hand + np.radians(20), self.reflex)
            state["steps"][new] = state["touched"][new] = 0
        touching = felt & (state["touched"][:, 0] == 0)
        state["stopped"][touching], state["touched"][touching] = arm[touching], 1
        near = np.abs(arm - state["before"]).max(1) < NEAR
        state["steps"][near | (state["steps"][:, 0] > 0)] += 1
        length = np.maximum(np.abs(state["way"]).max(1, keepdims=True), STEP)
        advance = np.minimum(STEP * state["steps"] / length, BEYOND)
        points = np.where(
            state["touched"] > 0,
            np.hstack([state["stopped"], state["hand"]]),
            np.hstack([state["before"] + advance * state["way"], np.zeros((len(arm), 2))]),
        )
        actions = self.joints.actions(points, seen)
        return (actions if np.ndim(episode_start) else actions[0]), state


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--babbles", type=int, default=1000, help="babbles to learn from")
    parser.add_argument("--cases", type=int, default=300, help="test cases of each size")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    chain = Chain(arguments.seed).learn(arguments.babbles)
    seconds = time.process_time()
    print(f"{chain.babbled} babbles, {chain.learnt} learnt from, {seconds:.0f} s of CPU time")
    for cm in (2.4, 4, 6):  # 4 cm was never babbled.
        cases = gym_babble.scenarios("palm_side", arguments.cases, 2000, diameters=[cm / 100])
        print(f"{cm} cm: held {gym_babble.evaluate(chain, cases=cases).rate('held'):.3f}")
