"""The phases of the chain for agents of one's own, and for neighbours that remember its babbles.

Catches targets that are converted otherwise than the network's are, a second look that nobody asks
the agent for, errors that get lost between Python and the core, and neighbours of other babbles
than those of the chain.
"""

import gymnasium as gym
import numpy as np
import pytest
from comparing import assert_same

from gym_babble import (
    ChainAgent,
    HebbBabbling,
    Joints,
    NearestNeighbours,
    evaluate,
    load_agent,
    scenarios,
)
from gym_babble.errors import ConfigError
from gym_babble.study.roster import trainer_for
from gym_babble.study.trainers.base import Order

GRASP = "BabbleGrasp-v0"


@pytest.fixture(scope="module")
def hebb():
    return HebbBabbling(GRASP, variant="chain", seed=1).learn(40)


class Recalling(ChainAgent):
    """Goes where the network of another agent says."""

    def __init__(self, env, hebb):
        super().__init__(env)
        self.hebb, self.joints, self.looks = hebb, Joints(env), 0
        self.reflex = self.interface.quantities["reflex"]

    def recall(self, senses):
        self.looks += 1
        found = self.hebb.decide(senses)
        low, high = self.joints.ranges[:2].T
        closed = np.radians(90.0 - found[:, 4:] + self.hebb.brain["squeeze_deg"])
        arms = [low + found[:, i : i + 2] * (high - low) for i in (0, 2)]
        return (*arms, np.minimum(closed, self.reflex))


@pytest.mark.parametrize("control", ["posture", "delta_posture"])
def test_the_networks_targets_make_its_actions_bit_for_bit(hebb, control):
    n, steps = 12, 240
    envs = gym.make_vec(GRASP, num_envs=n, control=control)
    acting = hebb.continue_in(envs)
    own = Recalling(envs, hebb)
    states, starts, begun, phases = [None, None], np.ones(n, bool), 0, set()
    seen, _ = envs.reset(seed=5)
    for _ in range(steps):
        begun += starts.sum()
        pairs = [a.predict(seen, s, starts) for a, s in zip((acting, own), states, strict=True)]
        states = [state for _, state in pairs]
        assert_same(pairs[0][0], pairs[1][0])
        assert states[0].phases() == states[1].phases()
        phases |= {*states[1].phases()}
        seen, _, terminated, truncated, _ = envs.step(pairs[1][0])
        starts = terminated | truncated
    assert phases == {"reach", "advance", "close"}
    # Some of these grasps miss, and the agent looks again.
    assert own.looks > begun


def test_phases_follow_each_other(hebb):
    env = gym.make(GRASP)
    agent, state, played = Recalling(env, hebb), None, []
    seen, _ = env.reset(seed=0)
    ended = False
    while not ended:
        action, state = agent.predict(seen, state)
        (phase,) = state.phases()
        if played[-1:] != [phase]:
            played.append(phase)
        seen, _, terminated, truncated, _ = env.step(action)
        ended = terminated or truncated
    assert played[:3] == ["reach", "advance", "close"]


def test_it_is_evaluated_as_the_network_is(hebb):
    cases = scenarios("palm_side", 20, 600)
    own = evaluate(Recalling(GRASP, hebb), cases=cases)
    assert own == evaluate(hebb, cases=cases)


def test_in_the_goal_form_it_grasps(hebb):
    env = gym.make("BabbleGraspGoal-v0")
    seen, _ = env.reset(seed=0)
    action, state = Recalling(env, hebb).predict(seen)
    assert env.action_space.contains(action)
    assert state.phases() == ["reach"]


def test_phases_of_other_plans_have_no_names():
    env = gym.make(GRASP)
    _, state = HebbBabbling(env).learn(2).predict(env.reset(seed=0)[0])
    assert state.phases() == [""]


class Giving(ChainAgent):
    """Recalls what it is given."""

    given = None

    def recall(self, senses):
        assert senses["eye"].shape == (1, 2)
        assert senses["fovea"].shape == (1, 441)
        if isinstance(self.given, Exception):
            raise self.given
        return self.given


PAIR = np.zeros((1, 2))


@pytest.mark.parametrize(
    ("given", "match"),
    [
        (None, r"recall = None is not \(pregrasp, contact, hand\)"),
        ((PAIR, PAIR), "is not .pregrasp, contact, hand."),
        ((PAIR, np.zeros(2), PAIR), r"recall: contact has shape \(2,\), expected \(1, 2\)"),
        ((PAIR, PAIR, np.zeros((2, 2))), r"recall: hand has shape \(2, 2\), expected \(1, 2\)"),
        (([[0, np.nan]], PAIR, PAIR), r"recall: pregrasp\[0, 1\] = nan is not finite"),
        ((PAIR, [[0.0, 75.0]], PAIR), r"recall: contact\[0, 1\] = 75 is not in \[-2π, 2π\] rad"),
        ((PAIR, PAIR, [["a", "b"]]), "recall: hand = .* is not made of real numbers"),
    ],
)
def test_targets_that_are_none_are_refused(given, match):
    env = gym.make(GRASP, obs="flat")
    agent = Giving(env)
    agent.given = given
    with pytest.raises(ConfigError, match=match):
        agent.predict(env.reset(seed=0)[0])


