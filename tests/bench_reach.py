"""Benchmarks of the reaching environments from Python: `make microbench`, or

pytest -o python_files='bench_*.py' --benchmark-only [-m slow]
"""

from __future__ import annotations

import subprocess
import sys

import gymnasium
import numpy as np
import pytest

from gym_babble import HebbBabbling, scenarios

IDS = ("BabbleReach-v0", "BabbleReachGoal-v0")
IMPORT = "import {}; from time import perf_counter as t; s = t(); import {}; print(t() - s)"


def test_import_beyond_gymnasiums_own(benchmark):
    """The row is a whole interpreter; `seconds` is the import after gymnasium's."""
    program = IMPORT.format("gymnasium", "gym_babble")
    command = [sys.executable, "-c", program]

    def seconds():
        return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    benchmark.extra_info["seconds"] = min(seconds() for _ in range(3))
    benchmark.pedantic(seconds, rounds=3)
    assert benchmark.extra_info["seconds"] < 0.3


@pytest.mark.parametrize("env_id", IDS)
def test_step_through_make(benchmark, env_id):
    """One control step, resets amortised."""
    env = gymnasium.make(env_id)
    env.reset(seed=0)
    action = np.array([0.1, -0.1], np.float32)

    def step():
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()

    benchmark(step)


@pytest.mark.parametrize("env_id", IDS)
def test_step_of_a_batch_of_64(benchmark, env_id):
    """One control step of 64 environments, autoresets included; `per_env_us` is of one."""
    envs = gymnasium.make_vec(env_id, num_envs=64, threads=1)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    action = envs.action_space.sample()
    benchmark(envs.step, action)
    benchmark.extra_info["per_env_us"] = 1e6 * benchmark.stats["mean"] / 64


def test_reset_with_a_given_case(benchmark):
    env = gymnasium.make(IDS[0])
    options = {"scenario": scenarios("table1", 1)[0]}
    env.reset(seed=0, options=options)
    benchmark(lambda: env.reset(options=options))


def test_reset_with_a_drawn_case(benchmark):
    env = gymnasium.make(IDS[0])
    env.reset(seed=0)
    benchmark(env.reset)


@pytest.mark.slow
@pytest.mark.parametrize("quasi_static", [False, True], ids=["full", "quasi_static"])
@pytest.mark.parametrize("threads", [1, 2])
def test_20_000_legal_movements_babbled_and_learnt(benchmark, quasi_static, threads):
    def learn():
        return HebbBabbling(seed=0, quasi_static=quasi_static, threads=threads).learn(20_000)

    agent = benchmark.pedantic(learn, rounds=1)
    benchmark.extra_info["legal_rate"] = agent.learnt_rate
