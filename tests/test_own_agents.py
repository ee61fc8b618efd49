"""Agents of one's own, and what copies and pickles of ours keep."""

from __future__ import annotations

import copy
import pickle

import gymnasium as gym
import numpy as np
import pytest
from comparing import BATCHES, assert_same

from gym_babble import Agent, HebbBabbling, Oracle, Random, Scripted, evaluate, scenarios
from gym_babble.agents.base import predictor
from gym_babble.agents.loading import named_agent
from gym_babble.errors import ConfigError
from gym_babble.study.results import test_tally as tally_of
from gym_babble.study.run import execute, runs_of
from gym_babble.study.short import comparison
from gym_babble.viz.episode import play

PATTERN = "BabbleReachPattern-v0"

OWN = '''
import numpy as np

class Bulge:
    """Of one argument, as in a first lesson."""

    def __init__(self, env):
        self.env = env

    def predict(self, observation):
        assert observation["eye"].shape == (2,)
        return np.array([0.5, -0.5], np.float32)

class Seeded:
    def __init__(self, seed):
        self.random = np.random.default_rng(seed)

    def predict(self, observation, state=None, episode_start=None, deterministic=False):
        return self.random.uniform(-1, 1, (len(observation["eye"]), 2)), state

class Plain:
    def predict(self, observation):
        return np.zeros(2, np.float32)

class Placed(Plain):
    env = "BabbleReach-v0"

class Mute:
    pass

class Odd:
    def predict(self, observation, state):
        return None

def function():
    pass
'''


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A module of one's own in the current folder."""
    (tmp_path / "lesson_agents.py").write_text(OWN, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return "lesson_agents"


def test_agents_of_ones_own_are_tested_by_name(own):
    cases = scenarios("table1", 30)
    bulge = evaluate(f"{own}:Bulge", PATTERN, cases)
    assert len(bulge.outcomes) == 30
    assert len(evaluate(f"{own}:Seeded", PATTERN, cases).outcomes) == 30
    assert evaluate(f"{own}:Plain", PATTERN, cases) != bulge
    with pytest.raises(ConfigError, match=r"Bulge: name the environment .*attribute `env`"):
        evaluate(f"{own}:Bulge", cases=cases)
    stepwise = evaluate(f"{own}:Placed", cases=cases)
    assert stepwise == evaluate(f"{own}:Plain", "BabbleReach-v0", cases)
    assert evaluate("scripted", cases=cases) == evaluate(Scripted(), cases=cases)
    for name, env_id, test in (("Bulge", PATTERN, bulge), ("Placed", "BabbleReach-v0", stepwise)):
        (spec,) = runs_of(comparison("reach", [f"{own}:{name}"], cases=30, case_seed=0))
        record, _ = execute(spec)
        assert spec.agent.label == name
        assert record["env"] == env_id
        assert tally_of(record)["success"]["count"] == test.count("success")


def test_an_agent_of_one_argument_is_filmed(own):
    episode = play(named_agent(f"{own}:Bulge", env_id=PATTERN), scenarios("table1", 1)[0])
    assert episode.moments > 10


@pytest.mark.parametrize(
    ("name", "match"),
    [
        ("no_module:Class", "no module 'no_module'"),
        ("{own}:Missing", "no class 'Missing'; it has Bulge, Seeded, Plain, Placed, Mute, Odd"),
        ("{own}:function", "no class 'function'"),
        ("{own}:Mute", r"no predict\(observation\)"),
        ("{own}:Odd", r"takes \(observation, state\)"),
        (":Class", "module:Class"),
    ],
)
def test_what_is_no_agent_is_named(own, name, match):
    with pytest.raises(ConfigError, match=match):
        named_agent(name.format(own=own), env_id=PATTERN)


@pytest.mark.usefixtures("own")
def test_an_error_inside_of_ones_module_is_shown_as_it_is(tmp_path):
    (tmp_path / "broken_agent.py").write_text("import missing_library\n", encoding="utf-8")
    with pytest.raises(ModuleNotFoundError, match="missing_library"):
        named_agent("broken_agent:Any", env_id=PATTERN)


def test_one_argument_sees_each_environment_by_itself():
    class Eye:
        def predict(self, observation):
            return observation["eye"] * 2 - 1, None

    envs = gym.make_vec("BabbleReachPattern-v0", num_envs=5)
    observation, _ = envs.reset(seed=0)
    predict = predictor(Eye())
    actions, state = predict(observation, None, np.ones(5, bool), True)
    assert_same(actions, observation["eye"] * 2 - 1)
    assert state is None
    env = gym.make("BabbleReachPattern-v0", obs="flat")
    flat, _ = env.reset(seed=0)
    lazy = type("Lazy", (), {"predict": lambda _, seen: seen[:2]})()
    assert_same(predictor(lazy)(flat, None, np.array([True]), True)[0], flat[:2])


AGENTS = {
    "hebb": lambda: HebbBabbling(seed=1, quasi_static=True).learn(30),
    "hebb grasps": lambda: HebbBabbling("BabbleGrasp-v0", seed=1).learn(3),
    "random": lambda: Random(gym.make("BabbleReach-v0", config="icub"), seed=4),
    "random grasps": lambda: Random("BabbleGrasp-v0", seed=4),
    "scripted": lambda: Scripted(gym.make_vec("BabbleGraspFull-v0", num_envs=2)),
    "oracle": lambda: Oracle("BabbleReachPattern-v0"),
}


@pytest.mark.parametrize("name", AGENTS)
def test_copies_and_pickles_act_alike(name):
    agent = AGENTS[name]()
    assert isinstance(agent, Agent)
    interface = agent.interface
    kwargs = {} if interface.entry.name == "reach" else {"region": interface.options["region"]}
    envs = BATCHES[interface.entry.name](3, control=interface.options["control"], **kwargs)
    seen, _ = envs.reset(seed=0)
    agent.predict(seen)  # A random agent's copies go on where it is.
    pickled = pickle.loads(pickle.dumps(agent))  # noqa: S301 - our own
    others = [copy.deepcopy(agent), copy.copy(agent), pickled]
    expected = agent.predict(seen)[0]
    for other in others:
        assert other.interface.task.config() == interface.task.config()
        assert other.interface.options == interface.options
        assert_same(other.predict(seen)[0], expected)


def test_a_copy_learns_by_itself():
    agent = HebbBabbling(seed=1).learn(10)
    other = copy.deepcopy(agent).learn(10)
    assert (agent.learnt, other.learnt) == (10, 20)
    assert_same(agent.learn(10).weights, other.weights)


def test_recall_takes_what_the_environment_gives():
    for env_id, names in (
        ("BabbleReachPattern-v0", {"movement"}),
        ("BabbleGrasp-v0", {"arm", "hand"}),
    ):
        agent = HebbBabbling(env_id).learn(5)
        recalled = []
        for obs in ("senses", "flat", "goal", "retina"):
            reward = "sparse" if obs == "goal" else "progress"
            env = gym.make(env_id, obs=obs, reward=reward)
            seen, _ = env.reset(seed=3)
            if obs != "goal":  # A goal is drawn too, which makes another case.
                recalled.append(agent.recall(seen))
            assert set(agent.recall(seen)) == names
        for other in recalled[1:]:
            assert_same(other, recalled[0])
        assert all(part.shape == (21, 21) for part in recalled[0].values())
        seen, _ = gym.make_vec(env_id, num_envs=2).reset(seed=3)
        with pytest.raises(ConfigError, match="one observation"):
            agent.recall(seen)
        with pytest.raises(ConfigError, match="observation has nose"):
            agent.recall({"nose": np.zeros(2)})
