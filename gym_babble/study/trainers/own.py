"""Agents of a user's own, by file or by "module:Class"."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium

from gym_babble.agents.loading import LoadedAgent, own_agent, own_class
from gym_babble.config import Config
from gym_babble.errors import ConfigError
from gym_babble.study.trainers.base import Cost, arguments_of, check_settings
from gym_babble.study.trainers.still import StillTrainer, from_file

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.trainers.base import Order, Trainer

__all__ = ["OwnTrainer", "own_trainer"]

PIECES = 200
"""Pieces that an own agent's learning is divided into, so that checkpoints can come between."""

ACTS_IN = {"reach": "BabbleReachPattern-v0", "grasp": "BabbleGrasp-v0"}


class _Counter(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Counts the control steps and episodes of an agent that learns by stepping its environment."""

    def __init__(self, env: Any, steps: int) -> None:
        super().__init__(env)
        self._steps = steps
        self.episodes = self.control_steps = 0

    def step(self, action: Any) -> Any:
        """A step, counted."""
        result = self.env.step(action)
        self.control_steps += self._steps
        self.episodes += int(result[2] or result[3])
        return result


class OwnTrainer:
    """Trains an agent with `learn(control_steps)`, which goes on for about so many control steps.

    What it costs is counted in the environment that the agent was made with. An agent that learns
    elsewhere says it itself, by an attribute `control_steps`, and `trials` if it has them.
    """

    def __init__(self, agent: Any, counter: _Counter, loaded: LoadedAgent) -> None:
        self.agent, self.arguments = agent, loaded.arguments
        self._counter = counter

    @property
    def cost(self) -> Cost:
        """The cost of learning so far."""
        return Cost(
            trials=int(getattr(self.agent, "trials", self._counter.episodes)),
            control_steps=int(getattr(self.agent, "control_steps", self._counter.control_steps)),
        )

    def train(self, control_steps: int, pause: Callable[[], None]) -> None:
        """Calls `learn` in pieces until at least so many control steps have been used in all.

        Raises:
            ConfigError: A piece used no control step.
        """
        piece = max(1, control_steps // PIECES)
        while (before := self.cost.control_steps) < control_steps:
            self.agent.learn(piece)
            if self.cost.control_steps <= before:
                raise ConfigError(
                    f"{type(self.agent).__name__}.learn({piece}) used no control step of the "
                    "environment that the agent was made with: step that one, or count in an "
                    "attribute `control_steps`"
                )
            pause()

    def save(self) -> tuple[str, bytes] | None:
        """No file: a study does not know how to write it."""
        return None


def own_trainer(name: str, order: Order) -> Trainer:
    """A trainer for an agent from a file or of "module:Class".

    Raises:
        ConfigError: There is no such class, or it cannot act where it is ordered to.
        FileNotFoundError: There is no such file.
    """
    if ":" not in name or Path(name).exists():
        return from_file(name, order)
    check_settings(order, ())
    named = getattr(own_class(name), "env", None)
    default = named if isinstance(named, str) else ACTS_IN[order.task]
    arguments = arguments_of(order, default)
    if arguments.task != order.task:
        raise ConfigError(f"{name} acts in {arguments.title}, and the cases are of {order.task}ing")
    whole = arguments.option("control") == "pattern"
    steps = Config.from_json(arguments.interface().task.config()).movement_steps if whole else 1
    counter = _Counter(arguments.single(), steps)
    agent = own_agent(name, counter, seed=order.seed)
    loaded = LoadedAgent(agent, arguments)
    if not callable(getattr(agent, "learn", None)):
        return StillTrainer(loaded)
    if not order.budget:
        raise ConfigError(
            f"budget is missing: {name} learns, so give it control steps to learn from"
        )
    return OwnTrainer(agent, counter, loaded)
