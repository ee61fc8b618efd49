"""Studies on a cluster of Ray: of two nodes on this machine, in `make frameworks`."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time

import pytest
from studying import REACH, Silent, results, run, small

from gym_babble.errors import ConfigError, MissingExtraError, StudyError
from gym_babble.study import ray_engine
from gym_babble.study.engine import run_study
from gym_babble.study.run import runs_of

OWN = '''
import os
from pathlib import Path
import numpy as np

HERE = Path(__file__).parent

class Learner:
    """Searches one action for all cases, and writes down where each run begins."""

    env, control_steps, score = "BabbleReachPattern-v0", 0, -1.0

    def __init__(self, env, seed=0):
        self.env, self.random = env, np.random.default_rng(seed)
        self.best = np.zeros(2, np.float32)
        with (HERE / "starts").open("a") as file:
            file.write(f"{type(self).__name__} {seed} {os.getppid()} {os.getpid()}\\n")

    def learn(self, control_steps):
        self.control_steps += control_steps
        action = self.random.uniform(-1, 1, 2).astype(np.float32)
        score = 0.0
        for case in range(40):
            self.env.reset(seed=case)
            score += self.env.step(action)[1]
        if score > self.score:
            self.best, self.score = action, score

    def predict(self, observation):
        return self.best

class Broken(Learner):
    def learn(self, control_steps):
        raise RuntimeError("no way")

class Dies(Learner):
    def learn(self, control_steps):
        os._exit(3)
'''


def learners(*names, **changes):
    """A study of reaching with own agents."""
    agents = [f"ray_learners:{name}" for name in names]
    return small(agents, tasks={"reach": {**REACH, "budget": 200_000}}, **changes)


def test_without_ray_the_message_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'gym-babble\[ray\]'"):
        run_study(small(["random"]), tmp_path, Silent(), engine="ray")


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"engine": "rya"}, "engine = 'rya'"),
        ({"engine": "ray", "jobs": 2}, "jobs = 2"),
        ({"address": "auto"}, "address = 'auto'"),
    ],
)
def test_arguments_that_an_engine_does_not_take_are_errors(tmp_path, arguments, match):
    with pytest.raises(ConfigError, match=match):
        run_study(small(["random"]), tmp_path / "new", Silent(), **arguments)
    assert not (tmp_path / "new").exists()


@pytest.fixture
def starts(tmp_path, monkeypatch):
    """Where the own agents' module is, and which runs have begun: name, seed, node, process."""
    (tmp_path / "ray_learners.py").write_text(OWN, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("RAY_worker_niceness", "0")
    monkeypatch.setenv("RAY_memory_monitor_refresh_ms", "0")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)  # Ray's processes look for packages in the driver's folder first.

    def read():
        path = tmp_path / "starts"
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        return [tuple(line.split()) for line in lines]

    return read


@pytest.fixture
def cluster(starts):  # noqa: ARG001 - the nodes get its environment
    """A cluster of two nodes on this machine, each with one processor; we are on the first."""
    ray = pytest.importorskip("ray", reason="only `make frameworks` has Ray")
    cluster_utils = pytest.importorskip("ray.cluster_utils")
    nodes = cluster_utils.Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    nodes.other = nodes.add_node(num_cpus=1)
    nodes.wait_for_nodes()
    ray.init(address=nodes.address, log_to_driver=False, logging_level="error")
    yield nodes
    ray.shutdown()
    nodes.shutdown()


class KillsANode(Silent):
    """Kills the second node while it does a run."""

    def __init__(self, cluster, starts):
        super().__init__()
        self.cluster, self.starts, self.killed = cluster, starts, ()

    def end(self, spec, record):
        super().end(spec, record)
        if self.killed:
            return
        raylets = {process.process.pid for process in self.cluster.other.all_processes["raylet"]}
        there = [one for one in self.starts() if int(one[2]) in raylets and alive(int(one[3]))]
        busy = [one for one in there if f"reach.{one[0]}.{one[1]}" not in self.ended]
        if busy:
            self.cluster.remove_node(self.cluster.other, allow_graceful=False)
            self.killed = busy[0]


