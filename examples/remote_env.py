"""An environment on a server, played from Python as if it were here: with the same bits.

You learn to connect to a server, which may be on another machine, single and with a batch. Start
one first: `gym-babble serve`. `openenv_client.py` and `server_client.mjs` do without this package.
"""

import argparse

import gymnasium as gym
import numpy as np

from gym_babble import Scripted
from gym_babble.remote import DEFAULT_URL, RemoteEnv, RemoteVectorEnv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--url", default=DEFAULT_URL)
parser.add_argument("--seed", type=int, default=0)
arguments = parser.parse_args()

there = RemoteEnv("BabbleReach-v0", url=arguments.url)
here = gym.make("BabbleReach-v0")
here.reset(seed=arguments.seed)
there.reset(seed=arguments.seed)
there.action_space.seed(arguments.seed)
steps, ended = 0, False
while not ended:
    action = there.action_space.sample()
    senses, reward, terminated, truncated, info = there.step(action)
    expected, same_reward, *_ = here.step(action)
    assert all(np.array_equal(senses[name], expected[name]) for name in expected)
    assert reward == same_reward
    steps, ended = steps + 1, terminated or truncated
there.close()
outcome = next(name for name, so in info["outcome"].items() if so)
print(f"{outcome} after {steps} steps, the same bits as here")

envs = RemoteVectorEnv("BabbleGrasp-v0", 16, url=arguments.url)  # A step is one request.
agent, state, held = Scripted("BabbleGrasp-v0"), None, np.zeros(16, bool)
observations, _ = envs.reset(seed=arguments.seed)
starts = np.ones(16, bool)
for _ in range(240):
    actions, state = agent.predict(observations, state, starts)
    observations, _, terminated, truncated, infos = envs.step(actions)
    starts = terminated | truncated
    held |= infos["held"]
envs.close()
print(f"a scripted agent held {held.sum()} of 16 balls there")
