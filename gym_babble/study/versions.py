"""Versions of this package and of everything it runs on, and the machine."""

from __future__ import annotations

import platform
import re
from functools import cache
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from gym_babble._core import __version__
from gym_babble.checks import processors
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv

__all__ = ["EXTRAS", "code_hash", "machine", "physics_hash", "versions"]

EXTRAS = {
    "sb3": ("stable-baselines3", "torch"),
    "figures": ("matplotlib", "pillow"),
    "human": ("pygame-ce",),
    "video": ("moviepy",),
    "study": ("jinja2", "scipy"),
    "ray": ("ray",),
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


@cache
def physics_hash() -> str:
    """Hash of what both tasks show in 20 steps of seed 0: the same for the same physics.

    It is the same on every machine, and does not depend on the form of snapshots.
    """
    digest = blake2b(digest_size=8)
    for env in (BabbleReachEnv(obs="flat"), BabbleGraspEnv(obs="flat", control="posture")):
        shown, _ = env.reset(seed=0)
        action = np.full_like(env.action_space.sample(), 0.25)
        for step in range(20):
            digest.update(shown.astype("<f4").tobytes())
            action[0] = 0.1 * (step % 7) - 0.3
            shown, reward, *_ = env.step(action)
            digest.update(np.array(reward, "<f8").tobytes())
    return digest.hexdigest()


@cache
def code_hash() -> str:
    """Hash of this package's Python sources."""
    root = Path(__file__).parent.parent
    digest = blake2b(digest_size=8)
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()
