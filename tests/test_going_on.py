"""What an agent keeps, so that it goes on learning as it began, and what it refuses."""

from __future__ import annotations

import copy
import json
import pickle

import gymnasium as gym
import numpy as np
import pytest
from comparing import assert_same

from gym_babble import HebbBabbling, babble, brain, evaluate, load_agent, scenarios
from gym_babble.errors import ConfigError

REACH, GRASP = "BabbleReachPattern-v0", "BabbleGrasp-v0"
ICUB = {"profile": "icub", "reach": {"movement_s": 5.0}}


def oja(a, _, g, *rest):
    _, w, eta, _ = rest
    return eta * a[:, None] * (g[None] - a[:, None] * w)


@pytest.mark.parametrize(
    ("env", "n", "arguments"),
    [
        (REACH, 40, {}),
        (REACH, 40, {"variant": "conjunctive"}),
        (GRASP, 5, {}),
        (GRASP, 3, {"brain": {"learning_period_s": 0.05}}),
        (GRASP, 5, {"brain": {"learning_period_s": None}, "rule": "oja"}),
    ],
    ids=["paper", "conjunctive", "grasp", "every step", "once"],
)
def test_the_bits_depend_on_neither_threads_nor_pauses_nor_files(env, n, arguments, tmp_path):
    whole = HebbBabbling(env, seed=6, threads=1, **arguments).learn(n)
    for threads in (2, 8):
        again = HebbBabbling(env, seed=6, threads=threads, **arguments).learn(n, callback_every=2)
        assert_same(again.weights, whole.weights)
    paused = HebbBabbling(env, seed=6, threads=2, **arguments).learn(n // 3)
    paused.save(tmp_path / "agent")
    stored = load_agent(tmp_path / "agent").learn(n - n // 3)
    pickled = pickle.loads(pickle.dumps(paused)).learn(n - n // 3)  # noqa: S301
    for agent in (paused.learn(n - n // 3), stored, pickled):
        assert_same(agent.weights, whole.weights)
        assert (agent.babbled, agent.learnt) == (whole.babbled, whole.learnt)
        assert agent.brain == whole.brain
        assert_same(vars(agent.experiences()), vars(whole.experiences()))


def test_an_agent_learns_from_its_experiences_along_the_movement():
    agent = HebbBabbling(GRASP, seed=2).learn(6)
    period_s = agent.brain["learning_period_s"]
    rows = agent.experiences()
    made = babble(GRASP, agent.babbled, 2, learning_period_s=period_s)
    assert_same(vars(made[made.learnable]), vars(rows))
    # Three postures of two seconds.
    assert np.bincount(rows.babble.astype(int)).max() == 3 * round(2 / period_s)
    assert (np.diff(rows.babble.astype(int)) >= 0).all()
    # Eq. 7 over the rows, in their order, is what it has learnt.
    side = agent.brain["neurons"]
    map_ = brain.PopulationMap(side, [0, 0], [1, 1], agent.brain["sigma"])
    reach = brain.Association(len(map_), len(map_))
    reach.learn(map_.encode(rows.percepts["eye"]), map_.encode(rows.actions["arm"]))
    assert_same(reach.weights, agent.weights["reach.weights"])


@pytest.mark.parametrize("period_s", [0, -1, 2.5, 1e-9, "often", [], {}])
def test_a_period_out_of_bounds_is_named(period_s):
    with pytest.raises(ConfigError, match="learning_period_s"):
        HebbBabbling(GRASP, brain={"learning_period_s": period_s})


def test_a_movement_of_reaching_is_learnt_from_once():
    with pytest.raises(ConfigError, match=r"learning_period_s.*once"):
        babble(REACH, 3, learning_period_s=0.1)
    with pytest.raises(ConfigError, match="learning_period_s"):
        HebbBabbling(REACH, brain={"learning_period_s": 0.1})


def learning_elsewhere(tmp_path):
    """An agent made on one body that acts on another, as a file, a copy and a pickle give it."""
    path = tmp_path / "agent"
    HebbBabbling(gym.make(REACH, config=ICUB), seed=1, quasi_static=True).learn(30).save(path)
    elsewhere = load_agent(path, gym.make(REACH))
    elsewhere.save(tmp_path / "again")
    return [
        elsewhere,
        copy.deepcopy(elsewhere),
        pickle.loads(pickle.dumps(elsewhere)),  # noqa: S301
        load_agent(tmp_path / "again", gym.make(REACH)),
    ]


def test_an_agent_goes_on_learning_on_its_own_config_alone(tmp_path):
    whole = HebbBabbling(gym.make(REACH, config=ICUB), seed=1, quasi_static=True).learn(50)
    for k, agent in enumerate(learning_elsewhere(tmp_path)):
        before = agent.weights
        assert agent.interface.task.config() != whole.interface.task.config()
        cases = scenarios("table1", 20)
        assert evaluate(agent, REACH, cases).rate("success") >= 0
        # Its babbles are those of its own body, wherever it acts.
        assert_same(vars(agent.experiences()), vars(whole.experiences()[:30]))
        assert agent.steps_per_babble == whole.steps_per_babble
        with pytest.raises(ConfigError, match=r"body\.\S+ = \S+ is not the agent's"):
            agent.learn(20)
        assert_same(agent.weights, before)
        agent.save(tmp_path / f"{k}")
        home = load_agent(tmp_path / f"{k}")
        assert json.loads(home.interface.task.config())["profile"] == "icub"
        assert_same(home.learn(20).weights, whole.weights)


def test_the_first_field_that_differs_is_named(tmp_path):
    HebbBabbling(REACH).learn(1).save(tmp_path / "agent")
    config = {"reach": {"movement_s": 7.5}}
    agent = load_agent(tmp_path / "agent", gym.make(REACH, config=config))
    with pytest.raises(ConfigError, match=r"reach\.movement_s = 7\.5 is not the agent's 8\.0"):
        agent.learn(1)


def test_a_rule_of_another_kind_is_refused(tmp_path):
    HebbBabbling(REACH).learn(5).save(tmp_path / "core")
    HebbBabbling(REACH, rule=oja).learn(5).save(tmp_path / "own")
    with pytest.raises(ConfigError, match="covariance"):
        HebbBabbling.load(tmp_path / "core", rule=oja)
    with pytest.raises(ConfigError, match=r"oja.*not a function"):
        HebbBabbling.load(tmp_path / "own", rule="oja")
    with pytest.raises(ConfigError, match="rule of your own"):
        HebbBabbling.load(tmp_path / "own").learn(5)
    assert HebbBabbling.load(tmp_path / "own", rule=oja).learn(5).learnt == 10


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 0.3, -0.3])
def test_weights_are_set_all_or_none(wrong):
    agent = HebbBabbling(GRASP).learn(2)
    before = agent.weights
    weights = agent.weights
    weights["reach.weights"][:] = 0.1
    weights["grasp.weights"][3, 4] = wrong
    with pytest.raises(ConfigError, match="weights"):
        agent.weights = weights
    assert_same(agent.weights, before)


@pytest.mark.parametrize("stop", [False, np.False_, np.mean([1.0]) < 0, 0, np.array(False)])
def test_any_false_value_stops(stop):
    agent = HebbBabbling(REACH, quasi_static=True)
    assert agent.learn(40, callback=lambda _: stop, callback_every=10).learnt == 10


@pytest.mark.parametrize("go_on", [None, True, np.True_, 1])
def test_none_and_true_values_do_not(go_on):
    agent = HebbBabbling(REACH, quasi_static=True)
    assert agent.learn(40, callback=lambda _: go_on, callback_every=10).learnt == 40


def test_an_agent_goes_on_in_a_body_that_changed(tmp_path):
    changed = {"body": {"joints": {"elbow": {"upper_deg": 110.0}}}}
    env = gym.make(REACH, config=changed)
    before = HebbBabbling(REACH, seed=3).learn(60)
    weights = before.weights
    moved = before.continue_in(env)
    assert_same(moved.weights, weights)
    assert (moved.babbled, moved.learnt, moved.seed) == (before.babbled, 60, 3)
    # It babbles on where it was, in the new body.
    made = babble(env, before.babbled + 400, 3)[before.babbled :]
    moved.learn(30)
    kept = made.learnable & (made.babble < moved.babbled)
    assert kept.sum() == 30
    assert_same(before.weights, weights)
    assert (moved.weights["weights"] != weights["weights"]).any()
    moved.save(tmp_path / "agent")
    stored = HebbBabbling.load(tmp_path / "agent")
    assert stored.interface.task.config() == moved.interface.task.config()
    assert_same(stored.learn(20).weights, moved.learn(20).weights)
    cases = scenarios("table1", 20, config=changed)
    assert evaluate(moved, cases=cases).cases == tuple(cases)
    with pytest.raises(ConfigError, match="reaching"):
        before.continue_in("BabbleGrasp-v0")


def test_the_readout_is_a_setting_of_the_brain():
    env = gym.make(REACH)
    agent = HebbBabbling(env, seed=1, brain={"readout": "peak", "peak_radius": 1}).learn(40)
    observation, _ = env.reset(seed=2)
    (a,) = agent.recall(observation).values()
    map_ = brain.PopulationMap(21, [0, 0], [1, 1])
    peak = agent.decide(observation)
    assert peak == pytest.approx(map_.read_out_peak(a.ravel(), 1), abs=1e-9)
    mean = HebbBabbling(env, seed=1)
    mean.weights = agent.weights
    assert mean.brain["readout"] == "population"
    assert mean.decide(observation) == pytest.approx(map_.read_out(a.ravel()), abs=1e-9)
    with pytest.raises(ConfigError, match=r"readout.*mode.*population.*peak"):
        HebbBabbling(env, brain={"readout": "mode"})


def test_the_input_of_pairs_has_a_gain():
    env = gym.make(REACH)
    observation, _ = env.reset(seed=2)
    plain, loud = (
        HebbBabbling(env, "conjunctive", brain={"input_gain": gain}).perceive(observation)
        for gain in (1.0, 20.0)
    )
    (plain,), (loud,) = plain.values(), loud.values()
    assert plain.sum() == pytest.approx(1.0, abs=1e-5)
    assert loud == pytest.approx(np.minimum(20 * plain, 1), rel=1e-6)
    assert loud.max() == 1
    for gain in (0, -1, 1e6, float("nan")):
        with pytest.raises(ConfigError, match="input_gain"):
            HebbBabbling(env, "conjunctive", brain={"input_gain": gain})
