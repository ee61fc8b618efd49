"""Options of grasping that a chain of babbles needs, and what `info` tells of the object."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from comparing import assert_same
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv

import gym_babble
from gym_babble.agents.acting import EnvArguments, arguments_for
from gym_babble.envs import BabbleGraspEnv, BabbleGraspVectorEnv, BabbleReachEnv
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import ConfigError, ScenarioError, SnapshotError

ALL = {
    "enclosure_reflex": True,
    "reflex_releases": True,
    "support_stays": True,
    "arm_touch": True,
}
CONTROLS = ["delta_posture", "posture", "torque"]
OPEN = np.zeros(2)


def settled(env, arm, hand, steps):
    """Steps with the equilibrium points of arm and hand [rad]; what the last one gave."""
    joints = gym_babble.Joints(env)
    for _ in range(steps):
        last = env.step(joints.actions([*arm, *hand]))
    return last


def at_rest(seed, **options):
    """An environment with the object in the hand, where the arm is, and what the reflex asks."""
    env = BabbleGraspEnv(control="posture", max_episode_steps=2_000, **options)
    env.reset(seed=seed, options={"in_hand": True})
    return env, env.scenario["start"], env.interface.quantities["reflex"]


# The object in the hand.


@pytest.mark.parametrize("diameter", [0.024, 0.06])
def test_the_object_is_put_before_the_palm_and_is_then_held(diameter):
    env = BabbleGraspEnv(control="posture", in_hand_starts=0.0)
    for seed in range(3):
        _, info = env.reset(seed=seed, options={"in_hand": True, "diameter": diameter})
        assert info["object"][:2].tolist() == list(env.scenario["object"])
        reflex = env.interface.quantities["reflex"]
        for _ in range(200):
            *_, terminated, truncated, info = settled(env, env.scenario["start"], reflex, 1)
            if terminated or truncated:
                break
        assert info["held"]


def test_it_is_put_there_in_each_environment_of_a_batch_and_holds_for_autoresets():
    envs = BabbleGraspVectorEnv(3, max_episode_steps=2, control="posture")
    start = (0.2, 0.8)
    envs.reset(seed=0, options={"in_hand": True, "start": start})
    single = BabbleGraspEnv(max_episode_steps=2, control="posture")
    for _ in range(5):
        _, _, _, _, infos = envs.step(np.zeros((3, 4), np.float32))
    for i in range(3):
        single.reset(seed=i, options={"in_hand": True, "start": start})
        case = single.scenario
        assert case["start"] == pytest.approx(start)
        assert np.hypot(*(infos["object"][i, :2] - case["object"])) < 0.05


def test_a_case_of_which_the_object_is_put_in_the_hand_keeps_start_and_size():
    case = gym_babble.scenarios("palm_side", 1, 1_000, diameters=[0.05])[0]
    env = BabbleGraspEnv()
    env.reset(options={"scenario": case, "in_hand": True})
    played = env.scenario
    assert (played["start"], played["diameter"]) == (case["start"], case["diameter"])
    assert played["object"] != case["object"]
    env.reset(options={"scenario": case, "in_hand": False})
    assert env.scenario["object"] == case["object"]
    env.reset(options={"scenario": played})
    assert env.scenario == played


@pytest.mark.parametrize("value", [1, 0.0, "yes", [True], np.array([True, False]), {}])
def test_what_is_no_truth_value_is_refused_and_the_episode_goes_on(value):
    env = BabbleGraspEnv()
    env.reset(seed=0)
    before = env.get_state()
    with pytest.raises(ScenarioError, match=r"in_hand = .+ is not True or False"):
        env.reset(options={"in_hand": value})
    assert env.get_state() == before


def test_reaching_has_no_hand_to_put_objects_in():
    with pytest.raises(ConfigError, match="in_hand"):
        BabbleReachEnv().reset(options={"in_hand": True})


# A support that stays, and a reflex that lets go.


def test_grasp_release_and_grasp_again_on_a_support_that_stays():
    # Catches a support that goes, a hold that ends the episode, and one that cannot come back.
    for seed in range(3):
        env, arm, reflex = at_rest(seed, support_stays=True)
        seen = []
        for hand, steps in ((reflex, 100), (OPEN, 140), (reflex, 0)):
            for _ in range(steps):
                observation, _, terminated, truncated, info = settled(env, arm, hand, 1)
                assert not terminated
                assert not truncated
                assert info["object"][2] > -1e-3
                assert info["held"] == info["is_success"]
            seen.append(info["held"])
        assert seen[:2] == [True, False], seed
        assert observation["touch"][1:].max() == 0
        before = info["object"].copy()
        *_, info = settled(env, arm, OPEN, 60)
        assert np.abs(info["object"] - before).max() < 1e-3  # It lies where it was released.
        here = gym_babble.Joints(env).posture(observation)[:2]
        held = [settled(env, here, reflex, 1)[-1]["held"] for _ in range(140)]
        assert True in held
        assert info["ever_success"]


def test_a_hold_at_the_time_limit_is_a_success():
    for hand_closes in (True, False):
        env = BabbleGraspEnv(control="posture", support_stays=True, reward="sparse")
        env.reset(seed=0, options={"in_hand": True})
        hand = env.interface.quantities["reflex"] if hand_closes else OPEN
        _, reward, terminated, truncated, info = settled(env, env.scenario["start"], hand, 240)
        assert (terminated, truncated) == (False, True)
        assert outcome_of(info) == ("success" if hand_closes else "timeout")
        assert reward == hand_closes


@pytest.mark.parametrize("control", CONTROLS)
def test_the_reflex_lets_go_when_the_hand_is_opened_and_not_without_the_option(control):
    opened = {}
    for releases in (False, True):
        env = BabbleGraspEnv(
            control=control, enclosure_reflex=True, reflex_releases=releases, support_stays=True
        )
        observation, _ = env.reset(seed=3, options={"in_hand": True})
        joints = gym_babble.Joints(env)
        arm = joints.posture(observation)[:2]
        closed = [*arm, *env.interface.quantities["reflex"]]
        for _ in range(80):
            observation, *_ = env.step(joints.actions(closed, observation))
        assert observation["hand"].min() > 0.2
        for _ in range(120):
            action = joints.actions([*arm, 0.0, 0.0], observation)
            action[2:] = -1.0 if control != "torque" else -0.5
            observation, *_ = env.step(action)
        opened[releases] = observation["hand"].max()
    assert opened[True] < 0.1
    assert opened[False] > 0.2


def test_the_reflex_closes_again_when_the_palm_is_touched_again():
    env = BabbleGraspEnv(
        max_episode_steps=500, enclosure_reflex=True, reflex_releases=True, support_stays=True
    )
    env.reset(seed=0, options={"in_hand": True, "start": (0.2, 0.8)})

    def turned(elbow, hand, steps):
        for _ in range(steps):
            observation, *_ = env.step(np.array([0.0, elbow, hand, hand], np.float32))
        return observation["hand"]

    assert turned(0.1, 0.0, 80).min() > 0.2  # The palm moves to the object.
    assert turned(0.0, -1.0, 120).max() < 0.02
    assert turned(-0.5, -1.0, 20).max() < 0.02  # Away from it, and back to it.
    assert turned(0.4, 0.0, 80).min() > 0.2


def test_a_release_needs_a_reflex():
    with pytest.raises(ConfigError, match="reflex_releases = true is not possible without"):
        BabbleGraspEnv(reflex_releases=True)


def test_an_agent_acts_with_its_own_reflex():
    own = EnvArguments.of(BabbleGraspEnv(enclosure_reflex=True, reflex_releases=True).interface)
    with pytest.raises(ConfigError, match=r"reflex_releases True, and the test .+ False"):
        arguments_for(own, None, None, {"reflex_releases": False})


# What is felt and told.


def test_arm_and_back_of_the_hand_feel_what_the_palm_does_not():
    # Catches forces of the wrong link, and a back that is the palm's side.
    env = BabbleGraspEnv(control="posture", arm_touch=True)
    felt = {}
    for name, along, side in (("upper arm", 0.07, 1), ("forearm", 0.22, -1), ("back", 0.32, -1)):
        start = np.array([0.6, np.radians(5.0)])
        elbow = 0.15 * np.array([np.cos(start[0]), np.sin(start[0])])
        turned = start[0] if along < 0.15 else start.sum()
        unit = np.array([np.cos(turned), np.sin(turned)])
        joint, way = (np.zeros(2), along) if along < 0.15 else (elbow, along - 0.15)
        place = joint + way * unit + side * 0.04 * np.array([-unit[1], unit[0]])
        env.reset(options={"start": start, "object": place, "diameter": 0.04})
        most = np.zeros(6)
        for k in range(40):
            arm = start + np.array([side * 0.02 * k, 0.0])
            observation, *_ = settled(env, arm, OPEN, 1)
            both = np.concatenate([observation["touch_arm"], observation["touch"]])
            most = np.maximum(most, both)
        felt[name] = most > 0
    assert felt["upper arm"].tolist() == [True, False, False, False, False, False]
    assert felt["forearm"].tolist()[:3] == [False, True, False]
    assert felt["back"].tolist()[:4] == [False, False, True, True]


def test_more_touch_adds_a_sense_and_changes_no_other():
    plain, more = BabbleGraspEnv(obs="flat"), BabbleGraspEnv(obs="flat", arm_touch=True)
    assert_same(plain.reset(seed=1)[0], more.reset(seed=1)[0][:-3])
    assert more.interface.spec.senses[-1].name == "touch_arm"
    for action in np.random.default_rng(0).uniform(-1, 1, (50, 4)).astype(np.float32):
        assert_same(plain.step(action)[0], more.step(action)[0][:-3])


@pytest.mark.parametrize("obs", ["senses", "flat"])
def test_agents_of_the_package_act_where_there_is_more_touch(obs):
    cases = gym_babble.scenarios("palm_side", 4)
    for agent in (gym_babble.Scripted, gym_babble.Random):
        results = [
            gym_babble.evaluate(agent(BabbleGraspEnv(arm_touch=more, obs=obs)), cases=cases)
            for more in (False, True)
        ]
        assert len(results[1]) == 4
        if agent is gym_babble.Scripted:
            assert results[0].steps == results[1].steps


def test_the_object_is_where_the_case_put_it_and_a_hand_can_hide_it():
    env = BabbleGraspEnv(control="posture", diameters=[0.01])
    _, info = env.reset(seed=0)
    assert info["object"].tolist() == [*env.scenario["object"], 0.0]
    assert info["in_sight"]
    hiding = (2.449, 0.1086)
    env.reset(options={"in_hand": True, "start": hiding})
    reflex = env.interface.quantities["reflex"]
    observation, *_, info = settled(env, hiding, reflex, 60)
    assert not info["in_sight"]
    before = observation["eye"]
    observation, *_, info = settled(env, hiding, reflex, 1)
    assert observation["eye"].tolist() == before.tolist()  # The eye stays.


# All options at once: like every environment.


def test_gymnasiums_checker_passes_and_infos_are_those_of_single_environments():
    check_env(BabbleGraspEnv(**ALL), skip_render_check=True)
    makers = [lambda: BabbleGraspEnv(**ALL, max_episode_steps=15)] * 3
    native = BabbleGraspVectorEnv(3, **ALL, max_episode_steps=15)
    foreign = SyncVectorEnv(makers)
    options = {"in_hand": True}
    assert_same(native.reset(seed=5, options=options), foreign.reset(seed=5, options=options))
    for actions in np.random.default_rng(0).uniform(-1, 1, (40, 3, 4)).astype(np.float32):
        assert_same(native.step(actions), foreign.step(actions))


@pytest.mark.parametrize("control", CONTROLS)
def test_a_state_goes_on_bit_for_bit_and_sees_what_was_seen(control):
    env = BabbleGraspEnv(control=control, **ALL)
    copy = BabbleGraspEnv(control=control, **ALL)
    env.reset(seed=2, options={"in_hand": True})
    for action in np.random.default_rng(1).uniform(-1, 1, (60, 4)).astype(np.float32):
        copy.set_state(env.get_state())
        first = env.step(action)
        assert_same(first, copy.step(action))
        again = BabbleGraspEnv(control=control, **ALL)
        again.set_state(env.get_state())
        assert again._batch.one()[4]["in_sight"] == first[4]["in_sight"]
    with pytest.raises(SnapshotError, match="another config or other options"):
        BabbleGraspEnv(control=control).set_state(env.get_state())


def test_make_and_the_registered_ids_take_the_options():
    env = gymnasium.make("BabbleGraspGoal-v0", **ALL)
    observation, _ = env.reset(seed=0, options={"in_hand": True})
    assert observation["observation"].shape == (458,)
