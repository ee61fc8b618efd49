"""Measures stores anew and writes the pages: `make results`, or `python -m results.run NAME`."""

from __future__ import annotations

import argparse
import datetime as dt
import json
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from gym_babble.files.write import write_file
from gym_babble.study.versions import versions
from results import pages, published
from results.stores import ROOT, STORES, Stores, path_of


def measured(command: str) -> dict[str, Any]:
    """What a command prints with `--json`, and how long it took."""
    command = f"{command} --json"
    program, *words = shlex.split(command)
    program = (
        sys.executable if program == "python" else str(Path(sys.executable).with_name(program))
    )
    words = [str(ROOT / word) if (ROOT / word).is_file() else word for word in words]
    began = time.perf_counter()
    # Pictures and tables that it writes beside what it prints are not kept.
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([program, *words], cwd=folder, check=True, stdout=subprocess.PIPE)
    return {
        "command": command,
        "seconds": round(time.perf_counter() - began, 1),
        "printed": json.loads(run.stdout),
    }


def measure(name: str) -> None:
    """Runs the commands of a store one after another and writes its file."""
    runs = {}
    for run, command in STORES[name].items():
        print(f"{name}: {command}", file=sys.stderr)
        runs[run] = measured(command)
    about = {
        "date": dt.datetime.now(dt.timezone.utc).date().isoformat(),
        "versions": versions(),
    }
    write_file(path_of(name), json.dumps({"about": about, "runs": runs}, indent=1) + "\n")


def main(words: list[str]) -> None:
    """Measures the named stores, or all, and writes the pages."""
    parser = argparse.ArgumentParser(prog="results.run", description=__doc__)
    names = (*STORES, published.NAME)
    parser.add_argument("stores", nargs="*", metavar="NAME", help=f"of {', '.join(names)}; or all")
    arguments = parser.parse_args(words)
    unknown = set(arguments.stores) - set(names)
    if unknown:
        parser.error(f"{', '.join(sorted(unknown))}: not one of {', '.join(names)}")
    for name in arguments.stores or names:
        if name == published.NAME:
            published.run()
        else:
            measure(name)
    pages.write(Stores())


if __name__ == "__main__":
    main(sys.argv[1:])
