"""The docs' tables from bench/results.json; `python -m bench.report` rewrites them."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bench.cases import BATCHES, CASES, LARGE_BATCHES, SERVED, THREADS, batch_name
from bench.process import ROOT
from gym_babble.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

Results = dict[str, Any]
PAGES = ("docs/benchmarks.md", "docs/scaling.md", "README.md")
BLOCK = re.compile(r"(<!-- bench: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
NOT_MEASURED = "–"
CONTROL_HZ = 20
"""Steps of an environment in a second of simulated time."""


@dataclass(frozen=True)
class Mark:
    """A target for one or several rows."""

    text: str
    ours: tuple[str, ...]
    """The rows; the worst one counts."""
    bound: float
    unit: str
    key: str = "cpu_us"
    peer: str | None = None
    """The peer than which ours must be `bound` times cheaper; without a peer, ours must be at most
    `bound`."""
    scale: float = 1.0
    """Factor from the row's unit to the mark's unit."""

    def measured(self, rows: Mapping[str, Any]) -> float | None:
        """The value to compare with the bound; None if a row is missing."""
        needed = (*self.ours, *([self.peer] if self.peer else []))
        if not all(name in rows for name in needed):
            return None
        worst = max(rows[name][self.key] for name in self.ours)
        found: float = rows[self.peer][self.key] / worst if self.peer else worst * self.scale
        return found

    def met(self, measured: float) -> bool:
        """Whether the value meets the bound."""
        return measured >= self.bound if self.peer else measured <= self.bound


def cheaper(text: str, ours: str, bound: float, peer: str) -> Mark:
    """A target relative to a peer."""
    return Mark(text, (ours,), bound, "×", peer=peer)


MARKS = (
    cheaper("reaching, 64, beside EnvPool `Reacher-v5`, 64", "reach-64-1t", 6, "envpool-reacher"),
    cheaper("reaching, 64, beside `FetchReach-v4`", "reach-64-1t", 150, "fetchreach"),
    cheaper("reaching, single, beside `Reacher-v5`, single", "reach", 3, "reacher"),
    cheaper(
        "object held, 64, beside EnvPool `HandReach-v3`, 64", "held-64-2t", 3, "envpool-handreach"
    ),
    cheaper("object held, 64, beside `myoHandReachRandom-v0`", "held-64-2t", 3, "myohandreach"),
    *(
        cheaper(
            f"physics step, {degrees} degrees of freedom, {scene}, beside MuJoCo's",
            f"physics-{scene}-{degrees}",
            1,
            f"mujoco-{scene}-{degrees}",
        )
        for degrees in (9, 18)
        for scene in ("free", "held")
    ),
    cheaper("the same, as an aim", "physics-held-18", 2, "mujoco-held-18"),
    Mark("the fovea's edges, in Rust", ("fovea-beside", "fovea-over"), 20, "µs", "clock_us"),
    Mark("the eye's image, 630 × 630", ("eye-reach", "eye-grasp"), 0.4, "ms", scale=1e-3),
    Mark(
        "`rgb_array`, 480 × 480", ("third_person-reach", "third_person-grasp"), 3, "ms", scale=1e-3
    ),
    Mark("reset with a given case", ("reset-reach", "reset-grasp"), 60, "µs"),
    Mark("`RemoteEnv`, reaching, a step", ("wire-reach",), 100, "µs", "clock_us"),
    Mark(
        "`RemoteEnv`, reaching, beside OpenEnv's client and server",
        ("wire-reach",),
        5,
        "×",
        "clock_us",
        peer="wire-openenv",
    ),
    Mark("`RemoteVectorEnv`, reaching, 64, a step of one", ("wire-reach-64",), 4, "µs", "clock_us"),
    Mark(
        "`RemoteVectorEnv`, object held, 64, beside the local batch",
        ("wire-held-64",),
        0.9,
        "×",
        "clock_us",
        peer="wire-local-held-64",
    ),
    Mark(
        "memory of a reaching environment",
        tuple(f"memory-reach-{n}" for n in LARGE_BATCHES),
        8,
        "KiB",
        "kib",
    ),
    Mark(
        "memory of a grasping environment",
        tuple(f"memory-{state}-{n}" for state in ("grasp", "held") for n in LARGE_BATCHES),
        256,
        "KiB",
        "kib",
    ),
)


def number(value: float | None) -> str:
    """The value with three digits."""
    if value is None:
        return NOT_MEASURED
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:#.3g}".rstrip(".")


def markdown(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def marks(results: Results) -> str:
    """The targets and the results."""
    rows = []
    for mark in MARKS:
        found = mark.measured(results["rows"])
        sign = "≥" if mark.peer else "≤"
        verdict = NOT_MEASURED if found is None else "met" if mark.met(found) else "**missed**"
        measured = number(found) if found is None else f"{number(found)} {mark.unit}"
        rows.append([mark.text, f"{sign} {mark.bound:g} {mark.unit}", measured, verdict])
    return markdown(["", "mark", "measured", ""], rows)


def machine(results: Results) -> str:
    """The machine of the run."""
    about = results["about"]
    versions = about["versions"]
    peers = ", ".join(
        f"{package} {version}"
        for venv in ("gym", "robotics", "envpool", "myo", "openenv", "rpc")
        for package, version in versions[venv].items()
        if (venv, package) != ("robotics", "gymnasium")
    )
    return (
        f"{about['cpu']}, {about['cores']} cores, {about['system']}, {about['date']}, load "
        f"{about['load_before']:.2f} before.\nMedians of {about['rounds']} rounds of "
        f"{about['seconds']:g} s. Python {about['python']}, rustc {about['rustc']}; {peers}.\n"
    )


PEERS = (
    "floor-64",
    "floor",
    "reach-64-1t",
    "reach",
    "envpool-reacher",
    "reacher",
    "fetchreach",
    "grasp-64-2t",
    "grasp",
    "held-64-2t",
    "held",
    "envpool-handreach",
    "handreach",
    "myohandreach",
)
"""Rows of the table of peers, by task."""


def peers(results: Results) -> str:
    """Our environments and the peers'."""
    rows = []
    for name in PEERS:
        case, row = CASES[name], results["rows"].get(name, {})
        label = (
            f"**{case.label}**" if name.startswith(("reach-", "grasp-", "held-")) else case.label
        )
        step = f"{case.step_ms:g} ms / {case.physics_steps}" if case.step_ms else NOT_MEASURED
        clock = row.get("clock_us")
        rate = NOT_MEASURED if clock is None else f"{float(f'{1e6 / clock:.3g}'):,.0f}"
        rows.append([label, step, number(row.get("cpu_us")), rate])
    return markdown(["environment", "simulated / physics steps", "CPU µs a step", "steps/s"], rows)


