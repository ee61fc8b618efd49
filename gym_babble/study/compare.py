"""Compares Hebb babbling with PPO and with agents that need no learning.

Each agent learns in its own environment. All agents are tested on the same cases: Table I for
reaching, objects on the palm's side for grasping. With several seeds, each seed has its own
learners and its own 1,000 (`cases`) tests, and the table shows means and ranges of the seeds.
"""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Any

from gym_babble.checks import check_seed
from gym_babble.errors import ConfigError, MissingExtraError, StudyError
from gym_babble.study.comparison import Comparison, Result, StoredResult, TrainedResult
from gym_babble.study.contenders import CONTENDERS, Contender, Settings, own_contender
from gym_babble.study.evaluation import evaluate
from gym_babble.study.learning import CurvePoint, Learning
from gym_babble.study.rates import counted, tally
from gym_babble.study.scenarios import scenarios
from gym_babble.study.stored import STUDIES, Run, Study
from gym_babble.study.tasks import TASKS, Task

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from gym_babble.study.scenarios import GraspScenario, Scenario

__all__ = ["compare"]


def compare(
    agents: Sequence[str] | None = None,
    settings: Settings | None = None,
    *,
    log: Callable[[str], None] = lambda _: None,
) -> Comparison:
    """Trains and tests contenders one after the other.

    Args:
        agents: Keys of the task's `CONTENDERS`, and "module:Class" for agents of your own; by
            default all contenders that are not `opt_in`.
        settings: Settings of the comparison.
        log: Called with a line of text before each contender.

    Raises:
        ConfigError: An unknown task or key, or a number out of bounds.
        ScenarioError: The config has no room for a case.
    """
    settings = settings or Settings()
    if settings.task not in TASKS:
        raise ConfigError(f"task = {settings.task!r} is not one of {', '.join(TASKS)}")
    task = TASKS[settings.task]
    contenders = _chosen(agents, task)
    if min(settings.seeds, settings.movements, settings.babbles) < 1:
        raise ConfigError("seeds, movements and babbles must be at least 1")
    check_seed(settings.seed)
    began = perf_counter()
    cases = [
        scenarios(task.protocol, settings.cases, seed, config=settings.config, threads=None)
        for seed in settings.all_seeds
    ]
    results: list[Result] = []
    skipped: dict[str, str] = {}
    for i, contender in enumerate(contenders, start=1):
        log(f"[{i}/{len(contenders)}] {contender.title}, {contender.detail}")
        try:
            results.append(_run(contender, task, settings, cases))
        except (MissingExtraError, StudyError) as error:
            skipped[contender.key] = str(error)
            log(f"left out: {error}")
    return Comparison(settings, tuple(results), skipped, perf_counter() - began)


def _chosen(keys: Sequence[str] | None, task: Task) -> list[Contender]:
    known = {contender.key: contender for contender in CONTENDERS[task.name]}
    if keys is None:
        return [contender for contender in known.values() if not contender.opt_in]
    unknown = [key for key in keys if key not in known and ":" not in key]
    if unknown or not keys:
        raise ConfigError(
            f"agents = {list(keys)} is not a selection of {', '.join(known)}, or module:Class"
        )
    return [
        known[key] if key in known else own_contender(key, task.name) for key in dict.fromkeys(keys)
    ]


def _run(
    contender: Contender,
    task: Task,
    settings: Settings,
    cases: Sequence[Sequence[Scenario | GraspScenario]],
) -> Result:
    if contender.train is None:
        return _stored(contender, task, settings)
    trained = tuple(contender.train(settings, seed) for seed in settings.all_seeds)
    bar = settings.progress_bar and contender.slow_test
    tests = []
    for one, its_cases in zip(trained, cases, strict=True):
        with one.while_acting():
            test = evaluate(
                one.agent, one.env_id, its_cases, config=settings.config, progress_bar=bar
            )
        tests.append(test)
    rates = tuple(tally(test, task) for test in tests)
    return TrainedResult(
        contender, task, trained[0].env_id, settings.all_seeds, trained, rates, tuple(tests)
    )


def _stored(contender: Contender, task: Task, settings: Settings) -> StoredResult:
    """The stored study of a task; it has its own seeds and cases."""
    study = Study.read(STUDIES / f"ppo_{task.name}.json")
    if settings.config != study.config:
        raise StudyError(f"the stored study is of config {study.config}")
    return StoredResult(
        contender,
        task,
        env_id=study.presets[study.runs[0].preset]["env_id"],
        seeds=tuple(run.seed for run in study.runs),
        trained=tuple(_learning(run) for run in study.runs),
        rates_by_seed=tuple(_rates(run) for run in study.runs),
        study=study,
    )


def _rates(run: Run) -> dict[str, Any]:
    """A run's test in the form of `tally`."""
    split = {size: counted(part) for size, part in run.by_size.items()}
    return {**counted(run.counts), **({"by_size": split} if split else {})}


def _learning(run: Run) -> Learning:
    return Learning(
        trials=run.movements,
        control_steps=run.control_steps,
        seconds=run.seconds,
        curve=tuple(CurvePoint(int(steps), *rest) for steps, *rest in run.curve),
    )
