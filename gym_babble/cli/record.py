"""`gym-babble record`."""

import zipfile
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from gym_babble.agents.loading import REFERENCES, LoadedAgent, named_agent
from gym_babble.cli.arguments import (
    ControlName,
    EnvId,
    OwnConfig,
    Seed,
    VecNormalizeFile,
    given_options,
    one_of,
)
from gym_babble.cli.output import name_files, say
from gym_babble.envs.registry import ENVIRONMENTS, TASKS
from gym_babble.errors import ConfigError
from gym_babble.files import check_file, write_file
from gym_babble.study.scenarios import PROTOCOLS
from gym_babble.viz.film import Film, panel_width
from gym_babble.viz.scenes import check_same_task, find_cases, play_scene, stages
from gym_babble.viz.video import check_film, film_bytes

__all__ = ["record"]

MOST_FPS = 50.0
"""Frames per second that a GIF can show."""
(CAMERAS,) = {
    option.values for task in TASKS.values() for option in task.options if option.name == "camera"
}


def record(
    agents: Annotated[
        list[str],
        typer.Argument(
            help="One or more agents: random, scripted, oracle; files written by `babble`; "
            "module:Class; zips of stable-baselines3 (which contain pickled Python: use only files "
            "you trust)."
        ),
    ],
    *,
    file: Annotated[
        Path,
        typer.Option("--out", help="File: .mp4, .gif, or .png for a contact sheet of six frames."),
    ],
    titles: Annotated[
        list[str] | None, typer.Option("--title", help="Title of a panel; once for each agent.")
    ] = None,
    protocol: Annotated[
        str | None,
        typer.Option(
            help="Test cases. Default: those that `evaluate` uses.",
            metavar=f"<{'|'.join(PROTOCOLS)}>",
        ),
    ] = None,
    case: Annotated[
        list[int] | None,
        typer.Option(
            "--case", min=0, help="Index of a case; several follow one another. Default: 0."
        ),
    ] = None,
    seed: Seed = 0,
    split: Annotated[Literal["test", "validation"], typer.Option(help="Set of cases.")] = "test",
    learning: Annotated[
        str | None,
        typer.Option(
            help="Instead of several agents: one that babbled, as it was after these numbers of "
            "babbles that it learnt from, e.g. 0,100,1000."
        ),
    ] = None,
    camera: Annotated[str, typer.Option(help="Camera.", **one_of(CAMERAS))] = "third_person",
    size: Annotated[
        int | None,
        typer.Option(
            min=160, max=1920, help="Width of a panel [pixel]. Default: fits 1280 pixels."
        ),
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.1, max=100, help="Times as fast as simulated time.")
    ] = 1.0,
    fps: Annotated[
        float | None,
        typer.Option(
            min=1, max=MOST_FPS, help="Frames per second. Default: one for each control step."
        ),
    ] = None,
    env_id: EnvId = None,
    control: ControlName = None,
    config: OwnConfig = None,
    vec_normalize: VecNormalizeFile = None,
) -> None:
    """Film agents side by side on the same cases, with the eye's view.

    Below a Hebb agent are its maps: what it sees, the weights, and what it recalls, with a ring
    where the map is read out. "Weights out" are those from the most active input neuron, "weights
    in" those to the most active output neuron. Red is positive, blue negative.
    """
    check_file(file, "--out")
    check_film(file)
    given = {"seed": seed, "options": given_options(control=control), "config": config}
    loaded = _load(agents, env_id=env_id, vec_normalize=vec_normalize, given=given)
    if learning is None:
        shown = dict(zip(_titles(agents, titles), loaded, strict=True))
    else:
        shown = stages(_only(loaded, titles), _numbers(learning), progress_bar=True)
    check_same_task(shown)
    scenes = []
    for one in find_cases(list(shown.values()), case or [0], protocol, seed, split):
        scenes.append(play_scene(shown, one, _caption(one, seed, split, speed), camera))
        for panel in scenes[-1].panels:
            say(f"{panel.title}: {panel.episode.outcome} after {panel.episode.seconds:.2f} s")
    frames = fps or min(MOST_FPS, scenes[0].panels[0].episode.control_hz)
    film = Film(scenes, size or panel_width(len(shown)), frames, speed)
    write_file(file, film_bytes(film, file.suffix, progress_bar=True))
    name_files([file])


def _load(
    names: list[str], *, env_id: str | None, vec_normalize: Path | None, given: dict[str, Any]
) -> list[LoadedAgent]:
    """The agents. Without an id, those by name act where the first of the others acts."""
    zips = [name for name in names if Path(name).is_file() and zipfile.is_zipfile(name)]
    found: dict[int, LoadedAgent] = {}
    # Those by name are last.
    for i, name in sorted(enumerate(names), key=lambda one: one[1] in REFERENCES):
        where = dict(given, env_id=env_id)
        if env_id is None and name in REFERENCES and found:
            there = found[min(found)].arguments
            row = next(row for row in ENVIRONMENTS if row.task == there.task)
            where |= {"env_id": row.id, "config": there.config, "options": there.options}
        statistics = vec_normalize if name in zips or not zips else None
        try:
            found[i] = named_agent(name, vec_normalize=statistics, **where)
        except ConfigError as error:
            said = str(error)
            raise ConfigError(said if said.startswith(name) else f"{name}: {said}") from error
    return [found[i] for i in range(len(names))]


def _titles(names: list[str], titles: list[str] | None) -> list[str]:
    """A title for each agent, unlike the others."""
    if titles and len(titles) != len(names):
        raise typer.BadParameter(
            f"{len(titles)} titles for {len(names)} agents: give one for each, or none",
            param_hint="--title",
        )
    wanted = titles or [name if ":" in name else Path(name).name for name in names]
    for i, title in enumerate(wanted):
        if title in wanted[:i]:
            wanted[i] = f"{title} ({wanted[:i].count(title) + 1})"
    return wanted


def _only(loaded: list[LoadedAgent], titles: list[str] | None) -> LoadedAgent:
    if len(loaded) > 1 or titles:
        raise typer.BadParameter("takes one agent, and no titles", param_hint="--learning")
    return loaded[0]


def _numbers(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is not a list of whole numbers, as 0,100,1000", param_hint="--learning"
        ) from None


def _caption(case: Any, seed: int, split: str, speed: float) -> str:
    """Which case it is."""
    task = TASKS[PROTOCOLS[case["protocol"]]]
    drawn = f", {split}, seed {seed}" if task.protocols[case["protocol"]].random else ""
    fast = "" if speed == 1.0 else f"; {speed:g} times as fast as simulated time"
    return f"{case['protocol']}, case {case['index']}{drawn}{fast}"
