"""The film of the README: two agents that babbled and learnt by a Hebb rule, side by side.

Left, the conjunctive variant reaches around an obstacle; right, the paper's agent grasps a ball.
Each film is a success, chosen from the first test cases for how much it shows.

python examples/film.py --out docs/images/babble.gif    # about half a minute
"""

import argparse
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from gym_babble import HebbBabbling, scenarios
from gym_babble.agents.loading import acting_agent
from gym_babble.files import check_file, write_file
from gym_babble.viz.film import Film, record

SIZE = 560
MIDDLE = slice(60, 440), slice(70, 490)
"""What is shown of a picture of this size: rows and columns [pixel]."""
EVERY = 4
"""Every fourth control step is shown, for 100 ms: twice as fast as simulated time."""
LAST = 10
"""Pictures at the end of the longer film that stand still."""


def shows(case: dict[str, Any]) -> tuple[float, ...]:
    """How much a case shows: a long way in the picture's middle, or a big object far to turn."""
    if "target" in case:
        start, target = np.array(case["start"]), np.array(case["target"])
        middle = 0.5 * (start + target)
        return (float(np.linalg.norm(target - start) - np.linalg.norm(middle - (0.0, 0.3))),)
    x, y = case["object"]
    return case["diameter"], float(np.arctan2(y, x) - case["start"][0])


def film(agent: HebbBabbling, cases: list[Any]) -> Film:
    """The success that shows most."""
    loaded = acting_agent(agent)
    for case in sorted(cases, key=shows, reverse=True):
        one = record(loaded, options={"scenario": case}, size=SIZE)
        if one.outcome == "success":
            print(f"case {case['index']} of {case['protocol']}")
            return one
    raise SystemExit(
        f"none of {len(cases)} cases of {cases[0]['protocol']} was a success: learn more"
    )


def side_by_side(films: list[Film]) -> list[Image.Image]:
    """Pictures of films beside each other; one that has ended stands still."""
    frames = [one.frames[::EVERY] for one in films]
    pictures = []
    for k in range(max(map(len, frames)) + LAST):
        left, right = (these[min(k, len(these) - 1)][MIDDLE] for these in frames)
        bar = np.full((len(left), 6, 3), 255, np.uint8)
        pictures.append(Image.fromarray(np.hstack([left, bar, right])))
    palette = pictures[len(pictures) // 2].quantize(96)
    return [one.quantize(palette=palette, dither=Image.Dither.NONE) for one in pictures]


def main() -> None:
    """Babbles, learns and films."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("babble.gif"), help="file for the film")
    parser.add_argument("--movements", type=int, default=20_000, help="legal movements to learn")
    parser.add_argument("--babbles", type=int, default=1_000, help="babbles of grasping to learn")
    parser.add_argument("--cases", type=int, default=20, help="test cases to choose from")
    arguments = parser.parse_args()
    check_file(arguments.out, "--out")
    reaching = HebbBabbling("BabbleReachPattern-v0", "conjunctive", seed=0)
    reaching.learn(arguments.movements, progress_bar=True)
    grasping = HebbBabbling("BabbleGrasp-v0", seed=0)
    grasping.learn(arguments.babbles, progress_bar=True)
    films = [
        film(reaching, scenarios("table1", arguments.cases)),
        film(grasping, scenarios("palm_side", arguments.cases)),
    ]
    first, *rest = side_by_side(films)
    gif = BytesIO()
    first.save(gif, "GIF", save_all=True, append_images=rest, duration=100, loop=0)
    write_file(arguments.out, gif.getvalue())
    print(f"{arguments.out}: {len(gif.getvalue()) / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
