"""Runs one case in its own process."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.cases import OURS, RUST, SERVED

if TYPE_CHECKING:
    from bench.cases import Case
    from bench.clock import Row

ROOT = Path(__file__).resolve().parent.parent
VENVS = ROOT / ".venv-bench"
LONGEST_S = 300.0
CRITERION = re.compile(r"bench:\s+([\d,]+) ns/iter")


class CaseError(RuntimeError):
    """A case that could not be measured."""


def interpreter(venv: str) -> str:
    """The Python of a case."""
    return sys.executable if venv in (OURS, SERVED) else str(VENVS / venv / "bin" / "python")


def measure(case: Case, seconds: float) -> Row:
    """Measures a case and returns its results by name.

    Raises:
        CaseError: The case failed, took too long or printed no result.
    """
    if case.venv != RUST:
        job = {"function": case.function, "arguments": case.arguments, "seconds": seconds}
        worker = [interpreter(case.venv), "-m", "bench.worker"]
        # Some packages write logs to where they run.
        with tempfile.TemporaryDirectory() as folder:
            return _last_json(_output(worker, json.dumps(job), folder))
    crate, _, bench = case.function.partition(":")
    command = ["cargo", "bench", "--quiet", "--package", crate, "--bench", bench, "--"]
    if "row" not in case.arguments:
        return _last_json(_output([*command, *case.arguments.values(), str(seconds)]))
    times = ["--warm-up-time", "0.2", "--measurement-time", str(seconds)]
    row = ["--exact", case.arguments["row"], "--output-format", "bencher"]
    found = CRITERION.search(printed := _output([*command, *row, *times]))
    if found is None:
        raise CaseError(f"criterion printed {printed!r}")
    return {"clock_us": int(found[1].replace(",", "")) / 1e3}


def _output(command: list[str], given: str | None = None, folder: str | Path = ROOT) -> str:
    try:
        done = subprocess.run(
            command,
            input=given,
            capture_output=True,
            text=True,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"},
            timeout=LONGEST_S,
            check=True,
        )
    except subprocess.TimeoutExpired as error:
        raise CaseError(f"longer than {LONGEST_S:g} s") from error
    except subprocess.CalledProcessError as error:
        said = [line for line in (error.stderr or error.stdout).splitlines() if line.strip()]
        raise CaseError(said[-1] if said else f"exit status {error.returncode}") from error
    return done.stdout


def _last_json(printed: str) -> Row:
    """The last line, because some libraries print their own lines before it."""
    try:
        row: Any = json.loads(printed.strip().rpartition("\n")[2])
    except json.JSONDecodeError as error:
        raise CaseError(f"no result in {printed[-200:]!r}") from error
    return {name: float(value) for name, value in row.items()}
