"""The film of the README: two agents that babbled and learnt by a Hebb rule, side by side.

Left, the conjunctive variant reaches around an obstacle; right, the paper's agent grasps a ball.
Each episode is a success, chosen from the first test cases for how much it shows. Agents of one
task on one case need no program: `gym-babble record`.

python docs/experiments/film_babble.py --out docs/images/babble.gif    # about half a minute
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from gym_babble import HebbBabbling, scenarios
from gym_babble.agents.loading import acting_agent
from gym_babble.files import check_file, write_file
from gym_babble.viz.episode import Episode, play
from gym_babble.viz.film import Film, Scene
from gym_babble.viz.panel import Panel
from gym_babble.viz.video import check_film, film_bytes


def shows(case: dict[str, Any]) -> tuple[float, ...]:
    """How much a case shows: a long way in the picture's middle, or a big object far to turn."""
    if "target" in case:
        start, target = np.array(case["start"]), np.array(case["target"])
        middle = 0.5 * (start + target)
        return (float(np.linalg.norm(target - start) - np.linalg.norm(middle - (0.0, 0.3))),)
    x, y = case["object"]
    return case["diameter"], float(np.arctan2(y, x) - case["start"][0])


def success(agent: HebbBabbling, cases: list[Any]) -> Episode:
    """The success that shows most."""
    loaded = acting_agent(agent)
    for case in sorted(cases, key=shows, reverse=True):
        episode = play(loaded, case)
        if episode.outcome == "success":
            print(f"case {case['index']} of {case['protocol']}")
            return episode
    raise SystemExit(
        f"none of {len(cases)} cases of {cases[0]['protocol']} was a success: learn more"
    )


def main() -> None:
    """Babbles, learns and films."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("babble.gif"), help="file for the film")
    parser.add_argument("--movements", type=int, default=20_000, help="legal movements to learn")
    parser.add_argument("--babbles", type=int, default=1_000, help="babbles of grasping to learn")
    parser.add_argument("--cases", type=int, default=20, help="test cases to choose from")
    arguments = parser.parse_args()
    check_file(arguments.out, "--out")
    check_film(arguments.out)
    reaching = HebbBabbling("BabbleReachPattern-v0", "conjunctive", seed=0)
    reaching.learn(arguments.movements, progress_bar=True)
    grasping = HebbBabbling("BabbleGrasp-v0", seed=0)
    grasping.learn(arguments.babbles, progress_bar=True)
    reached = success(reaching, scenarios("table1", arguments.cases))
    grasped = success(grasping, scenarios("palm_side", arguments.cases))
    panels = (
        Panel("Reaching", f"after {reaching.learnt:,} legal movements", reached),
        Panel("Grasping", f"after {grasping.learnt:,} babbles", grasped),
    )
    film = Film([Scene(panels)], width=360, fps=10, speed=2.0)
    write_file(arguments.out, film_bytes(film, arguments.out.suffix, progress_bar=True))
    print(f"{arguments.out}: {arguments.out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
