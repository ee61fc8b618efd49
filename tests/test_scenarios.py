"""Cases by name, and intervals of rates."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binomtest

from gym_babble import (
    Config,
    Evaluation,
    HebbBabbling,
    Oracle,
    Random,
    Scripted,
    evaluate,
    scenarios,
)
from gym_babble.envs import BabbleReachEnv
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import BabbleError, ConfigError, ScenarioError
from gym_babble.study.outcomes import wilson


def test_table1_is_the_same_for_everyone():
    cases = scenarios("table1", 40, seed=1)
    assert len(cases) == 40
    assert cases == scenarios("table1", 40, seed=1, threads=2)
    assert cases[:10] == scenarios("table1", 10, seed=1)
    assert [case["index"] for case in cases] == list(range(40))
    assert {case["protocol"] for case in cases} == {"table1"}
    targets = {case["target"] for case in cases}
    for other in (
        scenarios("table1", 40, seed=2),
        scenarios("table1", 40, seed=1, split="validation"),
        scenarios("table1", 40, seed=1, split="learning"),
    ):
        assert not targets & {case["target"] for case in other}


def test_cases_keep_the_configs_geometry():
    for config, radius, (near, far) in (("paper", 0.035, (0.08, 0.25)), ("icub", 0.02, (0.1, 0.2))):
        for case in scenarios("table1", 50, config=config):
            start, target = np.array(case["start"]), np.array(case["target"])
            assert near <= np.linalg.norm(start - target) <= far
            assert case["obstacle"] == pytest.approx((*((start + target) / 2), radius))


def test_fig4_has_36_starts_around_each_of_4_targets():
    cases = scenarios("fig4")
    targets = {}
    for case in cases:
        targets.setdefault(case["target"], []).append(case)
    assert len(targets) == 4
    for k, (target, around) in enumerate(targets.items()):
        assert len(around) == 36
        assert {case["index"] // 36 for case in around} == {k}
        distances = [math.dist(case["start"], target) for case in around]
        assert distances == pytest.approx([distances[0]] * len(around))


def test_a_case_is_played_as_it_says():
    env = BabbleReachEnv(obs="goal", reward="sparse")
    for case in (*scenarios("table1", 5), *scenarios("fig4")[:5]):
        observation, _ = env.reset(options={"scenario": case})
        assert observation["achieved_goal"] == pytest.approx(case["start"], abs=1e-6)
        assert observation["desired_goal"] == pytest.approx(case["target"], abs=1e-6)
        assert env.scenario["obstacle"] == case["obstacle"]
        env.reset(options=env.scenario)
        assert env.scenario == {key: case[key] for key in ("start", "target", "obstacle")}


def test_options_beside_a_scenario_replace_its_parts():
    case = scenarios("table1", 1)[0]
    env = BabbleReachEnv()
    env.reset(options={"scenario": case, "obstacle": None})
    assert env.scenario == {"start": case["start"], "target": case["target"], "obstacle": None}


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"protocol": "table9"}, "table9"),
        ({"protocol": None}, "protocol"),
        ({"protocol": "table1", "n": 0}, "n = 0"),
        ({"protocol": "table1", "n": -3}, "n = -3"),
        ({"protocol": "table1", "n": 2, "split": "train"}, "train"),
        ({"protocol": "table1", "n": 2, "threads": 0}, "threads"),
        ({"protocol": "table1", "n": 2, "config": "tall"}, "tall"),
        ({"protocol": "table1", "n": 2, "seed": -1}, "seed"),
        ({"protocol": "table1", "n": 2, "seed": 2**64}, "seed"),
        ({"protocol": "table1", "diameters": [0.03]}, r"diameters = \[0.03\]: reaching has no"),
    ],
    ids=str,
)
def test_what_scenarios_refuses(arguments, named):
    with pytest.raises(ConfigError, match=named):
        scenarios(**arguments)


@pytest.mark.parametrize("protocol", ["fig4", "table2", "fig7"])
@pytest.mark.parametrize("argument", [{"seed": 3}, {"split": "validation"}, {"n": 5}, {"seed": 0}])
def test_a_fixed_list_takes_no_seed_split_or_number(protocol, argument):
    # "Seed 3" of a list that has no seed looked like new cases.
    (name,) = argument
    with pytest.raises(ConfigError, match=f"{name} = .*{protocol!r} is one fixed list"):
        scenarios(protocol, **argument)


def test_a_case_bears_the_name_of_its_config():
    labels = {
        scenarios("table1", 1, config=config)[0]["config"]
        for config in (
            "paper",
            {"profile": "paper"},
            Config(),
            "icub",
            {"reach": {"movement_s": 5.0}},
        )
    }
    changed = labels - {"paper", "icub"}
    assert len(labels) == 3
    assert all(label.startswith("paper, changed (") for label in changed)


def test_wilsons_interval():
    # Worked by hand: p = 0.7, n = 10, z = 1.959964.
    z, p, n = 1.959964, 0.7, 10
    centre = (p + z**2 / 20) / (1 + z**2 / 10)
    half = z * math.sqrt(p * 0.3 / n + z**2 / 400) / (1 + z**2 / 10)
    assert wilson(7, 10) == pytest.approx((centre - half, centre + half))
    for count, n in ((7, 10), (670, 1000), (0, 50), (50, 50), (1, 1)):
        reference = binomtest(count, n).proportion_ci(0.95, method="wilson")
        assert wilson(count, n) == pytest.approx((reference.low, reference.high), abs=1e-6)
    assert wilson(0, 0) == (0, 1)
    for n in range(1, 50):  # Rounding leaves no share beside its interval.
        for count in range(n + 1):
            low, high = wilson(count, n)
            assert 0 <= low <= count / n <= high <= 1


def test_evaluation_counts_what_happened():
    cases = scenarios("table1", 60, seed=7)
    result = evaluate(Oracle(), cases=cases)
    assert len(result.outcomes) == 60
    assert set(result.outcomes) <= {"success", "collision", "joint_limit", "timeout"}
    assert result.steps == (1,) * 60
    assert result.rate("success") == sum(result.returns) / 60 > 0.9
    low, high = result.interval("success")
    assert low < result.rate("success") <= high
    reached = tuple(outcome == "success" for outcome in result.outcomes)
    assert result.facts == {"is_success": reached, "ever_success": reached}
    assert result.count("is_success") == result.count("success") == sum(reached)
    assert result.cases == tuple(cases)
    assert isinstance(result, Evaluation)


@pytest.mark.parametrize("ask", ["count", "rate", "interval"])
def test_an_unknown_outcome_or_fact_is_an_error_that_names_what_was_meant(ask):
    # A rate of 0.0 for a word with a slip was believed.
    result = evaluate(Scripted(), cases=scenarios("table1", 3))
    with pytest.raises(ConfigError, match=r"'sucess'.*did you mean 'success'"):
        getattr(result, ask)("sucess")
    with pytest.raises(ConfigError, match=r"'held' is not one of success, collision"):
        getattr(result, ask)("held")
    assert result.rate("timeout") == 0.0


def test_an_evaluation_is_split_by_size():
    cases = scenarios("palm_side", 12)
    result = evaluate("random", "BabbleGrasp-v0", cases)
    split = result.by_size()
    assert list(split) == ["2.4 cm", "6 cm"]
    for size, part in split.items():
        assert {f"{100 * case['diameter']:g} cm" for case in part.cases} == {size}
    for i, case in enumerate(cases):
        part = split[f"{100 * case['diameter']:g} cm"]
        at = part.cases.index(case)
        for name in ("outcomes", "steps", "returns"):
            assert getattr(part, name)[at] == getattr(result, name)[i]
        for name, held in result.facts.items():
            assert part.facts[name][at] == held[i]
    config = {"grasp": {"any_diameter_between": True}}
    cases = scenarios("palm_side", 12, config=config)
    mixed = evaluate("random", "BabbleGrasp-v0", cases, config=config)
    low, high = mixed.by_size().values()
    assert len(low) + len(high) == 12
    assert max(c["diameter"] for c in low.cases) < min(c["diameter"] for c in high.cases)
    assert evaluate(Scripted(), cases=scenarios("table1", 3)).by_size() == {}


def test_evaluation_equals_playing_one_by_one_in_every_control():
    cases = scenarios("table1", 6, seed=8)
    for control in ("pattern", "posture", "delta_posture"):
        env_id = "BabbleReachPattern-v0" if control == "pattern" else "BabbleReachSparse-v0"
        env = BabbleReachEnv(control=control, reward="sparse")
        agent = Scripted(env)
        result = evaluate(agent, env_id, cases, control=control)
        for i, case in enumerate(cases):
            observation, _ = env.reset(options={"scenario": case})
            state, total, steps, ended = None, 0.0, 0, False
            while not ended:
                action, state = agent.predict(observation, state)
                observation, reward, terminated, truncated, info = env.step(action)
                total, steps, ended = total + reward, steps + 1, terminated or truncated
            expected = (outcome_of(info), steps, total)
            assert (result.outcomes[i], result.steps[i], result.returns[i]) == expected
            assert {name: held[i] for name, held in result.facts.items()} == {
                name: info[name] for name in result.facts
            }


def test_agents_are_ordered_as_documented():
    cases = scenarios("table1", 150, seed=9)
    rates = {
        name: evaluate(agent, cases=cases).rate("success")
        for name, agent in (
            ("random", Random(seed=0)),
            ("hebb", HebbBabbling(seed=1).learn(2000)),
            ("scripted", Scripted()),
            ("oracle", Oracle()),
        )
    }
    assert rates["random"] < 0.45 < rates["hebb"] < rates["scripted"] <= rates["oracle"]


def test_an_evaluation_of_nothing_or_of_cases_of_another_body():
    with pytest.raises(ConfigError, match="cases"):
        evaluate(Scripted(), cases=[])
    with pytest.raises(ScenarioError, match=r"cases\[1\] is a int"):
        evaluate(Scripted(), cases=[*scenarios("table1", 1), 3])
    far = {
        "protocol": "table1",
        "index": 0,
        "start": (0.3, 0.1),
        "target": (9, 9),
        "obstacle": None,
    }
    with pytest.raises(ScenarioError, match="target") as caught:
        evaluate(Scripted(), cases=[far])
    assert isinstance(caught.value, BabbleError)
