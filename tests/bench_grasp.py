"""Benchmarks of the grasping environments from Python: `make microbench`, or

pytest -o python_files='bench_*.py' --benchmark-only

Every observation but `retina`'s image bears the fovea's 441 edges, so every step and reset has an
image of the eye in it.
"""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from grasping import at, posture, to_object

from gym_babble.envs import BabbleGraspEnv

ENV_ID = "BabbleGrasp-v0"
CASE = {"start": (-0.7, 0.9), "object": (0.0, 0.2), "diameter": 0.06}
# The goal form goes on when the object is held.
HELD = {"obs": "goal", "reward": "sparse", "control": "posture", "max_episode_steps": 1_000_000}


def holding(env):
    """The action that holds the object of `CASE`."""
    return posture(
        env, at(env, CASE["object"], CASE["diameter"]), env.unwrapped.interface.quantities["reflex"]
    )


def test_step_through_make_with_the_arm_free(benchmark):
    """One control step, resets amortised."""
    env = gymnasium.make(ENV_ID)
    env.reset(seed=0)
    action = np.array([0.1, -0.1, 0.1, -0.1], np.float32)

    def step():
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()

    benchmark(step)


def test_step_with_the_object_held(benchmark):
    """One control step with all contacts of a grasp."""
    env = BabbleGraspEnv(**HELD)
    _, info = env.reset(seed=0, options=CASE)
    while not info["held"]:
        info = env.step(to_object(env, info))[4]
    benchmark(env.step, holding(env))


@pytest.mark.parametrize("state", ["free", "held"])
def test_step_of_a_batch_of_64(benchmark, state):
    """One control step of 64 environments, autoresets included; `per_env_us` is of one."""
    if state == "free":
        envs = gymnasium.make_vec(ENV_ID, num_envs=64, threads=1)
        envs.reset(seed=0)
        envs.action_space.seed(0)
        action = envs.action_space.sample()
    else:
        envs = gymnasium.make_vec(ENV_ID, num_envs=64, threads=1, **HELD)
        single = BabbleGraspEnv(**HELD)
        _, info = single.reset(seed=0, options=CASE)
        envs.reset(seed=0, options=CASE)
        while not info["held"]:
            action = to_object(single, info)
            info = single.step(action)[4]
            infos = envs.step(np.stack([action] * 64))[4]
        assert infos["held"].all()
        action = np.stack([holding(single)] * 64)
    benchmark(envs.step, action)
    benchmark.extra_info["per_env_us"] = 1e6 * benchmark.stats["mean"] / 64


def test_step_with_a_retina_of_84_pixels(benchmark):
    env = BabbleGraspEnv(obs="retina", max_episode_steps=1_000_000)
    env.reset(seed=0, options=CASE)
    benchmark(env.step, np.zeros(4, np.float32))


def test_the_foveas_edges(benchmark):
    """The picture of what an observation has of the eye's image."""
    env = BabbleGraspEnv(render_mode="rgb_array", camera="edges", width=63, height=63)
    env.reset(seed=0, options=CASE)
    benchmark(env.render)


def test_reset_with_a_given_case(benchmark):
    """The eye turns to the object from its rest, by its reflex."""
    env = gymnasium.make(ENV_ID)
    env.reset(seed=0, options=CASE)
    benchmark(lambda: env.reset(options=CASE))


def test_reset_with_a_drawn_case(benchmark):
    env = gymnasium.make(ENV_ID)
    env.reset(seed=0)
    benchmark(env.reset)
