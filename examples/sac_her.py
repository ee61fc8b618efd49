"""SAC with hindsight experience replay on the goal form of reaching (stable-baselines3).

The reward says only whether the fingertip is at the target (0) or not (-1). Hindsight pretends that
the place which was reached had been the target: `compute_reward` judges it anew.

python examples/sac_her.py               # 100,000 steps: some 10 minutes on one core
"""

import argparse

import torch
from stable_baselines3 import SAC, HerReplayBuffer

from gym_babble import evaluate, scenarios
from gym_babble.sb3 import BabbleVecEnv, ProgressBar

ENV = "BabbleReachGoal-v0"

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--steps", type=int, default=100_000)
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
arguments = parser.parse_args()

torch.set_num_threads(1)
env = BabbleVecEnv(ENV, 8)
model = SAC(
    "MultiInputPolicy",
    env,
    replay_buffer_class=HerReplayBuffer,
    replay_buffer_kwargs={"n_sampled_goal": 4, "goal_selection_strategy": "future"},
    learning_starts=8 * 240,  # Hindsight draws from episodes that have ended.
    train_freq=1,
    gradient_steps=4,
    batch_size=256,
    gamma=0.98,
    seed=0,
)
model.learn(arguments.steps, callback=ProgressBar())
env.close()

result = evaluate(model, ENV, scenarios("table1", arguments.cases))
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
