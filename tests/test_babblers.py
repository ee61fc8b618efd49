"""The developmental baselines: each learns, beats chance, and its file is all of it.

Catches an agent that averages left and right, that learns from what it did not do, whose learning
depends on how it is called, and one that acts otherwise than the core does on the same decision.
"""

import pickle

import gymnasium as gym
import numpy as np
import pytest
from comparing import assert_same

from gym_babble import evaluate, scenarios
from gym_babble.agents import (
    GoalBabbling,
    HebbBabbling,
    NearestNeighbours,
    Oracle,
    ReflexOnly,
    RewardHebb,
    Scripted,
    babble,
    load_agent,
)
from gym_babble.agents.deciding import Learning
from gym_babble.agents.local_maps import LocalMaps
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import AgentFileError, ConfigError

REACH, GRASP = "BabbleReachPattern-v0", "BabbleGrasp-v0"
KINDS = [
    (NearestNeighbours, REACH),
    (NearestNeighbours, GRASP),
    (GoalBabbling, REACH),
    (GoalBabbling, GRASP),
    (RewardHebb, REACH),
]
each_kind = pytest.mark.parametrize(
    ("kind", "env"), KINDS, ids=[f"{kind.__name__}-{env}" for kind, env in KINDS]
)
SOME = {REACH: 30, GRASP: 4}


def senses_of(env_id, n=5):
    env = gym.make(env_id, obs="flat")
    return np.stack([env.reset(seed=seed)[0] for seed in range(n)])


def cases_of(env_id, n):
    return scenarios("table1" if env_id == REACH else "palm_side", n, seed=100, split="validation")


