"""Every experiment of the docs runs, on a small budget, and ends in its last line."""

import json
import re
import runpy
import shlex
import sys

import pytest
import torch

RUNS = {
    "film_babble.py": (
        "--movements 500 --babbles 100 --out {folder}/babble.gif",
        r".+/babble\.gif: \d+ kB",
    ),
    "film_chain.py": (
        "--babbles 5 200 --width 160 --out {folder}/chain.gif --strip {folder}/chain.png",
        r".+/chain\.gif: \d+ kB",
    ),
    "tune.py": (
        "sac BabbleReachGoal-v0 --steps 300 --seeds 1 --cases 20 --trials 2 --out {folder}",
        r"best of 2: [01]\.\d{3} with \{.+\}",
    ),
    "sensitivity.py": (
        "--seeds 1 --cases 20 --movements 50",
        r"\| 2,000 movements( \| \d\.\d{3}){4} \|",
    ),
    "grasp_sizes.py": (
        "--trials 2 --diameters 2.4",
        r"\| 2\.4 \| \d\.\d\d \| .+ \| \d+, \d+ \| \d+ of 441 \|",
    ),
    "solvable.py": (
        "--cases 3 --ids BabbleReachGoal-v0",
        r"\| `BabbleReachGoal-v0` \| pattern \| \d\.\d{3} \| \d\.\d{3} \|",
    ),
    "convergence.py": ("--steps 640", r"posture: 0 in 640 control steps"),
    "grasp_chain.py": (
        "--seeds 0 --babbles 5 --trials 50 --cases 2 --diameters 6 --more 6",
        r"\{'seed': 0, .+ 'held': [01]\.\d, .+\}",
    ),
    "grasp_carry.py": (
        "--seeds 1 --babbles 5 --cases 2 --diameters 6",
        r"\{'seed': 0, .+ 'carried': [01]\.\d, .+\}",
    ),
    "grasp_basin.py": (
        "--trials 2 --diameters 2.4 --places 2.6 3.8 1.2 --figure {folder}/basin.png",
        r"\| 2\.4 \| 3\.8 \| 1\.00 \|",
    ),
    "grasp_movements.py": (
        "--babbles 0 5 --seeds 1 --cases 2 --diameters 6",
        r"\{'babbles': 5, .+ 'held': \{'6 cm': [01]\.\d\}\}",
    ),
    "grasp_sides.py": ("--cases 12", r"\| all \| 12 \| \d\.\d\d \| \d\.\d\d \|"),
    "grasp_interference.py": (
        "--seeds 1 --babbles 12 --cases 8",
        r"\| both, xi 0\.8 \| 6 cm \|.+\|",
    ),
    "grasp_learning_period.py": (
        "--seeds 1 --babbles 6 --every 60",
        r"\| 0\.05 \| \d\.\d+ \| .+ \|",
    ),
    "obstacle_alone.py": (
        "--cases 40 --tests 20 --seeds 1 --movements 20",
        r"\| any \| \d\.\d{3} \| \d\.\d{3} \|",
    ),
    "readouts.py": (
        "--bodies icub --movements 20 --seeds 1 --tests 10",
        r"\| icub \| obstacle x eye, Hebb \| peak \| 20 \| \d\.\d{3} \| \d\.\d{3} \|",
    ),
    "changed_body.py": (
        (
            "--movements 20 --repair 10 --ppo 512 --ppo-repair 512 --seeds 1 --tests 9 "
            "--changes 'elbow to 100°'"
        ),
        r"\| PPO \| elbow to 100° \| there alone \| \d\.\d{3} \| \d\.\d{3} \|",
    ),
    "own_chain.py": (
        "--babbles 5 --cases 4 --seeds 1",
        r"seed 0, 50 babbles, 6 cm: held [01]\.\d{3}",
    ),
}
# What a run prints depends on its bits, and two threads of PyTorch on a busy machine are slow.
torch.set_num_threads(1)


def test_every_experiment_runs_and_is_listed(repository):
    folder = repository / "docs" / "experiments"
    found = {path.name for path in folder.glob("*.py")}
    assert found == RUNS.keys()
    listed = re.findall(
        r"^\| \[(\w+\.py)\]\(\1\) \|", (folder / "README.md").read_text("utf-8"), re.MULTILINE
    )
    assert sorted(listed) == sorted(found)


@pytest.mark.parametrize("name", RUNS)
def test_last_line(name, repository, monkeypatch, capsys, tmp_path):
    arguments, expected = RUNS[name]
    words = shlex.split(arguments.format(folder=tmp_path))
    path = repository / "docs" / "experiments" / name
    monkeypatch.syspath_prepend(str(path.parent))  # As for `python docs/experiments/NAME`.
    monkeypatch.setattr(sys, "argv", [str(path), *words])
    runpy.run_path(str(path), run_name="__main__")
    last = capsys.readouterr().out.strip().splitlines()[-1]
    assert re.fullmatch(expected, last), last


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("sensitivity.py", {"change", "success", "collision", "joint_limit", "legal_rate"}),
        ("grasp_sizes.py", {"diameter", "held", "edges"}),
        ("grasp_chain.py", {"diameter_cm", "held", "kept", "control_steps"}),
        ("grasp_carry.py", {"diameter_cm", "carried", "held", "distance_cm"}),
        ("grasp_movements.py", {"babbles", "units", "straightness", "palm_first", "held"}),
        ("grasp_sides.py", {"rows", "all"}),
        ("solvable.py", {"id", "control", "cases", "scripted", "oracle"}),
        ("convergence.py", {"delta_posture", "posture"}),
        ("grasp_interference.py", {"babbled_with", "mean", "spread", "babbled", "in_hand"}),
    ],
)
def test_an_experiment_prints_json(name, keys, repository, monkeypatch, capsys):
    path = repository / "docs" / "experiments" / name
    monkeypatch.setattr(sys, "argv", [str(path), *shlex.split(RUNS[name][0]), "--json"])
    runpy.run_path(str(path), run_name="__main__")
    printed = json.loads(capsys.readouterr().out)
    assert keys <= set(printed[0] if isinstance(printed, list) else printed)
