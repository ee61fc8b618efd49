"""The virtual environments of the peers, and the machine of a run."""

from __future__ import annotations

import json
import platform
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

from bench.cases import OURS
from bench.process import ROOT, VENVS, interpreter
from gym_babble.checks import processors

PACKAGES = {
    OURS: ("gym-babble", "gymnasium", "numpy"),
    "gym": ("gymnasium", "mujoco"),
    "robotics": ("gymnasium-robotics", "gymnasium", "mujoco"),
    "envpool": ("envpool",),
    "myo": ("MyoSuite", "mujoco"),
    "openenv": ("openenv",),
    "rpc": ("dm-env-rpc", "rlmesh"),
}
"""Packages that a report names, by virtual environment."""
VERSIONS = (
    "import sys, json, importlib.metadata as m;"
    "print(json.dumps({name: m.version(name) for name in sys.argv[1:]}))"
)


def install(venv: str, python: str) -> None:
    """Creates the virtual environment of a peer from its requirements, unless it exists.

    Raises:
        FileNotFoundError: The Python is not installed.
        CalledProcessError: pip failed.
    """
    wanted = (ROOT / "bench" / f"requirements-{venv}.txt").read_text(encoding="utf-8")
    stamp = VENVS / venv / "requirements.txt"
    if stamp.exists() and stamp.read_text(encoding="utf-8") == wanted:
        return
    if shutil.which(python) is None:
        raise FileNotFoundError(
            f"{python} not found: the peers' packages are pinned for Python 3.11; name another "
            "with --python"
        )
    shutil.rmtree(VENVS / venv, ignore_errors=True)
    subprocess.run([python, "-m", "venv", str(VENVS / venv)], check=True)
    new = VENVS / venv / "wanted.txt"
    new.write_text(wanted, encoding="utf-8")
    pip = [interpreter(venv), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "--requirement", str(new)], check=True)
    new.rename(stamp)


def describe() -> dict[str, Any]:
    """Processor, system and versions, but neither the machine's nor the user's name."""
    return {
        "date": time.strftime("%Y-%m-%d"),
        "cpu": _processor(),
        "cores": processors(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "rustc": _printed(["rustc", "--version"]).split()[1],
        "versions": {
            venv: json.loads(_printed([interpreter(venv), "-c", VERSIONS, *names]))
            for venv, names in PACKAGES.items()
        },
    }


def _processor() -> str:
    try:
        facts = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2] for line in facts.splitlines() if line.startswith("model name")]
    return " ".join(names[0].split()) if names else platform.processor()


def _printed(command: list[str]) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout
