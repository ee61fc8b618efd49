"""A run of a study: one agent learns one task with one seed, and is tested."""

from __future__ import annotations

import datetime as dt
import json
import traceback
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from gym_babble.agents.loading import LoadedAgent
from gym_babble.envs.registry import task_entry
from gym_babble.errors import BabbleError, ConfigError
from gym_babble.study.evaluation import play_cases
from gym_babble.study.paths import SHOWN_CASES, hand_paths
from gym_babble.study.roster import RosterAgent, roster_agent, trainer_for
from gym_babble.study.scenarios import scenarios
from gym_babble.study.spec import Study, StudyAgent, StudyTask
from gym_babble.study.trainers.base import Order
from gym_babble.study.versions import code_hash, machine, physics_hash, versions

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.outcomes import Evaluation
    from gym_babble.study.trainers.base import Trainer

__all__ = ["FORMAT", "RunSpec", "checkpoints", "execute", "failed", "runs_of", "stored_test"]

FORMAT = 1
"""Version of a stored run."""

FIRST_CHECKPOINT = 1_000
"""Control steps at the first checkpoint; the others follow in the steps 1, 2, 5, 10."""


@dataclass(frozen=True, kw_only=True)
class RunSpec:
    """What a run is made from."""

    task_name: str
    """Name of the task in the study."""
    task: StudyTask
    agent: StudyAgent
    seed: int
    budget: int
    """Control steps to learn from; 0 for an agent that does not learn."""
    tuned: str = ""
    """Hash of its tuned settings, if a file has them."""

    @property
    def name(self) -> str:
        """Task, label and seed."""
        return f"{self.task_name}.{self.agent.label}.{self.seed}"

    def to_json(self) -> dict[str, Any]:
        """All that decides the result, as JSON types, apart from the physics."""
        task = {k: v for k, v in asdict(self.task).items() if k != "budget"}
        agent = {k: v for k, v in asdict(self.agent).items() if k not in ("tasks", "seeds")}
        whole = {
            "task": {"name": self.task_name, **task},
            "agent": {**agent, "budget": self.budget},
            "tuned": self.tuned,
            "seed": self.seed,
        }
        return json.loads(json.dumps(whole))  # type: ignore[no-any-return]

    @classmethod
    def from_json(cls, document: dict[str, Any]) -> RunSpec:
        """The run that `to_json` described."""
        task = dict(document["task"])
        name = task.pop("name")
        return cls(
            task_name=name,
            task=StudyTask(**task),
            agent=StudyAgent(**document["agent"]),
            seed=document["seed"],
            budget=document["agent"]["budget"],
            tuned=document["tuned"],
        )

    @property
    def fingerprint(self) -> str:
        """Names this very run: runs with the same one have the same results."""
        text = json.dumps([FORMAT, self.to_json(), physics_hash()], sort_keys=True)
        return sha256(text.encode()).hexdigest()[:12]

    def order(self) -> Order:
        """The order for the trainer."""
        return Order(
            task=self.task.task,
            seed=self.seed,
            budget=self.budget,
            config=self.task.config,
            env_id=self.agent.env_id,
            options=self.agent.options,
            settings=self.agent.settings,
        )

    def cases(self) -> list[Any]:
        """The cases of its test."""
        task = self.task
        protocol = task_entry(task.task).protocols[task.protocol]
        sampled = (task.cases, task.case_seed) if protocol.random else ()
        return list(scenarios(task.protocol, *sampled, config=task.config))


def runs_of(study: Study) -> list[RunSpec]:
    """The runs of a study: one seed after the other, so that an early stop has all agents.

    Raises:
        ConfigError: An unknown agent, or one that takes part in no task.
    """
    found: list[tuple[int, RunSpec]] = []
    for i, agent in enumerate(study.agents):
        try:
            entry = roster_agent(agent.agent)
        except ConfigError as error:
            raise ConfigError(f"agents[{i}].{error}") from error
        names = [name for name in agent.tasks or study.tasks if _can(entry, study.tasks[name])]
        missing = [name for name in agent.tasks if name not in names]
        if missing or not names:
            raise ConfigError(
                f"agents[{i}].agent = {agent.agent!r} can do none of "
                f"{', '.join(missing or study.tasks)}"
            )
        for name in names:
            found += _seeds_of(study, name, agent, entry)
    return [run for _, run in sorted(found, key=lambda pair: pair[0])]


def _can(entry: RosterAgent | None, task: StudyTask) -> bool:
    return entry is None or task.task in entry.tasks


def _seeds_of(
    study: Study, name: str, agent: StudyAgent, entry: RosterAgent | None
) -> list[tuple[int, RunSpec]]:
    """The runs of an agent on a task, each with its turn."""
    task = study.tasks[name]
    budget = agent.budget or task.budget or 0
    seeds = agent.seeds or study.seeds
    tuned = ""
    if entry is not None:
        place = entry.tasks[task.task]
        budget = (budget or place.budget) if place.budget else 0
        seeds = seeds if entry.seeded else seeds[:1]
        agent = replace(
            agent,
            env_id=agent.env_id or place.env_id,
            options={**entry.options, **agent.options},
            settings={**entry.settings, **agent.settings},
        )
        text = entry.tuned(str(agent.env_id))
        tuned = sha256(text.encode()).hexdigest()[:12] if text else ""
    run = RunSpec(task_name=name, task=task, agent=agent, seed=0, budget=budget, tuned=tuned)
    return [(turn, replace(run, seed=seed)) for turn, seed in enumerate(seeds)]


