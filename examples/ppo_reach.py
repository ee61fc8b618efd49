"""PPO (stable-baselines3) on reaching: train a preset, test it on Table I, keep the model.

python examples/ppo_reach.py                          # whole movements: 25 s with the test
python examples/ppo_reach.py --preset delta_posture   # step by step: about a minute
"""

import argparse
from io import BytesIO

from gym_babble import evaluate, scenarios
from gym_babble.files import check_file, write_file
from gym_babble.study.ppo import train_ppo
from gym_babble.study.presets import PRESETS
from gym_babble.study.tasks import REACH, task_of

presets = [name for name, preset in PRESETS.items() if task_of(preset.env_id) == REACH]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--preset", choices=presets, default="pattern")
parser.add_argument("--steps", type=int, help="steps to learn from; the preset's if not given")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
parser.add_argument("--save", help="file for the model, which PPO.load reads")
arguments = parser.parse_args()
if arguments.save:
    check_file(arguments.save, "--save")

trained = train_ppo(arguments.preset, steps=arguments.steps, progress_bar=True)
for point in trained.curve:
    print(f"{point.steps:8d} steps  {point.seconds:6.1f} s  success {point.success:.3f}")
if arguments.save:
    model = BytesIO()
    trained.agent.save(model)
    write_file(arguments.save, model.getvalue())

cases = scenarios("table1", arguments.cases)
result = evaluate(trained.agent, cases=cases)
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
