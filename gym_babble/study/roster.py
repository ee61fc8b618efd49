"""The agents of studies by name: how each learns, what it sees and what it knows beforehand.

To add one, write its trainer in a file and add its line here. An agent of your own needs no line:
a study takes "module:Class".
"""

from __future__ import annotations

import difflib
import importlib
import re
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from gym_babble.errors import ConfigError
from gym_babble.study.trainers.own import own_trainer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gym_babble.study.trainers.base import Order, Trainer

__all__ = ["ROSTER", "Place", "RosterAgent", "roster_agent", "trainer_for"]

PATTERN, REACH, GRASP = "BabbleReachPattern-v0", "BabbleReach-v0", "BabbleGrasp-v0"

GOAL = "BabbleReachGoal-v0"

TUNED = Path(__file__).parent / "tuned"

REFLEX = "enclosure reflex"
IN_HAND = "objects placed in the hand"
GEOMETRY = "body geometry"
SIMULATOR = "the simulator"
GENERATORS = "movement patterns"


class Place(NamedTuple):
    """Where an agent learns a task, and how long."""

    env_id: str
    budget: int
    """Control steps to learn from; 0 if it does not learn."""
    sees: str
    """What it decides from."""
    knows: tuple[str, ...] = ()
    """What it knows or has before it learns."""


@dataclass(frozen=True, kw_only=True)
class RosterAgent:
    """An agent that a study can name."""

    title: str
    trainer: str
    """Its trainer, "module:function" in `gym_babble.study.trainers`; the function takes an
    `Order`."""
    tasks: Mapping[str, Place]
    """The tasks that it can do."""
    options: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    seeded: bool = True
    """Whether it depends on the seed; if not, one run is enough."""
    in_compare: bool = True
    """Whether `gym-babble compare` includes it unless agents are named."""

    @property
    def extra(self) -> str | None:
        """The extra that its trainer needs and that is not installed; None if none is missing."""
        needs_it = self.trainer.startswith("sb3:")
        return "sb3" if needs_it and find_spec("stable_baselines3") is None else None

    def tuned(self, env_id: str) -> str:
        """The text of its tuned settings in an environment; empty if it has none in a file."""
        module, _, algorithm = self.trainer.partition(":")
        if module != "sb3":
            return ""
        text = (TUNED / f"{algorithm}.yml").read_text(encoding="utf-8")
        found = re.search(rf"^{re.escape(env_id)}:\n((?: .*\n?|\n)*)", text, re.MULTILINE)
        return found[1] if found else ""


