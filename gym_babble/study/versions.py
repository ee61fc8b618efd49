"""Versions of this package and of everything it runs on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from gym_babble._core import __version__

__all__ = ["EXTRAS", "versions"]

EXTRAS = {
    "sb3": ("stable-baselines3", "torch"),
    "figures": ("matplotlib", "pillow"),
    "human": ("pygame-ce",),
    "video": ("moviepy",),
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
