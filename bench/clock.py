"""CPU time, clock time and memory of this process."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

Row = dict[str, float]
"""What a case measured, by name."""

WARM_UP_S = 0.2


def spin(
    body: Callable[[], object],
    units: int,
    seconds: float,
    *,
    restart: Callable[[], object] | None = None,
    calls: int = 1_000_000_000,
) -> Row:
    """CPU and clock time of one unit [µs], over some seconds after a warm-up.

    CPU time is that of the process and all of its threads.

    Args:
        body: What is timed, a few microseconds long or more, so that looking at the clock is
            nothing beside it.
        units: How many units one call of it does.
        seconds: How long to measure, at least one call.
        restart: Called before every `calls` calls, outside of the time.
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
    """Calls made, clock and CPU seconds, of at most `calls` calls begun within some seconds."""
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
    """Memory of this process [KiB], its share of shared pages counted (PSS).

    Raises:
        OSError: The system is not Linux.
    """
    for line in Path("/proc/self/smaps_rollup").read_text(encoding="ascii").splitlines():
        if line.startswith("Pss:"):
            return float(line.split()[1])
    raise OSError("/proc/self/smaps_rollup has no line Pss")
