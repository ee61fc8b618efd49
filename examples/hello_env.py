"""The first environment: what it senses, what an action is, and an episode of random actions.

You learn Gymnasium's loop of reset and step, how an episode ends, and what `info` says about it.
"""

import gymnasium as gym

import gym_babble  # noqa: F401 - registers the environments

env = gym.make("BabbleReach-v0")
for name, space in env.observation_space.items():
    print(f"sense {name}: {space.shape[0]} numbers in [{space.low.min():g}, {space.high.max():g}]")
print(f"action: {env.action_space.shape[0]} changes of the muscles' equilibrium points, in [-1, 1]")

env.action_space.seed(0)
observation, info = env.reset(seed=0)
total, steps, ended = 0.0, 0, False
while not ended:
    action = env.action_space.sample()  # An agent looks at the observation here.
    observation, reward, terminated, truncated, info = env.step(action)
    total, steps, ended = total + float(reward), steps + 1, terminated or truncated
outcome = next(name for name, so in info["outcome"].items() if so)
print(f"{outcome} after {steps} steps of 50 ms, return {total:.3f}")
