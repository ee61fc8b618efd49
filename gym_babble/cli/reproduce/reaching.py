"""Reproduces Table I and Figures 2, 4 and 5."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from gym_babble.cli.arguments import (
    AsJson,
    Cases,
    ConfigName,
    FirstSeed,
    Movements,
    Picture,
    QuasiStatic,
    Seed,
    Seeds,
    Variant,
)
from gym_babble.cli.learning import learn_reaching
from gym_babble.cli.output import (
    check_picture,
    name_files,
    print_json,
    print_results,
    table_files,
    write_table,
)
from gym_babble.files import check_folder
from gym_babble.paper import fig2 as generators
from gym_babble.paper import fig4 as movements_to_targets
from gym_babble.paper import fig5 as weights
from gym_babble.paper import table1 as rates
from gym_babble.paper.tables import table1_table
from gym_babble.study.rates import share
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.style import save

__all__ = ["fig2", "fig4", "fig5", "table1"]


def table1(
    *,
    seed: FirstSeed = 0,
    seeds: Seeds = 5,
    cases: Cases = 1_000,
    config: ConfigName = "paper",
    variant: Variant = "paper",
    control: Annotated[
        Literal["pattern", "delta_posture"], typer.Option(help="Control in the tests.")
    ] = "pattern",
    quasi_static: QuasiStatic = False,
    movements: Movements = 20_000,
    folder: Annotated[Path, typer.Option("--out", help="Folder for table1.json and .csv.")] = (
        Path()
    ),
    as_json: AsJson = False,
) -> None:
    """Table I: outcomes of reaching, beside the paper's rates."""
    check_folder(folder, "--out", table_files("table1"))
    table = rates.table1(
        seed=seed,
        seeds=seeds,
        cases=cases,
        config=config,
        variant=variant,
        control=control,
        quasi_static=quasi_static,
        movements=movements,
        progress_bar=True,
    )
    document = table.to_json()
    if as_json:
        print_json(document)
    else:
        title = f"Table I: Hebb {variant}, config {config}, {control} control"
        print_results(table1_table(document, title))
    write_table(folder, "table1", document, table.to_csv())


def fig2(file: Picture = Path("fig2.png")) -> None:
    """Figure 2: paths of the pattern generators."""
    check_picture(file)
    save(generators.draw(), file)
    name_files([file])


def fig4(
    *,
    file: Picture = Path("fig4.png"),
    variant: Variant = "paper",
    movements: Movements = 20_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Figure 4: trajectories to 4 targets from 36 starts around each."""
    check_picture(file)
    agent = learn_reaching(variant, movements, seed, config)
    cases = scenarios("fig4", config=config)
    halfway = movements_to_targets.trajectories(agent, cases, config)
    exchanged = [movements_to_targets.switched(case) for case in cases]
    switched = movements_to_targets.trajectories(agent, exchanged, config)
    counts = movements_to_targets.reached(agent, seed, config)
    if as_json:
        print_json({"config": config, "variant": variant, "movements": movements, **counts})
    else:
        for name, found in counts["reached"].items():
            both = f"{found['halfway']} halfway, {found['switched']} switched"
            print_results(f"{name}: {both}, of {counts['cases']}")
    save(movements_to_targets.draw(halfway, switched), file)
    name_files([file])


def fig5(
    file: Picture = Path("fig5.png"),
    movements: Movements = 20_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Figure 5: the weights of two sets of input neurons."""
    check_picture(file)
    sets = weights.weight_sets(learn_reaching("paper", movements, seed, config))
    left, right, correlation = sets.left.sum(), sets.right.sum(), sets.mirror_correlation
    if as_json:
        found = {"left": int(left), "right": int(right), "mirror_correlation": correlation}
        print_json({"config": config, "movements": movements, "seed": seed, **found})
    else:
        print_results(
            f"{left} input neurons curve left, {right} right; the mean of one set correlates "
            f"{share(correlation)} with the mirrored mean of the other"
        )
    save(weights.draw(sets), file)
    name_files([file])
