"""Save an episode in the middle and go on from there twice; save an agent and let it learn on.

You learn that a state is bytes, that the same actions from it give the same bits, and that an agent
from a file learns on as if it had never been saved.
"""

import tempfile
from pathlib import Path

import gymnasium as gym
import numpy as np

from gym_babble import HebbBabbling

env = gym.make("BabbleGrasp-v0")
env.action_space.seed(0)
env.reset(seed=0)
for _ in range(20):
    env.step(env.action_space.sample())
state = env.unwrapped.get_state()
print(f"a state of {len(state)} bytes")


def play(shoulder: float) -> str:
    """Goes on for 20 steps from the state, and returns a hash of where it ended."""
    env.unwrapped.set_state(state)
    for _ in range(20):
        env.step(np.array([shoulder, 0, 0, 0], np.float32))
    return env.unwrapped.state_hash()


assert play(0.5) == play(0.5)  # The same actions: the same bits.
assert play(0.5) != play(-0.5)  # What if it had turned the other way?

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "hebb.safetensors"
    HebbBabbling("BabbleReachPattern-v0", seed=0).learn(100).save(path)
    restored = HebbBabbling.load(path).learn(100)
whole = HebbBabbling("BabbleReachPattern-v0", seed=0).learn(200)
same = np.array_equal(restored.weights["weights"], whole.weights["weights"])
print(f"100 movements, saved, 100 more: the weights of 200 movements: {same}")
