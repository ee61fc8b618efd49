"""The stored results: the commands behind each file, and a look into it."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import fmean
from typing import Any

from gym_babble.study.rates import paper_tally
from results import published

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "results"

TABLE1 = "gym-babble reproduce table1 --seeds 5"
REACHING = "--env-id BabbleReachPattern-v0"
HOLD = "python docs/experiments/grasp_sizes.py"
STEPS = "--env-id BabbleReach-v0"
GRASPING = "--env-id BabbleGrasp-v0"
READOUTS = "python docs/experiments/readouts.py"
INPUTS = '"obstacle, Eq. 7" "obstacle, Hebb" "eye, Eq. 7" "eye, Hebb"'
PAIRS = '"obstacle x eye, Eq. 7" "obstacle x eye, Hebb"'
CHANGED_BODY = "python docs/experiments/changed_body.py"
CHAIN = "python docs/experiments/grasp_chain.py"
SOLVED = ("BabbleReachGoal-v0", "BabbleGrasp-v0")

STORES: dict[str, dict[str, str]] = {
    "table1": {
        "paper": TABLE1,
        "paper-icub": f"{TABLE1} --config icub",
        "paper-steps": f"{TABLE1} --control delta_posture",
        "conjunctive": f"{TABLE1} --variant conjunctive",
        "conjunctive-250": f"{TABLE1} --variant conjunctive --movements 250",
        "conjunctive-icub": f"{TABLE1} --variant conjunctive --config icub",
        "conjunctive-icub-250": f"{TABLE1} --variant conjunctive --config icub --movements 250",
        "paper-4000": f"{TABLE1} --movements 4000",
        "conjunctive-4000": f"{TABLE1} --variant conjunctive --movements 4000",
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
        "curves": "python examples/own_agent.py",
        "rules": "python examples/own_rule.py --movements 2000",
    },
    "own_chain": {"chain": "python docs/experiments/own_chain.py"},
    "own_chunk": {"rates": "python examples/own_chunk.py"},
    "solved": {id_: f"python docs/experiments/solvable.py --ids {id_}" for id_ in SOLVED},
    "sensitivity": {"rows": "python docs/experiments/sensitivity.py"},
    "vote": {"rows": "python docs/experiments/obstacle_alone.py"},
    "readouts": {
        "paper": f"{READOUTS} --bodies paper --networks {INPUTS} {PAIRS}",
        "icub": f"{READOUTS} --bodies icub --networks {PAIRS}",
        "fine": f'{READOUTS} --bodies paper --movements 20000 --networks "fine obstacle, Hebb"',
    },
    "changed_body": {
        "conjunctive": f'{CHANGED_BODY} --movements 4000 --agents "Hebb `conjunctive`"',
        "paper": f'{CHANGED_BODY} --movements 4000 --agents "Hebb `paper`"',
        "ppo": f"{CHANGED_BODY} --agents PPO --ppo-repair 1024 4096 --changes none "
        '"elbow to 85°" "a fifth of the stiffness" "eye 4 cm to the right"',
    },
    "fig4": {"paper": "gym-babble reproduce fig4"},
    "fig5": {"paper": "gym-babble reproduce fig5"},
    "table2": {"paper": "gym-babble reproduce table2 --seeds 5 --cases 300"},
    "table2_small": {
        "paper": "gym-babble reproduce table2 --seeds 6 --cases 40 --babbles 200 --hold-trials 1"
    },
    "sizes": {
        "tree": HOLD,
        "independent": f"{HOLD} --fingers independent --diameters 2.4 6 8",
        "rapier": f"{HOLD} --engine rapier --diameters 2.4 6 8",
        "open": f"{HOLD} --reflex 70 70 --diameters 2.4",
        "open-rapier": f"{HOLD} --reflex 70 70 --engine rapier --diameters 2.4",
        "closed": f"{HOLD} --reflex 90 90 --diameters 2.4",
        "closed-rapier": f"{HOLD} --reflex 90 90 --engine rapier --diameters 2.4",
    },
    "periods": {"rows": "python docs/experiments/grasp_learning_period.py"},
    "convergence": {"counts": "python docs/experiments/convergence.py"},
    "sides": {"scripted": "python docs/experiments/grasp_sides.py"},
    "chain": {
        "paper": CHAIN,
        "icub": f"{CHAIN} --config icub --babbles 1000 --trials 0 --more 2",
    },
    "basin": {"elbow": "python docs/experiments/grasp_basin.py"},
    "movements": {"rows": "python docs/experiments/grasp_movements.py"},
    "carry": {"chain": "python docs/experiments/grasp_carry.py"},
    "interference": {"rows": "python docs/experiments/grasp_interference.py --seeds 2"},
}
"""For each store its runs, each with its command; `--json` is added."""

TUNING = ROOT / "docs" / "studies" / "tuning"
"""Folder of what docs/experiments/tune.py wrote."""


def path_of(name: str) -> Path:
    """The file of a store."""
    return FOLDER / f"{name}.json"


def derived(stores: Stores) -> dict[str, float]:
    """Numbers that several stored ones give."""
    ours = stores["table1"]["paper"]["over_seeds"]["success"]["mean"]
    changed = {row["change"]: row["success"] for row in stores["sensitivity"]["rows"]}
    none = changed.pop("none")
    del changed["camera frame fick"]
    held: dict[tuple[int, float], list[float]] = {}
    for row in stores["chain"]["paper"]:
        if not row["practised"]:
            held.setdefault((row["learnt"], row["diameter_cm"]), []).append(row["kept"])
    own_chain = {
        f"own_chain_{cm:g}": fmean(
            row["held"] for row in stores["own_chain"]["chain"] if row["cm"] == cm
        )
        for cm in (2.4, 4, 6)
    }
    voted = {choice: found["success"] for choice, found in stores["vote"]["rows"].items()}
    (fine,) = (row["success"] for row in stores["readouts"]["fine"] if row["readout"] == "peak")
    return {
        **own_chain,
        "chain_small": fmean(held[1_000, 2.4]),
        "chain_small_100": fmean(held[100, 2.4]),
        "chain_unseen": fmean(held[1_000, 4.0]),
        "above_paper": ours - paper_tally()["success"]["rate"],
        "inside_big_cm": -stores["interference"]["rows"][5]["mean"][0],
        "missed": 100 * (1 - voted["hebb"]),
        "missed_by_input": 100 * (1 - voted["vote_obstacle"]),
        "missed_by_rule": 100 * (voted["vote_obstacle"] - voted["hebb"]),
        "won_back": 100 * (fine - voted["hebb"]),
        "of_a_row": 1.96 * (none * (1 - none) / 2_000) ** 0.5,
        "of_other_changes": max(abs(success - none) for success in changed.values()),
    }


class Stores(dict[str, Any]):
    """The stores by name, read when needed: what each run printed, or the study's numbers."""

    def __missing__(self, name: str) -> Any:
        """Reads a store."""
        if name == "derived":
            self[name] = derived(self)
        elif name == "tuning":
            files = sorted(TUNING.glob("*.json"))
            self[name] = [json.loads(path.read_text(encoding="utf-8")) for path in files]
        elif name == published.NAME:
            self[name] = published.document()
        else:
            stored = json.loads(path_of(name).read_text(encoding="utf-8"))
            self[name] = {run: found["printed"] for run, found in stored["runs"].items()}
        return self[name]

    def find(self, path: str) -> Any:
        """The value at a path such as `table1/paper/by_seed/0/success/rate`.

        A part of the form `name=value` selects the item of a list that has this value.
        """
        value: Any = self
        for part in path.split("/"):
            key, equals, wanted = part.partition("=")
            if equals:
                value = next(item for item in value if str(item[key]) == wanted)
            elif isinstance(value, list):
                value = value[int(part)]
            else:
                value = value[part]
        return value
