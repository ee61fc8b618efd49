"""The native batch: a real vector environment, equal to single ones to the bit."""

from __future__ import annotations

import copy
import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from comparing import (
    ALL_IDS,
    BATCHES,
    GRASP_IDS,
    IDS,
    TASKS,
    assert_same,
    drawn_actions,
    info_of,
    one_of,
)
from grasping import OPEN, grasp, posture, to_object
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.wrappers import vector as wrappers
from hypothesis import given, settings
from hypothesis import strategies as st
from processes import forking

from gym_babble import scenarios
from gym_babble.envs import BabbleGraspEnv, BabbleGraspVectorEnv, BabbleReachVectorEnv

MODES = tuple(AutoresetMode)
FORMS = (
    {"obs": "senses"},
    {"obs": "flat", "control": "torque"},
    {"obs": "goal", "reward": "sparse", "max_episode_steps": 30},
    {"obs": "retina", "retina_size": 36, "max_episode_steps": 9},
    {"obs": "senses", "control": "pattern", "reward": "sparse"},
)
GRASP_FORMS = (
    *FORMS[:4],
    {"obs": "flat", "control": "posture", "enclosure_reflex": True},
    {"obs": "senses", "region": "full", "any_diameter_between": True, "max_episode_steps": 90},
)
ALL_FORMS = [("reach", form) for form in FORMS] + [("grasp", form) for form in GRASP_FORMS]
names = pytest.mark.parametrize(
    ("task", "form"),
    ALL_FORMS,
    ids=lambda x: x if isinstance(x, str) else "-".join(map(str, x.values())),
)
each_task = pytest.mark.parametrize("task", TASKS)


def make_sync(task, n, mode, form):
    return SyncVectorEnv([lambda: TASKS[task](**form)] * n, autoreset_mode=mode)


def without_resets(mode):
    return mode is AutoresetMode.DISABLED


def vector_rollout(envs, actions, options=None):
    """All that a batch gives, with masked resets where it does not reset itself."""
    seen = [envs.reset(seed=5, options=options)]
    for action in actions:
        seen.append(envs.step(action))
        ended = seen[-1][2] | seen[-1][3]
        if without_resets(envs.metadata["autoreset_mode"]) and ended.any():
            seen.append(envs.reset(options={"reset_mask": ended}))
    return seen


@names
@pytest.mark.parametrize("mode", MODES, ids=lambda mode: mode.name)
def test_the_batch_equals_gymnasiums_batch_of_singles(mode, task, form):
    native = BATCHES[task](4, autoreset_mode=mode, **form)
    sync = make_sync(task, 4, mode, form)
    assert native.observation_space == sync.observation_space
    assert native.action_space == sync.action_space
    assert native.single_observation_space == sync.single_observation_space
    actions = drawn_actions(native.action_space, 20 if form["obs"] == "retina" else 280, 8)
    ours, theirs = vector_rollout(native, actions), vector_rollout(sync, actions)
    assert_same(ours, theirs)
    ends = sum((step[2] | step[3]).sum() for step in ours if len(step) == 5)
    assert ends >= 4


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_environment_i_is_the_single_one_seeded_s_plus_i(env_id):
    limit = {"max_episode_steps": 200}
    envs = gymnasium.make_vec(env_id, num_envs=5, **limit)
    actions = drawn_actions(envs.action_space, 600, 0)
    seen = [envs.reset(seed=100)] + [envs.step(action) for action in actions]
    for i in range(5):
        env = gymnasium.make(env_id, **limit)
        observation, info = env.reset(seed=100 + i)
        ended, episodes = False, 0
        for k in range(len(seen)):
            if k and ended:
                (observation, info), ended, episodes = env.reset(), False, episodes + 1
                reward = 0.0
            elif k:
                observation, reward, terminated, truncated, info = env.step(actions[k - 1][i])
                ended = terminated or truncated
                assert (terminated, truncated) == (seen[k][2][i], seen[k][3][i])
            assert_same(observation, one_of(seen[k][0], i))
            assert_same(info, info_of(seen[k][-1], i))
            assert not k or reward == seen[k][1][i]
        assert episodes >= 2


