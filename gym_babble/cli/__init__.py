"""The command line `gym-babble`.

Results go to stdout, progress and messages to stderr. Bad input ends with exit code 2, any other
failure with 1, each with one line that says what is wrong.
"""

import json
import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal

import gymnasium
import typer
from rich.console import Console

from gym_babble._core import __version__
from gym_babble.agents import HebbBabbling, HebbGrasping
from gym_babble.agents.loading import load_agent
from gym_babble.cli.doctor import examine
from gym_babble.envs.registration import ENVIRONMENTS
from gym_babble.errors import BabbleError, ConfigError, MissingExtraError
from gym_babble.export import export_mjcf, export_urdf
from gym_babble.paper import reproduce
from gym_babble.paper import table2 as grasping
from gym_babble.study.compare import CONTENDERS, Settings
from gym_babble.study.compare import compare as run_comparison
from gym_babble.study.evaluation import evaluate as run_evaluation
from gym_babble.study.report import write_report
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tables import (
    doctor_table,
    info_tables,
    paper_tally,
    plain_table,
    rate_cells,
    rates_table,
    share,
    table1_table,
    table2_tables,
    tally,
)
from gym_babble.study.tasks import TASKS, task_of
from gym_babble.viz import figures
from gym_babble.viz.film import record, save_film

__all__ = ["app", "main"]

app = typer.Typer(
    help="Reaching and grasping learned by motor babbling: environments, agents and the paper's "
    "experiments.",
    add_completion=False,
    rich_markup_mode=None,
)
reproduced = typer.Typer(help="Make the paper's table or one of its figures.")
app.add_typer(reproduced, name="reproduce")

# What typer's complaints about arguments derive from; its name has moved between versions.
UsageError: Any = typer.BadParameter.__bases__[0]

out = Console()
messages = Console(stderr=True)

AsJson = Annotated[bool, typer.Option("--json", help="One JSON document on stdout.")]
TaskName = Annotated[Literal["reach", "grasp"], typer.Option(help="Task.")]
ConfigName = Annotated[str, typer.Option(help="paper, icub, or a TOML or JSON file.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed.")]
Seeds = Annotated[int, typer.Option(min=1, help="How many seeds: 0, 1, ...")]
Cases = Annotated[int, typer.Option(min=1, help="Tests, of each seed.")]
Movements = Annotated[int, typer.Option(min=1, help="Legal movements to learn from (reaching).")]
Babbles = Annotated[int, typer.Option(min=1, help="Babbles to learn from (grasping).")]
Variant = Annotated[
    Literal["paper", "conjunctive"], typer.Option(help="Variant of the agent (reaching).")
]
QuasiStatic = Annotated[
    bool, typer.Option("--quasi-static", help="Babble without the muscles' lag: faster (reaching).")
]
EnvId = Annotated[
    str | None,
    typer.Option(
        help="Environment to act in; BabbleReachPattern-v0 if not given, or BabbleGrasp-v0 for an "
        "agent that babbled grasping."
    ),
]
OwnConfig = Annotated[
    str | None, typer.Option(help="paper, icub, or a file; the one it learnt on if not given.")
]
ALL_AGENTS = "; ".join(
    f"{task}: " + ",".join(f"[{one.key}]" if one.asked_for else one.key for one in CONTENDERS[task])
    for task in TASKS
)
Agents = Annotated[
    str | None,
    typer.Option(help=f"Some of {ALL_AGENTS}; all but those in brackets if not given."),
]
AgentName = Annotated[
    str,
    typer.Argument(
        help="random, scripted, oracle, a file of `babble`, or a zip of stable-baselines3 (which "
        "holds pickled Python: only those you trust)."
    ),
]


