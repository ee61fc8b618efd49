"""`gym-babble evaluate`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from gym_babble.agents.loading import REFERENCES, named_agent
from gym_babble.cli.arguments import (
    AgentName,
    AsJson,
    Cases,
    ControlName,
    EnvId,
    OwnConfig,
    Seed,
    VecNormalizeFile,
    given_options,
)
from gym_babble.cli.output import print_json, print_results
from gym_babble.envs.registry import TASKS
from gym_babble.study.evaluation import default_cases, play_cases
from gym_babble.study.rates import paper_tally, tally
from gym_babble.study.tables import rate_cells, rate_rows, rates_table
from gym_babble.study.tasks import task_named

__all__ = ["evaluate"]


def evaluate(
    agent: AgentName,
    *,
    cases: Cases = 1_000,
    seed: Seed = 0,
    split: Annotated[Literal["test", "validation"], typer.Option(help="Set of cases.")] = "test",
    env_id: EnvId = None,
    control: ControlName = None,
    config: OwnConfig = None,
    vec_normalize: VecNormalizeFile = None,
    as_json: AsJson = False,
) -> None:
    """Test an agent on its task's cases: Table I, or objects of its environment's region."""
    options = given_options(control=control)
    loaded = named_agent(
        agent,
        env_id=env_id,
        config=config,
        seed=seed,
        options=options,
        vec_normalize=vec_normalize,
    )
    where = loaded.arguments
    task = task_named(where.task)
    test = default_cases(where, cases, seed, split)
    rates = tally(play_cases(loaded, test, options, progress_bar=True), task)
    protocol, label = test[0]["protocol"], test[0]["config"]
    if as_json:
        about = {"env_id": where.title, "control": where.option("control"), "config": label}
        about |= {"protocol": protocol, "seed": seed, "split": split}
        print_json({"agent": agent, **about, **rates})
        return
    title = f"{cases:,} {TASKS[task.name].protocols[protocol].cases}, 95 % Wilson intervals"
    table = rates_table(title, task=task)
    # A file may be called like an agent.
    name = agent if Path(agent).name in REFERENCES else Path(agent).name
    for row in rate_rows([rates], [seed], task):
        table.add_row(row.title or name, *rate_cells(row.rates, task))
    if task.paper is not None:
        table.add_row("the paper", *rate_cells(paper_tally()))
    print_results(table)
