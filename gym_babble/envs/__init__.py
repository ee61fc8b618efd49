"""The environments."""

from gym_babble.envs.grasp import BabbleGraspEnv, BabbleGraspVectorEnv
from gym_babble.envs.reach import BabbleReachEnv, BabbleReachVectorEnv
from gym_babble.envs.single import BabbleEnv
from gym_babble.envs.vector import BabbleVectorEnv

__all__ = [
    "BabbleEnv",
    "BabbleGraspEnv",
    "BabbleGraspVectorEnv",
    "BabbleReachEnv",
    "BabbleReachVectorEnv",
    "BabbleVectorEnv",
]