@app.callback(invoke_without_command=True)
def _top(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command("list")
def list_environments(as_json: AsJson = False) -> None:
    """List the environments."""
    listed = []
    for row in ENVIRONMENTS:
        env: Any = gymnasium.make(row.id)
        steps = env.unwrapped.choices.spec.max_episode_steps
        listed.append({**asdict(row), "max_episode_steps": steps})
    if as_json:
        _print_json(listed)
        return
    table = plain_table(None, ["id", "obs", "control", "reward", "steps", "solved at"], left=4)
    for found in listed:
        threshold = found["reward_threshold"]
        cells = (str(found[name]) for name in ("id", "obs", "control", "reward"))
        steps = str(found["max_episode_steps"])
        table.add_row(*cells, steps, "" if threshold is None else f"{threshold:g}")
    _print(table)


@app.command()
def info(
    env_id: Annotated[str, typer.Argument(metavar="ID", help="As `list` shows it.")],
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Show an environment: senses, action, reward terms, limits."""
    task_of(env_id)
    row = next(row for row in ENVIRONMENTS if row.id == env_id)
    env: Any = gymnasium.make(env_id, config=config)
    spec = env.unwrapped.choices.spec
    goals = list(spec.goals) if row.obs == "goal" else []
    described = {
        **asdict(row),
        "observation_space": str(env.observation_space),
        "action_space": str(env.action_space),
        "senses": [asdict(entry) for entry in (*spec.senses, *goals)],
        "action": asdict(spec.action),
        "reward_terms": spec.reward_terms,
        "outcomes": spec.outcomes,
        "max_episode_steps": spec.max_episode_steps,
        "control_hz": spec.control_hz,
    }
    if as_json:
        _print_json(described)
    else:
        _print(*info_tables(described))


@app.command()
def babble(
    *,
    file: Annotated[Path, typer.Option("--out", help="File for the agent.")],
    task: TaskName = "reach",
    variant: Variant = "paper",
    movements: Movements = 20_000,
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
    quasi_static: QuasiStatic = False,
    as_json: AsJson = False,
) -> None:
    """Let an agent babble and learn, and save it."""
    _check_folder_of(file)
    agent: HebbBabbling | HebbGrasping
    chosen: dict[str, Any] = {"config": config, "seed": seed}
    if task == "reach":
        agent = _learn(variant, movements, seed, config, quasi_static=quasi_static)
        made, good = agent.movements, agent.legal_movements
        chosen = {"variant": variant, **chosen, "quasi_static": quasi_static}
    else:
        agent = _learn_grasping(babbles, seed, config)
        made, good = agent.babbles, agent.kept
    agent.save(file)
    names = TASKS[task]
    if as_json:
        counts = {names.made: made, f"{names.good}_{names.made}": good}
        _print_json({"file": str(file), **chosen, **counts, f"{names.good}_rate": good / made})
        return
    out.print(
        f"{made:,} {names.made}, {good:,} of them {names.good} ({share(good / made)}): {file}",
        highlight=False,
    )


@app.command()
def evaluate(
    agent: AgentName,
    *,
    cases: Cases = 1_000,
    seed: Seed = 0,
    split: Annotated[Literal["test", "validation"], typer.Option(help="Which cases.")] = "test",
    env_id: EnvId = None,
    config: OwnConfig = None,
    as_json: AsJson = False,
) -> None:
    """Test an agent on its task's cases: Table I, or objects on the palm's side."""
    loaded = load_agent(agent, env_id=env_id, config=config, seed=seed)
    task = task_of(loaded.env_id)
    drawn = scenarios(task.protocol, cases, seed, split=split, config=loaded.config)
    result = run_evaluation(
        loaded.agent,
        loaded.env_id,
        drawn,
        config=loaded.config,
        progress_bar=True,
        **loaded.env_kwargs,
    )
    rates = tally(result, task)
    if as_json:
        _print_json(
            {"agent": agent, "env_id": loaded.env_id, "seed": seed, "split": split, **rates}
        )
        return
    table = rates_table(f"{cases:,} {task.cases}, 95 % Wilson intervals", task=task)
    table.add_row(Path(agent).name, *rate_cells(rates, task))
    if task.paper is not None:
        table.add_row("the paper", *rate_cells(paper_tally()))
    _print(table)


@app.command()
def compare(
    *,
    report: Annotated[
        Path | None, typer.Option(help="Folder for index.html and results.json.")
    ] = None,
    other_report: Annotated[
        str | None, typer.Option(help="The other task's page, from there, to link to.")
    ] = None,
    task: TaskName = "reach",
    agents: Agents = None,
    seeds: Seeds = 1,
    cases: Cases = 1_000,
    movements: Movements = 20_000,
    babbles: Babbles = 1_000,
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Compare Hebb babbling with PPO, and with agents that need no learning."""
    if report is not None:
        _check_folder_of(report)
        figures.check_format(report / "figure.svg")  # A missing extra shows now.
    settings = Settings(
        task=task,
        config=config,
        seeds=seeds,
        cases=cases,
        movements=movements,
        babbles=babbles,
        progress_bar=True,
    )
    keys = None if agents is None else [key.strip() for key in agents.split(",")]
    comparison = run_comparison(keys, settings, say=_say)
    written: list[Path] = []
    if report is not None:
        _say("writing the report")
        command = ["gym-babble", "compare", "--task", task, "--report", str(report)]
        command += ["--agents", agents] if agents is not None else []
        command += ["--seeds", str(seeds), "--cases", str(cases)]
        many = movements if task == "reach" else babbles
        command += [f"--{comparison.task.made}", str(many), "--config", config]
        command += ["--other-report", other_report] if other_report is not None else []
        written = write_report(comparison, report, shlex.join(command), other_report)
    if as_json:
        _print_json(comparison.to_json())
    else:
        _print(comparison.table())
    _say(f"{comparison.seconds:.0f} s")
    _name_files(written)


@app.command()
def render(
    agent: AgentName,
    *,
    folder: Annotated[Path, typer.Option("--out", help="Folder for the pictures.")],
    kind: Annotated[
        Literal["png", "gif", "mp4"], typer.Option("--format", help="Of the film.")
    ] = "gif",
    seed: Seed = 0,
    camera: Annotated[
        Literal["third_person", "eye", "fovea", "edges"], typer.Option(help="Camera.")
    ] = ("third_person"),
    size: Annotated[int, typer.Option(min=16, max=4096, help="Edge of a picture [pixel].")] = 360,
    env_id: EnvId = None,
    config: OwnConfig = None,
) -> None:
    """Film an episode of an agent: a contact sheet, and frames, GIF or MP4."""
    _check_folder_of(folder)
    loaded = load_agent(agent, env_id=env_id, config=config, seed=seed)
    film = record(loaded, seed=seed, camera=camera, size=size)
    _say(f"{film.outcome} after {len(film.frames) - 1} control steps")
    _name_files(save_film(film, folder, kind))


@app.command()
def export(
    *,
    kind: Annotated[
        Literal["mjcf", "urdf"],
        typer.Option("--format", help="mjcf: for MuJoCo, with a case's things; urdf: robot alone."),
    ] = "mjcf",
    task: TaskName = "grasp",
    config: ConfigName = "paper",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the case (mjcf).")] = 0,
    timestep: Annotated[
        float | None,
        typer.Option(help="MuJoCo's step [s]; the environment's if not given (mjcf)."),
    ] = None,
    file: Annotated[Path | None, typer.Option("--out", help="File; stdout if not given.")] = None,
) -> None:
    """Write the robot for other simulators."""
    if file is not None:
        _check_folder_of(file)
    if kind == "mjcf":
        text = export_mjcf(task, config=config, seed=seed, timestep=timestep)
    else:
        text = export_urdf(task, config=config)
    if file is None:
        typer.echo(text, nl=False)
        return
    file.write_text(text, encoding="utf-8")
    _name_files([file])


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Check what is installed, that the core computes what it should, and how fast it is."""
    found = examine()
    if as_json:
        _print_json(found)
    else:
        _print(doctor_table(found))
    if not found["same_bits"]:
        raise typer.Exit(1)


@reproduced.command("table1")
def reproduce_table1(
    *,
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
    """Table I: how reaching ends, beside the paper's rates."""
    _check_folder_of(folder)
    table = reproduce.table1(
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
    folder.mkdir(exist_ok=True)
    files = [folder / "table1.json", folder / "table1.csv"]
    files[0].write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    files[1].write_text(table.to_csv(), encoding="utf-8")
    if as_json:
        _print_json(document)
    else:
        title = f"Table I: Hebb {variant}, config {config}, {control} control"
        _print(table1_table(document, title))
    _name_files(files)


@reproduced.command("fig2")
def reproduce_fig2(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "fig2.png"
    ),
) -> None:
    """Figure 2: paths of the pattern generators."""
    _check_folder_of(file)
    figures.save(figures.fig2(), file)
    _name_files([file])


@reproduced.command("fig4")
def reproduce_fig4(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "fig4.png"
    ),
    variant: Variant = "paper",
    movements: Movements = 20_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
) -> None:
    """Figure 4: trajectories to 4 targets from 36 starts around each."""
    _check_picture(file)
    agent = _learn(variant, movements, seed, config)
    cases = scenarios("fig4", config=config)
    found = reproduce.ways(agent, cases, config)
    switched = reproduce.ways(agent, [reproduce.switched(case) for case in cases], config)
    missing = reproduce.starts_without_case(config)
    figures.save(figures.fig4(found, switched, missing), file)
    for name, made in (("obstacle halfway", found), ("switched", switched)):
        good = sum(way.outcome == "success" for way in made)
        out.print(f"{name}: {good} of {len(made)} reach", highlight=False)
    out.print(f"{len(missing)} starts have no case", highlight=False)
    _name_files([file])


@reproduced.command("fig5")
def reproduce_fig5(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "fig5.png"
    ),
    movements: Movements = 20_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
) -> None:
    """Figure 5: the two patterns of weights."""
    _check_picture(file)
    sets = reproduce.weight_sets(_learn("paper", movements, seed, config))
    figures.save(figures.fig5(sets), file)
    out.print(
        f"{sets.left.sum()} input neurons curve left, {sets.right.sum()} right; the mean of one "
        f"set correlates {share(sets.mirror_correlation)} with the mirrored mean of the other",
        highlight=False,
    )
    _name_files([file])


