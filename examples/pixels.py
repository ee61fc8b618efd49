"""PPO from the pixels of the eye: reach around an obstacle that is only seen in the image.

You learn `obs="retina"`, and to choose which senses a network of stable-baselines3 gets: here the
image of the eye, which looks at the target, and the eye's own posture. An episode is one movement.
"""

import argparse

import gymnasium as gym
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.torch_layers import CombinedExtractor

from gym_babble import evaluate, scenarios
from gym_babble.sb3 import BabbleVecEnv, ProgressBar

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--movements", type=int, default=8_192, help="movements to learn from")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
arguments = parser.parse_args()


class ImageAndEye(CombinedExtractor):
    """A convolutional network for the image, beside pan and tilt of the eye."""

    def __init__(self, space: gym.spaces.Dict) -> None:
        super().__init__(gym.spaces.Dict({name: space[name] for name in ("retina", "eye")}))


torch.set_num_threads(1)
env = BabbleVecEnv("BabbleReachPattern-v0", 128, obs="retina", retina_size=36)
model = PPO(
    "MultiInputPolicy",
    env,
    n_steps=8,
    batch_size=256,
    learning_rate=1e-3,
    gamma=0.0,  # An episode is one step.
    gae_lambda=1.0,
    policy_kwargs={"features_extractor_class": ImageAndEye, "log_std_init": -1.0},
    seed=0,
    device="cpu",
)
model.learn(arguments.movements, callback=ProgressBar())
result = evaluate(model, cases=scenarios("table1", arguments.cases))
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
