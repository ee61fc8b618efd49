"""CPU time, clock time and memory of this process."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

Row = dict[str, float]
"""The results of a case, by name."""

WARM_UP_S = 0.2


def spin(
    body: Callable[[], object],
    units: int,
    seconds: float,
    *,
    restart: Callable[[], object] | None = None,
    calls: int = 1_000_000_000,
) -> Row:
    """CPU and clock time of one unit [µs], measured after a warm-up.

    CPU time is that of the process and all of its threads.

    Args:
        body: Code to time. It must take a few microseconds or more, much longer than reading the
            clock.
        units: Units of work in one call.
        seconds: Duration of the measurement; at least one call is made.
        restart: Called before every `calls` calls, outside the measured time.
        calls: See `restart`.
    """
    _span(body, WARM_UP_S, restart, calls)
    done, clock, cpu = 0, 0.0, 0.0
    while done == 0 or clock < seconds:
        more = _span(body, seconds - clock, restart, calls)
        done, clock, cpu = done + more[0], clock + more[1], cpu + more[2]
    each = 1e6 / (done * units)
    return {"cpu_us": cpu * each, "clock_us": clock * each}


def _span(
    body: Callable[[], object], seconds: float, restart: Callable[[], object] | None, calls: int
) -> tuple[int, float, float]:
    """Number of calls, clock and CPU seconds, of at most `calls` calls within some seconds."""
    if restart is not None:
        restart()
    done, cpu, now = 0, time.process_time(), time.perf_counter()
    start = now
    while done < calls and (done == 0 or now - start < seconds):
        body()
        done += 1
        now = time.perf_counter()
    return done, now - start, time.process_time() - cpu


def memory_kib() -> float:
    """Memory of this process [KiB], with its part of shared pages (PSS).

    Raises:
        OSError: The system is not Linux.
    """
    for line in Path("/proc/self/smaps_rollup").read_text(encoding="ascii").splitlines():
        if line.startswith("Pss:"):
            return float(line.split()[1])
    raise OSError("/proc/self/smaps_rollup has no line Pss")
