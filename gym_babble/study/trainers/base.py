"""What all trainers share: where they train, what it costs, and how they pause for tests."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from gym_babble.agents.acting import arguments_for
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from gym_babble.agents.acting import EnvArguments
    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike

__all__ = ["Cost", "Order", "Trainer", "arguments_of", "check_settings"]


@dataclass(frozen=True, kw_only=True)
class Order:
    """What a trainer is asked to train: one agent, task and seed of a study."""

    task: str
    """The task, "reach" or "grasp"."""
    seed: int
    """Seed of learning."""
    budget: int
    """Control steps to learn from."""
    config: ConfigLike = "paper"
    """Body and task."""
    env_id: str | None = None
    """Environment to learn and act in; the trainer's own choice if None."""
    options: dict[str, Any] = field(default_factory=dict)
    """Further options of the environment, e.g. `{"enclosure_reflex": True}`."""
    settings: dict[str, Any] = field(default_factory=dict)
    """Settings of the agent itself."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """The interactions that learning has used so far. All of them count, failed trials too."""

    trials: int = 0
    """Movements, babbles or episodes that have ended."""
    accepted: int | None = None
    """Trials that a babbling agent learnt from; None for agents that learn from all."""
    control_steps: int = 0
    """Control steps; a whole movement counts with all its steps."""


class Trainer(Protocol):
    """Trains one agent. It runs in one thread and one process."""

    agent: Agent
    """The agent: `evaluate` can test it before, between and after learning."""
    arguments: EnvArguments
    """Where the agent acts."""

    @property
    def cost(self) -> Cost:
        """The cost of learning so far."""
        ...

    def train(self, control_steps: int, pause: Callable[[], None]) -> None:
        """Learns until at least so many control steps have been used in all.

        Args:
            control_steps: Where to stop.
            pause: Called after each piece of learning, whenever the agent can be tested. Pieces
                are short beside the distance between checkpoints.
        """
        ...

    def save(self) -> tuple[str, bytes] | None:
        """The agent as a file, with its suffix; None if it has none, as agents that do not learn.

        `gym_babble.evaluate` reads the file.
        """
        ...


def arguments_of(order: Order, env_id: str) -> EnvArguments:
    """The environment of an order; `env_id` unless the order names one.

    Raises:
        ConfigError: An unknown id, option or config.
    """
    return arguments_for(None, order.env_id or env_id, order.config, order.options)


def check_settings(order: Order, known: Collection[str]) -> dict[str, Any]:
    """The settings of an order.

    Raises:
        ConfigError: One is unknown.
    """
    for name in order.settings:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            meant = f"; did you mean {near[0]!r}?" if near else ""
            there = f"there are {', '.join(known)}" if known else "there are none"
            raise ConfigError(f"settings.{name}: unknown setting; {there}{meant}")
    return order.settings