@pytest.mark.parametrize(("task", "n"), [("reach", 64), ("grasp", 4)])
def test_a_thread_is_woken_for_so_many_environments_and_no_more_than_processors(
    task, n, monkeypatch
):
    monkeypatch.setattr("gym_babble.envs.vector.processors", lambda: 3)
    assert [BATCHES[task](k).threads for k in (1, 2 * n - 1, 2 * n, 9 * n)] == [1, 1, 2, 3]


@settings(max_examples=15)
@given(
    task=st.sampled_from(sorted(TASKS)),
    mode=st.sampled_from(MODES),
    moment=st.integers(0, 30),
    n=st.integers(1, 5),
    how=st.sampled_from(["state", "pickle", "deepcopy"]),
)
def test_a_batch_continues_from_its_states_and_copies(task, *, mode, moment, n, how):
    def make():
        return BATCHES[task](n, autoreset_mode=mode, max_episode_steps=11)

    def play(envs, actions):
        seen = []
        for action in actions:
            seen.append(envs.step(action))
            ended = seen[-1][2] | seen[-1][3]
            if without_resets(mode) and ended.any():
                seen.append(envs.reset(options={"reset_mask": ended}))
        return seen

    envs = make()
    actions = drawn_actions(envs.action_space, 60, moment)
    envs.reset(seed=moment)
    play(envs, actions[:moment])
    if how == "state":
        other = make()
        other.reset(seed=99)
        other.set_state(envs.get_state())
    else:
        other = copy.deepcopy(envs) if how == "deepcopy" else pickle.loads(pickle.dumps(envs))  # noqa: S301
    assert other.call("state_hash") == envs.call("state_hash")
    assert_same(play(envs, actions[moment:]), play(other, actions[moment:]))


@each_task
def test_unseeded_resets_reproduce_after_a_seed(task):
    envs = BATCHES[task](3)
    seen = []
    for seed in (4, 5, 4):
        envs.reset(seed=seed)
        seen.append([envs.reset()[0] for _ in range(3)])
    assert_same(seen[0], seen[2])
    assert not np.array_equal(seen[0][0]["eye"], seen[1][0]["eye"])
    envs.reset(seed=[4, None, 6])
    assert_same(one_of(envs.reset()[0], 0), one_of(seen[0][0], 0))


@each_task
def test_each_autoreset_draws_a_new_case(task):
    control = {"reach": "pattern", "grasp": "torque"}[task]
    envs = BATCHES[task](2, control=control, autoreset_mode="SameStep", max_episode_steps=1)
    envs.reset(seed=0)
    actions = drawn_actions(envs.action_space, 20, 0)
    places = {envs.step(action)[0]["eye"].tobytes() for action in actions}
    assert len(places) == 20


def test_options_hold_for_autoresets_until_others_are_named():
    cases = scenarios("table1", 2, seed=3)
    envs = BabbleReachVectorEnv(2, control="pattern", autoreset_mode="SameStep")

    def targets():
        return [case["target"] for case in envs.get_attr("scenario")]

    wanted = [case["target"] for case in cases]
    envs.reset(seed=0, options={"scenario": cases})
    for action in drawn_actions(envs.action_space, 4, 0):
        assert targets() == wanted
        envs.step(action)
    envs.reset(options={"scenario": cases[1]})
    assert targets() == [wanted[1]] * 2
    envs.reset(options={"scenario": cases[0], "reset_mask": np.array([True, False])})
    assert targets() == wanted
    envs.reset(options={"reset_mask": np.array([True, True])})
    assert targets() == wanted
    envs.reset(options={})
    assert not set(targets()) & set(wanted)


def test_options_of_grasping_hold_for_autoresets_until_others_are_named():
    envs = BabbleGraspVectorEnv(2, max_episode_steps=3, autoreset_mode="SameStep")
    objects = [(0.0, 0.2), (-0.1, 0.2)]

    def placed():
        return [case["object"] for case in envs.get_attr("scenario")]

    envs.reset(seed=0, options={"scenario": [{"object": place} for place in objects]})
    starts = set()
    for action in drawn_actions(envs.action_space, 12, 0):
        assert placed() == objects
        envs.step(action)
        starts |= {case["start"] for case in envs.get_attr("scenario")}
    assert len(starts) == 10
    envs.reset(options={"object": objects[1], "reset_mask": np.array([True, False])})
    assert placed() == [objects[1]] * 2
    envs.reset(options={"reset_mask": np.array([True, True])})
    assert placed() == [objects[1]] * 2
    envs.reset(options={})
    assert not set(placed()) & set(objects)