ROSTER = {
    "hebb-paper": RosterAgent(
        title="Hebb paper",
        trainer="babbling:hebb",
        tasks={
            "reach": Place(PATTERN, 24_400_000, "obstacle", (GENERATORS,)),
            "grasp": Place(GRASP, 160_000, "eye and fovea", (REFLEX, IN_HAND)),
        },
    ),
    "hebb-conjunctive": RosterAgent(
        title="Hebb conjunctive",
        trainer="babbling:hebb",
        tasks={"reach": Place(PATTERN, 24_400_000, "obstacle × eye", (GENERATORS,))},
        settings={"variant": "conjunctive"},
    ),
    "hebb-chain": RosterAgent(
        title="Hebb chain",
        trainer="babbling:hebb",
        tasks={"grasp": Place(GRASP, 500_000, "eye and size", (REFLEX, IN_HAND))},
        settings={"variant": "chain"},
        in_compare=False,
    ),
    "nearest-neighbour": RosterAgent(
        title="Nearest neighbours",
        trainer="babbling:nearest_neighbours",
        tasks={
            "reach": Place(PATTERN, 24_400_000, "obstacle × eye", (GENERATORS,)),
            "grasp": Place(GRASP, 160_000, "eye and fovea", (REFLEX, IN_HAND)),
        },
        in_compare=False,
    ),
    "goal-babbling": RosterAgent(
        title="Goal babbling",
        trainer="babbling:goal_babbling",
        tasks={
            "reach": Place(PATTERN, 24_400_000, "obstacle × eye", (GENERATORS,)),
            "grasp": Place(GRASP, 160_000, "eye", (REFLEX, IN_HAND)),
        },
        in_compare=False,
    ),
    "reward-hebb": RosterAgent(
        title="Reward-modulated Hebb",
        trainer="babbling:reward_hebb",
        tasks={"reach": Place(PATTERN, 24_400_000, "obstacle × eye", (GENERATORS,))},
        in_compare=False,
    ),
    "shuffled-pairs": RosterAgent(
        title="Hebb, shuffled pairs",
        trainer="babbling:hebb",
        tasks={
            "reach": Place(PATTERN, 24_400_000, "obstacle", (GENERATORS,)),
            "grasp": Place(GRASP, 160_000, "eye and fovea", (REFLEX, IN_HAND)),
        },
        settings={"shuffled": True},
        in_compare=False,
    ),
    "reflex-only": RosterAgent(
        title="Reflex only",
        trainer="still:reference",
        tasks={"grasp": Place(GRASP, 0, "touch", (REFLEX,))},
        settings={"name": "reflex-only"},
        in_compare=False,
    ),
    "ppo": RosterAgent(
        title="PPO step by step",
        trainer="sb3:ppo",
        tasks={"reach": Place(REACH, 1_000_000, "all"), "grasp": Place(GRASP, 2_500_000, "all")},
        in_compare=False,
    ),
    "ppo-pattern": RosterAgent(
        title="PPO whole movements",
        trainer="sb3:ppo",
        tasks={"reach": Place(PATTERN, 3_670_016, "all", (GENERATORS,))},
    ),
    "ppo-obstacle": RosterAgent(
        title="PPO whole movements, obstacle only",
        trainer="sb3:ppo",
        tasks={"reach": Place(PATTERN, 3_670_016, "obstacle", (GENERATORS,))},
        settings={"senses": ["obstacle"]},
    ),
    "ppo-eye-obstacle": RosterAgent(
        title="PPO whole movements, obstacle and eye",
        trainer="sb3:ppo",
        tasks={"reach": Place(PATTERN, 3_670_016, "obstacle, eye", (GENERATORS,))},
        settings={"senses": ["eye", "obstacle"]},
    ),
    "ppo-reflex": RosterAgent(
        title="PPO step by step, with the reflex",
        trainer="sb3:ppo",
        tasks={"grasp": Place(GRASP, 2_500_000, "all", (REFLEX,))},
        options={"enclosure_reflex": True},
        in_compare=False,
    ),
    "ppo-in-hand": RosterAgent(
        title="PPO step by step, half of the starts in the hand",
        trainer="sb3:ppo",
        tasks={"grasp": Place(GRASP, 2_500_000, "all", (IN_HAND,))},
        settings={"learning_options": {"in_hand_starts": 0.5}},
        in_compare=False,
    ),
    "sac": RosterAgent(
        title="SAC whole movements",
        trainer="sb3:sac",
        tasks={"reach": Place(PATTERN, 896_000, "all", (GENERATORS,))},
    ),
    "sac-her": RosterAgent(
        title="SAC + HER whole movements",
        trainer="sb3:sac",
        tasks={"reach": Place(GOAL, 896_000, "all", (GENERATORS,))},
        in_compare=False,
    ),
    "td3": RosterAgent(
        title="TD3 whole movements",
        trainer="sb3:td3",
        tasks={"reach": Place(PATTERN, 896_000, "all", (GENERATORS,))},
        in_compare=False,
    ),
    "random": RosterAgent(
        title="Random",
        trainer="still:reference",
        tasks={
            "reach": Place(PATTERN, 0, "nothing", (GENERATORS,)),
            "grasp": Place(GRASP, 0, "nothing"),
        },
        settings={"name": "random"},
    ),
    "scripted": RosterAgent(
        title="Scripted",
        trainer="still:reference",
        tasks={
            "reach": Place(PATTERN, 0, "all", (GENERATORS, GEOMETRY)),
            "grasp": Place(GRASP, 0, "all", (REFLEX, GEOMETRY)),
        },
        settings={"name": "scripted"},
        seeded=False,
    ),
    "oracle": RosterAgent(
        title="Oracle",
        trainer="still:reference",
        tasks={
            "reach": Place(PATTERN, 0, "all", (GENERATORS, GEOMETRY, SIMULATOR)),
            "grasp": Place(GRASP, 0, "all", (GEOMETRY, SIMULATOR)),
        },
        settings={"name": "oracle"},
        seeded=False,
    ),
}
"""The agents by name."""


def roster_agent(name: str) -> RosterAgent | None:
    """The roster's agent of a name; None for a file or "module:Class".

    Raises:
        ConfigError: There is no such agent.
    """
    if name in ROSTER:
        return ROSTER[name]
    if any(letter in name for letter in ":./\\"):
        return None
    near = difflib.get_close_matches(name, ROSTER, 1)
    meant = f"; did you mean {near[0]!r}?" if near else ""
    raise ConfigError(
        f"agent = {name!r} is not one of {', '.join(ROSTER)}, nor a file, nor module:Class{meant}"
    )


def trainer_for(name: str, order: Order) -> Trainer:
    """The trainer of an agent by name, from a file, or of "module:Class".

    The order has what the roster says of the agent, as `runs_of` completes it.

    Raises:
        ConfigError: There is no such agent or setting, or it cannot do what is ordered.
        FileNotFoundError: There is no such file.
        MissingExtraError: The trainer needs an extra that is not installed.
    """
    entry = roster_agent(name)
    if entry is None:
        return own_trainer(name, order)
    if order.task not in entry.tasks:
        raise ConfigError(f"agent = {name!r} has no form for {order.task}ing")
    module, _, function = entry.trainer.partition(":")
    make = getattr(importlib.import_module(f"gym_babble.study.trainers.{module}"), function)
    return make(order)  # type: ignore[no-any-return]
