"""The environments."""

from gym_babble.envs.reach import BabbleReachEnv
from gym_babble.envs.vector import BabbleReachVectorEnv

__all__ = ["BabbleReachEnv", "BabbleReachVectorEnv"]