@each_kind
def test_learning_depends_on_the_seed_alone(kind, env, tmp_path):
    n = SOME[env]
    whole = kind(env, seed=4).learn(n)
    parts = kind(env, seed=4).learn(n // 2, callback_every=1)
    parts.save(tmp_path / "agent")
    assert (tmp_path / "agent").read_bytes() == parts.to_bytes()
    for agent in (pickle.loads(pickle.dumps(parts)), load_agent(tmp_path / "agent"), parts):  # noqa: S301 - our own bytes
        assert type(agent) is kind
        agent.learn(n - n // 2)
        assert agent.to_bytes() == whole.to_bytes()
        assert_same(agent.decide(senses_of(env)), whole.decide(senses_of(env)))
    assert kind(env, seed=5).learn(n).to_bytes() != whole.to_bytes()
    assert 0 < whole.learnt <= whole.babbled


@each_kind
def test_an_interrupted_call_leaves_the_agent_as_it_was(kind, env, monkeypatch):
    agent = kind(env, seed=4).learn(2)
    before = agent.to_bytes()
    learn = kind._learn

    def interrupted(self, babbles):
        learn(self, babbles)
        raise KeyboardInterrupt

    monkeypatch.setattr(kind, "_learn", interrupted)
    with pytest.raises(KeyboardInterrupt):
        agent.learn(3)
    assert agent.to_bytes() == before


@each_kind
def test_evaluate_reads_the_file(kind, env, tmp_path):
    agent = kind(env, seed=1).learn(SOME[env] // 2)
    agent.save(tmp_path / "agent")
    cases = cases_of(env, 10)
    found = [evaluate(a, cases=cases) for a in (agent, str(tmp_path / "agent"))]
    assert found[0].rate("success") == found[1].rate("success")


@each_kind
def test_files_that_are_cut_short_or_altered_are_refused(kind, env, tmp_path):
    data = kind(env).learn(2).to_bytes()
    for wrong in (data[:-3], data.replace(b'\\"seed\\":0', b'\\"seed\\":1'), b"", b"random"):
        (tmp_path / "agent").write_bytes(wrong)
        with pytest.raises(AgentFileError):
            load_agent(tmp_path / "agent")


class Copying(Learning):
    """Decides what another agent does."""

    KIND, TASKS, ARRAYS = "copying", ("reach", "grasp"), ()

    def __init__(self, env, other):
        super().__init__(env, 0, {})
        self._other = other

    def _learn(self, babbles):
        pytest.fail(f"it was asked to learn from {babbles} babbles, and it only copies")

    def _decide(self, senses):
        return self._other.decide(senses)


@pytest.mark.parametrize(
    ("make", "control"),
    [
        *((BabbleReachEnv, control) for control in ("pattern", "posture", "delta_posture")),
        *((BabbleGraspEnv, control) for control in ("posture", "delta_posture")),
    ],
)
def test_decisions_of_python_act_as_the_same_ones_of_the_core(make, control):
    env = make(control=control)
    own = Scripted(env)
    copying = Copying(env, own)
    observation = env.reset(seed=3)[0]
    states = [None, None]
    for _ in range(60):
        pairs = [a.predict(observation, s) for a, s in zip((own, copying), states, strict=True)]
        states = [state for _, state in pairs]
        assert_same(pairs[0][0], pairs[1][0])
        observation, _, terminated, truncated, _ = env.step(pairs[0][0])
        if terminated or truncated:
            break


@pytest.mark.parametrize("decided", [np.full((1, 2), np.nan), np.zeros((1, 3)), np.zeros((2, 2))])
def test_decisions_that_are_none_are_refused(decided):
    env = BabbleReachEnv(control="pattern")
    agent = Copying(env, Oracle(env))
    agent._decide = lambda _senses: decided
    with pytest.raises(ConfigError, match="decide"):
        agent.predict(env.reset(seed=0)[0])


def test_an_exception_of_an_agents_own_is_raised():
    env = BabbleReachEnv(control="pattern")
    agent = Copying(env, None)
    with pytest.raises(AttributeError, match="decide"):
        agent.predict(env.reset(seed=0)[0])


@each_kind
def test_torque_and_other_tasks_are_refused(kind, env):
    with pytest.raises(ConfigError, match="torque"):
        kind(gym.make(env, control="torque") if env == GRASP else BabbleReachEnv(control="torque"))
    if len(kind.TASKS) == 1:
        with pytest.raises(ConfigError, match="learns in reach"):
            kind(GRASP)


def test_neighbours_are_those_of_numpy():
    agent = NearestNeighbours(REACH, k=3, seed=2).learn(200)
    made = babble(REACH, agent.babbled, seed=2)
    made = made[made.learnable]
    assert len(made) == 200
    seen = np.hstack([made.percepts["eye"], made.percepts["obstacle"]]).astype(np.float64)
    spread = seen.std(axis=0)
    for senses, chosen in zip(senses_of(REACH), agent.decide(senses_of(REACH)), strict=True):
        named = dict(agent.interface.spec.slices)
        wanted = np.hstack([senses[named["eye"]], senses[named["obstacle"]]])
        nearest = np.argsort(np.linalg.norm((seen - wanted) / spread, axis=1))[:3]
        # Of three numbers in a row the medoid is the middle one.
        assert chosen[0] == np.sort(made.actions["b"][nearest, 0])[1]


def test_local_maps_learn_a_curve_and_keep_what_they_know_when_one_is_added():
    maps = LocalMaps(0.2, 0.5, np.zeros(1), 1)
    random = np.random.default_rng(0)
    for _ in range(3000):
        x = random.uniform(0, 1, 1)
        maps.learn(x, np.sin(3 * x), 1.0)
        maps.learn(x, np.array([9.0]), 0.0)
    shown = np.linspace(0.05, 0.95, 20)[:, None]
    assert max(abs(maps(x) - np.sin(3 * x)).item() for x in shown) < 0.05
    before = maps(np.array([1.3])).item()
    maps.learn(np.array([1.3]), np.array([before]), 1.0)
    assert abs(maps(np.array([1.3])).item() - before) < 1e-5


def success(agent, env, n=200):
    return evaluate(agent, cases=cases_of(env, n)).rate("success")


def test_each_beats_chance_in_reaching():
    chance = success("random", REACH)
    for agent, babbles in (
        (NearestNeighbours(REACH), 300),
        (GoalBabbling(REACH), 1_000),
        (RewardHebb(REACH), 1_000),
    ):
        agent.learn(babbles)
        assert success(agent, REACH) > chance + 0.2, agent


def test_shuffled_pairs_do_not_tell_where_the_obstacle_is():
    paired, shuffled = (
        HebbBabbling(REACH, "conjunctive", shuffled=s, quasi_static=True).learn(2_000)
        for s in (False, True)
    )
    assert (shuffled.babbled, shuffled.learnt) == (paired.babbled, paired.learnt)
    assert success(shuffled, REACH) < success(paired, REACH) - 0.3


@pytest.mark.parametrize("env", [REACH, GRASP])
def test_shuffling_goes_on_where_it_stopped(env, tmp_path):
    n = SOME[env]
    whole = HebbBabbling(env, shuffled=True, seed=3).learn(n)
    parts = HebbBabbling(env, shuffled=True, seed=3).learn(n // 3, callback_every=1)
    parts.save(tmp_path / "agent")
    again = load_agent(tmp_path / "agent")
    assert again.shuffled
    assert again.learn(n - n // 3).to_bytes() == whole.to_bytes()
    assert HebbBabbling(env, seed=3).learn(n).to_bytes() != whole.to_bytes()


def test_reflex_alone_reaches_by_chance():
    assert success(ReflexOnly(seed=0), GRASP, 30) < success(Scripted(GRASP), GRASP, 30) - 0.5
    with pytest.raises(ConfigError, match="grasping"):
        ReflexOnly(REACH)
