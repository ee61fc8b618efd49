"""The short form of a study."""

import json

import pytest
from rich.console import Console
from studying import run

from gym_babble.cli import main
from gym_babble.errors import ConfigError
from gym_babble.study import roster
from gym_babble.study.results import results_json, task_table
from gym_babble.study.roster import ROSTER
from gym_babble.study.run import runs_of
from gym_babble.study.short import comparison, usual_agents
from gym_babble.study.spec import read_study
from gym_babble.study.specs import SPECS
from gym_babble.study.tasks import TASKS


@pytest.mark.parametrize("task", TASKS)
def test_it_is_a_study_of_one_task(task):
    study = comparison(task, seed=3, seeds=2, cases=5, budget=1_000, config="icub")
    assert [agent.agent for agent in study.agents] == list(usual_agents(task))
    assert all(task in ROSTER[agent.agent].tasks for agent in study.agents)
    (spec,) = study.tasks.values()
    assert (spec.task, spec.config, spec.cases, spec.case_seed) == (task, "icub", 5, 1_000)
    assert study.seeds == (3, 4)
    assert all(one.budget in {0, 1_000} for one in runs_of(study))


def test_who_needs_a_missing_extra_is_left_out_unless_named(monkeypatch):
    monkeypatch.setattr(roster, "find_spec", lambda _: None)
    left = {name for name, extra in usual_agents("reach").items() if extra == "sb3"}
    assert left == {name for name in usual_agents("reach") if name.startswith(("ppo", "sac"))}
    assert not left & {agent.agent for agent in comparison("reach").agents}
    assert [agent.agent for agent in comparison("reach", ["ppo"]).agents] == ["ppo"]


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"task": "fly"}, "task = 'fly'"),
        ({"agents": []}, "at least one"),
        ({"cases": 0}, "cases = 0"),
        ({"budget": 0}, "budget = 0"),
        ({"seed": -1}, "seed = -1"),
        ({"seeds": 0}, "1 to 1000 seeds"),
        ({"config": "pepper"}, "pepper"),
    ],
)
def test_a_wrong_argument_is_named(arguments, match):
    with pytest.raises(ConfigError, match=match):
        comparison(**arguments)


def test_the_tables_fit_80_characters_and_lose_nothing(tmp_path):
    for task in TASKS:
        study = comparison(task, ["hebb-paper", "random", "a:B"], seeds=2, cases=6, budget=5_000)
        store, _ = run(study, tmp_path / task)
        console = Console(width=80)
        with console.capture() as capture:
            console.print(task_table(study, store.runs(), task))
        told = capture.get()
        assert "…" not in told
        assert max(map(len, told.splitlines())) <= 80
        for words in ("Hebb paper", "Random", "seed 0", "seed 1", "a:B: there is no module 'a'"):
            assert words in " ".join(told.split())
        document = json.loads(json.dumps(results_json(study, store.runs()), allow_nan=False))
        agents = document["tasks"][task]["agents"]
        for row in (agents["hebb-paper"], agents["random"]):
            for seed in row["by_seed"]:
                assert sum(seed[name]["count"] for name in TASKS[task].outcomes) == 6
            rates = [seed["success"]["rate"] for seed in row["by_seed"]]
            assert row["test"]["success"]["mean"] == pytest.approx(sum(rates) / 2)
        assert agents["hebb-paper"]["cost"]["control_steps"] >= 5_000
        assert agents["B"]["test"] is None
        assert "no module" in agents["B"]["by_seed"][0]["error"]


@pytest.mark.parametrize("name", SPECS)
def test_the_studies_of_the_package_can_run(name):
    study = read_study(name)
    assert study.name == name
    labels = {spec.agent.label for spec in runs_of(study)}
    assert labels == {agent.label for agent in study.agents}


def test_compare_prints_and_writes_its_report(tmp_path, capsys):
    pytest.importorskip("jinja2", reason="the wheel's tests install no extra")
    folder = tmp_path / "report"
    words = ["compare", "--agents", "hebb-paper,random", "--cases", "6", "--budget", "5000"]
    words += ["--report", str(folder), "--json"]
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert not ended.value.code
    printed = json.loads(capsys.readouterr().out)
    assert list(printed["tasks"]["reach"]["agents"]) == ["hebb-paper", "random"]
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert f"gym-babble compare --report {folder} --task reach --agents hebb-paper,random" in page
    assert (folder / "study" / "study.json").exists()
    numbers = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    mine = printed["tasks"]["reach"]["agents"]["hebb-paper"]["test"]["success"]["mean"]
    (task,) = numbers["tasks"]
    assert task["agents"][0]["rates"]["success"] == pytest.approx(mine)
