"""Agents: anything with `predict(observation)`, or with stable-baselines3's `predict`."""

from gym_babble.agents.babbling import Experiences, babble
from gym_babble.agents.base import Agent
from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.loading import load_agent
from gym_babble.agents.reference import Oracle, Random, Scripted

__all__ = [
    "Agent",
    "Experiences",
    "HebbBabbling",
    "Oracle",
    "Random",
    "Scripted",
    "babble",
    "load_agent",
]
