"""Environments on a server: the same bits as local ones, and the same errors."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import warnings
from threading import Thread

import gymnasium
import numpy as np
import pytest
from comparing import ALL_IDS, BATCHES, TASKS, assert_same, drawn_actions, rollout
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.wrappers import vector as wrappers
from serving import served
from test_vector import ALL_FORMS, MODES, vector_rollout

from gym_babble import HebbBabbling, Scripted, scenarios
from gym_babble.envs import BabbleReachEnv
from gym_babble.errors import (
    ActionError,
    BusyError,
    ConfigError,
    LimitError,
    ScenarioError,
    ServerError,
    SnapshotError,
)
from gym_babble.remote import RemoteEnv, RemoteVectorEnv
from gym_babble.remote.session import Session

each_id = pytest.mark.parametrize("env_id", ALL_IDS)
each_mode = pytest.mark.parametrize("mode", MODES, ids=lambda mode: mode.name)
FIRST_OF = {"reach": "BabbleReach-v0", "grasp": "BabbleGrasp-v0"}


@pytest.fixture(scope="module")
def url():
    with served("--envs-per-session", 128) as server:
        yield server.url


def id_for(task, form):
    """An id that takes a form."""
    return "BabbleGraspFull-v0" if form.get("region") == "full" else FIRST_OF[task]


@each_id
def test_gymnasiums_checker_is_content(env_id, url):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = RemoteEnv(env_id, url=url)
        check_env(env, skip_render_check=True)  # Rendering is compared below.
        env.close()


@pytest.mark.parametrize(
    ("mode", "task", "form"),
    [
        pytest.param(mode, *of, marks=[] if (i + k) % 3 == 0 else pytest.mark.slow)
        for k, mode in enumerate(MODES)
        for i, of in enumerate(ALL_FORMS)
    ],
    ids=lambda x: "-".join(map(str, x.values())) if isinstance(x, dict) else str(x),
)
def test_a_remote_batch_equals_a_local_one(mode, task, form, url):
    if form.get("control") != "pattern":
        form = {**form, "max_episode_steps": min(30, form.get("max_episode_steps", 30))}
    local = BATCHES[task](4, autoreset_mode=mode, **form)
    remote = RemoteVectorEnv(id_for(task, form), 4, url=url, autoreset_mode=mode, **form)
    assert isinstance(remote, VectorEnv)
    assert remote.metadata == local.metadata
    for name in ("observation_space", "action_space", "single_observation_space"):
        assert getattr(remote, name) == getattr(local, name)
    actions = drawn_actions(local.action_space, 20 if form["obs"] == "retina" else 70, 8)
    seen = vector_rollout(remote, actions)
    assert_same(seen, vector_rollout(local, actions))
    assert sum((step[2] | step[3]).sum() for step in seen if len(step) == 5)
    remote.close()


def compare_single(env_id, url, steps, **options):
    local = gymnasium.make(env_id, **options).unwrapped
    remote = RemoteEnv(env_id, url=url, **options)
    assert remote.observation_space == local.observation_space
    assert_same(remote.reset(seed=5), local.reset(seed=5))
    for action in drawn_actions(local.action_space, steps, 1):
        assert_same(rollout(remote, [action], reset=False), rollout(local, [action], reset=False))
    assert remote.state_hash() == local.state_hash()
    remote.close()


@each_id
def test_a_remote_environment_equals_a_local_one(env_id, url):
    compare_single(env_id, url, 150, max_episode_steps=70)


@pytest.mark.parametrize("obs", ["flat", "retina"])
def test_other_observations_of_single_environments(obs, url):
    for env_id in FIRST_OF.values():
        compare_single(env_id, url, 12, obs=obs, retina_size=36, max_episode_steps=5)


@pytest.mark.slow
@each_id
def test_ten_thousand_steps_have_the_same_bits(env_id, url):
    compare_single(env_id, url, 10_000)


@pytest.mark.slow
@each_id
@each_mode
def test_ten_thousand_steps_of_batches_have_the_same_bits(mode, env_id, url):
    local = gymnasium.make_vec(env_id, num_envs=4, autoreset_mode=mode)
    remote = RemoteVectorEnv(env_id, 4, url=url, autoreset_mode=mode)
    assert_same(remote.reset(seed=3), local.reset(seed=3))
    local.action_space.seed(0)
    for _ in range(2_500):
        actions = local.action_space.sample()
        seen = remote.step(actions)
        assert_same(seen, local.step(actions))
        ended = seen[2] | seen[3]
        if mode is AutoresetMode.DISABLED and ended.any():
            again = {"reset_mask": ended}
            assert_same(remote.reset(options=again), local.reset(options=again))
    remote.close()


# Seeds, cases, states.


def test_seeds_masks_and_cases_are_those_of_a_local_batch(url):
    remote, local = RemoteVectorEnv(num_envs=3, url=url), BATCHES["reach"](3)
    cases = scenarios("table1", 3)
    masks = [np.array(mask) for mask in ([True, False, True], [False, True, False])]
    for arguments in (
        {"seed": 4, "options": {"reset_mask": masks[0]}},  # The first one seeds all.
        {"options": {"reset_mask": masks[1]}},
        {"seed": [1, None, 2**64 - 1]},
        {"seed": [5, 6, 7], "options": {"reset_mask": masks[1]}},
        {"options": {"scenario": cases}},
        {"options": {"scenario": [None, {"obstacle": None}, None]}},
        {"options": {"reset_mask": masks[1], "target": (0.15, 0.25)}},
        {"options": {}},
        {},
    ):
        assert_same(remote.reset(**arguments), local.reset(**arguments))
        assert remote.np_random_seed == local.np_random_seed
        assert_same(remote.call("scenario"), local.call("scenario"))
    unseeded = RemoteVectorEnv(num_envs=3, url=url)
    unseeded.reset()
    local.reset(seed=list(unseeded.np_random_seed))
    assert unseeded.call("state_hash") == local.call("state_hash")


@pytest.mark.parametrize("task", TASKS)
def test_states_go_from_one_to_the_other(task, url):
    remote = RemoteVectorEnv(FIRST_OF[task], 3, url=url)
    local = BATCHES[task](3)
    remote.reset(seed=1)
    actions = drawn_actions(local.action_space, 60, 0)
    for action in actions[:30]:
        remote.step(action)
    states = remote.get_state()
    local.set_state(states)
    assert remote.call("state_hash") == local.call("state_hash")
    seen = [remote.step(action) for action in actions[30:]]
    assert_same(seen, [local.step(action) for action in actions[30:]])
    remote.set_state(states)
    assert_same(seen, [remote.step(action) for action in actions[30:]])
    before = remote.call("state_hash")
    for broken in ([*states[:2], states[2][:-1]], [*states[:2], None], states[:2], None):
        with pytest.raises((SnapshotError, ConfigError)):
            remote.set_state(broken)
        assert remote.call("state_hash") == before
    single = RemoteEnv(FIRST_OF[task], url=url)
    assert single.interface.unconverged_steps is None  # Those that are counted here are none of it.
    single.set_state(states[1])
    assert single.get_state() == states[1]


# Pictures.


def test_render_modes_show_what_local_environments_show(url, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    for mode in ("rgb_array", "rgb_array_list", "human"):
        made = {"width": 60, "height": 48, "max_episode_steps": 4}
        local = gymnasium.make("BabbleGrasp-v0", render_mode=mode, **made).unwrapped
        remote = RemoteEnv("BabbleGrasp-v0", mode, url=url, **made)
        with pytest.raises(ResetNeeded):
            remote.render()
        for env in (remote, local):
            env.reset(seed=0)
        for action in drawn_actions(local.action_space, 4, 0):
            assert_same(remote.step(action), local.step(action))
            assert_same(remote.render(), local.render())
        assert remote.moments == local.moments == 5
        assert_same(remote.picture("eye", (50, 40), 2), local.picture("eye", (50, 40), 2))
        assert_same(remote.trajectory, local.trajectory)
        assert_same(remote.scenario, local.scenario)
        for env in (remote, local):
            env.close()


@each_mode
def test_lists_of_frames_span_autoresets(mode, url):
    made = {"width": 24, "height": 24, "max_episode_steps": 3, "autoreset_mode": mode}
    remote = RemoteVectorEnv("BabbleReach-v0", 2, "rgb_array_list", url=url, **made)
    local = BATCHES["reach"](2, "rgb_array_list", **made)
    actions = drawn_actions(local.action_space, 8, 0)
    assert_same(vector_rollout(remote, actions), vector_rollout(local, actions))
    assert_same(remote.render(), local.render())
    assert_same(remote.render(), local.render())


def test_calls_and_attributes_of_each_environment(url):
    remote = RemoteVectorEnv("BabbleReachGoal-v0", 3, "rgb_array", url=url, threads=1, width=20)
    local = gymnasium.make_vec(
        "BabbleReachGoal-v0", num_envs=3, render_mode="rgb_array", threads=1, width=20
    )
    for envs in (remote, local):
        envs.reset(seed=2)
        envs.set_attr("weight", [1, 2, 3])
    for name in ("scenario", "trajectory", "get_state", "weight", "render", "threads"):
        assert_same(remote.call(name), local.call(name))
    assert_same(remote.get_attr("action_space"), local.get_attr("action_space"))
    assert_same(remote.render(), local.render())
    with pytest.raises(AttributeError):
        remote.set_attr("scenario", 1)
    with pytest.raises(ConfigError, match="step"):
        remote.call("step")
    achieved, desired = remote.reset(seed=1)[0]["achieved_goal"], np.zeros((3, 2))
    rewards = remote.compute_reward(achieved, desired, {})
    assert_same(rewards, local.unwrapped.compute_reward(achieved, desired, {}))
    with pytest.raises(AttributeError):
        RemoteEnv(url=url).compute_reward  # noqa: B018 - that it is not there is the test


def test_wrappers_of_gymnasium_fit(url):
    def wrapped(envs):
        return wrappers.RecordEpisodeStatistics(wrappers.FlattenObservation(envs))

    remote = wrapped(RemoteVectorEnv("BabbleReach-v0", 2, url=url, max_episode_steps=9))
    local = wrapped(BATCHES["reach"](2, max_episode_steps=9))
    for envs in (remote, local):
        envs.reset(seed=3)
    for actions in drawn_actions(local.action_space, 30, 0):
        ours, theirs = remote.step(actions), local.step(actions)
        for infos in (ours[4], theirs[4]):
            infos.get("episode", {}).pop("t", None)
        assert_same(ours, theirs)


# Errors.

WRONG = (
    (lambda env: env.reset(seed=-1), ConfigError),
    (lambda env: env.reset(options={"obstacels": None}), ConfigError),
    (lambda env: env.reset(options={"target": (9.0, 9.0)}), ScenarioError),
    (lambda env: env.reset(options={"target": (0.1, np.inf)}), ScenarioError),
    (lambda env: env.set_state(b"no state"), SnapshotError),
    (lambda env: env.set_state(BabbleReachEnv(reward="sparse").get_state()), SnapshotError),
    (lambda env: env.picture("eye", (16, 16), 0), ConfigError),
    (lambda env: env.step([0.0, np.nan]), ActionError),
    (lambda env: env.step([0.0]), ActionError),
    (lambda env: env.step(["a", "b"]), ActionError),
)


def test_errors_are_those_of_a_local_environment(url):
    remote, local = RemoteEnv(url=url), BabbleReachEnv()
    for env in (remote, local):
        with pytest.raises(ResetNeeded):
            env.step([0.0, 0.0])
        env.reset(seed=0)
    for wrong, kind in WRONG:
        told = []
        for env in (remote, local):
            with pytest.raises(kind) as caught:
                wrong(env)
            told.append((type(caught.value), str(caught.value)))
        # The server counts a state's place in its list.
        assert told[0][0] is told[1][0]
        assert told[0][1].removeprefix("states[0]: ") == told[1][1]
        assert remote.state_hash() == local.state_hash()
    assert_same(remote.reset(seed=1), local.reset(seed=1))


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"env_id": "BabbleReach-v1"}, "BabbleReach-v1"),
        ({"obs": "sense"}, "sense"),
        ({"obs": np.array(["flat"])}, "obs"),
        ({"width": np.nan}, "width"),
        ({"camera": 3}, "camera"),
        ({"retina": 3}, "retina_size"),
        ({"config": {"bdy": {}}}, "bdy"),
        ({"render_mode": "ansi"}, "ansi"),
        ({"url": "http://127.0.0.1"}, "url"),
        ({"url": "127.0.0.1:8741"}, "url"),
        ({"url": None}, "url"),
        ({"timeout": 0}, "timeout"),
        ({"timeout": "soon"}, "timeout"),
        ({"env_id": "BabbleGrasp-v0", "region": "full"}, "BabbleGraspFull-v0"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_wrong_arguments_are_told_without_a_server(arguments, named):
    nobody = {"url": "ws://127.0.0.1:9"}
    with pytest.raises(ConfigError, match=named):
        RemoteEnv(**{**nobody, **arguments})
    with pytest.raises(ConfigError, match=named):
        RemoteVectorEnv(**{**nobody, "num_envs": 2, **arguments})


def test_wrong_arguments_of_batches(url):
    for arguments in (
        {"num_envs": 0},
        {"autoreset_mode": "sometimes"},
        {"threads": 0},
        {"render_mode": "human"},
    ):
        with pytest.raises(ConfigError):
            RemoteVectorEnv(url=url, **arguments)
    with pytest.raises(LimitError, match=r"num_envs = 129: this server allows at most 128"):
        RemoteVectorEnv(num_envs=129, url=url)


def test_another_version_is_told(url, monkeypatch):
    # The client reads numbers by the spec it has: that of the server must be the same.
    begin = Session.__init__

    def begin_elsewhere(self, *arguments):
        begin(self, *arguments)
        self.made["spec"]["senses"].pop()

    monkeypatch.setattr(Session, "__init__", begin_elsewhere)
    with pytest.raises(ServerError, match="install the same version"):
        RemoteEnv(url=url)


def test_copies_are_refused_and_say_what_to_do(url):
    env = RemoteEnv(url=url)
    for attempt in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="set_state"):
            attempt(env)


def test_a_second_thread_is_refused_at_once(url):
    env = RemoteEnv(url=url)
    env.reset(seed=0)
    caught = []

    def step():
        try:
            env.step(np.zeros(2, np.float32))
        except BusyError as error:
            caught.append(error)

    with env._batch:
        other = Thread(target=step)
        other.start()
        other.join()
    assert len(caught) == 1
    env.step(np.zeros(2, np.float32))


def test_a_closed_environment_says_so(url):
    for env in (RemoteEnv(url=url), RemoteVectorEnv(num_envs=2, url=url)):
        env.reset(seed=0)
        env.close()
        env.close()
        with pytest.raises(ClosedEnvironmentError):
            env.reset()


# Agents.


def test_agents_act_in_remote_environments(url):
    for env_id, kind in (("BabbleReach-v0", Scripted), ("BabbleReachPattern-v0", HebbBabbling)):
        played = []
        for env in (RemoteEnv(env_id, url=url), gymnasium.make(env_id).unwrapped):
            agent = kind(env)
            if kind is HebbBabbling:
                agent.learn(250)
            observation, _ = env.reset(seed=3)
            for _ in range(20):
                action, _ = agent.predict(observation)
                played.append(env.step(action))
                observation = played[-1][0]
                if played[-1][2]:
                    break
        half = len(played) // 2
        assert_same(played[:half], played[half:])


def test_without_its_libraries_the_error_names_the_extra():
    for library in ("msgspec", "websockets"):
        program = f"import sys; sys.modules[{library!r}] = None; import gym_babble.remote"
        run = subprocess.run(
            [sys.executable, "-c", program], check=False, capture_output=True, text=True
        )
        assert f"{library} is not installed" in run.stderr
        assert "gym-babble[remote]" in run.stderr