def test_each_autoreset_mode_shows_the_end_of_a_grasp():
    # A success in one environment of two, and nothing of it in the other.
    shown = {}
    case = {"start": (-0.7, 0.9), "object": (0.0, 0.2), "diameter": 0.06}
    single = BabbleGraspEnv(control="posture")
    played = grasp(single, seed=0, options=case)
    actions = [posture(single, (-1.2, 0.5), OPEN)] * len(played)
    single.reset(options=case)
    hand = [to_object(single, result[-1]) for result in played[:-1]]
    for mode in MODES:
        envs = BabbleGraspVectorEnv(2, control="posture", autoreset_mode=mode)
        envs.reset(seed=0, options=case)
        for pair in zip(hand, actions, strict=False):
            last = envs.step(np.stack(pair))
        assert last[2].tolist() == [True, False]
        assert last[1][0] == played[-1][1]
        shown[mode] = last
    for mode in (AutoresetMode.NEXT_STEP, AutoresetMode.DISABLED):
        assert_same(one_of(shown[mode][0], 0), played[-1][0])
        assert_same(info_of(shown[mode][4], 0), played[-1][4])
    observation, _, _, _, infos = shown[AutoresetMode.SAME_STEP]
    assert_same(infos["final_obs"][0], played[-1][0])
    assert_same(info_of(infos["final_info"], 0), played[-1][4])
    assert infos["final_obs"][1] is None
    assert infos["_final_obs"].tolist() == [True, False]
    assert not infos["held"].any()
    assert infos["outcome"]["running"][0]
    assert_same(one_of(observation, 0), played[0][0])


@each_task
def test_what_was_returned_never_changes(task):
    envs = BATCHES[task](3, max_episode_steps=5, autoreset_mode="SameStep")
    actions = drawn_actions(envs.action_space, 12, 0)
    kept = [envs.reset(seed=0)] + [envs.step(action) for action in actions]
    frozen = copy.deepcopy(kept)
    envs.reset(seed=1)
    for action in actions:
        envs.step(action)
    assert_same(frozen, kept)


LIVED_ON = ("num_envs", "step", "render_mode", "observation_space", "single_action_space")
LIVED_ON += ("action_space", "interface", "scenario", "spec", "metadata", "threads", "get_state")
"""What belongs to the batch itself."""


@each_task
def test_attributes_and_methods_of_each_environment(task):
    form = {"render_mode": "rgb_array", "width": 32, "height": 24}
    envs = BATCHES[task](3, **form)
    sync = make_sync(task, 3, AutoresetMode.NEXT_STEP, form)
    envs.reset(seed=2)
    sync.reset(seed=2)
    for name in ("scenario", "trajectory", "render_mode", "action_space", "observation_space"):
        assert_same(envs.get_attr(name), sync.get_attr(name))
    for name in ("state_hash", "get_state", "render"):
        assert_same(envs.call(name), sync.call(name))
    assert_same(envs.render(), sync.render())
    envs.call("set_state", envs.get_state()[1])
    assert len(set(envs.call("state_hash"))) == 1
    for values in ([1, 2, 3], [np.zeros(2)] * 3, np.arange(3.0), "all"):
        for made in (envs, sync):
            made.set_attr("note", values)
        assert_same(envs.get_attr("note"), sync.get_attr("note"))
        assert_same(copy.deepcopy(envs).get_attr("note"), envs.get_attr("note"))
    for name in LIVED_ON:
        with pytest.raises(AttributeError, match=f"{name} cannot be set"):
            envs.set_attr(name, envs.get_attr("num_envs"))
    with pytest.raises(AttributeError):
        envs.get_attr("no_such_thing")
    with pytest.raises(ValueError, match="note"):
        envs.set_attr("note", [1, 2])
    for name in ("reset", "step", "close"):
        with pytest.raises(ValueError, match=name):
            envs.call(name)
    envs.close()
    envs.close()
    assert envs.closed


