"""Studies: their files, their runs, what is stored, and what a stop at any moment leaves."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from studying import GRASP, REACH, results, run, small

from gym_babble import HebbBabbling, evaluate, scenarios
from gym_babble.errors import ConfigError, StudyError
from gym_babble.study.results import test_tally as tally_of
from gym_babble.study.roster import ROSTER
from gym_babble.study.run import RunSpec, checkpoints, execute, runs_of
from gym_babble.study.spec import read_study, study_of
from gym_babble.study.store import Store

OWN = '''
import numpy as np

class Learner:
    """Learns one number: the mean of what it tried with success."""

    env = "BabbleReachPattern-v0"

    def __init__(self, env, seed=0):
        self.env, self.mean, self.count = env, np.zeros(2), 0
        self.random = np.random.default_rng(seed)
        print("an agent prints what it likes")

    def learn(self, control_steps):
        for _ in range(max(1, control_steps // 224)):
            self.env.reset(seed=int(self.random.integers(2**32)))
            action = self.random.uniform(-1, 1, 2).astype(np.float32)
            _, reward, *_ = self.env.step(action)
            if reward > 0:
                self.count += 1
                self.mean += (action - self.mean) / self.count

    def predict(self, observation):
        return self.mean.astype(np.float32)

class Counts(Learner):
    """Learns elsewhere, and says what it used."""

    control_steps = trials = 0

    def learn(self, control_steps):
        self.control_steps += control_steps
        self.trials += 1

class Idle(Learner):
    def learn(self, control_steps):
        pass

class Broken(Learner):
    def learn(self, control_steps):
        raise RuntimeError("no\\nway")

class Dies(Learner):
    def learn(self, control_steps):
        import os, sys
        print("last words", file=sys.stderr, flush=True)
        os._exit(3)

class NoNumber(Learner):
    def predict(self, observation):
        return np.full(2, np.nan, np.float32)
'''


@pytest.fixture
def own(tmp_path, monkeypatch):
    (tmp_path / "own_learners.py").write_text(OWN, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return "own_learners"


def only_reaching(*agents, **changes):
    return small(list(agents), tasks={"reach": REACH}, **changes)


def test_a_study_is_its_file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        'name = "small"\nseeds = 2\n[tasks.reach]\nprotocol = "table1"\ncases = 20\n'
        'checkpoint_cases = 10\nbudget = 20000\n[[agents]]\nagent = "hebb-paper"\n'
        '[[agents]]\nagent = "hebb-paper"\nlabel = "slow"\nseeds = [7]\n'
        'settings = {rule = "oja"}\n',
        encoding="utf-8",
    )
    study = read_study(path)
    slow = {"agent": "hebb-paper", "label": "slow", "settings": {"rule": "oja"}, "seeds": [7]}
    assert study == only_reaching("hebb-paper", slow, seeds=2)
    assert study_of(study.to_json()) == study
    as_json = tmp_path / "study.json"
    as_json.write_text(json.dumps(study.to_json()), encoding="utf-8")
    assert read_study(as_json) == study
    assert [spec.name for spec in runs_of(study)] == [
        *("reach.hebb-paper.0", "reach.slow.7", "reach.hebb-paper.1")
    ]


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"nmae": "x"}, r"nmae: unknown field; .*did you mean 'name'"),
        ({"name": "a/b"}, "name = 'a/b' is not a name"),
        ({"seeds": 0}, r"seeds = 0 is not a whole number in \[1, 1000\]"),
        ({"seeds": [1, 1]}, "each once"),
        ({"agents": []}, "at least one of tasks and one of agents"),
        ({"agents": ["hebb-paper", "hebb-paper"]}, r"agents\[1\].label = 'hebb-paper' is there"),
        ({"agents": [{"agent": "random", "budgt": 1}]}, r"budgt: .*did you mean 'budget'"),
        ({"agents": [{"agent": "random", "tasks": ["reech"]}]}, r"did you mean 'reach'"),
        ({"agents": [{"agent": "random", "budget": float("nan")}]}, "budget: nan is not finite"),
        ({"tasks": {"reach": {"protocol": "table3"}}}, "'table3' is not one of table1"),
        ({"tasks": {"reach": {"protocol": "fig4", "cases": 3}}}, "one fixed list"),
        ({"tasks": {"reach": {"protocol": "table1", "cases": 0}}}, "cases = 0 is not"),
        ({"tasks": {"reach": {"protocol": "table1", "config": "pepper"}}}, "pepper"),
        ({"tasks": {"reach": {}}}, "tasks.reach.protocol is missing"),
    ],
)
def test_a_wrong_field_is_named(tmp_path, change, match):
    document = {"name": "x", "tasks": {"reach": REACH}, "agents": ["random"]} | change
    with pytest.raises(ConfigError, match=match):
        study_of(document)
    path = tmp_path / "x.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(StudyError, match=r"x\.json: "):
        read_study(path)


def test_an_unknown_agent_or_study_is_named_with_the_nearest():
    with pytest.raises(ConfigError, match=r"agents\[0\].*did you mean 'hebb-paper'"):
        runs_of(only_reaching("heb-paper"))
    with pytest.raises(ConfigError, match="can do none of grasp"):
        runs_of(small(["hebb-conjunctive"], tasks={"grasp": {"protocol": "palm_side"}}))
    with pytest.raises(ConfigError, match="not a file that ends in"):
        read_study("no-such-study")
    with pytest.raises(FileNotFoundError):
        read_study("no-such-study.toml")


def test_each_agent_of_the_roster_runs_where_it_can():
    specs = runs_of(small(list(ROSTER), seeds=2))
    runs = {(spec.task_name, spec.agent.label) for spec in specs}
    assert runs == {(task, name) for name, entry in ROSTER.items() for task in entry.tasks}
    for spec in specs:
        entry = ROSTER[spec.agent.agent]
        assert bool(spec.budget) == bool(entry.tasks[spec.task.task].budget)
        assert spec.seed == 0 or entry.seeded
    assert [spec.seed for spec in specs] == sorted(spec.seed for spec in specs)


def test_tuned_settings_decide_a_run_too(monkeypatch):
    entry = ROSTER["ppo"]
    (before,) = {spec.fingerprint for spec in runs_of(only_reaching("ppo"))}
    assert "n_epochs" in entry.tuned("BabbleReach-v0")
    assert entry.tuned("BabbleReach-v0") != entry.tuned("BabbleGrasp-v0")
    monkeypatch.setattr(type(entry), "tuned", lambda *_: "gamma: 0.9")
    assert {spec.fingerprint for spec in runs_of(only_reaching("ppo"))} != {before}


@given(st.integers(1, 10**9))
def test_checkpoints_are_logarithmic_and_end_at_the_budget(budget):
    marks = checkpoints(budget)
    assert marks[-1] == budget
    assert marks == sorted(set(marks))
    assert all(1.9 < after / before < 2.6 for before, after in pairwise(marks[:-1]))
    assert not checkpoints(0)


def test_a_run_is_what_its_spec_says():
    spec = runs_of(only_reaching("hebb-paper", seeds=[5]))[0]
    again = RunSpec.from_json(json.loads(json.dumps(spec.to_json())))
    assert again.to_json() == spec.to_json()
    assert (again.name, again.fingerprint) == (spec.name, spec.fingerprint)
    shares = []
    record, (suffix, content) = execute(spec, shares.append)
    # The same agent, made by hand.
    agent = HebbBabbling("BabbleReachPattern-v0", seed=5)
    agent.learn(record["cost"]["accepted"])
    assert (suffix, content) == (".safetensors", agent.to_bytes())
    cases = scenarios("table1", 20, 1_000)
    test = evaluate(agent, cases=cases)
    names = record["test"]["outcomes"]
    assert [names[int(i)] for i in record["test"]["outcome"]] == list(test.outcomes)
    assert tally_of(record)["success"]["count"] == test.count("success")
    # Everything is charged, movements that could not be learnt from too.
    cost = record["cost"]
    assert cost["control_steps"] == 224 * cost["trials"] >= spec.budget
    assert cost["trials"] > cost["accepted"] > 0
    steps = [point["control_steps"] for point in record["checkpoints"]]
    assert steps == sorted(set(steps))
    assert steps[-1] == cost["control_steps"]
    assert all(len(point["outcome"]) == 10 for point in record["checkpoints"])
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_sizes_are_stored_apart():
    spec = runs_of(small(["scripted"], tasks={"grasp": {"protocol": "palm_side", "cases": 6}}))[0]
    record, file = execute(spec)
    assert file is None
    tally = tally_of(record)
    assert tally["by_size"].keys() == {"2.4 cm", "6 cm"}
    assert sum(part["cases"] for part in tally["by_size"].values()) == 6 == tally["cases"]
    assert {"reach", "palm_reach"} < tally.keys()


def test_what_is_there_is_not_done_again(tmp_path):
    study = small(["hebb-paper", "random"], seeds=2)
    store, watch = run(study, tmp_path / "s")
    assert watch.ended == dict.fromkeys((spec.name for spec in runs_of(study)), "finished")
    before = results(store)
    times = {path: path.stat().st_mtime_ns for path in (tmp_path / "s/runs").iterdir()}
    lost = next(path for path in times if "grasp.hebb-paper.1" in path.name)
    lost.unlink()
    store, watch = run(study, tmp_path / "s")
    assert watch.waiting == ["grasp.hebb-paper.1"]
    assert watch.done == 7
    assert results(store) == before
    del times[lost]
    assert all(path.stat().st_mtime_ns == then for path, then in times.items())
    # More seeds and agents go on in the same folder; what no longer fits is said, and kept.
    changed = {"agent": "hebb-paper", "settings": {"rule": "oja"}}
    store, watch = run(only_reaching(changed, "random", seeds=3), tmp_path / "s")
    again = [f"reach.hebb-paper.{seed}" for seed in range(3)]
    assert sorted(watch.waiting) == [*again, "reach.random.2"]
    assert "reach.hebb-paper.0: agent.settings.rule was None, and is 'oja' now" in watch.unfit
    assert "grasp.random.1: the study has no such run" in watch.unfit
    assert all(path.exists() for path in times)


def test_a_run_of_other_physics_is_no_part_of_the_results(tmp_path):
    store, _ = run(only_reaching("random"), tmp_path)
    (path,) = (tmp_path / "runs").iterdir()
    record = json.loads(path.read_text(encoding="utf-8"))
    other = path.with_name("reach.random.0.0123456789ab.json")
    other.write_text(json.dumps(record | {"physics": "0" * 16}), encoding="utf-8")
    path.unlink()
    assert not store.runs()[0].finished
    (sentence,) = store.unfit(runs_of(store.study()))
    assert sentence.startswith("reach.random.0: ran with physics 0000000000000000, and they are")


def test_a_store_of_another_version_or_study_is_refused(tmp_path):
    store, _ = run(only_reaching("random"), tmp_path)
    with pytest.raises(StudyError, match="is the folder of study 'small', and this is 'other'"):
        run(only_reaching("random", name="other"), tmp_path)
    (path,) = (tmp_path / "runs").iterdir()
    record = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(record | {"format": 9}), encoding="utf-8")
    with pytest.raises(StudyError, match=r"format = 9, and this version reads 1"):
        store.runs()
    cut = {name: record[name] for name in ("format", "spec")}
    path.with_name("x.json").write_text(json.dumps(cut), encoding="utf-8")
    with pytest.raises(StudyError, match=r"x\.json: not a run of a study: 'physics'"):
        store.unfit(runs_of(store.study()))
    path.with_name("x.json").unlink()
    path.write_text('{"format": 1', encoding="utf-8")
    with pytest.raises(StudyError, match="not a file of a study"):
        run(only_reaching("random"), tmp_path)
    with pytest.raises(FileNotFoundError, match=r"not the folder of a study: no study\.json"):
        Store(tmp_path / "nowhere").study()


def test_agents_of_ones_own_learn_without_being_registered(own, tmp_path):
    agents = [f"{own}:{name}" for name in ("Learner", "Counts")]
    store, watch = run(only_reaching(*agents), tmp_path / "s")
    assert set(watch.ended.values()) == {"finished"}
    learner, counts = (one.record for one in store.runs())
    assert learner["cost"]["control_steps"] == 224 * learner["cost"]["trials"] >= 20_000
    assert counts["cost"]["control_steps"] >= 20_000
    assert counts["cost"]["trials"] == 200
    assert learner["env"] == "BabbleReachPattern-v0"


def test_a_failed_run_is_a_row_that_says_so(own, tmp_path):
    names = ("Broken", "Idle", "Dies", "NoNumber")
    study = only_reaching(*(f"{own}:{name}" for name in names), "random")
    store, watch = run(study, tmp_path / "s")
    errors = {one.spec.agent.label: one.error for one in store.runs()}
    assert errors["Broken"] == "RuntimeError: no way"
    assert "learn(100) used no control step" in errors["Idle"]
    assert errors["Dies"] == "the process ended with code 3"
    assert errors["NoNumber"] == "action[0][0] = NaN: actions must be finite"
    assert errors["random"] is None
    dead = next(one for one in store.runs() if one.spec.agent.label == "Dies")
    assert "last words" in dead.record["trace"]
    # They are tried again; what is finished is not.
    _, watch = run(study, tmp_path / "s")
    assert [name.split(".")[1] for name in watch.waiting] == list(names)


def test_settings_and_controls_are_checked(own):
    for agent, match in (
        ({"agent": "hebb-paper", "settings": {"varaint": "paper"}}, "did you mean 'variant'"),
        ({"agent": "hebb-paper", "options": {"control": "torque"}}, "torque"),
        ({"agent": "hebb-paper", "env_id": "BabbleGrasp-v0"}, "grasp"),
        ({"agent": f"{own}:Learner", "env_id": "BabbleGrasp-v0"}, "cases are of reaching"),
        ({"agent": "no/such/file.zip"}, "no such file"),
    ):
        record, file = execute(runs_of(only_reaching(agent))[0])
        assert record["status"] == "failed"
        assert match in record["error"]
        assert file is None
    (spec,) = runs_of(small([f"{own}:Learner"], tasks={"reach": {"protocol": "table1"}}))
    assert "budget is missing" in execute(spec)[0]["error"]


def test_an_agents_file_joins_and_a_strange_body_does_not(tmp_path):
    path = tmp_path / "agent.safetensors"
    HebbBabbling("BabbleReachPattern-v0").learn(50).save(path)
    (spec,) = runs_of(only_reaching(str(path)))
    record, _ = execute(spec)
    assert tally_of(record)["cases"] == 20
    assert spec.agent.label == "agent"
    (spec,) = runs_of(small([str(path)], tasks={"reach": {**REACH, "config": "icub"}}))
    assert "the agent acts in" in execute(spec)[0]["error"]


def kill_at_random(study, folder, times, seed):
    """Runs a study by its command, kills it, and starts it again, so many times."""
    spec = folder / "spec.json"
    spec.write_text(json.dumps(study.to_json()), encoding="utf-8")
    words = ["study", "run", str(spec), "--out", str(folder / "s"), "--jobs", "2"]
    command = [sys.executable, "-c", f"from gym_babble.cli import main; main({words})"]
    moments = np.random.default_rng(seed).uniform(0.8, 2.5, times)
    killed = 0
    for moment in moments:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moment)
        process.kill()
        killed += process.wait() == -signal.SIGKILL
    return killed


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGKILL")
@pytest.mark.parametrize(("times", "seeds"), [(2, 2), pytest.param(20, 16, marks=pytest.mark.slow)])
def test_a_study_that_is_killed_ends_with_the_same_results(tmp_path, times, seeds):
    tasks = {"reach": {**REACH, "budget": 500_000}, "grasp": {**GRASP, "budget": 4_000}}
    study = small(["hebb-paper", "random"], seeds=seeds, tasks=tasks)
    assert kill_at_random(study, tmp_path, times, seed=times)
    store, watch = run(study, tmp_path / "s")
    assert not watch.unfit
    store, watch = run(study, tmp_path / "s")
    assert not watch.waiting
    whole, _ = run(study, tmp_path / "whole")
    assert results(store) == results(whole)