def test_an_exception_on_a_second_look_is_raised():
    env = gym.make(GRASP)
    agent, state = Giving(env), None
    agent.given = (PAIR, PAIR, PAIR)
    seen, _ = env.reset(seed=3)
    _, state = agent.predict(seen, state)
    agent.given = LookupError("on the second look")
    with pytest.raises(LookupError, match="second look"):  # noqa: PT012 - some step raises it
        for _ in range(240):
            action, state = agent.predict(seen, state)
            seen, *_ = env.step(action)


def test_other_tasks_and_torque_are_refused():
    with pytest.raises(ConfigError, match="the chain acts in grasping alone"):
        Giving("BabbleReachPattern-v0")
    with pytest.raises(ConfigError, match="torque"):
        Giving(gym.make(GRASP, control="torque"))
    with pytest.raises(ConfigError, match="the chain acts in grasping alone"):
        NearestNeighbours("BabbleReachPattern-v0", babbling="chain")
    with pytest.raises(ConfigError, match="babbling = 'chian' is not one of paper, chain"):
        NearestNeighbours(GRASP, babbling="chian")


def test_neighbours_remember_the_babbles_of_the_chain(hebb):
    agent = NearestNeighbours(GRASP, babbling="chain", k=1, seed=hebb.seed).learn(40)
    assert (agent.babbled, agent.control_steps) == (hebb.babbled, hebb.control_steps)
    made = hebb.experiences()
    edges = made.percepts["fovea"].astype(np.float64)
    middle = np.abs(np.arange(21) - 10.0)
    size = np.array([(e.reshape(21, 21) * np.hypot(middle[:, None], middle)).sum() for e in edges])
    seen = np.column_stack([made.percepts["eye"], size / edges.sum(axis=1)])
    # Whoever sees a babble again does what was done in it.
    senses = np.zeros((40, agent.interface.spec.slices[-1][1].stop), np.float32)
    slices = dict(agent.interface.spec.slices)
    senses[:, slices["eye"]], senses[:, slices["fovea"]] = made.percepts["eye"], edges
    assert len(np.unique(seen, axis=0)) == 40
    found = agent.decide(senses)
    arms = np.hstack([made.actions["pregrasp"], made.actions["arm"]])
    joints = Joints(GRASP)
    shares = joints.shares(np.hstack([found[:, :2], np.zeros((40, 2))]))[:, :2]
    np.testing.assert_allclose(shares, arms[:, :2], atol=1e-6)
    shares = joints.shares(np.hstack([found[:, 2:4], np.zeros((40, 2))]))[:, :2]
    np.testing.assert_allclose(shares, arms[:, 2:], atol=1e-6)
    closed = np.minimum(
        np.radians(110.0 - made.actions["hand"]), agent.interface.quantities["reflex"]
    )
    np.testing.assert_allclose(found[:, 4:], closed, atol=1e-6)


def test_neighbours_of_the_chain_are_kept_in_files(tmp_path):
    agent = NearestNeighbours(GRASP, babbling="chain", k=1, seed=4).learn(2)
    agent.save(tmp_path / "agent")
    again = load_agent(tmp_path / "agent")
    assert again.settings == {"k": 1, "babbling": "chain"}
    whole = NearestNeighbours(GRASP, babbling="chain", k=1, seed=4).learn(3)
    assert again.learn(1).to_bytes() == whole.to_bytes()
    cases = scenarios("palm_side", 5, 600)
    assert evaluate(again, cases=cases) == evaluate(whole, cases=cases)


def test_a_study_counts_their_babbles():
    settings = {"babbling": "chain", "k": 1}
    order = Order(task="grasp", seed=2, budget=1, settings=settings)
    trainer = trainer_for("nearest-neighbour", order)
    trainer.train(500, lambda: None)
    assert trainer.agent.settings == settings
    assert trainer.cost.control_steps == trainer.cost.trials * 380 >= 500


def test_neighbours_before_learning_are_in_the_middle():
    agent = NearestNeighbours(GRASP, babbling="chain")
    assert agent.decide(gym.make(GRASP).reset(seed=0)[0]).shape == (6,)
