"""Runs the snippets of docs/frameworks.md that need an environment of their own.

Called with a name in ENVIRONMENTS, by that environment's Python: `make frameworks`.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENTS = {
    "learners": ("stable-baselines3", "rl-zoo3", "TorchRL", "skrl", "Tianshou", "Minari"),
    "rllib": ("RLlib",),
    "lerobot": ("LeRobot",),
    "openenv": ("OpenEnv",),
}
"""The sections that each environment runs."""


def section(text: str, name: str) -> str:
    """The section of the page whose heading begins with a name."""
    found = re.search(rf"^## {re.escape(name)} .*?(?=^## )", text, re.MULTILINE | re.DOTALL)
    if found is None:
        sys.exit(f"docs/frameworks.md has no section {name}")
    return found[0]


def commands(name: str) -> list[list[str]]:
    """What to run for a section: its Python by this Python, and its commands with it."""
    text = section((ROOT / "docs" / "frameworks.md").read_text(encoding="utf-8"), name)
    blocks = re.findall(r"^```(python|sh)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    runners = {"python": (sys.executable, "-c"), "sh": ("bash", "-ec")}
    return [[*runners[language], code] for language, code in blocks]


def main() -> None:
    """Runs the sections one after the other, and stops at the first that fails."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    for name in ENVIRONMENTS[sys.argv[1]]:
        print(f"== {name}", flush=True)
        for command in commands(name):
            with tempfile.TemporaryDirectory() as folder:
                # Minari keeps datasets in the home folder, and refuses to write one twice.
                env = {**os.environ, "MINARI_DATASETS_PATH": folder, "PATH": path}
                subprocess.run(command, cwd=folder, check=True, env=env)


if __name__ == "__main__":
    main()
