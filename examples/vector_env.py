"""Many environments at once: a batch that the core steps in one call, on several threads.

You learn `make_vec`, what an autoreset does, and that environment i of a batch reset with seed s is
the single environment reset with seed s + i, bit for bit.
"""

import argparse

import gymnasium as gym
import numpy as np

import gym_babble  # noqa: F401 - registers the environments

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--num-envs", type=int, default=256)
parser.add_argument("--steps", type=int, default=480, help="steps of the batch")
arguments = parser.parse_args()

envs = gym.make_vec("BabbleReach-v0", num_envs=arguments.num_envs)
one = gym.make("BabbleReach-v0")
envs.action_space.seed(0)
observations, infos = envs.reset(seed=100)
alone, _ = one.reset(seed=103)
episodes, collisions, first = 0, 0, True
for _ in range(arguments.steps):
    actions = envs.action_space.sample()
    observations, rewards, terminated, truncated, infos = envs.step(actions)
    ended = terminated | truncated  # The next step resets these, and ignores their action.
    episodes += int(ended.sum())
    collisions += int(infos["outcome"]["collision"][ended].sum())
    if first:
        alone, reward, *ends, _ = one.step(actions[3])
        assert all(np.array_equal(alone[name], observations[name][3]) for name in alone)
        assert reward == rewards[3]
        first = not any(ends)
envs.close()
print(f"{episodes} episodes of random actions ended, {collisions} by a collision")
