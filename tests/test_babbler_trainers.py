"""The developmental baselines in studies: each learns there, and its cost and file are complete."""

import pytest

from gym_babble import evaluate, scenarios
from gym_babble.agents import ReflexOnly
from gym_babble.envs import BabbleGraspEnv
from gym_babble.study.roster import ROSTER, trainer_for
from gym_babble.study.trainers.base import Order

BABBLERS = ("nearest-neighbour", "goal-babbling", "reward-hebb", "shuffled-pairs")
EACH = [(name, task) for name in BABBLERS for task in ROSTER[name].tasks]


@pytest.mark.parametrize(("name", "task"), EACH)
def test_each_trains_and_counts_all_that_it_moved(name, task, tmp_path):
    trainer = trainer_for(name, Order(task=task, seed=2, budget=1))
    before, pauses = trainer.cost, []
    trainer.train(600, lambda: pauses.append(trainer.cost.control_steps))
    cost = trainer.cost
    assert before.control_steps == 0
    assert cost.control_steps == cost.trials * trainer.agent.steps_per_babble >= 600
    assert cost.control_steps == trainer.agent.control_steps
    assert 0 < cost.accepted <= cost.trials
    assert pauses[-1] == cost.control_steps
    suffix, data = trainer.save()
    path = tmp_path / f"agent{suffix}"
    path.write_bytes(data)
    cases = scenarios("table1" if task == "reach" else "palm_side", 5, seed=1)
    rates = [evaluate(a, cases=cases).rate("success") for a in (trainer.agent, str(path))]
    assert rates[0] == rates[1]


def test_in_hand_starts_are_for_learning_alone():
    env = BabbleGraspEnv(in_hand_starts=1.0)
    agent = ReflexOnly(env, seed=0)
    cases = scenarios("palm_side", 20, seed=1)
    elsewhere = ReflexOnly("BabbleGrasp-v0", seed=0)
    rates = [evaluate(a, cases=cases).rate("success") for a in (agent, elsewhere)]
    assert rates[0] == rates[1]
