"""The paper's agent of grasping and the scripted one, as users call them."""

import gymnasium as gym
import numpy as np
import pytest

from gym_babble import GraspScripted, HebbBabbling, HebbGrasping, evaluate, scenarios
from gym_babble.envs import BabbleGraspEnv
from gym_babble.errors import AgentFileError, ConfigError

CONTROLS = ("posture", "delta_posture")


@pytest.fixture(scope="module")
def agent():
    return HebbGrasping(seed=3).learn(120)


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
            recalled = agent.decide(senses["eye"][i : i + 1], senses["fovea"][i : i + 1])[0, found]
            assert recalled == pytest.approx(twin, abs=2e-4 * scale)


@pytest.mark.parametrize("control", CONTROLS)
def test_the_hand_stays_open_until_it_touches(saved, control):
    # Catches a hand that closes with the arm's movement, or never.
    env = BabbleGraspEnv(control=control)
    acting = HebbGrasping.load(saved, env)
    closed, state = [], None
    observation, _ = env.reset(seed=0, options={"diameter": 0.06})
    for _ in range(120):
        touched = state is not None and bool(state.touched[0])
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
    result = evaluate(GraspScripted(env), "BabbleGrasp-v0", cases, control=control, obs=obs)
    assert sum(result.facts["held"]) >= 5


def test_a_batch_decides_as_its_singles_and_begins_anew_where_told(agent):
    senses = sights()
    actions, state = agent.predict(senses)
    for i in range(6):
        action, _ = agent.predict({name: part[i] for name, part in senses.items()})
        assert action == pytest.approx(actions[i], abs=1e-6)
    # As if everybody had touched; environment 2 begins anew.
    state = state._replace(touched=np.ones(6, np.bool_))
    starts = np.arange(6) == 2
    again, after = agent.predict(senses, state, starts)
    assert after.touched.tolist() == [True, True, False, True, True, True]
    assert (again[[0, 1, 3, 4, 5], 2:] > 0).all()
    assert (again[2, 2:] <= 0).all()


def test_saving_keeps_every_bit(agent, tmp_path):
    path = tmp_path / "agent.safetensors"
    agent.save(path)
    loaded = HebbGrasping.load(path)
    assert (loaded.babbles, loaded.kept, loaded.config) == (agent.babbles, agent.kept, agent.config)
    for name, weights in agent.weights.items():
        np.testing.assert_array_equal(loaded.weights[name], weights)
    senses = sights()
    expected = agent.decide(senses["eye"], senses["fovea"])
    np.testing.assert_array_equal(loaded.decide(senses["eye"], senses["fovea"]), expected)
    loaded.learn(5)
    agent_again = HebbGrasping(seed=3).learn(120).learn(5)
    weights = agent_again.weights["reach.weights"]
    np.testing.assert_array_equal(loaded.weights["reach.weights"], weights)


def test_files_of_other_kinds_are_refused(saved, tmp_path):
    reaching = tmp_path / "reaching.safetensors"
    HebbBabbling(seed=0).learn(10).save(reaching)
    with pytest.raises(AgentFileError, match=r"gym_babble\.grasp"):
        HebbGrasping.load(reaching)
    with pytest.raises(AgentFileError):
        HebbBabbling.load(saved)
    cut = tmp_path / "cut.safetensors"
    cut.write_bytes(saved.read_bytes()[:-7])
    with pytest.raises(AgentFileError):
        HebbGrasping.load(cut)


def test_babbled_hands_are_those_of_their_objects(agent):
    left = agent.babbled
    assert left["eye"].shape == (120, 2)
    assert left["fovea"].shape == (120, 441)
    empty = HebbGrasping().babbled
    assert {name: (part.shape[1:], part.dtype) for name, part in left.items()} == {
        name: (part.shape[1:], part.dtype) for name, part in empty.items()
    }
    again = agent.decide(left["eye"].astype(float), left["fovea"])  # Of any kind of number.
    assert (again == agent.decide(left["eye"], left["fovea"])).all()
    small, big = (left["hand"][left["diameter"] == d].mean(axis=0) for d in (0.024, 0.06))
    assert len(small) == 2
    assert (big > small + 10).all()  # A bigger object leaves the hand more open.
    assert ((left["arm"] >= 0) & (left["arm"] <= 1)).all()


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: HebbGrasping("BabbleReach-v0"), "grasping"),
        (lambda: HebbGrasping(gym.make("BabbleGrasp-v0", control="torque")), "torque"),
        (lambda: HebbGrasping(config={"sigmas": 1}), r"config\.sigmas"),
        (lambda: HebbGrasping(config={"squeeze_deg": -1}), "squeeze_deg"),
        (lambda: HebbGrasping(config={"neurons": 1}), "neurons"),
        (lambda: HebbGrasping(seed=-1), "seed"),
        (lambda: HebbGrasping().learn(-1), "babbles"),
    ],
)
def test_bad_arguments_are_named(make, match):
    with pytest.raises(ConfigError, match=match):
        make()


def test_a_callback_stops_learning():
    agent = HebbGrasping(seed=0).learn(100, callback=lambda agent: agent.kept < 50)
    assert agent.kept == 50
