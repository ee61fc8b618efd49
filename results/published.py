"""The published study: its numbers, the picture of its learning curves, and its trained agents.

`python -m results.run published` runs what is missing of it, and writes all of this anew.
"""

from __future__ import annotations

import lzma
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.agents.trained import FOLDER as TRAINED
from gym_babble.agents.trained import TRAINED as NAMES
from gym_babble.files import write_file
from gym_babble.report.charts import band_of
from gym_babble.report.data import tasks_of
from gym_babble.report.document import document_of
from gym_babble.report.texts import HEADINGS, axis_words
from gym_babble.study.store import Store, StoredRun
from gym_babble.study.trainers.sb3_models import without_learning
from gym_babble.viz.charts import draw_bands
from gym_babble.viz.style import row_of_axes, save, styled
from results import course

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parent.parent
NAME = "published"
FOLDER = ROOT / "results" / NAME
PICTURE = ROOT / "docs" / "images" / "learning.png"

DRAWN = {
    "reach": (
        *("hebb-paper", "hebb-conjunctive", "goal-babbling"),
        *("ppo", "ppo-pattern", "ppo-obstacle", "sac"),
    ),
    "grasp": ("hebb-paper", "hebb-chain", "goal-babbling", "ppo", "ppo-reflex", "ppo-in-hand"),
}
"""The learning curves in the picture, by task."""

COLOURS = {label: i for i, label in enumerate(dict.fromkeys(sum(DRAWN.values(), ())))}
"""An agent has the same colour in both panels."""


def document() -> dict[str, Any]:
    """All numbers of the study, as its report has them."""
    store = Store(FOLDER)
    return document_of(store, tasks_of(store))


def run() -> None:
    """Does what is missing of the study; writes its picture, its agents, the lessons' numbers."""
    program = Path(sys.executable).with_name("gym-babble")
    words = ("study", "run", NAME, "--out", str(FOLDER))
    subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL)
    save(curves(document()), PICTURE)
    copy_agents()
    course.write(FOLDER)


@styled
def curves(numbers: dict[str, Any]) -> Figure:
    """Success against control steps, a panel for each task."""
    figure, axes = row_of_axes((9.2, 4.2), len(DRAWN), sharey=True)
    for ax, (name, labels) in zip(axes, DRAWN.items(), strict=True):
        task = next(one for one in numbers["tasks"] if one["name"] == name)
        agents = [agent for agent in task["agents"] if agent["label"] in labels]
        lines = [
            replace(band_of(agent, "control_steps"), series=COLOURS[agent["label"]])
            for agent in sorted(agents, key=lambda agent: labels.index(agent["label"]))
        ]
        paper = (task["paper"] or {}).get("success")
        words = axis_words(task, "control_steps")
        draw_bands(ax, lines, x=words, y="success at checkpoints", log=True, dotted=paper)
        ax.set_title(HEADINGS[task["task"]])
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=7.5)
    return figure


def copy_agents() -> None:
    """Copies the agents that the package contains from the runs of the first seed.

    Those whose file is not in the study's folder stay as they are.
    """
    runs = {run.spec.name: run for run in Store(FOLDER).runs()}
    for name in NAMES:
        run = runs[f"{name}.0"]
        if run.agent is not None:
            end = ".zip" if run.agent.suffix == ".zip" else f"{run.agent.suffix}.xz"
            write_file(TRAINED / f"{name}{end}", _small(run))


def _small(run: StoredRun) -> bytes:
    """The file of a run's agent, packed; of a model only what acts."""
    assert run.agent is not None
    if run.agent.suffix != ".zip":
        return lzma.compress(run.agent.read_bytes(), preset=9 | lzma.PRESET_EXTREME)
    return without_learning(run.agent)
