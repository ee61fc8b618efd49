"""What the core says of a robot, and the planar mechanics that follow from it."""

from __future__ import annotations

import json

import numpy as np

from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv


class Ours:
    """Links of a robot that all turn about the vertical."""

    def __init__(self, task, config):
        self.core = (BabbleReachEnv if task == "reach" else BabbleGraspEnv)(
            config=config
        ).interface.task
        self.links = json.loads(self.core.robot())
        self.low, self.high = np.array([link["range"] for link in self.links]).T
        self.sense = np.array([-1 if link["clockwise"] else 1 for link in self.links])

    def posture(self, shares):
        return self.low + np.array(shares[: len(self.links)]) * (self.high - self.low)

    def place(self, q):
        """Angle [rad] and origin [m] of every link."""
        placed = []
        for link, turn in zip(self.links, self.sense * q, strict=True):
            angle, origin = (0.0, np.zeros(3)) if link["parent"] is None else placed[link["parent"]]
            origin = origin + turned(link["origin"], angle)
            placed.append((angle + link["direction"] + turn, origin))
        return placed

    def mass_matrix(self, q):
        """The sum over the links of m Jᵀ J and I_zz ωᵀ ω [kg·m²]."""
        placed, n = self.place(q), len(self.links)
        total = np.zeros((n, n))
        for i, (link, (angle, origin)) in enumerate(zip(self.links, placed, strict=True)):
            centre = origin + turned(link["centre"], angle)
            motion, spin = np.zeros((2, n)), np.zeros(n)
            carrier = i
            while carrier is not None:
                x, y, _ = centre - placed[carrier][1]
                motion[:, carrier] = self.sense[carrier] * np.array([-y, x])
                spin[carrier] = self.sense[carrier]
                carrier = self.links[carrier]["parent"]
            total += link["mass"] * motion.T @ motion + link["inertia"][8] * np.outer(spin, spin)
        return total


def turned(vector, angle):
    (x, y, z), c, s = vector, np.cos(angle), np.sin(angle)
    return np.array([c * x - s * y, s * x + c * y, z])
