"""Pages of the API: for the public modules of the package, and for the crates."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from writing import write_pages

import gym_babble

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "gym_babble"
INTERNAL = ("checks", "cli", "files", "progress")
"""What the package shares with itself. The command line documents itself: `--help`."""
IMPORTED = re.compile(r"^ *(?:from|import) (gym_babble(?:\.\w+)*)", re.MULTILINE)
PAGES = {
    "gym_babble": ("",),
    "envs": ("envs", "envs.registry", "envs.interface", "envs.spaces"),
    "config": ("config",),
    "agents": ("agents", "agents.base", "agents.deciding", "agents.loading"),
    "brain": ("brain",),
    "course": ("course", "course.published", "course.palm"),
    "study": (
        *(
            "study.scenarios",
            "study.evaluation",
            "study.outcomes",
            "study.movements",
            "study.tasks",
        ),
        *("study.spec", "study.run", "study.store", "study.statistics", "study.efficiency"),
        *("study.two_agents", "study.logs", "study.versions", "study.tuned"),
        *("study.trainers.base", "study.trainers.sb3"),
    ),
    "report": ("report",),
    "viz": (
        "viz.episode",
        "viz.scenes",
        "viz.panel",
        "viz.film",
        "viz.video",
    ),
    "paper": tuple(f"paper.{path.stem}" for path in sorted((PACKAGE / "paper").glob("[a-z]*.py"))),
    "sb3": ("sb3",),
    "rllib": ("rllib",),
    "remote": ("remote",),
    "export": ("export",),
    "lab": ("lab",),
    "errors": ("errors",),
}
"""The modules on each page, from most to least used."""


def top_level() -> list[str]:
    """The public modules and packages directly in gym_babble."""
    modules = [path.stem for path in PACKAGE.glob("[a-z]*.py")]
    packages = [path.parent.name for path in PACKAGE.glob("[a-z]*/__init__.py")]
    return sorted(name for name in (*modules, *packages) if name not in INTERNAL)


def undocumented() -> list[str]:
    """Public modules, and modules that README, how-to guides or examples import, without a page."""
    documented = {"gym_babble", *(f"gym_babble.{name}" for part in PAGES.values() for name in part)}
    pages = [
        ROOT / "README.md",
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / "docs/how-to").glob("*.md"),
    ]
    examples = (ROOT / "examples").rglob("*.py")
    texts = (path.read_text(encoding="utf-8") for path in (*pages, *examples))
    met = {module for text in texts for module in IMPORTED.findall(text)}
    inside = {name for name in met if name.split(".")[1:2] and name.split(".")[1] in INTERNAL}
    public = {f"gym_babble.{name}" for name in top_level() if name not in PAGES}
    packages = {
        name for name in met if not public_names(name.removeprefix("gym_babble").lstrip("."))
    }
    return sorted((public | met) - inside - packages - documented)


def source(module: str) -> Path:
    """The file of a module; "" is the package."""
    path = PACKAGE.joinpath(*module.split(".")) if module else PACKAGE
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def public_names(module: str) -> list[str]:
    """The names that a module declares public and that `gym_babble` does not have."""
    for statement in ast.parse(source(module).read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "__all__":
            names = ast.literal_eval(statement.value)
            above = gym_babble.__all__ if module else ()
            return [name for name in names if name not in above and not name.startswith("_")]
    return []


def page(name: str, modules: tuple[str, ...]) -> str:
    """A page, in reStructuredText."""
    title = name if name == "gym_babble" else f"gym_babble.{name}"
    parts = [f"{title}\n{'=' * len(title)}"]
    for module in modules:
        path = f"gym_babble.{module}".rstrip(".")
        if len(modules) > 1:
            parts.append(f"{path}\n{'-' * len(path)}")
        # Constants need a line each: autodoc passes over those that have no text of their own.
        constants = [name for name in public_names(module) if name.isupper()]
        others = {"__version__", *constants, *(gym_babble.__all__ if module else ())}
        parts.append(f".. automodule:: {path}\n   :members:\n   :undoc-members:")
        parts[-1] += f"\n   :exclude-members: {', '.join(sorted(others))}"
        parts += [f".. autodata:: {path}.{name}\n   :no-value:" for name in constants]
    return "\n\n".join(parts) + "\n"


def summary(module: str) -> str:
    """The first line of a module's docstring."""
    text = ast.get_docstring(ast.parse(source(module).read_text(encoding="utf-8"))) or ""
    return text.split("\n\n")[0].replace("\n", " ")


def crates() -> dict[str, str]:
    """The crates that cargo documents by default, without bindings, and what each is."""
    workspace = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    (members,) = re.findall(r"^default-members = \[(.+)\]$", workspace, re.MULTILINE)
    found = {}
    for folder in re.findall(r'"([^"]+)"', members):
        text = (ROOT / folder / "Cargo.toml").read_text(encoding="utf-8")
        # The first of each is the package's.
        name, description = (
            re.findall(rf'^{key} = "(.+)"$', text, re.MULTILINE)[0]
            for key in ("name", "description")
        )
        found[name] = description
    return found


def index(names: list[str]) -> str:
    """The list of modules and crates, in Markdown."""
    modules = "\n".join(
        f"| [gym_babble{f'.{name}' * (name != 'gym_babble')}]({name}.rst) | "
        f"{summary('' if name == 'gym_babble' else name)} |"
        for name in names
    )
    rust = "\n".join(
        f"| [{name}](../rust/{name}/index.html) | {doc} |" for name, doc in crates().items()
    )
    return f"""# API

## Python

| module | about |
| --- | --- |
{modules}

The command line documents itself: `gym-babble --help`.

## Rust

[ARCHITECTURE.md](../../ARCHITECTURE.md) says how they depend on each other.

| crate | about |
| --- | --- |
{rust}

```{{toctree}}
:hidden:

{chr(10).join(names)}
```
"""


def write(folder: Path) -> None:
    """Writes the pages into a folder."""
    here = {name: modules for name, modules in PAGES.items() if source(modules[0]).is_file()}
    pages = {f"{name}.rst": page(name, modules) for name, modules in here.items()}
    write_pages(folder, pages | {"index.md": index(list(here))})
