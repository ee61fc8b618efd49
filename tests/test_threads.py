"""Threads, signals and forks: nobody waits for long, and nothing is half-done in silence."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import gymnasium
import numpy as np
import pytest
from comparing import BATCHES, TASKS, assert_same
from processes import in_fork

from gym_babble import HebbBabbling, Oracle, _core, babble, scenarios
from gym_babble.brain import Association
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv, BabbleReachVectorEnv
from gym_babble.errors import BabbleError, BusyError

BOUND_S = 2.0
"""What an interruption may take on a busy machine; alone it takes less than 0.1 s."""
each_task = pytest.mark.parametrize("task", TASKS)


class AlarmError(Exception):
    """What the handler of the alarm raises."""


@contextmanager
def alarm_after(seconds):
    """An alarm, and the moments at which it was heard."""
    heard = []

    def raise_alarm(*_):
        heard.append(time.perf_counter())
        raise AlarmError

    before = signal.signal(signal.SIGALRM, raise_alarm)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield heard
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def ticking():
    """A Python thread that notes the moments at which it runs.

    No thread has to make way for another meanwhile: it runs where one lets go of Python's lock by
    itself.
    """
    moments, stop, begun = [], threading.Event(), threading.Event()

    def tick():
        while not stop.is_set():
            moments.append(time.perf_counter())
            begun.set()
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    with switching_every(1_000):
        thread.start()
        begun.wait()
        try:
            yield moments
        finally:
            stop.set()
            thread.join()


@contextmanager
def switching_every(seconds):
    """How long a Python thread runs until it makes way for another that waits."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(seconds)
    try:
        yield
    finally:
        sys.setswitchinterval(before)


def reach_batch(n=2_000):
    """A batch whose steps are whole movements: a tenth of a millisecond each."""
    envs = BabbleReachVectorEnv(n, control="pattern", threads=1)
    envs.reset(seed=0)
    return envs


def still(envs):
    return np.zeros(envs.action_space.shape, np.float32)


def hebb(env, **arguments):
    """An agent of a task; a movement or 50 babbles are learnt together."""
    return HebbBabbling(ENVS[env], **arguments)


ENVS = {"reach": "BabbleReachPattern-v0", "grasp": "BabbleGrasp-v0"}


def learning(task, n, **arguments):
    agent = hebb(task, threads=2, **arguments)
    return lambda: agent.learn(n)


