"""What `make bench` measures, and that the docs show what it measured."""

from __future__ import annotations

import json
import math
import os
import re
import sys
import time
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from serving import PROGRAM

import gym_babble
from bench import chart, clock, ours, peers, process, report, run, wire, wire_ours
from bench.cases import CASES, OURS
from gym_babble.envs import BabbleGraspVectorEnv

SHORT_S = 0.05
# One of each kind of row, and what makes a large one small.
SOME = {
    "floor": {},
    "floor-64": {},
    "reach": {},
    "reach-16-2t": {},
    "grasp": {},
    "grasp-4-2t": {},
    "held": {},
    "held-64-2t": {"n": 20},  # More than there are states.
    "reset-reach": {},
    "reset-grasp": {},
    "edges-grasp": {},
    "eye-reach": {},
    "third_person-grasp": {},
    "memory-reach-1024": {"n": 64},
    "memory-held-1024": {"n": 64},
}
FEW = {"wire-held-64": {"n": 4}}


@pytest.fixture(scope="module", autouse=True)
def few_episodes():
    """The states that batches are filled with are made once for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ours, "POOL", 8)
        yield


@pytest.fixture(scope="module")
def results(repository):
    return json.loads((repository / "bench" / "results.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", SOME)
def test_a_row_measures(name, monkeypatch):
    if name.startswith("memory") and not clock.Path("/proc/self/smaps_rollup").exists():
        pytest.skip("memory is read from /proc")
    monkeypatch.setattr(clock, "WARM_UP_S", 0.0)
    case = CASES[name]
    row = measure_of(case)(SHORT_S, **{**case.arguments, **SOME[name]})
    assert set(row) == ({"kib"} if name.startswith("memory") else {"cpu_us", "clock_us"})
    assert all(math.isfinite(value) for value in row.values())
    # Memory freed by another test may be taken again, so its growth can be nothing here.
    assert name.startswith("memory") or min(row.values()) > 0


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs Linux")
@pytest.mark.parametrize("name", ["wire-echo", "wire-reach", "wire-reach-64", "wire-held-64"])
def test_a_row_of_round_trips_measures(name, monkeypatch):
    for module in (wire, wire_ours):
        monkeypatch.setattr(
            module, "program", lambda: [sys.executable, "-c", PROGRAM, "--port", "0"], raising=False
        )
    own = os.sched_getaffinity(0)
    try:
        row = measure_of(CASES[name])(SHORT_S, **{**CASES[name].arguments, **FEW.get(name, {})})
    finally:
        os.sched_setaffinity(0, own)
    assert set(row) == {"cpu_us", "clock_us", "p50_us", "p99_us"}
    assert 0 < row["p50_us"] <= row["p99_us"]
    assert row["clock_us"] > 0


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs Linux")
def test_sessions_at_once_are_told_apart(monkeypatch):
    monkeypatch.setattr(
        wire_ours, "program", lambda: [sys.executable, "-c", PROGRAM, "--port", "0"]
    )
    own = os.sched_getaffinity(0)
    try:
        row = wire_ours.sessions(SHORT_S, n=3)
    finally:
        os.sched_setaffinity(0, own)
    assert 0 < row["slowest"] <= 1 <= row["fastest"] < 3
    assert row["server_us"] >= 0


def measure_of(case):
    """The function that measures a row."""
    module, _, function = case.function.partition(":")
    return getattr(
        {"ours": ours, "peers": peers, "wire": wire, "wire_ours": wire_ours}[module], function
    )


def test_a_row_runs_in_a_process_of_its_own():
    row = process.measure(replace(CASES["floor"], venv=OURS), SHORT_S)
    assert 0 < row["cpu_us"] < 1_000


def test_a_row_that_fails_says_why():
    case = replace(CASES["reach"], arguments={"env_id": "BabbleNothing-v0"})
    with pytest.raises(process.CaseError, match="BabbleNothing"):
        process.measure(case, SHORT_S)


def test_every_hand_holds_its_object_at_every_timed_step():
    """A dropped object would make the row of held objects cheap."""
    states, moves = ours.held()
    envs = BabbleGraspVectorEnv(len(states), **ours.HOLDING)
    envs.reset(seed=0)
    envs.set_state(states)
    for action in moves:
        info = envs.step(action)[4]
        assert info["held"].all()
        assert info["outcome"]["running"].all()
    assert np.ptp(moves[:, :, :2], axis=0).min() > 0.1  # The arm moves.


def test_episodes_of_random_play_have_all_ages():
    """In step, the episodes would all be in the same phase, and none would end while timed."""
    envs = ours.gymnasium.make_vec("BabbleReach-v0", num_envs=ours.POOL)
    envs.reset(seed=0)
    envs.set_state(ours.playing("BabbleReach-v0"))
    observation = envs.step(np.zeros(envs.action_space.shape, np.float32))[0]
    shares, _ = np.histogram(observation["time"], bins=4, range=(0, 1))
    assert shares.min() > 0


def test_spin_counts_units_and_no_restarts(monkeypatch):
    monkeypatch.setattr(clock, "WARM_UP_S", 0.0)
    calls = []

    def body():
        calls.append("body")
        time.sleep(0.001)

    def restart():
        calls.append("restart")
        time.sleep(0.05)

    row = clock.spin(body, 10, 0.02, restart=restart, calls=3)
    assert 100 <= row["clock_us"] < 1_000  # A tenth of a millisecond, not the restarts' 50.
    assert row["cpu_us"] < row["clock_us"]  # Sleep is no CPU time.
    runs = "".join(call[0] for call in calls[2:]).split("r")[1:]
    assert {len(part) for part in runs[:-1]} == {3}


def test_a_call_longer_than_the_time_is_measured_once(monkeypatch):
    monkeypatch.setattr(clock, "WARM_UP_S", 0.0)
    row = clock.spin(lambda: time.sleep(0.02), 1, 0.001)
    assert row["clock_us"] >= 20_000


@pytest.mark.parametrize("degrees", [9, 18])
def test_mujoco_steps_the_robot_that_we_step(degrees):
    """Twin and ours are of one config; each of its joints has a muscle, and the hand reflexes."""
    theirs = CASES[f"mujoco-held-{degrees}"].arguments
    config = json.loads(CASES[f"physics-held-{degrees}"].arguments["config"])
    assert theirs["model"] == gym_babble.export_mjcf(config=config, options={"diameter": 0.05})
    root = ET.fromstring(theirs["model"])  # noqa: S314 - our own
    assert len(root.findall("actuator/position")) == degrees
    env = BabbleGraspVectorEnv(1, config=config)
    assert [theirs["reflex"][digit] for digit in ("thumb", "fingers")] == list(
        env.interface.quantities["reflex"]
    )


def test_an_interrupted_run_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "SAMPLES", tmp_path / "samples.jsonl")
    this = {"names": ["floor", "reach"], "seconds": 1.0, "rounds": 2}
    samples = run.Samples(this, resume=False)
    samples.add(0, "floor", {"cpu_us": 1.0, "clock_us": 2.0}, None)
    samples.add(0, "reach", None, "no reason")
    again = run.Samples(this, resume=True)
    again.add(1, "floor", {"cpu_us": 3.0, "clock_us": 4.0}, None)
    assert again.done == {(0, "floor"), (1, "floor")}
    assert again.errors == {(0, "reach"): "no reason"}
    expected = {"cpu_us": 2.0, "clock_us": 3.0, "rounds": [1.0, 3.0]}
    assert run.Samples(this, resume=True).medians() == {"floor": expected}
    again.add(0, "reach", {"cpu_us": 1.0, "clock_us": 1.0}, None)
    assert run.Samples(this, resume=True).errors == {}
    with pytest.raises(SystemExit, match="other rows"):
        run.Samples({**this, "rounds": 3}, resume=True)


def test_the_stored_run_has_every_row(results):
    assert set(results["rows"]) == set(CASES)
    assert {len(row["rounds"]) for row in results["rows"].values()} == {results["about"]["rounds"]}


@pytest.mark.parametrize("page", report.PAGES)
def test_the_docs_tables_are_the_stored_runs(repository, results, page):
    text = (repository / page).read_text(encoding="utf-8")
    assert report.filled(text, results) == text


def test_the_docs_cost_of_independent_fingers_is_the_stored_runs(repository, results):
    free, held = (
        results["rows"][f"physics-{scene}-18"]["cpu_us"]
        / results["rows"][f"physics-{scene}-9"]["cpu_us"]
        for scene in ("free", "held")
    )
    for page in ("docs/model.md", "gym_babble/config.py", "rust/babble_body/src/config.rs"):
        text = re.sub(r"[\s/]+", " ", (repository / page).read_text(encoding="utf-8"))
        assert f"{free:.1f} to {held:.1f} times" in text, page


def test_every_table_stands_on_a_page(repository):
    pages = "".join((repository / page).read_text(encoding="utf-8") for page in report.PAGES)
    assert {name for _, name, _ in report.BLOCK.findall(pages)} == set(report.BLOCKS)


@pytest.mark.parametrize("mark", report.MARKS, ids=lambda mark: mark.text)
def test_a_mark_is_met_up_to_its_bound(mark):
    """Ours at the bound beside a peer of 1,000 is met, two per cent more is missed."""
    bound = 1_000 / mark.bound if mark.peer else mark.bound / mark.scale
    for cost, met in ((bound * 0.99, True), (bound * 1.01, False)):
        rows = {name: {mark.key: cost / 2} for name in mark.ours}
        rows[mark.ours[-1]] = {mark.key: cost}  # The worst row counts.
        if mark.peer:
            rows[mark.peer] = {mark.key: 1_000.0}
        assert mark.met(mark.measured(rows)) is met
    assert mark.measured({}) is None


def test_pages_and_picture_can_be_made_without_some_rows(results, tmp_path, monkeypatch):
    """A row that failed leaves a gap, and the others are shown."""
    monkeypatch.setattr(chart, "PICTURE", tmp_path / "picture.png")
    rows = {name: row for name, row in results["rows"].items() if "held" not in name}
    chart.write({**results, "rows": rows})
    assert report.marks({**results, "rows": rows}).count(f"| {report.NOT_MEASURED} |") >= 4
    assert (tmp_path / "picture.png").stat().st_size > 10_000


def test_requirements_are_pins_and_nothing_else(repository):
    pin = re.compile(r"[\w.-]+==[\w.]+")
    for path in repository.glob("bench/requirements-*.txt"):
        lines = path.read_text(encoding="utf-8").splitlines()
        assert all(line.startswith("# ") or pin.fullmatch(line) for line in lines), path.name
