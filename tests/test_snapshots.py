"""States as bytes: they continue to the bit wherever they are read, or are refused by name."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from comparing import (
    ALL_CHOICES,
    BATCHES,
    EACH_CONTROL,
    GRASP_IDS,
    TASKS,
    assert_same,
    rollout,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from gym_babble.errors import BabbleError, SnapshotError
from gym_babble.sb3 import BabbleVecEnv

each_task = pytest.mark.parametrize("task", TASKS)
CONTACT = {"start": (0.2, 0.8), "object": (0.13, 0.2), "diameter": 0.05}
"""An object in the way of the hand."""


def task_of(env_id: str) -> str:
    return "grasp" if env_id in GRASP_IDS else "reach"


@st.composite
def kinds(draw: st.DrawFn) -> tuple[str, dict[str, Any]]:
    """A task with any combination of its choices."""
    env_id, choices = draw(st.sampled_from(ALL_CHOICES))
    task = task_of(env_id)
    engine = draw(st.sampled_from(["tree", "tree", "tree", "rapier"]))
    config: dict[str, Any] = {"profile": draw(st.sampled_from(["paper", "icub"]))}
    if draw(st.booleans()):
        config["noise"] = {"joint_deg": 1.0, "fovea": 0.1, "motor_deg": 2.0}
    extra: dict[str, Any] = {"max_episode_steps": draw(st.integers(1, 60))}
    if task == "grasp":
        extra["enclosure_reflex"] = draw(st.booleans())
        extra["any_diameter_between"] = draw(st.booleans())
        extra["in_hand_starts"] = draw(st.sampled_from([0.0, 0.5]))
        config["body"] = {"engine": engine}
    elif choices["obs"] != "goal":
        extra["settled"] = draw(st.booleans())
    if choices["control"] == "pattern":
        del extra["max_episode_steps"]
    render = draw(st.sampled_from([None, "rgb_array", "rgb_array_list"]))
    return task, {**choices, **extra, "config": config, "render_mode": render, "retina_size": 36}


def actions_for(env: Any, n: int, seed: int) -> list[Any]:
    """Actions a little beyond their bounds, each held for a while, so that arms get somewhere."""
    random = np.random.default_rng(seed)
    size = env.action_space.shape[0]
    held = random.uniform(-1.3, 1.3, (n // 5 + 1, size)).astype(np.float32)
    return list(np.repeat(held, 5, axis=0)[:n])


@settings(max_examples=60)
@given(
    kind=kinds(),
    seed=st.integers(0, 1000),
    moment=st.integers(0, 90),
    after=st.integers(1, 25),
    touching=st.booleans(),
)
def test_a_state_of_any_kind_continues_to_the_bit_from_any_moment(
    kind, tmp_path_factory, *, seed, moment, after, touching
):
    task, choices = kind
    env, other = (TASKS[task](**choices) for _ in range(2))
    actions = actions_for(env, moment + after, seed)
    case = CONTACT if touching and task == "grasp" else {}
    env.reset(seed=seed, options=case)
    rollout(env, actions[:moment], reset=False)
    path = tmp_path_factory.getbasetemp() / "state"
    path.write_bytes(env.get_state())
    other.reset(seed=seed + 1)
    rollout(other, actions[:3], reset=False)
    other.set_state(path.read_bytes())
    assert other.get_state() == env.get_state()
    assert other.state_hash() == env.state_hash()
    assert_same(other.trajectory, env.trajectory)
    assert_same(
        rollout(env, actions[moment:], reset=False), rollout(other, actions[moment:], reset=False)
    )
    assert other.state_hash() == env.state_hash()


ELSEWHERE = """
import json, sys
import numpy as np
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv

for line in sys.stdin:
    task, choices, state, actions = json.loads(line)
    env = {"grasp": BabbleGraspEnv, "reach": BabbleReachEnv}[task](**choices)
    env.set_state(bytes.fromhex(state))
    trace = [env.state_hash()]
    for action in actions:
        observation, reward, terminated, truncated, _ = env.step(np.array(action, np.float32))
        shown = np.concatenate([*map(np.ravel, observation.values()), [reward]])
        trace.append([env.state_hash(), shown.astype(np.float64).tobytes().hex()])
        if terminated or truncated:
            env.reset()
    print(json.dumps(trace))