def checkpoints(budget: int) -> list[int]:
    """Control steps at which an agent is tested: 1, 2, 5, 10 ... thousand, and the budget."""
    marks = []
    power = FIRST_CHECKPOINT
    while power < budget:
        marks += [mark for mark in (power, 2 * power, 5 * power) if mark < budget]
        power *= 10
    return [*marks, budget] if budget else []


def execute(
    spec: RunSpec, progress: Callable[[float], None] = lambda _: None
) -> tuple[dict[str, Any], tuple[str, bytes] | None]:
    """Trains and tests. A run that fails has a record that says why.

    Args:
        spec: The run.
        progress: Called with the share of the learning that is done.

    Returns:
        The record of the run as JSON types, and the agent's file with its suffix, if it has one.
    """
    try:
        results, file = _results(spec, progress)
    except Exception as error:  # noqa: BLE001 - an agent of a user's own may raise anything
        return failed(spec, _said(error), traceback.format_exc(limit=-4)), None
    return {**_about(spec), "status": "finished", **results}, file


def failed(spec: RunSpec, error: str, trace: str) -> dict[str, Any]:
    """The record of a run that failed."""
    return {**_about(spec), "status": "failed", "error": error, "trace": trace}


def _about(spec: RunSpec) -> dict[str, Any]:
    """What a record says of its run: the spec, and what it ran on."""
    return {
        "format": FORMAT,
        "fingerprint": spec.fingerprint,
        "spec": spec.to_json(),
        "physics": physics_hash(),
        "code": code_hash(),
        "versions": versions(),
        "machine": machine(),
        "date": dt.datetime.now(dt.timezone.utc).isoformat(timespec="seconds"),
    }


def _said(error: Exception) -> str:
    """An error in a line: ours as they are, others with their class."""
    text = " ".join(str(error).split())
    return text if isinstance(error, BabbleError) else f"{type(error).__name__}: {text}"


def _results(
    spec: RunSpec, progress: Callable[[float], None]
) -> tuple[dict[str, Any], tuple[str, bytes] | None]:
    trainer = trainer_for(spec.agent.agent, spec.order())
    cases = spec.cases()
    recorder = _Recorder(spec, trainer, cases[: spec.task.checkpoint_cases], progress)
    if spec.budget:
        trainer.train(spec.budget, recorder.pause)
        recorder.finish()
    test = _test(trainer, cases)
    results = {
        "env": trainer.arguments.title,
        "cost": recorder.cost(),
        "checkpoints": recorder.checkpoints,
        "test": stored_test(test),
        "paths": hand_paths(LoadedAgent(trainer.agent, trainer.arguments), cases[:SHOWN_CASES]),
    }
    return results, trainer.save()


def _test(trainer: Trainer, cases: list[Any]) -> Evaluation:
    loaded = LoadedAgent(trainer.agent, trainer.arguments)
    return play_cases(loaded, cases, trainer.arguments.options, threads=1)


def stored_test(test: Evaluation) -> dict[str, Any]:
    """A test as JSON types: for each case the index of its outcome and size, and its steps."""
    names, sizes = list(test.possible), test.by_size()
    of_case = {id(case): size for size, part in sizes.items() for case in part.cases}
    indices = {size: i for i, size in enumerate(sizes)}
    return {
        "outcomes": names,
        "outcome": "".join(str(names.index(outcome)) for outcome in test.outcomes),
        "facts": {
            name: "".join(str(int(one)) for one in values) for name, values in test.facts.items()
        },
        "sizes": list(sizes),
        "size": "".join(str(indices[of_case[id(case)]]) for case in test.cases) if sizes else "",
        "steps": list(test.steps),
    }


class _Recorder:
    """Stops the clocks while the agent is tested, and keeps the results of checkpoints."""

    def __init__(
        self,
        spec: RunSpec,
        trainer: Trainer,
        cases: list[Any],
        progress: Callable[[float], None],
    ) -> None:
        self._trainer, self._cases, self._progress = trainer, cases, progress
        self._budget, self._marks = spec.budget, checkpoints(spec.budget)
        self._cpu = self._clock = 0.0
        self.checkpoints: list[dict[str, Any]] = []
        self._start()

    def pause(self) -> None:
        """Tests the agent if it has passed a checkpoint."""
        self._stop()
        done = self._trainer.cost.control_steps
        self._progress(min(1.0, done / self._budget))
        if self._marks and done >= self._marks[0]:
            self._marks = [mark for mark in self._marks if mark > done]
            self._check()
        self._start()

    def finish(self) -> None:
        """Tests the agent at the end, unless its last checkpoint was there."""
        self._stop()
        steps = self._trainer.cost.control_steps
        if not self.checkpoints or self.checkpoints[-1]["control_steps"] < steps:
            self._check()

    def cost(self) -> dict[str, Any]:
        """What learning has used so far."""
        clocks = {"cpu_seconds": round(self._cpu, 3), "clock_seconds": round(self._clock, 3)}
        return {**asdict(self._trainer.cost), **clocks}

    def _check(self) -> None:
        test = _test(self._trainer, self._cases)
        self.checkpoints.append({**self.cost(), "outcome": stored_test(test)["outcome"]})

    def _start(self) -> None:
        self._began = process_time(), perf_counter()

    def _stop(self) -> None:
        self._cpu += process_time() - self._began[0]
        self._clock += perf_counter() - self._began[1]