def batches(results: Results) -> str:
    """Cost against the number of environments and threads."""
    heads = [
        "environments",
        *(f"{name}, {t} t" for name in ("reach", "grasp", "held") for t in THREADS),
    ]
    rows = []
    for n in BATCHES:
        cells = [
            results["rows"].get(batch_name(name, n, threads), {})
            for name in ("reach", "grasp", "held")
            for threads in THREADS
        ]
        rows.append(
            [
                f"{n:,}",
                *(f"{number(c.get('cpu_us'))} / {number(c.get('clock_us'))}" for c in cells),
            ]
        )
    return markdown(heads, rows)


def physics(results: Results) -> str:
    """Ours, rapier's and MuJoCo's."""
    rows = []
    for degrees in (9, 18):
        for scene in ("free", "held"):
            ours, rapier, mujoco = (
                results["rows"].get(f"{engine}-{scene}-{degrees}", {}).get("cpu_us")
                for engine in ("physics", "rapier", "mujoco")
            )
            times = f"{number(mujoco / ours)} ×" if ours and mujoco else NOT_MEASURED
            label = CASES[f"physics-{scene}-{degrees}"].label
            rows.append([label, number(ours), number(rapier), number(mujoco), times])
    heads = ["CPU µs a physics step", "ours", "rapier", "MuJoCo", "MuJoCo / ours"]
    return markdown(heads, rows)