"""


def test_another_process_continues_a_state_to_the_bit():
    # In mid-contact with either engine, and in each control of both tasks.
    kinds = [(task, {"control": control}) for task, control in EACH_CONTROL]
    kinds += [
        ("grasp", {"enclosure_reflex": True, "config": {"body": {"engine": engine}}})
        for engine in ("tree", "rapier")
    ]
    asked, expected, touched = [], [], 0
    for task, choices in kinds:
        env = TASKS[task](**choices)
        actions = actions_for(env, 40, 5)
        info = env.reset(seed=2, options=CONTACT if task == "grasp" else {})[1]
        for action in actions[:20]:
            *_, terminated, truncated, info = env.step(action)
            if terminated or truncated:
                env.reset()
        touched += info.get("reach", False)
        state = env.get_state().hex()
        after = [action.tolist() for action in actions[20:]]
        asked.append(json.dumps([task, choices, state, after]))
        trace: list[Any] = [env.state_hash()]
        for action in actions[20:]:
            observation, reward, terminated, truncated, _ = env.step(action)
            shown = np.concatenate([*map(np.ravel, observation.values()), [reward]])
            trace.append([env.state_hash(), shown.astype(np.float64).tobytes().hex()])
            if terminated or truncated:
                env.reset()
        expected.append(trace)
    assert touched >= 2
    run = subprocess.run(
        [sys.executable, "-c", ELSEWHERE],
        input="\n".join(asked),
        check=True,
        capture_output=True,
        text=True,
    )
    assert [json.loads(line) for line in run.stdout.splitlines()] == expected


def refused(env: Any, state: bytes) -> None:
    before = env.state_hash()
    with pytest.raises(SnapshotError) as caught:
        env.set_state(state)
    assert isinstance(caught.value, ValueError | BabbleError)
    assert env.state_hash() == before


@each_task
def test_each_byte_altered_and_each_length_are_refused(task):
    env = TASKS[task](max_episode_steps=9)
    env.reset(seed=0)
    for action in actions_for(env, 5, 0):
        env.step(action)
    good = env.get_state()
    env.step(actions_for(env, 1, 1)[0])
    for at in range(len(good)):
        altered = bytearray(good)
        altered[at] ^= 1 << (at % 8)
        refused(env, bytes(altered))
        refused(env, good[:at])
    refused(env, good + b"\0")
    env.set_state(good)
    assert env.get_state() == good


@each_task
@settings(max_examples=200)
@given(
    noise=st.binary(max_size=2000),
    keep=st.integers(0, 40),
    # Lengths of lists are numbers of up to ten bytes of seven bits each.
    prefix=st.sampled_from([b"", b"\xff" * 9 + b"\x01", b"\xff\xff\xff\xff\x0f", b"\x80" * 64]),
)
def test_noise_is_refused(task, noise, keep, prefix):
    env = TASKS[task](max_episode_steps=9)
    env.reset(seed=0)
    refused(env, noise)
    refused(env, env.get_state()[:keep] + prefix + noise)


@each_task
def test_a_state_says_what_it_is_not_of(task):
    env, foreign = TASKS[task](), TASKS[{"reach": "grasp", "grasp": "reach"}[task]]()
    other = TASKS[task](max_episode_steps=7)
    for made in (env, foreign, other):
        made.reset(seed=0)
    good = env.get_state()
    for state, named in (
        (foreign.get_state(), "not a snapshot of a"),
        (other.get_state(), "another config or other options"),
        (good[:4] + b"\x63" + good[5:], "version 99 is not"),
        (good[:-1], "cut short or altered"),
    ):
        with pytest.raises(SnapshotError, match=named):
            env.set_state(state)
    assert env.get_state() == good


PENDING = {
    "reach": [{"start": (0.1, 0.2)}, {"target": (0.05, 0.28), "obstacle": None}],
    "grasp": [{"object": (0.0, 0.2), "diameter": 0.03}, {"start": (-0.8, 0.5)}],
}


def to_the_next_episodes(env: Any, first: Any) -> list[Any]:
    """What follows over two automatic resets, after a first reset or step."""
    still = np.zeros(env.action_space.shape, np.float32)
    return [first(), *(env.step(still) for _ in range(7))]


@each_task
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_what_was_asked_of_the_cases_to_come_survives(task, mode):
    kind = BATCHES[task]
    env, other = (kind(2, autoreset_mode=mode, max_episode_steps=3) for _ in range(2))
    env.reset(seed=0, options={"scenario": PENDING[task]})
    still = np.zeros(env.action_space.shape, np.float32)
    for _ in range(3):
        env.step(still)
    other.set_state(env.get_state())
    copies = [other, pickle.loads(pickle.dumps(env)), deepcopy(env)]  # noqa: S301
    expected = to_the_next_episodes(env, lambda: env.step(still))
    for scenario, asked in zip(env.call("scenario"), PENDING[task], strict=True):
        assert all(scenario[name] == pytest.approx(value) for name, value in asked.items())
    for copy in copies:
        assert_same(to_the_next_episodes(copy, lambda copy=copy: copy.step(still)), expected)
        assert copy.call("scenario") == env.call("scenario")


@each_task
def test_what_was_asked_of_a_vec_env_survives(task):
    env, other = (BabbleVecEnv(f"Babble{task.title()}-v0", 2) for _ in range(2))
    env.seed(0)
    env.set_options(PENDING[task])
    waiting = deepcopy(env)
    assert_same(env.reset(), waiting.reset())
    other.reset()
    other.envs.set_state(env.envs.get_state())
    # Without options a reset asks for what was asked before, which the states hold.
    assert_same(env.reset(), other.reset())
    assert env.get_attr("scenario") == other.get_attr("scenario")


@each_task
def test_options_of_one_environment_leave_those_of_the_others(task):
    envs = BATCHES[task](2)
    first, second = PENDING[task]
    envs.reset(seed=0, options={"scenario": PENDING[task]})
    envs.reset(options={"scenario": [None, {}]})
    found = envs.call("scenario")
    assert all(found[0][name] == pytest.approx(value) for name, value in first.items())
    assert any(found[1][name] != second[name] for name in second)
