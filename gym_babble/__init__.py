"""Reaching learned by motor babbling: Gymnasium environments with a Rust core.

Importing this package registers its environments with Gymnasium:

    >>> import gymnasium as gym, gym_babble
    >>> env = gym.make("BabbleReach-v0")

After Caligiore, Ferrauto, Parisi, Accornero, Capozza, Baldassarre: Using motor babbling and Hebb
rules for modeling the development of reaching with obstacles and grasping (2008).
"""

import warnings

from gym_babble._core import __version__, debug_build
from gym_babble.agents import (
    Agent,
    ChainAgent,
    Experiences,
    GoalBabbling,
    HebbBabbling,
    Joints,
    NearestNeighbours,
    Oracle,
    Random,
    ReflexOnly,
    RewardHebb,
    Scripted,
    babble,
    load_agent,
)
from gym_babble.config import Config
from gym_babble.envs.registration import register_all
from gym_babble.export import export_mjcf, export_urdf
from gym_babble.study.evaluation import evaluate
from gym_babble.study.outcomes import Evaluation
from gym_babble.study.scenarios import Scenario, scenarios

__all__ = [
    "Agent",
    "ChainAgent",
    "Config",
    "Evaluation",
    "Experiences",
    "GoalBabbling",
    "HebbBabbling",
    "Joints",
    "NearestNeighbours",
    "Oracle",
    "Random",
    "ReflexOnly",
    "RewardHebb",
    "Scenario",
    "Scripted",
    "__version__",
    "babble",
    "evaluate",
    "export_mjcf",
    "export_urdf",
    "load_agent",
    "scenarios",
]

register_all()

if debug_build:
    warnings.warn(
        "gym_babble's core was built without optimisation: run `make setup`", stacklevel=2
    )
