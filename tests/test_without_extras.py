"""What works without PyTorch, and without any extra: all but PPO, and all but pictures too."""

import subprocess
import sys

import pytest

PYTORCH = ("stable_baselines3", "torch")
PICTURES = ("matplotlib", "PIL", "moviepy", "pygame", "scipy", "jinja2", "yaml")
FEW = ("--cases", "8")
TABLES = (
    ("list",),
    ("info", "BabbleGrasp-v0"),
    ("doctor",),
    ("babble", "--movements", "250", "--out", "agent.safetensors"),
    ("evaluate", "agent.safetensors", *FEW),
    ("compare", "--budget", "50000", *FEW),
    ("compare", "--task", "grasp", "--budget", "5000", *FEW),
    ("reproduce", "table1", "--seeds", "1", "--movements", "250", *FEW),
    ("export",),
)
FIGURES = (
    ("compare", "--budget", "300000", "--report", "report", *FEW),
    ("reproduce", "fig2"),
    ("reproduce", "fig5", "--movements", "1000"),
    ("record", "scripted", "--out", "film.mp4", "--size", "160", "--fps", "2"),
)
PROGRAM = """
import sys
from importlib.machinery import PathFinder

class Hiding(PathFinder):
    # As if these were not installed.
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        hidden = name.partition(".")[0] in {blocked}
        return None if hidden else PathFinder.find_spec(name, path, target)

sys.meta_path[sys.meta_path.index(PathFinder)] = Hiding
import gymnasium, gym_babble
from gym_babble.cli import main
gymnasium.make("BabbleGrasp-v0", render_mode="rgb_array").reset()
for words in {commands}:
    try:
        main(words)
    except SystemExit as ended:
        assert not ended.code, words
"""


@pytest.mark.parametrize(
    ("blocked", "commands"),
    [(PYTORCH, FIGURES), ((*PYTORCH, *PICTURES), TABLES)],
    ids=["without PyTorch", "without any extra"],
)
def test_the_commands_run(blocked, commands, tmp_path):
    if commands == FIGURES:
        pytest.importorskip("matplotlib", reason="the wheel's tests install no extra")
    program = PROGRAM.format(blocked=blocked, commands=commands)
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