@reproduced.command("table2")
def reproduce_table2(
    *,
    seeds: Seeds = 5,
    cases: Annotated[
        int, typer.Option(min=2, help="Random cases in each region, of each seed.")
    ] = 1_000,
    config: ConfigName = "paper",
    babbles: Babbles = 1_000,
    hold_trials: Annotated[
        int, typer.Option(min=0, help="Trials of holding, of each diameter.")
    ] = 100,
    folder: Annotated[Path, typer.Option("--out", help="Folder for table2.json and .csv.")] = (
        Path()
    ),
    as_json: AsJson = False,
) -> None:
    """Table II: learned hands, and how reaching and grasping end, beside the paper's numbers."""
    _check_folder_of(folder)
    table = grasping.table2(
        seeds=seeds,
        cases=cases,
        config=config,
        babbles=babbles,
        hold_trials=hold_trials,
        progress_bar=True,
    )
    document = table.to_json()
    folder.mkdir(exist_ok=True)
    files = [folder / "table2.json", folder / "table2.csv"]
    files[0].write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    files[1].write_text(table.to_csv(), encoding="utf-8")
    if as_json:
        _print_json(document)
    else:
        _print(*table2_tables(document))
    _name_files(files)


@reproduced.command("fig7")
def reproduce_fig7(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "fig7.png"
    ),
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
) -> None:
    """Figure 7: final portions of the hand's ways, bold where it grasped."""
    _check_picture(file)
    agent = _learn_grasping(babbles, seed, config)
    cases = scenarios("fig7", config=config)
    ways = grasping.grasp_ways(agent, cases, config, progress_bar=True)
    figures.save(figures.fig7(ways), file)
    _name_files([file])


