"""SAC with hindsight experience replay on the goal form of reaching (stable-baselines3).

The reward only says whether the fingertip is at the target (0) or not (-1). Hindsight replay
treats the place that was reached as the target, and `compute_reward` computes the new reward.

There is no obstacle by default. An obstacle stands on the straight path to every target; with it
(--obstacle), hindsight learns to reach straight into it and needs far more steps than these. See
docs/baselines.md.

python examples/sac_her.py               # 100,000 steps: about 8 minutes on one core
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
parser.add_argument("--obstacle", action="store_true", help="with the obstacle")
arguments = parser.parse_args()

torch.set_num_threads(1)
env = BabbleVecEnv(ENV, 16)
cases = scenarios("table1", arguments.cases)
if not arguments.obstacle:
    env.set_options({"obstacle": None})
    cases = [{**case, "obstacle": None} for case in cases]
model = SAC(
    "MultiInputPolicy",
    env,
    replay_buffer_class=HerReplayBuffer,
    replay_buffer_kwargs={"n_sampled_goal": 4, "goal_selection_strategy": "future"},
    learning_starts=16 * 240,  # Hindsight draws from episodes that have ended.
    train_freq=1,
    gradient_steps=8,
    learning_rate=1e-3,
    gamma=0.98,
    seed=0,
    device="cpu",
)
model.learn(arguments.steps, callback=ProgressBar())
env.close()

result = evaluate(model, cases=cases)
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
