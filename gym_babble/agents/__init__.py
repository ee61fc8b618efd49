"""Agents: anything with stable-baselines3's `predict`."""

from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.movements import Agent
from gym_babble.agents.reference import Oracle, RandomBabbling, Scripted

__all__ = ["Agent", "HebbBabbling", "Oracle", "RandomBabbling", "Scripted"]
