"""`gym-babble evaluate`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from gym_babble.agents.loading import REFERENCES, named_agent
from gym_babble.cli.arguments import AgentName, AsJson, Cases, EnvId, OwnConfig, Seed
from gym_babble.cli.output import print_json, print_results
from gym_babble.study import evaluation
from gym_babble.study.rates import paper_tally, tally
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tables import rate_cells, rate_rows, rates_table
from gym_babble.study.tasks import task_of

__all__ = ["evaluate"]


def evaluate(
    agent: AgentName,
    *,
    cases: Cases = 1_000,
    seed: Seed = 0,
    split: Annotated[Literal["test", "validation"], typer.Option(help="Set of cases.")] = "test",
    env_id: EnvId = None,
    config: OwnConfig = None,
    as_json: AsJson = False,
) -> None:
    """Test an agent on its task's cases: Table I, or objects on the palm's side."""
    loaded = named_agent(agent, env_id=env_id, config=config, seed=seed)
    task = task_of(loaded.env_id)
    result = evaluation.evaluate(
        loaded.agent,
        loaded.env_id,
        scenarios(task.protocol, cases, seed, split=split, config=loaded.config),
        config=loaded.config,
        progress_bar=True,
        **loaded.env_kwargs,
    )
    rates = tally(result, task)
    if as_json:
        print_json({"agent": agent, "env_id": loaded.env_id, "seed": seed, "split": split, **rates})
        return
    table = rates_table(f"{cases:,} {task.cases}, 95 % Wilson intervals", task=task)
    # A file may be called like an agent.
    label = agent if Path(agent).name in REFERENCES else Path(agent).name
    for row in rate_rows([rates], [seed], task):
        table.add_row(row.title or label, *rate_cells(row.rates, task))
    if task.paper is not None:
        table.add_row("the paper", *rate_cells(paper_tally()))
    print_results(table)