def alive(pid):
    """Whether a process exists."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, 0)
        return True
    return False


@pytest.mark.filterwarnings("ignore")
def test_a_study_survives_the_death_of_a_node(tmp_path, cluster, starts):
    study = learners("Learner", seeds=6)
    watch = KillsANode(cluster, starts)
    began = time.perf_counter()
    store = run_study(study, tmp_path / "ray", watch, engine="ray")
    seconds = time.perf_counter() - began
    assert watch.killed
    name, seed, node, _ = watch.killed
    again = [one for one in starts() if one[:2] == (name, seed)]
    assert len(again) == 2
    assert {one[2] for one in again} > {node}  # It has begun again on the other node.
    assert len(starts()) == 7  # Nothing else had to.
    assert set(watch.ended.values()) == {"finished"}
    here, _ = run(study, tmp_path / "here")
    assert results(store) == results(here)
    print(f"6 runs, a node killed in run {seed}: {seconds:.0f} s")


@pytest.mark.usefixtures("cluster")
@pytest.mark.filterwarnings("ignore")
def test_both_engines_have_the_same_results(tmp_path):
    study = small(["hebb-paper", "random"], seeds=2)
    store = run_study(study, tmp_path / "ray", Silent(), engine="ray")
    here, _ = run(study, tmp_path / "here")
    assert results(store) == results(here)
    watch = Silent()
    run_study(study, tmp_path / "ray", watch, engine="ray")
    assert not watch.waiting


@pytest.mark.usefixtures("cluster")
@pytest.mark.filterwarnings("ignore")
def test_an_agent_that_fails_is_a_row_and_one_that_dies_is_one_too(tmp_path, starts):
    study = learners("Broken", "Dies", "Learner")
    store = run_study(study, tmp_path / "ray", Silent(), engine="ray")
    broken, dies, learner = store.runs()
    assert learner.finished
    assert broken.error == "RuntimeError: no way"
    assert dies.error == "its process or its node died 4 times: WorkerCrashedError"
    begun = [one[0] for one in starts()]
    assert (begun.count("Broken"), begun.count("Dies")) == (1, 1 + ray_engine.RETRIES)


@pytest.mark.usefixtures("cluster")
@pytest.mark.filterwarnings("ignore")
def test_a_node_of_another_version_stops_the_study(tmp_path, monkeypatch):
    decides = {**ray_engine.what_decides(), "numpy": "0.1"}
    monkeypatch.setattr(ray_engine, "what_decides", lambda: decides)
    study = small(["random"])
    with pytest.raises(StudyError, match=r"has numpy \d.+ instead of 0\.1: install there"):
        run_study(study, tmp_path / "ray", Silent(), engine="ray")
    assert not any((tmp_path / "ray" / "runs").iterdir())


@pytest.mark.filterwarnings("ignore")
def test_a_node_without_this_version_stops_the_study(tmp_path, cluster, monkeypatch):
    older = tmp_path / "older"
    (older / "gym_babble").mkdir(parents=True)
    (older / "gym_babble" / "__init__.py").touch()
    monkeypatch.setenv("PYTHONPATH", str(older))
    cluster.add_node(num_cpus=4)
    cluster.wait_for_nodes()
    with pytest.raises(StudyError, match="a node cannot run this version of gym-babble: Module"):
        run_study(small(["random"], seeds=6), tmp_path / "ray", Silent(), engine="ray")


@pytest.mark.filterwarnings("ignore")
def test_ctrl_c_ends_the_runs_of_a_cluster(tmp_path, cluster, starts):
    spec = tmp_path / "spec.json"
    study = learners("Learner", seeds=4)
    spec.write_text(json.dumps(study.to_json()), encoding="utf-8")
    out = tmp_path / "ray"
    words = ["study", "run", str(spec), "--out", str(out), "--engine", "ray"]
    words += ["--address", cluster.address]
    command = [sys.executable, "-c", f"from gym_babble.cli import main; main({words})"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 120
    while len(list(out.glob("runs/*.json"))) < 1:
        assert time.monotonic() < deadline
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    while any(alive(int(one[3])) for one in starts()):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    watch = Silent()
    store = run_study(study, out, watch, engine="ray")
    assert 0 < watch.done < len(runs_of(study))
    assert all(one.finished for one in store.runs())
