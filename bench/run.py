"""Measures all rows in rounds, and makes the docs' tables and picture from them: `make bench`.

Each row runs in its own process. Rounds are interleaved, every row once and then every row again,
so that a slow minute of the machine affects all rows. The result is the median of a row's rounds.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from bench import chart, machine, report
from bench.cases import CASES, OURS, RUST, SERVED, Case
from bench.process import ROOT, VENVS, CaseError, measure
from gym_babble import _core
from gym_babble.files import write_file

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.clock import Row

RESULTS = ROOT / "bench" / "results.json"
PART = VENVS / "part.json"
"""Results of a run of selected rows."""
SAMPLES = VENVS / "samples.jsonl"
"""Measurements of the last run so far."""
OVERHEAD_S = 1.6
"""Average time to start a process and prepare its row."""
QUIET_LOAD = 0.5

console = Console(stderr=True)


class Samples:
    """The measurements of a run, in a file from which an interrupted run can continue.

    The first line describes the run; each other line is a measurement. Failed rows are measured
    again.
    """

    def __init__(self, run: dict[str, Any], *, resume: bool) -> None:
        self.rows: dict[str, list[Row]] = {}
        self.errors: dict[tuple[int, str], str] = {}
        self.done: set[tuple[int, str]] = set()
        if resume and not SAMPLES.exists():
            raise SystemExit("error: --resume: there is no run to go on with")
        lines = SAMPLES.read_text(encoding="utf-8").splitlines() if resume else []
        if lines and json.loads(lines[0]) != run:
            raise SystemExit("error: --resume: the last run had other rows, rounds or seconds")
        for line in lines[1:]:
            self._take(json.loads(line))
        self._lines = lines or [json.dumps(run)]
        self._write()

    def add(self, turn: int, name: str, row: Row | None, error: str | None) -> None:
        """Adds a measurement and writes it to the file."""
        sample = {"turn": turn, "name": name, "row": row, "error": error}
        self._take(sample)
        self._lines.append(json.dumps(sample))
        self._write()

    def _write(self) -> None:
        write_file(SAMPLES, "\n".join(self._lines) + "\n")

    def _take(self, sample: dict[str, Any]) -> None:
        key = sample["turn"], sample["name"]
        if sample["row"] is None:
            self.errors[key] = sample["error"]
            return
        self.errors.pop(key, None)
        self.done.add(key)
        self.rows.setdefault(sample["name"], []).append(sample["row"])

    def medians(self) -> dict[str, dict[str, Any]]:
        """The medians of each row, and the first figure of each of its rounds."""
        return {name: _median(self.rows[name]) for name in CASES if name in self.rows}


def _median(rows: Sequence[Row]) -> dict[str, Any]:
    first = next(iter(rows[0]))
    middle = {key: statistics.median(row[key] for row in rows) for key in rows[0]}
    rounded: dict[str, Any] = {key: float(f"{value:.4g}") for key, value in middle.items()}
    return rounded | {"rounds": [float(f"{row[first]:.4g}") for row in rows]}


def prepare(cases: Sequence[Case], python: str) -> None:
    """Installs the peers and builds the Rust benchmarks that the rows need."""
    if _core.debug_build:
        raise SystemExit("error: the extension is a debug build: `make setup` builds it anew")
    VENVS.mkdir(exist_ok=True)
    for venv in sorted({case.venv for case in cases} - {OURS, RUST, SERVED}):
        with console.status(f"installing {venv} into {VENVS.name}/{venv}"):
            machine.install(venv, python)
    if any(case.name.startswith("wire-") for case in cases):
        console.print("building the server")
        subprocess.run(["cargo", "build", "--release", "--package", "babble_server"], check=True)
    for function in sorted({case.function for case in cases if case.venv == RUST}):
        crate, _, bench = function.partition(":")
        console.print(f"building the benchmark {bench} of {crate}")
        build = ["cargo", "bench", "--no-run", "--quiet", "--package", crate, "--bench", bench]
        subprocess.run(build, cwd=ROOT, check=True)


def play(cases: Sequence[Case], seconds: float, rounds: int, samples: Samples) -> None:
    """Measures every case once in each round."""
    left = [
        (turn, case)
        for turn in range(rounds)
        for case in cases
        if (turn, case.name) not in samples.done
    ]
    expected = len(left) * (seconds + OVERHEAD_S) / 60
    console.print(
        f"{len(cases)} rows, {rounds} rounds, {seconds:g} s each: about {expected:.0f} minutes"
    )
    columns = (
        TextColumn("{task.description:24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, speed_estimate_period=600.0) as progress:
        bar = progress.add_task("", total=len(left))
        for turn, case in left:
            progress.update(bar, description=case.name)
            try:
                row, error = measure(case, seconds), None
            except CaseError as problem:
                row, error = None, str(problem)
                console.print(f"{case.name}: {error}", style="red", markup=False)
            samples.add(turn, case.name, row, error)
            progress.advance(bar)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m bench.run", description=__doc__)
    parser.add_argument("--only", metavar="REGEX", default="", help="rows whose name matches")
    parser.add_argument("--seconds", type=float, default=1.0, help="measured time of a row")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--resume", action="store_true", help="go on with the last run")
    parser.add_argument("--python", default="python3.11", help="for the peers' environments")
    parser.add_argument("--list", action="store_true", help="print the names of the rows")
    given = parser.parse_args()
    if not 0 < given.seconds < math.inf:
        parser.error(f"--seconds {given.seconds}: must be positive and finite")
    if given.rounds < 1:
        parser.error(f"--rounds {given.rounds}: must be at least 1")
    try:
        found = any(re.search(given.only, name) for name in CASES)
    except re.error as error:
        parser.error(f"--only {given.only!r}: {error}")
    if not found:
        parser.error(f"--only {given.only!r}: matches no row; --list prints them")
    return given


def finish(samples: Samples, run: dict[str, Any], *, whole: bool) -> int:
    """Writes the results; after a whole run, the docs too."""
    rows = samples.medians()
    for name, row in rows.items():
        figures = "  ".join(f"{key} {row[key]:g}" for key in row if key != "rounds")
        print(f"{name:24}  {figures}")
    for (_, name), error in samples.errors.items():
        print(f"{name:24}  failed: {error}")
    results = {"about": machine.describe() | run if whole else run, "rows": rows}
    text = json.dumps(results, indent=1, ensure_ascii=False) + "\n"
    write_file(RESULTS if whole else PART, text)
    if whole:
        report.write(results)
        chart.write(results)
    return 1 if samples.errors else 0


def main() -> int:
    """Measures all or the selected rows, and writes the results."""
    given = arguments()
    cases = [case for case in CASES.values() if re.search(given.only, case.name)]
    names = [case.name for case in cases]
    if given.list:
        print("\n".join(names))
        return 0
    load = os.getloadavg()[0]
    if load > QUIET_LOAD:
        console.print(f"the machine is busy (load {load:.2f}): figures will be too high")
    try:
        prepare(cases, given.python)
    except (OSError, subprocess.CalledProcessError) as error:
        raise SystemExit(f"error: {error}") from error
    run = {"seconds": given.seconds, "rounds": given.rounds}
    samples = Samples({"names": names, **run}, resume=given.resume)
    try:
        play(cases, given.seconds, given.rounds, samples)
    except KeyboardInterrupt:
        console.print("stopped; --resume goes on from here")
        return 130
    return finish(samples, {"load_before": round(load, 2), **run}, whole=not given.only)


if __name__ == "__main__":
    sys.exit(main())