@reproduced.command("fig8")
def reproduce_fig8(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "fig8.png"
    ),
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
) -> None:
    """Figure 8: activation of the arm's map, and weights of reaching and grasping."""
    _check_picture(file)
    figures.save(figures.fig8(_learn_grasping(babbles, seed, config)), file)
    _name_files([file])


@reproduced.command("sight")
def reproduce_sight(
    file: Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")] = Path(
        "sight.png"
    ),
    config: ConfigName = "paper",
) -> None:
    """What the eye sees of the objects: its view, the fovea, and the edges there."""
    _check_picture(file)
    figures.save(figures.sight(grasping.sights(config)), file)
    _name_files([file])


def _learn_grasping(babbles: int, seed: int, config: str) -> HebbGrasping:
    agent = HebbGrasping(gymnasium.make("BabbleGrasp-v0", config=config), seed=seed)
    return agent.learn(babbles, progress_bar=True)


def _learn(
    variant: str, movements: int, seed: int, config: str, *, quasi_static: bool = False
) -> HebbBabbling:
    env = gymnasium.make("BabbleReachPattern-v0", config=config)
    agent = HebbBabbling(env, variant, seed=seed, quasi_static=quasi_static)
    return agent.learn(movements, progress_bar=True)


def _check_folder_of(path: Path) -> None:
    if not path.absolute().parent.is_dir():
        raise ConfigError(f"--out {path}: there is no folder {path.parent}; make it first")


def _check_picture(path: Path) -> None:
    """Finds what would fail after learning: a missing folder, extra or format."""
    _check_folder_of(path)
    figures.check_format(path)


def _print(*parts: Any) -> None:
    for part in parts:
        out.print(part, highlight=False)


def _print_json(document: Any) -> None:
    typer.echo(json.dumps(document, indent=2))


def _say(text: str) -> None:
    messages.print(text, highlight=False, markup=False)


def _name_files(files: list[Path]) -> None:
    for file in files[:3]:
        _say(str(file))
    if len(files) > 3:
        _say(f"... and {len(files) - 3} more")


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line and exits.

    Args:
        arguments: Words after `gym-babble`; the process's own if not given.
    """
    sys.exit(_run(arguments))


def _run(arguments: Sequence[str] | None) -> int:
    try:
        return app(arguments, standalone_mode=False) or 0
    except UsageError as error:
        return _fail(f"{error.format_message()} (see gym-babble --help)", 2)
    except MissingExtraError as error:
        return _fail(str(error), 1)
    except (BabbleError, FileNotFoundError) as error:
        return _fail(str(error), 2)
    except OSError as error:
        return _fail(str(error), 1)
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted", 130)


def _fail(text: str, code: int) -> int:
    # One line, whatever line breaks a library's message has.
    typer.echo(f"error: {' '.join(text.split())}", err=True)
    return code
