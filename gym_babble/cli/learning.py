"""Trains the agents that several commands need."""

import gymnasium

from gym_babble.agents import HebbBabbling

__all__ = ["learn_grasping", "learn_reaching"]


def learn_reaching(
    variant: str, movements: int, seed: int, config: str, *, quasi_static: bool = False
) -> HebbBabbling:
    """A Hebb agent of reaching that has learnt from legal movements."""
    env = gymnasium.make("BabbleReachPattern-v0", config=config)
    agent = HebbBabbling(env, variant, seed=seed, quasi_static=quasi_static)
    return agent.learn(movements, progress_bar=True)


def learn_grasping(babbles: int, seed: int, config: str, *, variant: str = "paper") -> HebbBabbling:
    """A Hebb agent of grasping that has learnt from babbles."""
    env = gymnasium.make("BabbleGrasp-v0", config=config)
    agent = HebbBabbling(env, variant, seed=seed)
    return agent.learn(babbles, progress_bar=True)
