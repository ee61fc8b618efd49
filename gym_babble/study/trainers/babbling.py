"""Trains agents that learn by babbling, in babbles that can be learnt from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.agents import GoalBabbling, HebbBabbling, NearestNeighbours, RewardHebb
from gym_babble.study.trainers.base import Cost, arguments_of, check_settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.agents.acting import EnvArguments
    from gym_babble.study.trainers.base import Order

__all__ = [
    "BabblingTrainer",
    "goal_babbling",
    "hebb",
    "nearest_neighbours",
    "reward_hebb",
]

PIECE = {"reach": 10, "grasp": 5}
"""Babbles to learn from between two pauses, by task. What is learnt does not depend on it."""

ACTS_IN = {"reach": "BabbleReachPattern-v0", "grasp": "BabbleGrasp-v0"}


class BabblingTrainer:
    """Trains an agent with `learn(babbles)`, `babbled`, `learnt` and `control_steps`.

    Args:
        agent: The agent.
        arguments: Where it acts.
    """

    def __init__(self, agent: Any, arguments: EnvArguments) -> None:
        self.agent, self.arguments = agent, arguments
        self._piece = PIECE[arguments.task]

    @property
    def cost(self) -> Cost:
        """The cost of learning so far."""
        return Cost(
            trials=self.agent.babbled,
            accepted=self.agent.learnt,
            control_steps=self.agent.control_steps,
        )

    def train(self, control_steps: int, pause: Callable[[], None]) -> None:
        """Babbles until at least so many control steps have been used in all."""
        while self.cost.control_steps < control_steps:
            self.agent.learn(self._piece)
            pause()

    def save(self) -> tuple[str, bytes] | None:
        """The agent's file."""
        return ".safetensors", self.agent.to_bytes()


def nearest_neighbours(order: Order) -> BabblingTrainer:
    """Random babbling with a nearest-neighbour inverse model; its settings are `k`, `babbling`."""
    settings = check_settings(order, ("k", "babbling"))
    arguments = arguments_of(order, ACTS_IN[order.task])
    agent = NearestNeighbours(arguments.single(), seed=order.seed, threads=1, **settings)
    return BabblingTrainer(agent, arguments)


def goal_babbling(order: Order) -> BabblingTrainer:
    """Online goal babbling; its settings are `radius`, `rate` and `noise` of `GoalBabbling`."""
    settings = check_settings(order, ("radius", "rate", "noise"))
    arguments = arguments_of(order, ACTS_IN[order.task])
    agent = GoalBabbling(arguments.single(), seed=order.seed, **settings)
    return BabblingTrainer(agent, arguments)


def reward_hebb(order: Order) -> BabblingTrainer:
    """Reward-modulated Hebb; its settings are `eta` and `noise` of `RewardHebb`."""
    settings = check_settings(order, ("eta", "noise"))
    arguments = arguments_of(order, ACTS_IN[order.task])
    agent = RewardHebb(arguments.single(), seed=order.seed, **settings)
    return BabblingTrainer(agent, arguments)


def hebb(order: Order) -> BabblingTrainer:
    """The paper's agent; its settings are `variant`, `rule`, `brain` and `shuffled`."""
    settings = check_settings(order, ("variant", "rule", "brain", "shuffled"))
    arguments = arguments_of(order, ACTS_IN[order.task])
    agent = HebbBabbling(arguments.single(), seed=order.seed, threads=1, **settings)
    return BabblingTrainer(agent, arguments)
