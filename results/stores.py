"""The stored results: the commands behind each file, and a look into it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "results"

TABLE1 = "gym-babble reproduce table1 --seeds 5"
REACHING = "--env-id BabbleReachPattern-v0"
STEPS = "--env-id BabbleReach-v0"
GRASPING = "--env-id BabbleGrasp-v0"

STORES: dict[str, dict[str, str]] = {
    "table1": {
        "paper": TABLE1,
        "paper-icub": f"{TABLE1} --config icub",
        "paper-steps": f"{TABLE1} --control delta_posture",
        "conjunctive": f"{TABLE1} --variant conjunctive",
        "conjunctive-250": f"{TABLE1} --variant conjunctive --movements 250",
        "conjunctive-icub": f"{TABLE1} --variant conjunctive --config icub",
        "conjunctive-icub-250": f"{TABLE1} --variant conjunctive --config icub --movements 250",
        "conjunctive-steps": f"{TABLE1} --variant conjunctive --control delta_posture",
    },
    "references": {
        "random": f"gym-babble evaluate random {REACHING}",
        "scripted": f"gym-babble evaluate scripted {REACHING}",
        "oracle": f"gym-babble evaluate oracle {REACHING}",
        "scripted-steps": f"gym-babble evaluate scripted {STEPS}",
        "grasp-random": f"gym-babble evaluate random {GRASPING}",
        "grasp-scripted": f"gym-babble evaluate scripted {GRASPING}",
    },
    "own": {
        "curves": "python examples/curves.py",
        "rules": "python examples/own_rule.py --movements 2000",
    },
    "sensitivity": {"rows": "python examples/sensitivity.py"},
    "fig4": {"paper": "gym-babble reproduce fig4"},
    "grasp": {"hebb": "gym-babble compare --task grasp --agents hebb-paper"},
    "table2": {"paper": "gym-babble reproduce table2 --seeds 5"},
    "sizes": {
        "tree": "python examples/grasp_sizes.py",
        "independent": "python examples/grasp_sizes.py --fingers independent",
        "rapier": "python examples/grasp_sizes.py --engine rapier",
    },
    "sides": {"scripted": "python examples/grasp_sides.py"},
    "interference": {"rows": "python examples/grasp_interference.py"},
}
"""For each store its runs, each with its command; `--json` is added."""

STUDIES = {
    "ppo_reach": ROOT / "docs" / "studies" / "ppo_reach.json",
    "ppo_grasp": ROOT / "gym_babble" / "study" / "results" / "ppo_grasp.json",
}
"""Stores that examples/ppo_study.py writes."""


def path_of(name: str) -> Path:
    """The file of a store."""
    return STUDIES.get(name, FOLDER / f"{name}.json")


class Stores(dict[str, Any]):
    """The stores by name: what each run printed, or the study. They are read when needed."""

    def __missing__(self, name: str) -> Any:
        """Reads a store."""
        stored = json.loads(path_of(name).read_text(encoding="utf-8"))
        if name in STORES:
            stored = {run: found["printed"] for run, found in stored["runs"].items()}
        self[name] = stored
        return stored

    def find(self, path: str) -> Any:
        """The value at a path such as `table1.paper.by_seed.0.success.rate`.

        A part of the form `name=value` selects the item of a list that has this value.
        """
        value: Any = self
        for part in path.split("."):
            key, equals, wanted = part.partition("=")
            if equals:
                value = next(item for item in value if str(item[key]) == wanted)
            elif isinstance(value, list):
                value = value[int(part)]
            else:
                value = value[part]
        return value
