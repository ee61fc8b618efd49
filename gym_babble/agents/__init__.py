"""Agents: anything with `predict(observation)`, or with stable-baselines3's `predict`."""

from gym_babble.agents.babbling import Experiences, babble
from gym_babble.agents.base import Agent
from gym_babble.agents.chain import ChainAgent
from gym_babble.agents.goal_babbling import GoalBabbling
from gym_babble.agents.hebb import HebbBabbling
from gym_babble.agents.joints import Joints
from gym_babble.agents.loading import load_agent
from gym_babble.agents.neighbours import NearestNeighbours
from gym_babble.agents.network import PolicyNetwork
from gym_babble.agents.reference import Oracle, Random, ReflexOnly, Scripted
from gym_babble.agents.reward_hebb import RewardHebb

__all__ = [
    "Agent",
    "ChainAgent",
    "Experiences",
    "GoalBabbling",
    "HebbBabbling",
    "Joints",
    "NearestNeighbours",
    "Oracle",
    "PolicyNetwork",
    "Random",
    "ReflexOnly",
    "RewardHebb",
    "Scripted",
    "babble",
    "load_agent",
]
