"""Small studies for the tests."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.study.engine import run_study
from gym_babble.study.spec import Study, study_of

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.study.store import Store

REACH = {"protocol": "table1", "cases": 20, "checkpoint_cases": 10, "budget": 20_000}
GRASP = {"protocol": "palm_side", "cases": 4, "checkpoint_cases": 2, "budget": 2_000}


class Silent:
    """Hears how a study goes on, and remembers."""

    def __init__(self) -> None:
        self.waiting: list[str] = []
        self.unfit: list[str] = []
        self.shares: list[float] = []
        self.ended: dict[str, str] = {}
        self.done = 0

    def begin(self, waiting, done, unfit):
        self.waiting = [spec.name for spec in waiting]
        self.done, self.unfit = done, list(unfit)

    def progress(self, spec, share):
        del spec
        self.shares.append(share)

    def end(self, spec, record):
        self.ended[spec.name] = record["status"]


def small(agents: list[Any], **changes: Any) -> Study:
    """A study of reaching and grasping that takes a second for each run."""
    document = {"name": "small", "tasks": {"reach": REACH, "grasp": GRASP}, "agents": agents}
    return study_of(document | changes)


def run(study: Study, folder: Path, jobs: int = 2) -> tuple[Store, Silent]:
    """Runs a study; returns its store, and what was heard."""
    watch = Silent()
    return run_study(study, folder, watch, jobs=jobs), watch


def results(store: Store) -> dict[str, Any]:
    """What must not depend on how often a study was stopped: no clocks and dates."""
    found = {}
    for one in store.runs():
        record = one.record or {}
        checkpoints = [
            {k: v for k, v in point.items() if not k.endswith("seconds")}
            for point in record.get("checkpoints", [])
        ]
        agent = None if one.agent is None else one.agent.read_bytes()
        found[one.spec.name] = (record.get("status"), record.get("test"), checkpoints, agent)
    return found