def slow_rule(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's arguments
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


def foreseeing(n):
    senses = np.repeat(reach_batch(1)._batch.all()["senses"], n, axis=0)
    return lambda: Oracle().decide(senses)


def core_learner(env, threads):
    task = env.interface.task
    brain = _core.brain_json(env.interface.entry.name, "paper")
    return _core.Learner(task, brain, 0, "null", False, threads)


# Each would take 10 s and more.
FOREVER = {
    "make": lambda: lambda: _core.Batch(BabbleGraspEnv().interface.task, 200_000),
    "learn": lambda: learning("reach", 100_000),
    "learn by a rule of one's own": lambda: learning("reach", 100_000, rule=slow_rule),
    "core learn": lambda: (
        lambda: core_learner(BabbleReachEnv(), threads=1).learn(
            BabbleReachEnv().interface.task, 100_000
        )
    ),
    "learn to grasp": lambda: learning("grasp", 2_000),
    "core learn to grasp": lambda: (
        lambda: core_learner(BabbleGraspEnv(), threads=2).learn(
            BabbleGraspEnv().interface.task, 2_000
        )
    ),
    "babble": lambda: lambda: babble("BabbleReach-v0", 1_000_000, threads=2),
    "table1": lambda: lambda: scenarios("table1", 100_000),
    "oracle": lambda: foreseeing(20_000),
    "hold": lambda: lambda: _core.hold(BabbleGraspEnv().interface.task, 0.05, 2_000, 2),
}


@pytest.mark.parametrize("name", FOREVER)
def test_long_calls_end_at_a_signal_and_let_other_threads_run(name, capsys):
    call = FOREVER[name]()
    with ticking() as moments, alarm_after(0.15) as heard:
        began = time.perf_counter()
        with pytest.raises(AlarmError):
            call()
        ended = time.perf_counter()
    with capsys.disabled():
        print(f"\n{name}: heard after {1e3 * (heard[0] - began - 0.15):.0f} ms,", end=" ")
        print(f"ended {1e3 * (ended - heard[0]):.0f} ms later", end=" ")
    assert ended - began - 0.15 < BOUND_S
    # With the interpreter's lock held none lies within the call.
    within = [moment for moment in moments if began + 0.002 < moment < ended - 0.002]
    assert len(within) >= 3


@pytest.mark.parametrize(
    ("task", "control", "lets"),
    [
        ("grasp", "delta_posture", True),
        ("reach", "pattern", True),
        # A microsecond: to let go of the lock and wait for it would take as long.
        ("reach", "delta_posture", False),
    ],
)
def test_other_threads_run_while_one_environment_steps(task, control, lets):
    env = TASKS[task](control=control, reward="sparse")
    env.reset(seed=0)
    state, action = env.get_state(), np.zeros(env.action_space.shape, np.float32)
    with ticking() as moments:
        ticks, deadline = len(moments), time.monotonic() + (10 if lets else 0.2)
        while len(moments) < ticks + 3 and time.monotonic() < deadline:
            env._batch.load(0, state)
            env._batch.step_one(action)
        ticked = len(moments) - ticks
    assert (ticked >= 3) if lets else (ticked == 0)


@pytest.mark.parametrize("camera", ["third_person", "eye"])
@each_task
def test_other_threads_run_while_a_big_picture_is_drawn(task, camera):
    env = TASKS[task](render_mode="rgb_array", camera=camera, width=4096, height=4096)
    env.reset(seed=0)
    with ticking() as moments:
        began = time.perf_counter()
        env.render()
        ended = time.perf_counter()
    within = [moment for moment in moments if began + 0.002 < moment < ended - 0.002]
    assert len(within) >= 3


def times(envs):
    """Steps that each environment has made since its reset, as shares of its time."""
    clock = dict(envs.interface.spec.slices)["time"]
    return envs._batch.all()["senses"][:, clock.start]


@pytest.mark.parametrize(
    ("task", "n", "choices"),
    [
        ("reach", 2_000, {"control": "pattern", "threads": 1}),
        ("reach", 4_000, {"control": "pattern", "threads": 2}),
        ("grasp", 4_096, {"threads": 1}),
    ],
)
def test_after_an_interrupted_step_all_need_a_reset(task, n, choices, capsys):
    envs = BATCHES[task](n, **choices)
    envs.reset(seed=0)
    before, actions = envs.call("state_hash"), still(envs)
    with alarm_after(0.02) as heard:
        began = time.perf_counter()
        with pytest.raises(AlarmError):
            envs.step(actions)
        ended = time.perf_counter()
    stepped = np.count_nonzero(times(envs))
    with capsys.disabled():
        print(f"\n{n} of {task}: heard after {1e3 * (heard[0] - began - 0.02):.0f} ms,", end=" ")
        print(f"ended {1e3 * (ended - heard[0]):.0f} ms later, {stepped} stepped", end=" ")
    # Had it been heard after the last one only, all would have stepped, and could go on.
    assert 0 < stepped < n
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step(actions)
    envs.reset(seed=0)
    assert envs.call("state_hash") == before
    envs.step(actions)


def test_after_an_interrupted_reset_those_that_it_chose_need_another():
    envs = reach_batch()
    mask = np.ones(envs.num_envs, np.bool_)
    mask[5] = False
    kept = envs.call("state_hash")[5]
    with alarm_after(0.02), pytest.raises(AlarmError):
        envs.reset(options={"reset_mask": mask})
    assert envs.call("state_hash")[5] == kept
    with pytest.raises(gymnasium.error.ResetNeeded, match="environment 0"):
        envs.step(still(envs))


# An arm so thick that no movement is legal, and movements that take long to try: their number of
# steps is odd, so a few postures cannot tell.
HOPELESS = {
    "body": {"arm": {"half_width_m": 0.05}, "obstacle": {"radius_m": 0.05}},
    "reach": {"control_period_s": 0.001, "movement_s": 59.999},
}


@pytest.mark.parametrize("n", [0, 1, 3], ids=["single", "batch of one", "batch"])
def test_a_reset_that_searches_long_is_interrupted(n, capsys):
    env = BabbleReachVectorEnv(n, config=HOPELESS) if n else BabbleReachEnv(config=HOPELESS)
    with alarm_after(0.1) as heard:
        with pytest.raises(AlarmError):
            env.reset(seed=0)
        ended = time.perf_counter()
    with capsys.disabled():
        print(f"\nreset ended {1e3 * (ended - heard[0]):.0f} ms after the alarm was heard", end=" ")
    assert ended - heard[0] < BOUND_S
    # Afterwards it can be used as before.
    case = {"start": (0.1, 0.2), "target": (0.2, 0.25), "obstacle": None}
    env.reset(options=case)
    env.step(np.zeros(env.action_space.shape, np.float32))


@pytest.mark.parametrize("rule", ["covariance", slow_rule])
@each_task
def test_interrupted_learning_is_as_after_its_last_whole_chunk(task, rule):
    agent = hebb(task, rule=rule, seed=2, threads=2)
    chunk = 50 if task == "grasp" else 250

    def arm(_):
        if agent.learnt == chunk:
            signal.setitimer(signal.ITIMER_REAL, 0.1)

    with alarm_after(60), pytest.raises(AlarmError):
        agent.learn(100_000, callback=arm)
    assert agent.learnt >= chunk
    assert agent.learnt % chunk == 0
    other = hebb(task, rule=rule, seed=2, threads=1).learn(agent.learnt)
    assert_same(agent.weights, other.weights)
    assert agent.babbled == other.babbled
    assert_same(agent.learn(5).weights, other.learn(5).weights)


def test_a_handler_that_does_not_raise_changes_nothing():
    calm, disturbed = reach_batch(4_000), reach_batch(4_000)
    heard = []
    before = signal.signal(signal.SIGALRM, lambda *_: heard.append(disturbed.threads))
    signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
    try:
        seen = disturbed.step(still(disturbed))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert len(heard) >= 2
    assert_same(seen, calm.step(still(calm)))


def test_a_handler_cannot_change_what_it_interrupts():
    envs, told = reach_batch(), []

    def step_again(*_):
        for call in (lambda: envs.step(still(envs)), envs.reset, envs.get_state):
            with pytest.raises(BusyError) as error:
                call()
            told.append(str(error.value))

    before = signal.signal(signal.SIGALRM, step_again)
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    try:
        envs.step(still(envs))
    finally:
        signal.signal(signal.SIGALRM, before)
    assert len(told) == 3
    assert all("signal" in text for text in told)
    assert np.count_nonzero(times(envs)) == envs.num_envs


INTERRUPTED = """
import signal, time
import numpy as np
from gym_babble import HebbBabbling, Oracle, evaluate, scenarios
from gym_babble.study.run import execute, runs_of
from gym_babble.study.short import comparison
from gym_babble.envs import BabbleGraspVectorEnv, BabbleReachVectorEnv

# A shell's background jobs are born deaf to it.
signal.signal(signal.SIGINT, signal.default_int_handler)

def stepping(envs):
    envs.reset(seed=0)
    actions = np.zeros(envs.action_space.shape, np.float32)
    def step_on():
        while True:
            envs.step(actions)
    return step_on

cases = scenarios("table1", 250) * 40
for name, call in {
    "4,096 of reaching": stepping(BabbleReachVectorEnv(4096)),
    "4,096 of grasping": stepping(BabbleGraspVectorEnv(4096)),
    "HebbBabbling.learn": lambda: HebbBabbling().learn(10**6),
    "HebbBabbling.learn to grasp": lambda: HebbBabbling("BabbleGrasp-v0").learn(10**5),
    "evaluate": lambda: evaluate(Oracle(), cases=cases),
    "a run": lambda: execute(runs_of(comparison("reach", ["hebb-conjunctive"], budget=10**9))[0]),
}.items():
    print(name, flush=True)
    try:
        call()
    except KeyboardInterrupt:
        print(time.monotonic(), flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="its Ctrl-C is no signal to one process")
def test_ctrl_c_is_heard_at_once(capsys):
    command = [sys.executable, "-c", INTERRUPTED]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        # What is never interrupted must not keep the tests.
        watch = threading.Timer(120, child.kill)
        watch.start()
        assert child.stdout is not None
        for name in child.stdout:
            time.sleep(0.4)
            sent = time.monotonic()
            child.send_signal(signal.SIGINT)
            delay = float(child.stdout.readline()) - sent
            with capsys.disabled():
                print(f"\n{name.strip()}: {1e3 * delay:.0f} ms", end=" ")
            assert delay < BOUND_S
        watch.cancel()
    assert child.returncode == 0


def hammer(call, enough, threads=2):
    """What a call gives in several threads at once until there was enough, and its errors."""
    given, busy = [], []
    start, deadline = threading.Barrier(threads), time.monotonic() + 30

    def strike():
        start.wait()
        while not enough(given, busy) and time.monotonic() < deadline:
            try:
                given.append(call())
            except BusyError as error:  # noqa: PERF203 - it is what is counted
                busy.append(error)

    with switching_every(1e-6), ThreadPoolExecutor(threads) as pool:
        for striking in [pool.submit(strike) for _ in range(threads)]:
            striking.result(timeout=60)
    assert enough(given, busy), (len(given), len(busy))
    return given, busy


@pytest.mark.parametrize("obs", ["goal", "retina"])
@each_task
def test_two_threads_on_one_environment_get_an_error_and_no_step_is_lost(task, obs):
    form = {"obs": obs, "retina_size": 36}
    if obs == "goal":
        # Without an end until the time limit.
        form["reward"] = "sparse"
    limit = 100_000
    batch = BATCHES[task](4, threads=2, max_episode_steps=limit, **form)
    single = TASKS[task](max_episode_steps=limit, **form)
    for env, at in ((single, ...), (batch, 0)):
        env.reset(seed=0)
        zeros = np.zeros(env.action_space.shape, np.float32)

        clock = dict(env.interface.spec.slices)["time"]

        def step(env=env, zeros=zeros, at=at, clock=clock):
            observation = env.step(zeros)[0]
            time_sense = (
                observation["observation"][..., clock] if obs == "goal" else observation["time"]
            )
            return round(float(time_sense[at][..., 0]) * limit)

        steps, busy = hammer(step, lambda given, busy: len(given) >= 50 and len(busy) >= 5)
        # Each step was seen once, by the thread that made it.
        assert sorted(steps) == list(range(1, len(steps) + 1))
        assert isinstance(busy[0], BabbleError)
        assert isinstance(busy[0], RuntimeError)
        assert "another thread" in str(busy[0])


@each_task
def test_two_threads_on_one_agent_get_an_error_and_nothing_is_learnt_twice(task):
    agent = hebb(task, seed=4, threads=1)
    calls, busy = hammer(lambda: agent.learn(3), lambda _, busy: len(busy) >= 5)
    other = hebb(task, seed=4, threads=1)
    for _ in calls:
        other.learn(3)
    assert_same(agent.weights, other.weights)
    assert "this agent is in use" in str(busy[0])


def test_a_learning_agent_is_its_learners_alone():
    # Also between two chunks, when its callback may look at it.
    agent, told = HebbBabbling(quasi_static=True), []

    def ask():
        for look in (lambda: agent.babbled, lambda: agent.weights, lambda: agent.learn(1)):
            with pytest.raises(BusyError):
                look()
            told.append(look)

    def callback(learner):
        assert learner.learnt == 250
        other = threading.Thread(target=ask)
        other.start()
        other.join()

    agent.learn(250, callback=callback)
    assert len(told) == 3
    assert agent.learn(1).learnt == 251


def test_threads_that_only_look_do_not_hinder_each_other():
    agent = HebbBabbling(quasi_static=True).learn(20)
    envs = reach_batch(64)
    senses = envs._batch.all()["senses"]
    wanted = agent.decide(senses)
    with switching_every(1e-6), ThreadPoolExecutor(4) as threads:
        decided = [threads.submit(agent.decide, senses) for _ in range(50)]
        hashes = [threads.submit(envs.call, "state_hash") for _ in range(20)]
        assert all((decision.result() == wanted).all() for decision in decided)
        assert len({tuple(found.result()) for found in hashes}) == 1


def test_another_thread_than_the_main_one_learns_and_hears_no_signal():
    agent = HebbBabbling(quasi_static=True)
    with ThreadPoolExecutor(1) as threads, alarm_after(0.05) as heard:
        learning = threads.submit(agent.learn, 500)
        with pytest.raises(AlarmError):
            time.sleep(5)
        assert learning.result().learnt == 500
    assert heard


def test_an_environment_that_was_stepped_at_a_fork_is_refused_in_the_child():
    envs = reach_batch(4_000)

    def refuse():
        for call in (lambda: envs.step(still(envs)), envs.reset, envs.get_state):
            with pytest.raises(BusyError, match="when this process was forked"):
                call()
        return b"refused"

    with ThreadPoolExecutor(1) as threads:
        stepping = threads.submit(envs.step, still(envs))
        time.sleep(0.02)
        answer = in_fork(refuse)
        assert not stepping.done()
    assert answer == b"refused"


def test_a_forked_child_drops_what_has_threads_in_its_parent():
    # To drop threads wakes them, and they are not there.
    kept = [reach_batch(64) for _ in range(3)]
    batches = [BabbleReachVectorEnv(64, threads=2) for _ in range(3)]
    for envs in batches:
        envs.reset(seed=0)
        envs.step(still(envs))
    agent = HebbBabbling(threads=2).learn(1)

    def drop():
        nonlocal agent
        batches.clear()
        agent = None
        return str(len(kept)).encode()

    assert in_fork(drop) == b"3"


def test_a_forked_child_learns_with_an_association_of_its_parents():
    g, a = np.ones(3_025, np.float32), np.ones(441, np.float32)
    weights = Association(len(g), len(a), threads=2)
    weights.learn(g, a)

    def learn():
        weights.learn(g / 2, a)
        return weights.weights.tobytes()

    theirs = in_fork(learn)
    weights.learn(g / 2, a)
    assert theirs == weights.weights.tobytes()
