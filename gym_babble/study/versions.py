"""Versions of this package and of everything it runs on, and the machine."""

from __future__ import annotations

import platform
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from gym_babble._core import __version__
from gym_babble.checks import processors

__all__ = ["EXTRAS", "machine", "versions"]

EXTRAS = {
    "sb3": ("stable-baselines3", "torch"),
    "figures": ("matplotlib", "pillow"),
    "human": ("pygame-ce",),
    "video": ("moviepy",),
    "study": ("scipy",),
}
"""The extras, with the packages of each."""


def versions() -> dict[str, str | None]:
    """Versions of Python, this package, its dependencies and extras; None if not installed."""
    packages = ("gymnasium", "numpy", *(name for extra in EXTRAS.values() for name in extra))
    found = {"gym-babble": __version__, "python": platform.python_version()}
    return {**found, **{name: _version(name) for name in packages}}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def machine() -> dict[str, str | int]:
    """System, architecture, processor, and number of processors."""
    return {
        "system": platform.system(),
        "architecture": platform.machine(),
        "processor": _processor(),
        "processors": processors(),
    }


def _processor() -> str:
    """The processor's name where the system tells it; Linux tells it in a file only."""
    try:
        told = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        told = ""
    names = re.findall(r"model name\s*:\s*(.+)", told)
    return str(names[0]) if names else platform.processor()
