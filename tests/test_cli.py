"""The command line: results on stdout, one line for what is wrong, exit codes."""

import csv
import json
import subprocess
import sys

import gymnasium as gym
import numpy as np
import pytest
from comparing import ENVIRONMENTS
from stable_baselines3 import PPO

from gym_babble import (
    HebbBabbling,
    evaluate,
    export_mjcf,
    export_urdf,
    load_agent,
    scenarios,
)
from gym_babble.envs.registry import TASKS
from gym_babble.study.tasks import GRASP, REACH
from gym_babble.study.trainers.sb3 import train_tuned

MOVEMENTS = "500"


@pytest.fixture
def run_json(run):
    """The document that a command prints with --json, and nothing beside it."""

    def run_json(*words):
        code, printed, _ = run(*words, "--json")
        assert code == 0
        return json.loads(printed)

    return run_json


@pytest.fixture(scope="module")
def agent_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("agents") / "icub.safetensors"
    env = gym.make("BabbleReachPattern-v0", config="icub")
    HebbBabbling(env, seed=1).learn(500).save(path)
    return path


@pytest.fixture(scope="module")
def grasping_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("agents") / "grasping.safetensors"
    HebbBabbling(gym.make("BabbleGrasp-v0", config="icub"), seed=1).learn(50).save(path)
    return path


def check_rates(rates, cases, task=REACH):
    assert rates["cases"] == cases
    assert sum(rates[name]["count"] for name in task.outcomes) == cases
    assert sum(rates[name]["rate"] for name in task.outcomes) == pytest.approx(1.0)
    for name in (*task.outcomes, *task.facts):
        assert rates[name]["low"] <= rates[name]["rate"] <= rates[name]["high"]


def test_help_needs_no_extra():
    blocked = ("matplotlib", "PIL", "moviepy", "pygame", "stable_baselines3", "torch")
    program = (
        f"import sys; sys.modules.update(dict.fromkeys({blocked}));"
        "from gym_babble.cli import main; main(['compare', '--help'])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0
    assert "--report" in run.stdout


def test_no_word_shows_the_commands(run):
    code, printed, _ = run()
    assert code == 0
    assert all(name in printed for name in ("list", "babble", "compare", "reproduce", "doctor"))


def test_list(run, run_json):
    ids = [row["id"] for row in run_json("list")]
    assert ids[: len(ENVIRONMENTS)] == [row.id for row in ENVIRONMENTS]
    _, printed, _ = run("list")
    for row, line in zip(ENVIRONMENTS, printed.splitlines()[2:], strict=False):
        solved_at = [] if row.reward_threshold is None else [f"{row.reward_threshold:g}"]
        chosen = [row.options[name] for name in ("obs", "control", "reward")]
        assert line.split() == [row.id, *chosen, str(row.max_episode_steps), *solved_at]


@pytest.mark.parametrize("row", ENVIRONMENTS, ids=lambda row: row.id)
def test_info_tells_the_spec(run, run_json, row):
    described = run_json("info", row.id)
    senses = [entry for entry in described["senses"] if "goal" not in entry["name"]]
    flat = gym.make(row.id, obs="flat", reward="sparse").observation_space
    assert sum(len(entry["labels"]) for entry in senses) == flat.shape[0]
    assert all(entry["unit"] for entry in described["senses"])
    assert described["control"] == row.options["control"]
    task = TASKS[row.task]
    assert [option["name"] for option in described["options"]] == list(task.defaults)
    assert [one["name"] for one in described["protocols"]] == list(task.protocols)
    code, printed, _ = run("info", row.id)
    assert code == 0
    assert all(entry["name"] in printed for entry in described["senses"])
    assert all(option["name"] in printed for option in described["options"])
    assert "rendered pictures [pixel]" in printed.replace("\n", " ")
    assert all(part["name"] in printed for part in described["case_parts"])
    assert len(printed.splitlines()) < 160  # A map of neurons is one row.


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ([], export_mjcf("grasp")),
        (["--format", "urdf"], export_urdf("grasp")),
        (
            ["--task", "reach", "--config", "icub", "--seed", 3],
            export_mjcf("reach", config="icub", seed=3),
        ),
        (["--timestep", 0.002], export_mjcf("grasp", timestep=0.002)),
    ],
)
def test_export(run, tmp_path, words, text):
    assert run("export", *words) == (0, text, "")
    path = tmp_path / "robot.xml"
    code, printed, said = run("export", *words, "--out", path)
    assert (code, printed) == (0, "")
    assert str(path) in said.replace("\n", "")
    assert path.read_text(encoding="utf-8") == text


