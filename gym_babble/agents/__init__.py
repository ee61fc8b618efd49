"""Agents: anything with stable-baselines3's `predict`."""

from gym_babble.agents.base import Agent
from gym_babble.agents.grasping import GraspRandom, GraspScripted, HebbGrasping
from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.reference import Oracle, RandomBabbling, Scripted

__all__ = [
    "Agent",
    "GraspRandom",
    "GraspScripted",
    "HebbBabbling",
    "HebbGrasping",
    "Oracle",
    "RandomBabbling",
    "Scripted",
]
