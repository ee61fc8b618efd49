"""Reproduces Table II, Figures 7 and 8, and the eye's view."""

from pathlib import Path
from typing import Annotated

import typer

from gym_babble.cli.arguments import (
    AsJson,
    Babbles,
    ConfigName,
    FirstSeed,
    Picture,
    Seed,
    Seeds,
    Variant,
)
from gym_babble.cli.learning import learn_grasping
from gym_babble.cli.output import (
    check_picture,
    name_files,
    print_json,
    print_results,
    table_files,
    write_table,
)
from gym_babble.files import check_folder
from gym_babble.paper import fig7 as palm
from gym_babble.paper import fig8 as weights
from gym_babble.paper import sight as views
from gym_babble.paper import table2 as rates
from gym_babble.paper.tables import table2_tables
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.style import save

__all__ = ["fig7", "fig8", "sight", "table2"]


def table2(
    *,
    seed: FirstSeed = 0,
    seeds: Seeds = 5,
    cases: Annotated[
        int, typer.Option(min=2, help="Random cases in each region, for each seed.")
    ] = 1_000,
    config: ConfigName = "paper",
    variant: Variant = "paper",
    babbles: Babbles = 1_000,
    hold_trials: Annotated[
        int, typer.Option(min=0, help="Trials of holding for each diameter.")
    ] = 100,
    folder: Annotated[Path, typer.Option("--out", help="Folder for table2.json and .csv.")] = (
        Path()
    ),
    as_json: AsJson = False,
) -> None:
    """Table II: learned hands, and outcomes of reaching and grasping, beside the paper's."""
    check_folder(folder, "--out", table_files("table2"))
    table = rates.table2(
        seed=seed,
        seeds=seeds,
        cases=cases,
        config=config,
        variant=variant,
        babbles=babbles,
        hold_trials=hold_trials,
        progress_bar=True,
    )
    document = table.to_json()
    if as_json:
        print_json(document)
    else:
        print_results(*table2_tables(document))
    write_table(folder, "table2", document, table.to_csv())


def fig7(
    file: Picture = Path("fig7.png"),
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
    variant: Variant = "paper",
) -> None:
    """Figure 7: final portions of the palm's trajectories."""
    check_picture(file)
    agent = learn_grasping(babbles, seed, config, variant=variant)
    cases = scenarios("fig7", config=config)
    save(palm.draw(palm.trajectories(agent, cases, progress_bar=True)), file)
    name_files([file])


def fig8(
    file: Picture = Path("fig8.png"),
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
) -> None:
    """Figure 8: activation of the arm's map, and weights of reaching and grasping."""
    check_picture(file)
    save(weights.draw(learn_grasping(babbles, seed, config)), file)
    name_files([file])


def sight(file: Picture = Path("sight.png"), config: ConfigName = "paper") -> None:
    """What the eye sees of the objects: its view, the fovea, and the edges in the fovea."""
    check_picture(file)
    save(views.draw(views.eye_views(config)), file)
    name_files([file])
