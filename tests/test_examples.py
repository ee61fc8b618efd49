"""Every example runs, on a small budget, and ends in the line that its reader waits for."""

import json
import re
import runpy
import sys
from functools import partial
from importlib.metadata import version

import pytest
import torch

from gym_babble.study import compare, ppo

RUNS = {
    "film.py": (
        "--movements 500 --babbles 100 --out {folder}/babble.gif",
        r".+/babble\.gif: \d+ kB",
    ),
    "learning_curves.py": (
        "--movements 500 --cases 20 --agents hebb-paper hebb-conjunctive --out {folder}/curves.png",
        r"Hebb conjunctive, obstacle × eye: 0\.\d+ after [\d,]+ control steps, 0\.\d+ on the tests",
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
    "ppo_study.py": (
        "--out {folder} --presets pattern delta_posture --seeds 1 --steps 512 --cases 20",
        r"\| delta_posture \| 512 \| 1 \| .+ \|",
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
    "sac_her.py": ("--steps 4000 --cases 20", r"success 0\.\d+ \[0\.\d+, .+\]"),
}
ELSEWHERE = {"rllib_ppo.py"}
"""Has its own environment: `make frameworks`."""

# What a run prints depends on its bits, and two threads of PyTorch on a busy machine are slow.
torch.set_num_threads(1)


def test_every_example_runs_somewhere(repository):
    found = {path.name for path in (repository / "examples").glob("*.py")}
    assert found == RUNS.keys() | ELSEWHERE


@pytest.mark.parametrize("name", RUNS)
def test_last_line(name, repository, monkeypatch, capsys, tmp_path):
    arguments, expected = RUNS[name]
    path = repository / "examples" / name
    monkeypatch.setattr(sys, "argv", [str(path), *arguments.format(folder=tmp_path).split()])
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
        ("grasp_sides.py", {"rows", "all"}),
        ("solvable.py", {"id", "control", "cases", "scripted", "oracle"}),
        ("grasp_interference.py", {"babbled_with", "mean", "spread", "babbled", "in_hand"}),
    ],
)
def test_an_experiment_prints_json(name, keys, repository, monkeypatch, capsys):
    path = repository / "examples" / name
    monkeypatch.setattr(sys, "argv", [str(path), *RUNS[name][0].split(), "--json"])
    runpy.run_path(str(path), run_name="__main__")
    printed = json.loads(capsys.readouterr().out)
    assert keys <= set(printed[0] if isinstance(printed, list) else printed)


def test_what_a_study_of_grasping_writes_is_what_compare_shows(
    repository, monkeypatch, capsys, tmp_path
):
    path = repository / "examples" / "ppo_study.py"
    monkeypatch.setattr(ppo, "train_ppo", partial(ppo.train_ppo, validation_cases=2))
    words = f"--task grasp --seeds 1 --steps 1 --cases 6 --out {tmp_path}"
    monkeypatch.setattr(sys, "argv", [str(path), *words.split()])
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out.strip().splitlines()[-1].startswith("| grasp | 1 | 1 |")
    study = json.loads((tmp_path / "ppo_grasp.json").read_text(encoding="utf-8"))
    assert study["command"] == f"python examples/ppo_study.py {words}"
    monkeypatch.setattr(compare, "STUDIES", tmp_path)
    settings = compare.Settings(task="grasp", cases=1)
    (result,) = compare.compare(["ppo-stored"], settings).results
    (run,) = study["runs"]
    (rates,) = result.rates_by_seed
    assert rates["cases"] == run["counts"]["cases"] == 6
    assert rates["timeout"]["count"] == run["counts"]["timeout"]
    assert sum(part["cases"] for part in run["by_size"].values()) == 6
    assert result.trained[0].control_steps == run["control_steps"] == 8_192


def test_a_study_goes_on_with_the_runs_that_are_missing(repository, monkeypatch, capsys, tmp_path):
    path = repository / "examples" / "ppo_study.py"

    def study(*words):
        arguments = f"--presets pattern --steps 512 --cases 20 --out {tmp_path}".split()
        monkeypatch.setattr(sys, "argv", [str(path), *arguments, *words])
        runpy.run_path(str(path), run_name="__main__")
        capsys.readouterr()
        return json.loads((tmp_path / "ppo_reach.json").read_text(encoding="utf-8"))["runs"]

    first = study("--seeds", "1-1")
    assert [run["seed"] for run in first] == [1]
    both = study("--seeds", "2", "--resume")
    assert [run["seed"] for run in both] == [0, 1]
    assert both[1] == first[0]  # Its seconds too: it did not run again.
    for run in both:
        assert run["versions"]["torch"] == version("torch")
        assert run["machine"]["torch_threads"] == 1
        assert run["validation"]["split"] == "validation"
    assert [run["seed"] for run in study("--seeds", "1")] == [0]
    with pytest.raises(SystemExit, match="number of cases"):
        study("--seeds", "1", "--resume", "--cases", "21")
