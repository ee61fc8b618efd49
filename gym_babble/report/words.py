"""The texts of each task's page."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["WORDS", "Words"]


class Words(NamedTuple):
    """The texts of a task's page."""

    heading: str
    lead: str
    cases: str
    rates: str
    """Explains the rates of the table."""
    learning: str
    """Explains the numbers on learning."""


WORDS = {
    "reach": Words(
        heading="Reaching around an obstacle: Hebb babbling beside PPO",
        lead="An arm learns to reach a target behind an obstacle: by motor babbling and a Hebb "
        "rule, as in Caligiore et al. (2008), and by reinforcement learning. All agents are tested "
        "on the same cases in the same simulation.",
        cases="legal cases that no agent has learnt from",
        rates="A case is legal if a babbled movement solved it, so every case can be solved.",
        learning="Movements: for Hebb, the legal movements it learnt from, and their share of all "
        "babbled movements; for PPO, episodes. Steps: control steps simulated during learning, in "
        "millions; a movement counts with all its steps.",
    ),
    "grasp": Words(
        heading="Grasping an object: Hebb babbling beside PPO",
        lead="An arm with a hand learns to reach for an object that it sees and to grasp it: by "
        "motor babbling with the object in the hand and a Hebb rule, as in Caligiore et al. "
        "(2008), and by reinforcement learning. All agents are tested on the same cases in the "
        "same simulation.",
        cases="objects on the palm's side of the arm that no agent has learnt from",
        rates="Success: the hand has held the object without support for a second. Touch: any part "
        "of arm or hand has touched the object, successful or not; of palm: the palm has.",
        learning="Babbles: for Hebb, the babbles in which the hand kept the object, and their "
        "share of all babbles; for PPO, episodes. Steps: control steps simulated during learning, "
        "in millions; a babble lasts 4 s.",
    ),
}
"""The texts of each task."""
