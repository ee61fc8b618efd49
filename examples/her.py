"""SAC with hindsight experience replay (HER) on the goal forms of both tasks.

You learn to use a goal environment of stable-baselines3: the reward only says whether the fingertip
is at the target, or the object at its goal (0), or not (-1), and hindsight treats the place that
was reached as the target, for which `compute_reward` computes the new reward.

In reaching there is no obstacle by default: one stands on the straight path to every target, and
with it (--obstacle) hindsight learns to reach into it. See docs/baselines.md.

python examples/her.py                              # 100,000 steps: about 8 minutes on one core
python examples/her.py --env BabbleGraspGoal-v0 --out carry.zip    # then load_agent("carry.zip")
"""

import argparse
import json

import torch
from stable_baselines3 import SAC, HerReplayBuffer

from gym_babble import evaluate, scenarios
from gym_babble.sb3 import BabbleVecEnv, ProgressBar

REACH = "BabbleReachGoal-v0"

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--env", default=REACH, choices=[REACH, "BabbleGraspGoal-v0"])
parser.add_argument("--options", type=json.loads, default={}, help="of the environment, as JSON")
parser.add_argument("--steps", type=int, default=100_000)
parser.add_argument("--seed", type=int, default=0)
parser.add_argument("--cases", type=int, default=1_000, help="cases to be tested on")
parser.add_argument("--obstacle", action="store_true", help="with the obstacle")
parser.add_argument("--out", help="file for the model")
arguments = parser.parse_args()

torch.set_num_threads(1)
env = BabbleVecEnv(arguments.env, 16, **arguments.options)
protocol = "table1" if arguments.env == REACH else "palm_side"
cases = scenarios(protocol, arguments.cases, goal=arguments.env != REACH)
if arguments.env == REACH and not arguments.obstacle:
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
    seed=arguments.seed,
    device="cpu",
)
model.learn(arguments.steps, callback=ProgressBar())
env.close()
if arguments.out:
    model.save(arguments.out)

result = evaluate(model, cases=cases)
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
