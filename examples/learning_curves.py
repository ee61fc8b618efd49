"""Learning curves of Hebb babbling and PPO on reaching: the picture of the README.

python examples/learning_curves.py --out docs/images/learning.png    # about two minutes
"""

import argparse
from pathlib import Path

from gym_babble.files import check_file
from gym_babble.study.compare import compare
from gym_babble.study.contenders import Settings
from gym_babble.viz import style
from gym_babble.viz.curves import learning_curves

AGENTS = ("hebb-paper", "hebb-conjunctive", "ppo-pattern", "ppo-posture")

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--out", type=Path, default=Path("learning.png"), help="file for the picture")
parser.add_argument("--agents", nargs="+", default=AGENTS, help="as in gym-babble compare")
parser.add_argument("--movements", type=int, default=20_000, help="legal movements of a Hebb agent")
parser.add_argument("--cases", type=int, default=1_000, help="test cases")
arguments = parser.parse_args()
check_file(arguments.out, "--out")
style.check_format(arguments.out)

settings = Settings(movements=arguments.movements, cases=arguments.cases, progress_bar=True)
comparison = compare(arguments.agents, settings)
for result in comparison.results:
    first, (test,) = result.trained[0].curve[0], result.tests
    print(
        f"{result.contender.title}, {result.contender.detail}: {first.success:.3f} after "
        f"{first.control_steps:,} control steps, {test.rate('success'):.3f} on the tests"
    )
style.save(learning_curves(comparison), arguments.out)
