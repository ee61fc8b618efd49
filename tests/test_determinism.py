"""The same seed gives the same bits: in any number of threads, in a batch or alone, in any process.

What is played is told by a trace: of each environment after each step the hash of its state, and a
digest of what it showed.
"""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from hashlib import blake2b

import numpy as np
import pytest
from comparing import BATCHES, EACH_CONTROL, TASKS, assert_same
from gymnasium.vector import AsyncVectorEnv, AutoresetMode
from processes import START_METHODS, forking, in_fork, in_process

from gym_babble import HebbBabbling

SEED = 11
# Of reaching a thread takes eight environments at least, whose episodes are longer.
SIZES = {"reach": (24, 60), "grasp": (6, 30)}
each_task = pytest.mark.parametrize("task", TASKS)
each_control = pytest.mark.parametrize(("task", "control"), EACH_CONTROL)
each_start_method = pytest.mark.parametrize("start_method", START_METHODS)


def choices(task, control="delta_posture"):
    """Short episodes, so that many begin anew; hands that close, so that there are contacts."""
    chosen = {"obs": "flat", "control": control}
    if control != "pattern":
        chosen["max_episode_steps"] = 20
    return chosen | ({"enclosure_reflex": True} if task == "grasp" else {})


def actions_of(task, i):
    """The actions of environment i (steps, k)."""
    width = TASKS[task]().action_space.shape[0]
    random = np.random.default_rng([SEED, i])
    return random.uniform(-1.1, 1.1, (SIZES[task][1], width)).astype(np.float32)


def all_actions(task):
    return np.stack([actions_of(task, i) for i in range(SIZES[task][0])], axis=1)


def digest(*shown):
    return blake2b(b"".join(np.asarray(x).tobytes() for x in shown), digest_size=8).hexdigest()


def single_trace(task, control="delta_posture"):
    """Environments that step alone, one after the other."""
    traces = []
    for i in range(SIZES[task][0]):
        env = TASKS[task](**choices(task, control))
        observation, _ = env.reset(seed=SEED + i)
        trace = [(env.state_hash(), digest(observation))]
        for action in actions_of(task, i):
            observation, reward, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                observation, _ = env.reset()
            shown = digest(observation, reward, terminated, truncated)
            trace.append((env.state_hash(), shown))
        traces.append(trace)
    return list(map(list, zip(*traces, strict=True)))


def vector_trace(envs, actions):
    """Environments that a vector environment of Gymnasium's steps, reset within the step."""
    observation, _ = envs.reset(seed=SEED)
    trace = [[*zip(envs.call("state_hash"), map(digest, observation), strict=True)]]
    for action in actions:
        observation, *end = envs.step(action)[:4]
        shown = map(digest, observation, *end)
        trace.append([*zip(envs.call("state_hash"), shown, strict=True)])
    return trace


def batch_trace(task, threads, control="delta_posture"):
    """Environments of the native batch."""
    made = {"threads": threads, "autoreset_mode": "SameStep", **choices(task, control)}
    return vector_trace(BATCHES[task](SIZES[task][0], **made), all_actions(task))


@pytest.fixture(scope="module")
def expected():
    """What each task's environments play alone."""
    return {task: single_trace(task) for task in TASKS}


@each_control
def test_any_number_of_threads_plays_what_single_environments_play(task, control):
    alone = single_trace(task, control)
    episodes = SIZES[task][0]
    assert len({state for row in alone for state, _ in row}) > episodes
    for threads in (1, 2, 8):
        assert batch_trace(task, threads, control) == alone


@each_task
def test_python_threads_play_the_same_at_once(task, expected):
    with ThreadPoolExecutor(3) as threads:
        played = [
            threads.submit(batch_trace, task, 2),
            threads.submit(single_trace, task),
            threads.submit(batch_trace, task, 1),
        ]
        for trace in played:
            assert trace.result() == expected[task]


@each_start_method
@each_task
def test_other_processes_play_the_same(task, start_method, expected):
    # The parent's threads have run, and are not there in a forked child.
    assert batch_trace(task, 2) == expected[task]
    assert in_process(start_method, batch_trace, task, 2) == expected[task]


@each_start_method
@each_task
def test_gymnasiums_processes_play_the_same(task, start_method, expected):
    n = 2
    make = TASKS[task]
    with forking():
        envs = AsyncVectorEnv(
            [lambda: make(**choices(task))] * n,
            context=start_method,
            shared_memory=start_method != "spawn",
            autoreset_mode=AutoresetMode.SAME_STEP,
        )
    try:
        trace = vector_trace(envs, all_actions(task)[:, :n])
    finally:
        envs.close(timeout=10)
    assert trace == [row[:n] for row in expected[task]]


