"""Agents that do not learn in a study: the reference agents, and agents from files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.agents.loading import named_agent
from gym_babble.study.trainers.base import Cost, check_settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.agents.loading import LoadedAgent
    from gym_babble.study.trainers.base import Order

__all__ = ["StillTrainer", "from_file", "reference"]


class StillTrainer:
    """Holds an agent that does not learn."""

    def __init__(self, loaded: LoadedAgent) -> None:
        self.agent, self.arguments = loaded.agent, loaded.arguments

    @property
    def cost(self) -> Cost:
        """No cost."""
        return Cost()

    def train(self, control_steps: int, pause: Callable[[], None]) -> None:
        """Does nothing."""

    def save(self) -> tuple[str, bytes] | None:
        """No file: the agent is there already."""
        return None


def reference(order: Order) -> StillTrainer:
    """The reference agent named by the setting `name`."""
    settings = check_settings(order, ("name",))
    return StillTrainer(
        named_agent(
            settings["name"],
            env_id=order.env_id,
            config=order.config,
            seed=order.seed,
            options=order.options,
        )
    )


def from_file(path: str, order: Order) -> StillTrainer:
    """The agent in a file, acting where it learnt unless the order names an environment.

    The setting `vec_normalize` names the statistics of a model that learnt behind VecNormalize.
    """
    settings = check_settings(order, ("vec_normalize",))
    return StillTrainer(
        named_agent(
            path,
            env_id=order.env_id,
            config=order.config,
            seed=order.seed,
            options=order.options,
            vec_normalize=settings.get("vec_normalize"),
        )
    )
