"""Arguments of agents, cases, rules and maps: whatever is given is taken or refused by its name."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
import pytest

from gym_babble import (
    Config,
    HebbBabbling,
    Oracle,
    Random,
    Scripted,
    babble,
    brain,
    checks,
    export_mjcf,
    load_agent,
    scenarios,
)
from gym_babble.envs import BabbleReachVectorEnv
from gym_babble.errors import BabbleError, BusyError, ConfigError
from gym_babble.paper.holding import hold_rates

MAP = brain.PopulationMap(3, [0, 0], [1, 1])


class SilentError(Exception):
    """What the `repr` of a stranger raises."""


class Stranger:
    """An object that cannot even be shown."""

    def __repr__(self):
        raise SilentError


JUNK = {
    "none": None,
    "true": True,
    "minus one": -1,
    "a fraction": 1.5,
    "nan": float("nan"),
    "infinity": float("inf"),
    "numpy nan": np.float32("nan"),
    "huge": 10**12,
    "beyond a float": 10**400,
    "beyond all digits": 10**5_000,
    "text": "five",
    "digits": "5",
    "surrogate": "\ud800",
    "bytes": b"5",
    "set": {1, 2},
    "list": [1, 2],
    "deep list": [[[[1]]]],
    "ragged": [[1], [1, 2]],
    "dict": {"a": 1},
    "array": np.array([1.0, 2.0, 3.0]),
    "times": np.zeros(2, "datetime64[s]"),
    "stranger": Stranger(),
    "type": int,
}

# A call, and arguments with which it succeeds within a moment.
CALLS = {
    "HebbBabbling": (
        HebbBabbling,
        {
            "env": "BabbleReachPattern-v0",
            "variant": "paper",
            "rule": None,
            "seed": 0,
            "quasi_static": True,
            "threads": 1,
            "brain": None,
        },
    ),
    "learn": (
        lambda **given: HebbBabbling(quasi_static=True, threads=1).learn(**given),
        {"babbles": 2, "progress_bar": False, "callback": None, "callback_every": 2},
    ),
    "brain": (
        lambda **given: HebbBabbling("BabbleReach-v0", brain=given),
        {"output_neurons": 5, "sigma": 0.7, "rule": {"eta": 0.5}},
    ),
    "numbers of a rule in brain": (
        lambda **given: HebbBabbling("BabbleReach-v0", brain={"rule": given}),
        {"eta": 0.5, "w_max": 0.2, "xi": 0.2},
    ),
    "rule": (
        lambda **given: HebbBabbling("BabbleReach-v0", rule=brain.CovarianceRule(**given)),
        {"eta": 0.5, "w_max": 0.2, "xi": 0.2},
    ),
    "babble": (babble, {"env": "BabbleReach-v0", "n": 2, "seed": 0, "quasi_static": True}),
    "Random": (Random, {"env": "BabbleReachPattern-v0", "seed": 1}),
    "Scripted": (Scripted, {"env": "BabbleReachPattern-v0"}),
    "Oracle": (Oracle, {"env": "BabbleReachPattern-v0", "threads": 1}),
    "load_agent": (load_agent, {"path": "missing", "env": None}),
    "predict": (
        Scripted().predict,
        {"observation": np.zeros(11), "state": None, "episode_start": None},
    ),
    "decide": (HebbBabbling().decide, {"observation": np.zeros(11)}),
    "recall": (HebbBabbling().recall, {"observation": np.zeros(11)}),
    "weights": (
        lambda weights: setattr(HebbBabbling(), "weights", weights),
        {"weights": {"a_mean": np.zeros(441)}},
    ),
    "scenarios": (
        scenarios,
        {"protocol": "fig4", "n": 2, "seed": 0, "split": "test", "config": "paper", "threads": 1},
    ),
    "hold_rates": (hold_rates, {"trials": 1, "config": "paper", "diameters": (0.03,)}),
    "export_mjcf": (export_mjcf, {"task": "reach", "config": "paper", "seed": 0, "timestep": None}),
    "Config.profile_named": (Config.profile_named, {"name": "paper"}),
    "Config.load": (Config.load, {"path": "missing.toml"}),
    "Config.from_json": (Config.from_json, {"text": "{}"}),
    "PopulationMap": (
        brain.PopulationMap,
        {"neurons": [3, 3], "low": [0, 0], "high": [1, 1], "sigma": 0.7},
    ),
    "encode": (MAP.encode, {"x": [0.2, 0.3]}),
    "read_out": (MAP.read_out, {"a": np.zeros(9)}),
    "read_out_peak": (MAP.read_out_peak, {"a": np.zeros(9), "radius": 1}),
    "ConjunctiveMap": (brain.ConjunctiveMap, {"inner": MAP, "outer": MAP}),
    "encode pairs": (
        brain.ConjunctiveMap(MAP, MAP).encode,
        {"inner": [0.2, 0.3], "outer": [0.2, 0.3]},
    ),
    "Association": (
        brain.Association,
        {"n_in": 3, "n_out": 2, "rule": "hebb", "threads": 1, "eta": 0.1, "w_max": 1.0},
    ),
    "learn an association": (
        lambda **given: brain.Association(3, 2).learn(**given),
        {"g": np.zeros(3), "a": np.zeros(2)},
    ),
    "recall of an association": (brain.Association(3, 2).recall, {"g": np.zeros(3)}),
    "set an association": (
        lambda **given: [setattr(brain.Association(3, 2), *item) for item in given.items()],
        {"weights": np.zeros((2, 3)), "a_mean": np.zeros(2), "g_mean": np.zeros(3)},
    ),
    "TimeBaseGenerator": (brain.TimeBaseGenerator, {"b1": 0.3, "b2": 0.7}),
    "curve": (brain.TimeBaseGenerator(0.3, 0.7).curve, {"n": 5}),
    "place": (brain.place, {"start": [0, 0], "target": [1, 1], "curve": np.zeros((3, 2))}),
}
EACH_ARGUMENT = [(name, argument) for name, (_, given) in CALLS.items() for argument in given]


@pytest.mark.parametrize(("name", "argument"), EACH_ARGUMENT, ids=lambda x: x)
def test_an_argument_of_any_kind_is_taken_or_refused_at_once(name, argument):
    call, good = CALLS[name]
    for kind, junk in JUNK.items():
        if (argument, kind) in {("babbles", "none"), ("callback", "type")}:
            continue  # As many as the paper's, and a function that raises.
        began = time.perf_counter()
        try:
            call(**{**good, argument: junk})
        except (BabbleError, FileNotFoundError) as error:
            assert str(error).isprintable() or "\n" in str(error)  # noqa: PT017 - not all raise
        assert time.perf_counter() - began < 5


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: HebbBabbling(threads=-1), r"threads = -1 .*\[1, 1024\]"),
        (lambda: HebbBabbling(seed="1"), r"seed = '1' .*2\^64"),
        (
            lambda: HebbBabbling(variant=None),
            "variant = None is not one of paper, conjunctive, chain",
        ),
        (lambda: HebbBabbling(quasi_static="no"), "quasi_static = 'no' is not True or False"),
        (lambda: HebbBabbling(brain=[1]), r"brain = \[1\] is not a dict"),
        (lambda: HebbBabbling(brain={"sigma": np.nan}), "brain.sigma: nan is not finite"),
        (lambda: HebbBabbling(brain={"rule": {"eta": {1}}}), r"brain.rule.eta: \{1\}"),
        (lambda: HebbBabbling(brain={"output_neurons": 10**9}), "output_neurons"),
        (lambda: HebbBabbling(rule=brain.OjaRule(xi=np.inf)), "rule.xi: inf is not finite"),
        (lambda: HebbBabbling("Nothing-v0"), "Nothing"),
        (lambda: HebbBabbling().learn(1000.0), r"babbles = 1000.0 .*\[0, 100000000\]"),
        (lambda: HebbBabbling().learn(10**12), r"babbles = 10+ .*\[0, 100000000\]"),
        (lambda: HebbBabbling().learn(1, callback_every=10**9), r"callback_every.*100000\]"),
        (lambda: babble("BabbleReach-v0", 10**9), r"n = 10+ .*\[1, 1000000\]"),
        (lambda: scenarios("table1", 10**9), r"n = 10+ .*\[1, 1000000\]"),
        (lambda: scenarios(["table1"]), "protocol = .*table1, fig4"),
        (lambda: brain.PopulationMap(10**6, 0, 1), r"neurons = 1000000 .*\[2, 1024\]"),
        (lambda: brain.PopulationMap([1024] * 3, [0] * 3, [1] * 3), r"2\^24"),
        (lambda: brain.PopulationMap(3, [0, np.nan], [1, 1]), r"low\[1\] = nan"),
        (lambda: brain.Association(10**6, 10**6), r"n_out = 1000000 .*\[1, 1073\]"),
        (lambda: brain.Association(3, 2, eta=np.nan), "eta = nan"),
        (lambda: brain.Association(3, 2).learn([0, 0, np.nan], [0, 0]), r"g\[2\] = nan"),
        (lambda: brain.TimeBaseGenerator(0.5, 0.5).curve(10**12), r"n = 10+ .*1000000\]"),
        (lambda: HebbBabbling().decide(np.zeros((2, 2, 11))), r"shape \(2, 2, 11\)"),
        (lambda: HebbBabbling().decide({"eye": np.zeros(3)}), r"'eye'.*shape \(3,\).*\(2,\)"),
    ],
)
def test_the_argument_is_named_with_its_bound(call, named):
    with pytest.raises(ConfigError, match=named):
        call()


def test_pairs_of_two_big_maps_are_refused_before_they_fill_the_memory():
    big = brain.PopulationMap(512, [0, 0], [1, 1])
    with pytest.raises(ConfigError, match=r"len\(inner\) \* len\(outer\) = 68719476736"):
        brain.ConjunctiveMap(big, big)
    with pytest.raises(ConfigError, match="at most 4096 at once"):
        big.encode(np.zeros((5_000, 2)))


def test_numpys_numbers_are_numbers():
    agent = HebbBabbling(
        "BabbleReach-v0",
        seed=np.uint64(2**63),
        quasi_static=np.True_,
        threads=np.int8(1),
        brain={
            "output_neurons": np.int64(5),
            "sigma": np.float32(0.5),
            "rule": {"eta": np.array(0.5)},
        },
    )
    assert agent.seed == 2**63
    assert (agent.brain["output_neurons"], agent.brain["sigma"], agent.brain["rule"]["eta"]) == (
        5,
        0.5,
        0.5,
    )
    assert agent.learn(np.int32(2)).learnt == 2
    cases = scenarios("table1", np.int64(2), np.uint8(1), threads=np.int16(1))
    assert cases == scenarios("table1", 2, 1)
    assert len(brain.PopulationMap(np.int64(3), np.float32(0), np.array([1]))) == 3
    assert BabbleReachVectorEnv(np.int64(2), threads=np.int64(1)).num_envs == 2


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system has no affinity")
def test_threads_are_as_many_as_the_processors_that_this_process_may_use():
    # In a container or a job of a cluster the machine has more.
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        assert checks.processors() == 1
        assert checks.check_threads(None) == 1
        assert BabbleReachVectorEnv(4096).threads == 1
    finally:
        os.sched_setaffinity(0, allowed)
    assert 1 <= checks.processors() <= len(allowed)


def test_nothing_counts_the_processors_in_another_way(repository):
    sources = [
        path
        for folder in ("gym_babble", "examples", "docs/experiments", "bench")
        for path in (repository / folder).rglob("*.py")
    ]
    assert not [path for path in sources if "cpu_count" in path.read_text(encoding="utf-8")]


def test_no_write_falls_between_what_a_rule_of_ones_own_reads_and_writes():
    # The rule reads the weights, computes the change, and writes the weights back.
    refused = []

    def rule(_a, _a_mean, _g, _g_mean, w, _eta, _w_max):
        def write():
            for change in ({"weights": w + 1}, {"a_mean": [1, 1]}, {"g_mean": [1, 1, 1]}):
                with pytest.raises(BusyError):
                    setattr(association, *next(iter(change.items())))
                refused.append(change)
            with pytest.raises(BusyError):
                association.learn(np.ones(3), np.ones(2))

        other = threading.Thread(target=write)
        other.start()
        other.join()
        return np.full_like(w, 0.1)

    association = brain.Association(3, 2, rule)
    association.learn(np.ones(3), np.ones(2))
    assert len(refused) == 3
    assert np.allclose(association.weights, 0.1)
    association.weights = np.zeros((2, 3))