def test_babble_saves_an_agent_that_evaluate_tests(run_json, tmp_path):
    path = tmp_path / "agent.safetensors"
    told = run_json("babble", "--movements", MOVEMENTS, "--seed", 3, "--out", path)
    agent = HebbBabbling.load(path)
    assert told["legal_movements"] == agent.learnt == 500
    assert told["legal_rate"] == agent.learnt_rate
    tested = run_json("evaluate", path, "--cases", 50, "--seed", 2)
    check_rates(tested, 50)
    expected = evaluate(agent, cases=scenarios("table1", 50, 2))
    assert tested["success"]["rate"] == expected.rate("success")


def test_babble_quasi_static(run_json, tmp_path):
    told = run_json("babble", "--quasi-static", "--movements", 50, "--out", tmp_path / "agent")
    assert told["quasi_static"]


def test_babble_saves_an_agent_of_grasping_that_evaluate_tests(run, run_json, tmp_path):
    path = tmp_path / "agent.safetensors"
    words = ("babble", "--task", "grasp", "--babbles", 60, "--seed", 3, "--out", path)
    told = run_json(*words)
    agent = HebbBabbling.load(path)
    assert told["kept_babbles"] == agent.learnt == 60
    assert told["kept_rate"] == agent.learnt_rate
    tested = run_json("evaluate", path, "--cases", 8, "--seed", 2)
    check_rates(tested, 8, GRASP)
    assert tested["env_id"] == "BabbleGrasp-v0"
    expected = evaluate(agent, "BabbleGrasp-v0", scenarios("palm_side", 8, 2))
    assert tested["success"]["count"] == expected.count("success")
    assert tested["palm_reach"]["count"] == sum(expected.facts["palm_reach"])
    code, printed, _ = run("evaluate", path, "--cases", 4)
    assert code == 0
    assert "of palm" in printed
    assert "the paper" not in printed  # Its tests are others.


def test_an_agent_of_grasping_acts_on_the_body_it_learnt_on(run_json, grasping_file):
    own = run_json("evaluate", grasping_file, "--cases", 12)
    assert own == run_json("evaluate", grasping_file, "--cases", 12, "--config", "icub")
    assert own["config"] == "icub"


@pytest.mark.parametrize(("name", "held"), [("scripted", 6), ("random", 0)])
def test_evaluate_agents_of_grasping_by_name(run_json, name, held):
    tested = run_json("evaluate", name, "--cases", 6, "--env-id", "BabbleGrasp-v0")
    check_rates(tested, 6, GRASP)
    assert tested["success"]["count"] == held


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGrasp-v0"])
def test_an_agent_of_the_other_task_is_refused(run, agent_file, grasping_file, env_id):
    file, task = (
        (agent_file, "reaching") if env_id == "BabbleGrasp-v0" else (grasping_file, "grasping")
    )
    code, _, told = run("evaluate", file, "--env-id", env_id)
    assert code == 2
    assert f"is not a Babble environment for {task}" in told
    assert told.count("\n") == 1


def test_a_saved_agent_is_tested_on_the_body_it_learnt_on(run, run_json, agent_file):
    own = run_json("evaluate", agent_file, "--cases", 100)
    assert own == run_json("evaluate", agent_file, "--cases", 100, "--config", "icub")
    assert (own["env_id"], own["config"]) == ("BabbleReachPattern-v0", "icub")
    code, _, told = run("evaluate", agent_file, "--config", "paper")
    assert code == 2
    assert "the test's config has" in told
    stepwise = run_json("evaluate", agent_file, "--cases", 5, "--env-id", "BabbleReach-v0")
    assert stepwise["control"] == "delta_posture"
    posture = run_json("evaluate", agent_file, "--cases", 5, "--control", "posture")
    assert posture["control"] == "posture"


@pytest.mark.parametrize("name", ["random", "scripted", "oracle"])
@pytest.mark.parametrize("env_id", ["BabbleReachPattern-v0", "BabbleReach-v0"])
def test_evaluate_agents_by_name(run_json, name, env_id):
    tested = run_json("evaluate", name, "--cases", 20, "--env-id", env_id)
    assert tested["env_id"] == env_id
    check_rates(tested, 20)


def test_evaluate_splits_differ(run_json):
    random = ("evaluate", "random", "--cases", 100)
    test, validation = run_json(*random), run_json(*random, "--split", "validation")
    assert test["success"] != validation["success"]