@pytest.mark.parametrize(
    ("task", "start_method"),
    [
        *((task, "fork") for task in TASKS),
        ("reach", "forkserver"),
        ("grasp", "spawn"),
        # Each child loads PyTorch.
        pytest.param("grasp", "forkserver", marks=pytest.mark.slow),
        pytest.param("reach", "spawn", marks=pytest.mark.slow),
    ],
)
def test_stable_baselines3s_processes_play_the_same(task, start_method, expected):
    # Not at the top, for the other children's sake.
    from stable_baselines3.common.vec_env import SubprocVecEnv  # noqa: PLC0415

    n = 2
    make = TASKS[task]
    with forking():
        envs = SubprocVecEnv([lambda: make(**choices(task))] * n, start_method=start_method)
    try:
        envs.seed(SEED)
        shown = map(digest, envs.reset())
        trace = [[*zip(envs.env_method("state_hash"), shown, strict=True)]]
        for action in all_actions(task)[:, :n]:
            observation, rewards, dones, infos = envs.step(action)
            truncated = np.array([info["TimeLimit.truncated"] for info in infos])
            shown = map(digest, observation, rewards, dones & ~truncated, truncated)
            trace.append([*zip(envs.env_method("state_hash"), shown, strict=True)])
    finally:
        envs.close()
    assert trace == [row[:n] for row in expected[task]]


def go_on(envs, actions):
    return [envs.step(action) for action in actions], envs.call("state_hash")


@each_task
def test_a_forked_child_goes_on_as_its_parent_does(task):
    made = {"threads": 2, "autoreset_mode": "SameStep", **choices(task)}
    envs = BATCHES[task](SIZES[task][0], **made)
    envs.reset(seed=SEED)
    actions = all_actions(task)
    go_on(envs, actions[:10])
    theirs = in_process("fork", go_on, envs, actions[10:])
    assert_same(theirs, go_on(envs, actions[10:]))


@each_task
def test_a_fork_in_a_thread_beside_one_that_steps_plays_the_same(task, expected):
    stop, stepping = threading.Event(), threading.Event()
    busy = BATCHES[task](64, threads=2)
    busy.reset(seed=0)
    still = np.zeros(busy.action_space.shape, np.float32)

    def step_on():
        while not stop.is_set():
            busy.step(still)
            stepping.set()

    def fork():
        stepping.wait()
        return [in_fork(lambda: digest_of(batch_trace(task, 2)).encode()) for _ in range(3)]

    other = threading.Thread(target=step_on)
    other.start()
    try:
        with ThreadPoolExecutor(1) as forker:
            played = forker.submit(fork).result(timeout=60)
    finally:
        stop.set()
        other.join()
    assert played == [digest_of(expected[task]).encode()] * 3


def digest_of(trace):
    return blake2b(repr(trace).encode(), digest_size=16).hexdigest()


def learnt(name, threads, parts):
    """The weights of an agent that learns in parts, and how much it babbled."""
    if name == "grasp":
        agent = HebbBabbling("BabbleGrasp-v0", seed=5, threads=threads)
    else:
        agent = HebbBabbling(variant=name, seed=3, threads=threads)
    for part in parts:
        agent.learn(part)
    return agent.weights, agent.babbled, agent.learnt


@pytest.mark.parametrize(
    ("name", "parts"),
    [("paper", (250, 30, 20)), ("conjunctive", (280, 20)), ("grasp", (9, 1, 2))],
)
def test_learning_is_the_same_in_parts_threads_and_processes(name, parts):
    whole = learnt(name, 1, [sum(parts)])
    for threads in (1, 2, 8):
        assert_same(learnt(name, threads, parts), whole)
    with ThreadPoolExecutor(2) as threads:
        for agent in [threads.submit(learnt, name, 2, parts) for _ in range(2)]:
            assert_same(agent.result(), whole)
    assert_same(in_process("fork", learnt, name, 2, parts), whole)


def go_on_learning(agent, n):
    return agent.learn(n).weights


@pytest.mark.parametrize("env", ["BabbleReachPattern-v0", "BabbleGrasp-v0"])
def test_a_forked_child_learns_on_as_its_parent_does(env):
    agent = HebbBabbling(env, threads=2).learn(10)
    theirs = in_process("fork", go_on_learning, agent, 10)
    assert_same(theirs, go_on_learning(agent, 10))
