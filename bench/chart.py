"""The picture of docs/benchmarks.md."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from matplotlib.figure import Figure

from bench.cases import BATCHES, CASES, THREADS, batch_name
from bench.process import ROOT
from gym_babble.files import write_file

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes

PICTURE = ROOT / "docs" / "images" / "benchmarks.png"
INK, FAINT, OURS, PEERS = "#1f2933", "#9aa5b1", "#1f6fb2", "#9aa5b1"
BARS = (
    ("reaching", ("reach-64-1t", "reach", "envpool-reacher", "reacher", "fetchreach")),
    (
        "grasping",
        ("grasp-64-2t", "held-64-2t", "held", "envpool-handreach", "myohandreach", "handreach"),
    ),
)
LINES = (
    ("reach", "reaching", "#1f6fb2"),
    ("grasp", "grasping", "#e0a050"),
    ("held", "object held", "#c2571a"),
)
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "text.color": INK,
}


def write(results: Mapping[str, Any]) -> None:
    """Draws the bars of ours and theirs, and cost against the number of environments."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11, 5), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        _bars(left, results["rows"])
        _lines(right, results["rows"])
        buffer = BytesIO()
        figure.savefig(buffer, format="png", dpi=150)
    write_file(PICTURE, buffer.getvalue())


def _bars(axes: Axes, rows: Mapping[str, Any]) -> None:
    heights, labels, at = [], [], 0.0
    for _, names in BARS:
        for name in names:
            if name not in rows:
                continue
            cost = rows[name]["cpu_us"]
            ours = CASES[name].venv == "ours"
            axes.barh(at, cost, color=OURS if ours else PEERS, height=0.75)
            axes.text(cost * 1.1, at, f"{cost:,.3g}" if cost < 100 else f"{cost:,.0f}", va="center")
            heights.append(at)
            labels.append(CASES[name].label.replace("`", ""))
            at += 1
        at += 0.6
    axes.set_yticks(heights, labels)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.margins(x=0.12)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("CPU time of one step [µs]")
    axes.set_title("A step of one environment: ours (blue) and peers")


def _lines(axes: Axes, rows: Mapping[str, Any]) -> None:
    for name, label, colour in LINES:
        for threads in THREADS:
            found = [(n, rows.get(batch_name(name, n, threads))) for n in BATCHES]
            points = [(n, row["clock_us"]) for n, row in found if row]
            axes.plot(
                *zip(*points, strict=True),
                color=colour,
                linestyle="--" if threads == 1 else "-",
                marker="o",
                markersize=3.5,
                label=label if threads > 1 else None,
            )
    axes.set_xscale("log", base=4)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xticks(BATCHES, [f"{n:,}" for n in BATCHES])
    axes.set_xlabel("environments, on two threads (dashed: on one)")
    axes.set_ylabel("clock time of one environment's step [µs]")
    axes.set_title("Cost against the number of environments")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3)
