"""Rules of one's own, and babbling without learning."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from comparing import assert_same

from gym_babble import HebbBabbling, babble, load_agent
from gym_babble.brain import CovarianceRule, HebbRule
from gym_babble.envs import BabbleReachEnv
from gym_babble.errors import ConfigError

ENVS = {"reach": "BabbleReachPattern-v0", "grasp": "BabbleGrasp-v0"}
each_env = pytest.mark.parametrize("env", ENVS.values(), ids=ENVS)


def covariance(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's arguments
    """Eq. 7."""
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


@each_env
@pytest.mark.parametrize("seed", [0, 7])
def test_equation_7_in_numpy_learns_what_the_core_does(env, seed):
    # Catches activities of another map, averages that start anew, and ξ or η of another rule.
    brain = {"rule": {"eta": 0.5, "xi": 0.4}}
    n = 60 if env == ENVS["reach"] else 4  # A babble of grasping applies the rule thirty times.
    own = HebbBabbling(env, rule=covariance, seed=seed, brain=brain).learn(n, callback_every=3)
    ours = HebbBabbling(env, rule="covariance", seed=seed, brain=brain).learn(n)
    assert own.babbled == ours.babbled
    for name, weights in ours.weights.items():
        assert np.abs(own.weights[name] - weights).max() < 1e-5, name
    assert max(np.abs(weights).max() for weights in own.weights.values()) > 0.01


def test_rules_by_name_and_by_class_are_the_same():
    by_name = HebbBabbling(rule="hebb", brain={"rule": {"eta": 0.5}}).learn(20)
    by_class = HebbBabbling(rule=HebbRule(eta=0.5)).learn(20)
    assert by_name.brain == by_class.brain
    assert_same(by_name.weights, by_class.weights)
    assert HebbBabbling().brain == HebbBabbling(rule=CovarianceRule()).brain


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        (lambda w: w[:-1], "shape"),
        (lambda w: np.where(w == w.flat[0], np.nan, w), "nan is not finite"),
        (lambda _: 1 / 0, "division"),
    ],
)
@each_env
def test_a_rule_that_fails_leaves_the_agent_as_before_the_chunk(env, wrong, match):
    # A babble of grasping calls it for thirty moments and two associations.
    chunk, calls_of_chunk, calls = (10, 10, []) if env == ENVS["reach"] else (1, 60, [])

    def fails_later(*arguments):
        calls.append(1)
        change = covariance(*arguments)
        return wrong(change) if len(calls) > 3 * calls_of_chunk else change

    agent = HebbBabbling(env, rule=fails_later)
    with pytest.raises((ConfigError, ZeroDivisionError), match=match):
        agent.learn(100, callback_every=chunk)
    assert agent.learnt == 3 * chunk
    same = HebbBabbling(env, rule=covariance).learn(agent.learnt, callback_every=chunk)
    assert agent.babbled == same.babbled
    assert_same(agent.weights, same.weights)


def test_an_agent_with_a_rule_of_its_own_needs_it_again_to_learn_on(tmp_path):
    path = tmp_path / "agent.safetensors"
    agent = HebbBabbling(rule=covariance).learn(10)
    agent.save(path)
    with pytest.raises(ConfigError, match="rule of your own"):
        load_agent(path).learn(1)
    again = HebbBabbling.load(path, rule=covariance).learn(10)
    assert_same(again.weights, agent.learn(10).weights)


@each_env
def test_a_callback_may_come_as_often_as_one_likes(env):
    seen = []
    watched = HebbBabbling(env).learn(
        12, callback_every=1, callback=lambda a: seen.append((a.learnt, a.weights))
    )
    assert [learnt for learnt, _ in seen] == list(range(1, 13))
    forming = [next(iter(weights.values())) for _, weights in seen]
    assert all((a != b).any() for a, b in pairwise(forming))
    for every in (5, 50):
        assert_same(HebbBabbling(env).learn(12, callback_every=every).weights, watched.weights)


@each_env
def test_experiences_are_those_that_are_learnt_from(env):
    agent = HebbBabbling(env, seed=3).learn(6)
    period_s = agent.brain.get("learning_period_s")
    made = babble(env, agent.babbled, 3, learning_period_s=period_s, threads=1)
    assert np.unique(made.babble).tolist() == list(range(agent.babbled))
    assert len(np.unique(made.babble[made.learnable])) == agent.learnt == 6
    learnt = agent.experiences()
    assert_same(vars(made[made.learnable]), vars(learnt))
    for threads in (2, 8):
        again = babble(env, agent.babbled, 3, learning_period_s=period_s, threads=threads)
        assert_same(vars(again), vars(made))
    assert_same(vars(babble(env, 4, 3, learning_period_s=period_s)), vars(made[made.babble < 4]))
    assert all(values.dtype == np.float32 for values in (made.percepts | made.actions).values())


def test_experiences_of_reaching_tell_how_each_movement_ended():
    made = babble("BabbleReach-v0", 300)
    assert set(made.outcome) == {"success", "collision", "joint_limit"}
    legal = ~np.isin(made.outcome, ["collision", "joint_limit"])
    assert (made.learnable == legal).all()
    assert 0.1 < legal.mean() < 0.3
    assert made.actions["b"].sum(axis=1) == pytest.approx(1)
    # What was seen is what the environment shows of such a case.
    assert set(made.percepts) < set(BabbleReachEnv().observation_space)
    quick = babble("BabbleReach-v0", 300, quasi_static=True)
    assert_same(quick.percepts, made.percepts)
    assert (quick.outcome != made.outcome).any()


def test_weights_of_an_agent_can_be_set():
    agent, other = HebbBabbling(seed=1).learn(20), HebbBabbling(seed=1)
    other.weights = agent.weights
    assert_same(other.weights, agent.weights)
    for wrong in ({"weights": np.ones((441, 441))}, {"weights": np.zeros(3)}, {"w": np.zeros(3)}):
        with pytest.raises((ConfigError, TypeError)):
            other.weights = wrong
    assert_same(other.weights, agent.weights)