OTHERS = re.compile("^(reset|edges|eye|fovea|third_person|memory)-")


def others(results: Results) -> str:
    """Resets, pictures and memory."""
    rows = []
    for name, case in CASES.items():
        if not OTHERS.match(name):
            continue
        row = results["rows"].get(name, {})
        if name.startswith("memory"):
            rows.append(
                [f"memory of an environment: {case.label}", f"{number(row.get('kib'))} KiB"]
            )
        else:
            rows.append([case.label, f"{number(row.get('cpu_us', row.get('clock_us')))} µs"])
    return markdown(["other", "measured"], rows)


def wire(results: Results) -> str:
    """Round trips over loopback."""
    rows = []
    for name, case in CASES.items():
        if not name.startswith("wire-") or name == "wire-sessions":
            continue
        row = results["rows"].get(name, {})
        clock = row.get("clock_us")
        rate = NOT_MEASURED if clock is None else f"{float(f'{1e6 / clock:.3g}'):,.0f}"
        times = (number(row.get(key)) for key in ("p50_us", "p99_us", "cpu_us"))
        label = f"**{case.label}**" if case.venv == SERVED else case.label
        rows.append([label, *times, rate])
    heads = ["client and server", "p50 µs", "p99 µs", "CPU µs a step, both", "steps/s"]
    return markdown(heads, rows)


def sessions(results: Results) -> str:
    """Sessions at once."""
    row = results["rows"].get("wire-sessions")
    if row is None:
        return f"{NOT_MEASURED}\n"
    rate = float(f"{1e6 / row['clock_us']:.3g}")
    return (
        f"64 sessions at once, each with one environment and a client of its own: "
        f"{rate:,.0f} steps/s in all. The slowest session had "
        f"{row['slowest']:.2f} of the mean rate, the fastest {row['fastest']:.2f}.\n"
    )


def scaling(results: Results) -> str:
    """Sessions that a core carries."""
    row = results["rows"].get("wire-sessions")
    if row is None:
        return f"{NOT_MEASURED}\n"
    carried = float(f"{1e6 / (row['server_us'] * CONTROL_HZ):.2g}")
    return (
        "With 64 sessions at once, each with one environment that reaches, a step costs the server "
        f"{row['server_us']:.0f} µs of a core. By that a core carries some {carried:,.0f} such "
        f"sessions that play in real time, {CONTROL_HZ} steps a second.\n"
    )


def speed(results: Results) -> str:
    """The README's few rows."""
    reaching = ("reach-64-1t", "envpool-reacher", "reach", "reacher", "fetchreach")
    grasping = ("held-64-2t", "envpool-handreach", "myohandreach")
    rows = [
        [CASES[name].label, number(results["rows"].get(name, {}).get("cpu_us"))]
        for name in (*reaching, *grasping)
    ]
    return markdown(["", "CPU µs a step"], rows)


BLOCKS: dict[str, Callable[[Results], str]] = {
    block.__name__: block
    for block in (marks, machine, peers, batches, physics, others, wire, sessions, scaling, speed)
}
"""The blocks between `<!-- bench: NAME -->` and `<!-- end -->` in the pages."""


def filled(page: str, results: Results) -> str:
    """The page with its blocks made from the results."""
    return BLOCK.sub(lambda found: found[1] + BLOCKS[found[2]](results) + found[3], page)


def write(results: Results) -> None:
    """Writes the blocks of all pages."""
    for name in PAGES:
        path = ROOT / name
        write_file(path, filled(path.read_text(encoding="utf-8"), results))


if __name__ == "__main__":
    from bench import chart

    stored = json.loads((ROOT / "bench" / "results.json").read_text(encoding="utf-8"))
    write(stored)
    chart.write(stored)
