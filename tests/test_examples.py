"""Every example runs, on a small budget, and ends in the line that its reader waits for."""

import json
import re
import runpy
import shlex
import sys

import pytest
import torch

RUNS = {
    "film.py": (
        "--movements 500 --babbles 100 --out {folder}/babble.gif",
        r".+/babble\.gif: \d+ kB",
    ),
    "film_chain.py": (
        "--babbles 5 200 --width 160 --out {folder}/chain.gif --strip {folder}/chain.png",
        r".+/chain\.gif: \d+ kB",
    ),
    "hebb_reach.py": (
        "--movements 250 --cases 50",
        r"success 0\.\d+ \[0\.\d+, .+\] \(paper: 0\.67\)",
    ),
    "curves.py": ("--cases 20", r"success 0\.\d+ \[0\.\d+, .+\]"),
    "own_rule.py": (
        "--movements 20 --cases 20",
        r"covariance: success 0\.\d+ \[0\.\d+, .+\]",
    ),
    "custom_body.py": (
        "--movements 100 --cases 30 --kd 10 40",
        r"K_D 40: lag 0\.80 s, legal 0\.\d+, success 0\.\d+, .+",
    ),
    "ppo_reach.py": ("--steps 512 --cases 20", r"success 0\.\d+ \[0\.\d+, .+\]"),
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
    "cleanrl_ppo.py": (
        "--steps 2000 --num-envs 16",
        r"success [01]\.\d\d in the last \d+ episodes",
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
    "own_chunk.py": (
        "--babbles 5 --cases 4 --seeds 1",
        r"chunk: held [01]\.\d{3} \([01]\.\d{3}\)",
    ),
    "sac_her.py": ("--steps 4000 --cases 20", r"success 0\.\d+ \[0\.\d+, .+\]"),
}
ELSEWHERE = {"rllib_ppo.py", "openenv_client.py"}
"""One has an environment of its own (`make frameworks`), one needs a server (test_openenv.py)."""

# What a run prints depends on its bits, and two threads of PyTorch on a busy machine are slow.
torch.set_num_threads(1)


def test_every_example_runs_somewhere(repository):
    found = {path.name for path in (repository / "examples").glob("*.py")}
    assert found == RUNS.keys() | ELSEWHERE


@pytest.mark.parametrize("name", RUNS)
def test_last_line(name, repository, monkeypatch, capsys, tmp_path):
    arguments, expected = RUNS[name]
    words = shlex.split(arguments.format(folder=tmp_path))
    path = repository / "examples" / name
    monkeypatch.syspath_prepend(str(path.parent))  # As for `python examples/NAME`.
    monkeypatch.setattr(sys, "argv", [str(path), *words])
    runpy.run_path(str(path), run_name="__main__")
    last = capsys.readouterr().out.strip().splitlines()[-1]
    assert re.fullmatch(expected, last), last


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("curves.py", {"success", "low", "high"}),
        ("own_rule.py", {"hebb", "oja", "covariance"}),
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
    path = repository / "examples" / name
    monkeypatch.setattr(sys, "argv", [str(path), *shlex.split(RUNS[name][0]), "--json"])
    runpy.run_path(str(path), run_name="__main__")
    printed = json.loads(capsys.readouterr().out)
    assert keys <= set(printed[0] if isinstance(printed, list) else printed)
