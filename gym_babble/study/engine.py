"""Runs a study: which runs are missing, and processes that do them side by side.

`gym_babble.study.ray_engine` does them on several machines.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

from gym_babble.checks import check_choice, check_whole, processors, shown
from gym_babble.errors import ConfigError, StudyError
from gym_babble.study.ray_engine import run_on_ray
from gym_babble.study.run import failed, runs_of
from gym_babble.study.store import Store

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from gym_babble.study.run import RunSpec
    from gym_babble.study.spec import Study
    from gym_babble.study.watch import Watch

__all__ = ["ENGINES", "run_here", "run_study"]

ENGINES = ("local", "ray")
"""What can do the runs of a study."""

# One thread for each run: more would only wait for each other.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
LAST_WORDS = 2_000
"""Letters of a dead process's messages that are kept."""


def run_study(
    study: Study,
    folder: str | Path,
    watch: Watch,
    *,
    jobs: int | None = None,
    engine: str = "local",
    address: str | None = None,
) -> Store:
    """Does the runs of a study that its folder does not have yet, and those that failed.

    Each finished run is written at once. Stopped at any moment, a study goes on where it was.

    Args:
        study: The study.
        folder: Its folder; created if missing.
        watch: Hears how it goes on.
        jobs: Runs at a time on this machine, each in a process with one thread; one for each
            processor if not given.
        engine: One of `ENGINES`: "local" for this machine, "ray" for a cluster of Ray.
        address: Address of the cluster; as for `run_on_ray`.

    Raises:
        ConfigError: An unknown agent or engine, a number out of bounds, or an argument that the
            engine does not take.
        ConnectionError: There is no cluster at the address.
        MissingExtraError: The engine is "ray", and Ray is not installed.
        StudyError: The folder is of another study or version, or a node of the cluster is.
        OSError: A file cannot be written.
    """
    jobs = _check_engine(engine, jobs, address)
    store, specs = Store(folder), runs_of(study)
    store.open(study)
    waiting = [run.spec for run in store.runs(specs) if not run.finished]
    watch.begin(waiting, len(specs) - len(waiting), store.unfit(specs))
    if engine == "ray":
        run_on_ray(waiting, store, watch, address, ONE_THREAD)
    else:
        run_here(waiting, store, watch, jobs)
    return store


def _check_engine(engine: str, jobs: int | None, address: str | None) -> int:
    """The number of jobs on this machine, if the engine takes the arguments."""
    check_choice("engine", engine, ENGINES)
    if engine == "ray" and jobs is not None:
        raise ConfigError(f"jobs = {shown(jobs)}: a cluster of Ray uses all its processors")
    if engine == "local" and address is not None:
        raise ConfigError(f"address = {shown(address)}: only engine 'ray' takes one")
    return check_whole("jobs", processors() if jobs is None else jobs, 1, 1_024, "jobs")


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
