"""PPO of stable-baselines3 with the package's tuned settings: train, test on Table I, keep it.

You learn to train by one call, and to test the model on the cases that all agents are tested on.

python examples/ppo.py                            # whole movements: 25 s with the test
python examples/ppo.py --env-id BabbleReach-v0    # step by step: about a minute
"""

import argparse
from io import BytesIO

from gym_babble import evaluate, scenarios
from gym_babble.files import check_file, write_file
from gym_babble.study.trainers.sb3 import train_tuned

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--env-id", default="BabbleReachPattern-v0", help="environment to learn in")
parser.add_argument("--steps", type=int, help="steps to learn from; the settings' if not given")
parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
parser.add_argument("--save", help="file for the model, which PPO.load reads")
arguments = parser.parse_args()
if arguments.save:
    check_file(arguments.save, "--save")

model = train_tuned("ppo", arguments.env_id, steps=arguments.steps, progress_bar=True)
if arguments.save:
    buffer = BytesIO()
    model.save(buffer)
    write_file(arguments.save, buffer.getvalue())

result = evaluate(model, cases=scenarios("table1", arguments.cases))
low, high = result.interval("success")
print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
