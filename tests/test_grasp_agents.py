"""The paper's agent of grasping and the scripted one, as users call them."""

import gymnasium as gym
import numpy as np
import pytest

from gym_babble import HebbBabbling, Scripted, babble, evaluate, load_agent, scenarios
from gym_babble.envs import BabbleGraspEnv
from gym_babble.errors import AgentFileError, ConfigError

CONTROLS = ("posture", "delta_posture")
GRASP = "BabbleGrasp-v0"


@pytest.fixture(scope="module")
def agent():
    return HebbBabbling(GRASP, seed=3).learn(120)


@pytest.fixture(scope="module")
def saved(agent, tmp_path_factory):
    path = tmp_path_factory.mktemp("agents") / "agent.safetensors"
    agent.save(path)
    return path


def sights(n=6, **options):
    envs = gym.make_vec("BabbleGrasp-v0", num_envs=n, **options)
    senses, _ = envs.reset(seed=0)
    envs.close()
    return senses


def test_recall_is_equations_3_and_4_on_the_weights(agent):
    # The five-line twin: catches maps with their axes exchanged, or another read-out.
    senses, weights = sights(), agent.weights
    grid = np.arange(21)
    for i in range(6):
        x, y = (
            np.exp(-((grid - 20 * share) ** 2) / (2 * 0.7**2))
            for share in senses["eye"][i].tolist()
        )
        for w, g, scale, found in (
            (weights["reach.weights"], np.outer(y, x).ravel(), 1.0, slice(0, 2)),
            (weights["grasp.weights"], senses["fovea"][i].astype(float), 90.0, slice(2, 4)),
        ):
            a = np.maximum(np.tanh(w @ g), 0.0).reshape(21, 21)
            columns, rows = (a.sum(0) @ grid, a.sum(1) @ grid)
            twin = scale * np.array([columns, rows]) / (20 * a.sum())
            recalled = agent.decide({name: part[i] for name, part in senses.items()})[found]
            assert recalled == pytest.approx(twin, abs=2e-4 * scale)


@pytest.mark.parametrize("control", CONTROLS)
def test_the_hand_stays_open_until_it_touches(saved, control):
    # Catches a hand that closes with the arm's movement, or never.
    env = BabbleGraspEnv(control=control)
    acting = load_agent(saved, env)
    closed, state = [], None
    observation, _ = env.reset(seed=1, options={"diameter": 0.06})
    for _ in range(120):
        touched = state is not None and bool(state.touched()[0])
        action, state = acting.predict(observation, state)
        target = observation["hand"] + observation["stretch"][2:] / (np.pi / 2)
        closed.append((touched, float(target.mean())))
        observation, *_, info = env.step(action)
    assert info["reach"]
    assert max(target for touched, target in closed if not touched) < 0.05
    assert max(target for touched, target in closed if touched) > 0.4


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("obs", ["senses", "flat", "retina"])
def test_scripted_grasps_in_every_form_of_observation(control, obs):
    cases = scenarios("palm_side", 6, split="validation")
    env = gym.make("BabbleGrasp-v0", control=control, obs=obs)
    result = evaluate(Scripted(env), "BabbleGrasp-v0", cases, control=control, obs=obs)
    assert sum(result.facts["held"]) >= 5


def test_a_batch_decides_as_its_singles_and_begins_anew_where_told(agent):
    senses = sights()
    actions, state = agent.predict(senses)
    for i in range(6):
        action, _ = agent.predict({name: part[i] for name, part in senses.items()})
        assert action == pytest.approx(actions[i], abs=1e-6)
    # As if everybody had touched; environment 2 begins anew.
    touching = {**senses, "touch": np.ones_like(senses["touch"])}
    _, state = agent.predict(touching, state)
    starts = np.arange(6) == 2
    again, after = agent.predict(senses, state, starts)
    assert after.touched().tolist() == [True, True, False, True, True, True]
    assert (again[[0, 1, 3, 4, 5], 2:] > 0).all()
    assert (again[2, 2:] <= 0).all()


def test_saving_keeps_every_bit(agent, tmp_path):
    path = tmp_path / "agent.safetensors"
    agent.save(path)
    loaded = load_agent(path)
    counts = (agent.babbled, agent.learnt, agent.brain)
    assert (loaded.babbled, loaded.learnt, loaded.brain) == counts
    for name, weights in agent.weights.items():
        np.testing.assert_array_equal(loaded.weights[name], weights)
    senses = sights()
    np.testing.assert_array_equal(loaded.decide(senses), agent.decide(senses))
    loaded.learn(5)
    agent_again = HebbBabbling(GRASP, seed=3).learn(120).learn(5)
    weights = agent_again.weights["reach.weights"]
    np.testing.assert_array_equal(loaded.weights["reach.weights"], weights)


def test_files_of_other_kinds_are_refused(saved, tmp_path):
    with pytest.raises(ConfigError, match="environment for grasping"):
        load_agent(saved, "BabbleReach-v0")
    cut = tmp_path / "cut.safetensors"
    cut.write_bytes(saved.read_bytes()[:-7])
    with pytest.raises(AgentFileError):
        load_agent(cut)


def test_babbled_hands_are_those_of_their_objects(agent):
    left = agent.experiences()
    assert len(np.unique(left.babble)) == agent.learnt
    sizes, hands = left.case["diameter"][:, 0], left.actions["hand"]
    small, big = (hands[sizes == np.float32(d)].mean(axis=0) for d in (0.024, 0.06))
    assert (big > small + 10).all()  # A bigger object leaves the hand more open.
    assert ((left.actions["arm"] >= 0) & (left.actions["arm"] <= 1)).all()
    # What is babbled can be shown to the agent as it is.
    recalled = agent.decide(left.percepts)
    assert np.abs(recalled[:, 2:] - hands).mean() < 5


def test_objects_that_the_hand_loses_are_experienced_too():
    env = BabbleGraspEnv(config={"body": {"grip": {"reflex_deg": [0, 0]}}})
    made = babble(env, 3, threads=1)
    assert made.outcome.tolist() == ["lost"] * 3
    assert not made.learnable.any()


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: HebbBabbling(gym.make(GRASP, control="torque")), "torque"),
        (lambda: HebbBabbling(GRASP, brain={"sigmas": 1}), r"brain\.sigmas"),
        (lambda: HebbBabbling(GRASP, brain={"squeeze_deg": -1}), "squeeze_deg"),
        (lambda: HebbBabbling(GRASP, brain={"neurons": 1}), "neurons"),
        (lambda: HebbBabbling(GRASP, seed=-1), "seed"),
        (lambda: HebbBabbling(GRASP).learn(-1), "babbles"),
    ],
)
def test_bad_arguments_are_named(make, match):
    with pytest.raises(ConfigError, match=match):
        make()


def test_a_callback_stops_learning():
    agent = HebbBabbling(GRASP, seed=0).learn(100, callback=lambda agent: agent.learnt < 50)
    assert agent.learnt == 50
