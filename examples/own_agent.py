"""An agent of your own, without learning: it curves away from the obstacle that it sees.

You learn that an agent is any object with `predict`, and how to test it. The command line finds it
too: `gym-babble evaluate own_agent:Curves`, from the folder of this file.
"""

import argparse
import json

import numpy as np

from gym_babble import evaluate, scenarios


class Curves:
    """Curves left or right, depending on the side on which it sees the obstacle."""

    env = "BabbleReachPattern-v0"  # Where it acts.

    def predict(self, observation: dict[str, np.ndarray]) -> np.ndarray:
        """Returns (b1, b2), scaled to [−1, 1]."""
        azimuth, _ = observation["obstacle"]
        b1 = 0.5 if azimuth > 0 else -0.5
        return np.array([b1, -b1], np.float32)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1_000, help="cases of Table I to be tested on")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    arguments = parser.parse_args()
    result = evaluate(Curves(), cases=scenarios("table1", arguments.cases))
    low, high = result.interval("success")
    if arguments.json:
        print(json.dumps({"success": result.rate("success"), "low": low, "high": high}))
    else:
        print(f"success {result.rate('success'):.3f} [{low:.3f}, {high:.3f}]")
