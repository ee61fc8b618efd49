"""Install a wheel in an empty environment and run tests of what users rely on against it.

The tests are copied out of the checkout, so that what they import is the installed package. Whoever
runs this needs uv in their Python.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parent.parent

# Gymnasium's checkers, determinism, states, pickling and forking; everything that is refused; the
# commands, of which the wheel alone serves those without pictures.
TESTS = (
    "test_bad_input.py",
    "test_config.py",
    "test_env.py",
    "test_env_reach.py",
    "test_lab.py",
    "test_toy.py",
    "test_without_extras.py",
    "test_smoke.py",
)
HELPERS = ("conftest.py", "comparing.py")
# One check opens a window, for which the wheel is installed without its extra.
SELECTION = ("-q", "-p", "no:cacheprovider", "-k", "not pictures_included")

PROBE = """
import pathlib, sys, sysconfig, gym_babble
assert pathlib.Path(gym_babble.__file__).is_relative_to(sys.prefix), gym_babble.__file__
if sysconfig.get_config_var("Py_GIL_DISABLED"):
    assert not sys._is_gil_enabled(), "importing the extension turned the GIL on"
print(gym_babble.__version__, "on", sys.version)
"""


def pins(*, oldest: bool) -> str:
    """Constraints of the newest tested releases, the oldest ones in their place if wanted."""
    newest = (CHECKOUT / "constraints.txt").read_text(encoding="utf-8")
    if not oldest:
        return newest
    old = (CHECKOUT / "constraints-oldest.txt").read_text(encoding="utf-8")
    replaced = set(re.findall(r"^([\w-]+)==", old, re.MULTILINE))
    kept = [line for line in newest.splitlines() if line.partition("==")[0] not in replaced]
    return "\n".join([*kept, old])


def environment(folder: Path, wheel: Path, python: str, *, oldest: bool) -> Path:
    """The Python of a new environment in `folder` with the wheel and what its tests need."""
    (folder / "pins.txt").write_text(pins(oldest=oldest), encoding="utf-8")
    uv = [sys.executable, "-m", "uv", "--quiet"]
    subprocess.run([*uv, "venv", "--python", python, folder / "venv"], check=True)
    scripts = "Scripts" if os.name == "nt" else "bin"
    installed = folder / "venv" / scripts / "python"
    options = ["--python", installed, "--only-binary", ":all:", "--constraint", folder / "pins.txt"]
    needs = [wheel.resolve(), "pytest", "hypothesis"]
    subprocess.run([*uv, "pip", "install", *options, *needs], check=True)
    return installed


def main() -> None:
    """Test one wheel on one Python."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--python", default=sys.executable, help="the Python to install it for")
    parser.add_argument("--oldest", action="store_true", help="with the oldest libraries supported")
    parser.add_argument("--smoke", action="store_true", help="run a few seconds of tests alone")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gym-babble-wheel-") as name:
        folder = Path(name)
        installed = environment(folder, options.wheel, options.python, oldest=options.oldest)
        shutil.copy(CHECKOUT / "pyproject.toml", folder)
        (folder / "tests").mkdir()
        tests = TESTS[-1:] if options.smoke else TESTS
        for file in (*HELPERS, *tests):
            shutil.copy(CHECKOUT / "tests" / file, folder / "tests")
        clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        for command in (
            [installed, "-W", "error", "-c", PROBE],
            [installed, "-m", "pytest", *SELECTION],
            [installed.with_name("gym-babble"), "doctor"],
        ):
            subprocess.run(command, cwd=folder, env=clean, check=True)


if __name__ == "__main__":
    main()
