"""Runs a study: which runs are missing, and processes that do them side by side."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any, Protocol

from gym_babble.checks import check_whole, processors
from gym_babble.errors import StudyError
from gym_babble.study.run import failed, runs_of
from gym_babble.study.store import Store

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from gym_babble.study.run import RunSpec
    from gym_babble.study.spec import Study

__all__ = ["Watch", "run_here", "run_study"]

# One thread for each run: more would only wait for each other.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
LAST_WORDS = 2_000
"""Letters of a dead process's messages that are kept."""


class Watch(Protocol):
    """Hears how a study goes on. Its methods are called from several threads."""

    def begin(self, waiting: Sequence[RunSpec], done: int, unfit: Sequence[str]) -> None:
        """Which runs will be done, how many are done already, and what does not fit."""

    def progress(self, spec: RunSpec, share: float) -> None:
        """What share of a run's learning is done."""

    def end(self, spec: RunSpec, record: dict[str, Any]) -> None:
        """A run is finished, or has failed."""


def run_study(
    study: Study,
    folder: str | Path,
    watch: Watch,
    *,
    jobs: int | None = None,
) -> Store:
    """Does the runs of a study that its folder does not have yet, and those that failed.

    Each finished run is written at once. Stopped at any moment, a study goes on where it was.

    Args:
        study: The study.
        folder: Its folder; created if missing.
        watch: Hears how it goes on.
        jobs: Runs at a time, each in a process with one thread; one for each processor if not
            given.

    Raises:
        ConfigError: An unknown agent, or a number out of bounds.
        StudyError: The folder is of another study or version.
        OSError: A file cannot be written.
    """
    jobs = check_whole("jobs", processors() if jobs is None else jobs, 1, 1_024, "jobs")
    store, specs = Store(folder), runs_of(study)
    store.open(study)
    waiting = [run.spec for run in store.runs(specs) if not run.finished]
    watch.begin(waiting, len(specs) - len(waiting), store.unfit(specs))
    run_here(waiting, store, watch, jobs)
    return store


def run_here(waiting: Sequence[RunSpec], store: Store, watch: Watch, jobs: int) -> None:
    """Does the runs in processes on this machine."""
    running: set[subprocess.Popen[str]] = set()
    pool = ThreadPoolExecutor(jobs)
    try:
        futures = [pool.submit(_in_process, spec, store, watch, running) for spec in waiting]
        for future in as_completed(futures):
            future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(running):
            process.kill()
        pool.shutdown()


def _in_process(
    spec: RunSpec, store: Store, watch: Watch, running: set[subprocess.Popen[str]]
) -> None:
    """Does a run in a process of its own, whose end leaves a record whatever happens."""
    order = json.dumps({"spec": spec.to_json(), "store": str(store.folder)})
    with TemporaryFile("w+", encoding="utf-8", errors="replace") as messages:
        process = subprocess.Popen(
            [sys.executable, "-m", "gym_babble.study.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=messages,
            text=True,
            env={**os.environ, **ONE_THREAD},
        )
        running.add(process)
        with process:
            assert process.stdin is not None
            assert process.stdout is not None
            process.stdin.write(order)
            process.stdin.close()
            for line in process.stdout:
                watch.progress(spec, float(line))
        running.remove(process)
        (run,) = store.runs([spec])
        record = run.record
        if process.returncode or record is None:
            messages.seek(0)
            said = messages.read()[-LAST_WORDS:]
            if "No space left" in said:
                raise StudyError(f"{store.folder}: {said.strip().splitlines()[-1]}")
            record = failed(spec, f"the process ended with code {process.returncode}", said)
            store.write(spec, record, None)
    watch.end(spec, record)