def test_evaluate_prints_the_papers_rates_beside(run):
    code, printed, _ = run("evaluate", "scripted", "--cases", 20)
    assert code == 0
    assert ".670" in printed
    assert "scripted" in printed


@pytest.mark.parametrize(
    ("env_id", "task"), [("BabbleReachPattern-v0", REACH), ("BabbleGrasp-v0", GRASP)]
)
def test_evaluate_a_model_of_stable_baselines3(run, run_json, tmp_path, env_id, task):
    path = tmp_path / "model.zip"
    train_tuned("ppo", env_id, steps=1).save(path)
    tested = run_json("evaluate", path, "--cases", 6)
    check_rates(tested, 6, task)
    assert tested["env_id"] == env_id
    assert tested == run_json("evaluate", path, "--cases", 6, "--env-id", env_id)
    PPO("MlpPolicy", "Pendulum-v1", device="cpu").save(path)
    where = ("--env-id", "BabbleReach-v0")
    code, _, told = run("evaluate", path, *where)
    assert code == 2
    assert "--env-id and --control" in told
    code, _, told = run("evaluate", path, *where, "--control", "posture")
    assert code == 2
    assert "observations" in told


def test_reproduce_table1(run_json, run, tmp_path):
    words = ("reproduce", "table1", "--seeds", 2, "--cases", 50, "--movements", MOVEMENTS)
    document = run_json(*words, "--out", tmp_path)
    assert document == json.loads((tmp_path / "table1.json").read_text(encoding="utf-8"))
    with (tmp_path / "table1.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert [row["seed"] for row in document["by_seed"]] == [0, 1]
    for row in document["by_seed"]:
        check_rates(row, 50)
    rates = [row["success"]["rate"] for row in document["by_seed"]]
    found = document["over_seeds"]["success"]
    assert found["mean"] == pytest.approx(np.mean(rates))
    assert [found["min"], found["max"]] == sorted(rates)
    second = run_json(*words[:2], "--seed", 1, "--seeds", 1, *words[4:], "--out", tmp_path)
    assert second["by_seed"] == document["by_seed"][1:]
    assert [float(line["success"]) for line in lines] == [
        row["success"]["rate"] for row in document["by_seed"]
    ]
    code, printed, _ = run(*words, "--control", "delta_posture", "--out", tmp_path)
    assert code == 0
    assert "range of seeds" in printed
    assert "success +" in printed or "success -" in printed  # z.


@pytest.mark.parametrize("figure", ["fig2", "fig4", "fig5"])
def test_reproduce_figures(run, tmp_path, figure):
    path = tmp_path / f"{figure}.png"
    learning = () if figure == "fig2" else ("--movements", 1000)
    code, _, _ = run("reproduce", figure, "--out", path, *learning)
    assert code == 0
    assert path.read_bytes().startswith(b"\x89PNG")


def test_figures_print_their_counts(run_json, tmp_path):
    words = ("--movements", 1000, "--out", tmp_path / "figure.png")
    counts = run_json("reproduce", "fig4", *words)
    assert counts["cases"] == 144
    assert set(counts["reached"]) == {"agent", "straight", "random", "scripted"}
    sets = run_json("reproduce", "fig5", *words)
    assert min(sets["left"], sets["right"]) > 0
    assert 0 < sets["mirror_correlation"] <= 1


def test_reproduce_table2(run_json, tmp_path):
    words = ("reproduce", "table2", "--seeds", 1, "--cases", 2, "--babbles", 10)
    words += ("--hold-trials", 1, "--out", tmp_path)
    document = run_json(*words)
    assert document == json.loads((tmp_path / "table2.json").read_text(encoding="utf-8"))
    with (tmp_path / "table2.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    grid = [size["tests"]["table2"]["by_seed"][0] for size in document["sizes"]]
    told = [int(line["cases"]) for line in lines if line["protocol"] == "table2"]
    assert told == [found["cases"] for found in grid]


def test_the_chain_takes_the_tests_of_table_2(run, run_json, tmp_path):
    few = ("--babbles", 2, "--variant", "chain")
    words = ("reproduce", "table2", "--seeds", 1, "--cases", 2, "--hold-trials", 0)
    document = run_json(*words, *few, "--out", tmp_path)
    assert document["variant"] == "chain"
    assert all(size["tests"]["table2"]["by_seed"][0]["cases"] for size in document["sizes"])
    path = tmp_path / "agent"
    assert run_json("babble", "--task", "grasp", *few, "--out", path)["variant"] == "chain"
    assert load_agent(path).variant == "chain"
    code, _, told = run("reproduce", "table2", "--variant", "conjunctive", "--out", tmp_path)
    assert (code, "conjunctive" in told) == (2, True)


@pytest.mark.parametrize("figure", ["fig7", "fig8", "sight"])
def test_reproduce_figures_of_grasping(run, tmp_path, figure):
    path = tmp_path / f"{figure}.png"
    learning = () if figure == "sight" else ("--babbles", 20)
    code, _, _ = run("reproduce", figure, "--out", path, *learning)
    assert code == 0
    assert path.read_bytes().startswith(b"\x89PNG")


def test_doctor(run, run_json):
    found = run_json("doctor")
    assert found["same_bits"]
    assert found["build"] == "release"
    assert found["unconverged_steps"] == 0
    code, printed, _ = run("doctor")
    assert code == 0
    assert "correct" in printed
    assert "0 of 12,800 physics steps" in printed


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["info", "BabbleReach-v9"], "BabbleReach-v0"),
        (["info", "BabbleReach-v0", "--config", "octopus"], "octopus"),
        (["info", "BabbleReach-v0", "--config", "none.toml"], "none.toml"),
        (["evaluate", "nobody"], "nobody"),
        (["evaluate", "random", "--env-id", "Pendulum-v1"], "Pendulum-v1"),
        (["evaluate", "no_module:Agent"], "no module 'no_module'"),
        (["evaluate", "random", "--cases", "0"], "--cases"),
        (["evaluate", "random", "--cases", "many"], "--cases"),
        (["evaluate", "random", "--split", "learning"], "--split"),
        (["evaluate", "random", "--control", "levitate"], "levitate"),
        (["evaluate", "random", "--vec-normalize", "no.pkl"], "not a zip"),
        (["compare", "--seed", "-1"], "--seed"),
        (["reproduce", "table1", "--seed", "-1"], "--seed"),
        (["evaluate", "random", "--seed", "-1"], "--seed"),
        (["babble", "--out", "nowhere/agent"], "nowhere"),
        (["babble"], "--out"),
        (["babble", "--out", "agent", "--variant", "other"], "--variant"),
        (["babble", "--out", "agent", "--movements", "0"], "--movements"),
        (["babble", "--out", "agent", "--task", "fly"], "--task"),
        (["compare", "--agents", "hebb-paper,nobody"], "nobody"),
        (["compare", "--agents", ""], "agents[0].agent is empty"),
        (["compare", "--task", "grasp", "--agents", "hebb-conjunctive"], "can do none of grasp"),
        (["compare", "--task", "grasp", "--budget", "0"], "--budget"),
        (["study", "run", "nothing", "--out", "x"], "is not one of"),
        (["study", "run", "nothing.toml", "--out", "x"], "nothing.toml"),
        (["study", "resume", "nowhere"], "not the folder of a study"),
        (["study", "report", "nowhere", "--out", "x"], "not the folder of a study"),
        (["compare", "--task", "fly"], "--task"),
        (["compare", "--seeds", "0"], "--seeds"),
        (["reproduce", "fig3"], "fig3"),
        (["reproduce", "fig5", "--out", "picture.xyz"], "picture.xyz"),
        (["reproduce", "table1", "--control", "torque"], "--control"),
        (["export", "--format", "sdf"], "--format"),
        (["export", "--timestep", "0"], "timestep = 0 is not above 0 s"),
        (["export", "--config", "thin.toml"], "thin.toml"),
        (["export", "--out", "no/robot.xml"], "no/robot.xml"),
        (["dance"], "dance"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(run, monkeypatch, tmp_path, words, said):
    monkeypatch.chdir(tmp_path)
    code, printed, told = run(*words)
    assert code == 2
    assert not printed
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert said in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("content", [b"", b"not an agent", b"PK\x05\x06" + bytes(18)])
def test_a_broken_agent_file_is_named(run, tmp_path, content):
    path = tmp_path / "broken"
    path.write_bytes(content)
    code, _, told = run("evaluate", path, "--env-id", "BabbleReachPattern-v0")
    assert code == 2
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert "broken" in told


def test_a_cut_agent_file_is_named(run, tmp_path, agent_file):
    path = tmp_path / "cut"
    path.write_bytes(agent_file.read_bytes()[:-100])
    code, _, told = run("evaluate", path)
    assert code == 2
    assert "cut" in told


def test_a_missing_extra_is_named_before_any_work(run, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for words in (["compare", "--report", tmp_path / "r"], ["reproduce", "fig4"]):
        code, printed, told = run(*words)
        assert code == 1
        assert not printed
        assert "gym-babble[figures]" in told
        assert told.count("\n") == 1
