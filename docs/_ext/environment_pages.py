"""The page of each registered environment, in the format of Gymnasium's docs.

Ids, options, spaces and bounds come from the core's registry, the text from the docstring of the
task's class. A task without such a class, like the toy of development builds, has no page.
"""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

import gymnasium
from writing import write_pages

import gym_babble.envs
from gym_babble.envs.registry import ENVIRONMENTS, TASKS

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.envs import BabbleEnv
    from gym_babble.envs.registry import Environment
    from gym_babble.envs.spaces import Entry

CLASSES = {
    kind.task_name: kind
    for name in gym_babble.envs.__all__
    if issubclass(kind := getattr(gym_babble.envs, name), gymnasium.Env) and kind.task_name
}
"""The class of each task that has one."""
DOCUMENTED = tuple(row for row in ENVIRONMENTS if row.task in CLASSES)
"""The environments that have a page."""
SHARED = "Bodies, noise, test cases, seeds, threads and errors"
AFTER_SPACES = ("Rewards", "Starting state", "Episode end", "Info", "Arguments")


def table(head: tuple[str, ...], rows: list[tuple[Any, ...]]) -> str:
    """A table of Markdown."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def sections(task: str) -> dict[str, str]:
    """The sections of the docstring of a task's class, by their headings."""
    parts = inspect.cleandoc(CLASSES[task].__doc__ or "").split("\n## ")
    first, *others = parts
    found = {"": first.strip()}
    for part in others:
        head, _, text = part.partition("\n")
        found[head] = text.strip()
    return found


def number(value: float) -> str:
    """A bound as a page shows it."""
    return f"{value:.4g}".replace("-", "−")


def entry_rows(entries: tuple[Entry, ...], *, unit: str = "") -> list[tuple[Any, ...]]:
    """Rows for the numbers of an array: one each, or one for a sense of a hundred equal ones."""
    rows: list[tuple[Any, ...]] = []
    start = 0
    for entry in entries:
        numbers = list(zip(entry.labels, entry.low, entry.high, strict=True))
        name = f"`{entry.name}`"
        if len(set(numbers)) == 1 and len(numbers) > 1:
            ((label, low, high),) = set(numbers)
            place = f"{start}–{start + len(numbers) - 1}"
            rows.append((place, name, label, number(low), number(high), unit or entry.unit))
        else:
            rows += [
                (start + i, name, label, number(low), number(high), unit or entry.unit)
                for i, (label, low, high) in enumerate(numbers)
            ]
        start += len(numbers)
    return rows


def action_table(env: BabbleEnv) -> str:
    """What each number of an action does."""
    action = env.interface.spec.action
    rows = [
        (i, label, number(low), number(high), action.unit)
        for i, (label, low, high) in enumerate(
            zip(action.labels, action.low, action.high, strict=True)
        )
    ]
    return table(("number", "action", "min", "max", "1 stands for"), rows)


def observation_tables(env: BabbleEnv) -> str:
    """What each number of an observation is."""
    head = ("number", "sense", "of", "min", "max", "unit")
    spec = env.interface.spec
    meanings = table(
        ("sense", "is"), [(f"`{one.name}`", one.description) for one in (*spec.senses, *spec.goals)]
    )
    if env.interface.obs != "goal":
        text = (
            'The numbers are those of the flat observation (`obs="flat"`), sense after sense.\n\n'
        )
        return f"{text}{table(head, entry_rows(spec.senses))}\n{meanings}"
    text = "`observation` is an array of these senses:\n\n"
    text += table(head, entry_rows(spec.senses))
    for goal in spec.goals:
        text += f"\n`{goal.name}` is an array of:\n\n{table(head, entry_rows((goal,)))}"
    return f"{text}\n{meanings}"


def space_name(env: BabbleEnv) -> str:
    """The observation space without the bounds of its hundreds of numbers."""
    space = env.observation_space
    assert isinstance(space, gymnasium.spaces.Dict)
    parts = ", ".join(f"{name} {part.shape}" for name, part in space.items())
    return f"Dict of {parts}"


def presets(row: Environment) -> str:
    """The options that differ from the task's defaults."""
    return ", ".join(f"`{name}={value!r}`" for name, value in row.presets.items())


def summary(row: Environment, env: BabbleEnv) -> str:
    """The facts on one screen."""
    limit = env.interface.spec.max_episode_steps
    hz = env.interface.spec.control_hz
    time = (
        "1 step: a whole movement"
        if row.options["control"] == "pattern"
        else (f"{limit} steps ({limit / hz:g} s)")
    )
    threshold = "none" if row.reward_threshold is None else number(row.reward_threshold)
    rows = [
        ("Make it", f'`gymnasium.make("{row.id}")`, after `import gym_babble`'),
        ("Action space", f"`{env.action_space}`"),
        ("Observation space", f"`{space_name(env)}`"),
        ("Differs from the task's defaults by", presets(row) or "nothing"),
        ("Time limit", time),
        ("Return that counts as solved", threshold),
    ]
    return table(("fact", row.id), rows)


def option_table(row: Environment) -> str:
    """The keywords of `make`, with the defaults of this id."""
    rows = [
        (f"`{one.name}`", f"`{row.options[one.name]!r}`", one.summary)
        for one in TASKS[row.task].options
    ]
    rows = [("`config`", "`'paper'`", "The body and the task's numbers."), *rows]
    return table(("keyword", "default here", "meaning"), rows)


def page(row: Environment) -> str:
    """The page of an environment."""
    env = CLASSES[row.task](**row.presets)
    text = sections(row.task)
    control, does = row.options["control"], env.interface.spec.action.description
    parts = [
        f"# {row.id}",
        f"![An episode of {row.id}](../images/environments/{row.id}.gif)",
        summary(row, env),
        text[""],
        f"## Description\n\n{text['Description']}",
        f"## Action space\n\nIn the control of this id, `{control}`: {does}.",
        action_table(env),
        f"### In each control\n\n{text['Action space']}",
        f"## Observation space\n\n{observation_tables(env)}",
        f"### In each form\n\n{text['Observation space']}",
        *(f"## {name}\n\n{text[name]}" for name in AFTER_SPACES),
        option_table(row),
        f"{SHARED} are on the page [the environments](../environments.md).",
        f"## Version history\n\n{text['Version history']}",
    ]
    return "\n\n".join(parts) + "\n"


def tile(row: Environment) -> str:
    """An environment in the gallery."""
    film = f"![An episode of {row.id}](../images/environments/{row.id}.gif)"
    parts = (f"[{film}]({row.id}.md)", f"[{row.id}]({row.id}.md)", sections(row.task)[""])
    text = "\n\n".join((*parts, presets(row)))
    return f":::{{container}} tile\n{text}\n:::"


def gallery() -> str:
    """The page that shows all of them."""
    tiles = "\n".join(tile(row) for row in DOCUMENTED)
    names = "\n".join(row.id for row in DOCUMENTED)
    return f"""# Environments

{len(DOCUMENTED)} ids of {len(CLASSES)} tasks, each with its own action, reward or place.
{SHARED} are on the page [the environments](../environments.md).

::::{{container}} tiles
{tiles}
::::

```{{toctree}}
:hidden:

../environments
{names}
```
"""


def write(folder: Path) -> None:
    """Writes the pages into a folder."""
    pages = {f"{row.id}.md": page(row) for row in DOCUMENTED}
    write_pages(folder, pages | {"index.md": gallery()})