@pytest.mark.parametrize("env_id", [IDS[2], GRASP_IDS[2]])
def test_the_goals_reward_is_there_as_in_single_environments(env_id):
    envs = gymnasium.make_vec(env_id, num_envs=3)
    sync = gymnasium.make_vec(env_id, num_envs=3, vectorization_mode="sync")
    goals = np.zeros(2), np.zeros((4, 2))
    assert_same(envs.call("compute_reward", *goals, {}), sync.call("compute_reward", *goals, {}))


@each_task
def test_frames_of_each_environment_since_the_last_call(task):
    envs = BATCHES[task](2, render_mode="rgb_array_list", width=32, height=32)
    envs.reset(seed=0)
    assert [len(frames) for frames in envs.render()] == [1, 1]
    for _ in range(4):
        envs.step(np.zeros(envs.action_space.shape, np.float32))
    assert [len(frames) for frames in envs.render()] == [4, 4]
    assert [len(frames) for frames in envs.render()] == [0, 0]


@pytest.mark.parametrize("mode", [None, "sync", "async", "vector_entry_point"])
@each_task
def test_make_vec_makes_it_in_every_mode(task, mode):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        envs = gymnasium.make_vec(f"Babble{task.title()}-v0", num_envs=3, vectorization_mode=mode)
    assert isinstance(envs.unwrapped, BATCHES[task]) == (mode not in ("sync", "async"))
    assert isinstance(envs, VectorEnv)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    single = BATCHES[task](3)
    assert_same(envs.reset(seed=1), single.reset(seed=1))
    for action in drawn_actions(single.action_space, 30, 0):
        assert_same(envs.step(action), single.step(action))
    envs.close()


@pytest.mark.parametrize(
    ("env_id", "shared_memory"), [(IDS[2], True), (IDS[2], False), (GRASP_IDS[2], True)]
)
def test_gymnasiums_processes_work(env_id, shared_memory):
    with forking():
        envs = gymnasium.make_vec(
            env_id,
            num_envs=2,
            vectorization_mode="async",
            vector_kwargs={"shared_memory": shared_memory},
        )
    native = gymnasium.make_vec(env_id, num_envs=2)
    assert_same(native.reset(seed=1), envs.reset(seed=1))
    for action in drawn_actions(native.action_space, 5, 0):
        assert_same(native.step(action), envs.step(action))
    assert_same(native.call("state_hash"), envs.call("state_hash"))
    envs.close()


@pytest.mark.parametrize("env_id", [IDS[0], GRASP_IDS[0]])
def test_make_vec_sets_the_time_limit_itself(env_id):
    envs = gymnasium.make_vec(env_id, num_envs=2, max_episode_steps=3)
    envs.reset(seed=0)
    still = np.zeros(envs.action_space.shape, np.float32)
    for _ in range(3):
        observation, _, _, truncated, infos = envs.step(still)
    assert truncated.all()
    assert infos["outcome"]["timeout"].all()
    assert (observation["time"] == 1).all()


@pytest.mark.parametrize(("env_id", "size"), [(IDS[0], 11), (GRASP_IDS[0], 455)])
def test_gymnasiums_vector_wrappers_work(env_id, size):
    envs = gymnasium.make_vec(env_id, num_envs=3, max_episode_steps=20)
    envs = wrappers.RecordEpisodeStatistics(envs)
    envs = wrappers.NormalizeReward(wrappers.FlattenObservation(envs))
    assert envs.single_observation_space.shape == (size,)
    observation, _ = envs.reset(seed=0)
    episodes = 0
    for action in drawn_actions(envs.action_space, 60, 0):
        assert observation in envs.observation_space
        observation, _, terminated, truncated, infos = envs.step(action)
        ended = terminated | truncated
        assert ended.any() == ("episode" in infos)
        if ended.any():
            assert (infos["episode"]["l"][ended] <= 20).all()
            episodes += ended.sum()
    assert episodes >= 6
