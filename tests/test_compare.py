"""The comparison: what each row holds, and what happens where an extra is missing."""

import json
import sys

import pytest
from rich.console import Console

from gym_babble import evaluate, scenarios
from gym_babble.compare import CONTENDERS, Settings, compare
from gym_babble.config import Config
from gym_babble.errors import ConfigError
from gym_babble.tables import OUTCOMES

SMALL = Settings(cases=50, movements=500, ppo_steps=1)


@pytest.fixture(scope="module")
def comparison():
    return compare(None, SMALL)


def test_all_contenders_take_part_in_their_order(comparison):
    assert [result.contender.key for result in comparison.results] == [c.key for c in CONTENDERS]
    assert not comparison.skipped


def test_each_agent_is_tested_on_the_same_cases(comparison):
    cases = scenarios("table1", 50)
    for result in comparison.results:
        one = result.trained[0]
        again = evaluate(one.agent, one.env_id, cases, **one.env_kwargs)
        if result.contender.key != "random":  # It has gone on babbling.
            assert again == result.tests[0]


def test_agents_act_where_they_learnt(comparison):
    ids = {result.contender.key: result.trained[0].env_id for result in comparison.results}
    assert ids.pop("ppo-posture") == "BabbleReach-v0"
    assert set(ids.values()) == {"BabbleReachPattern-v0"}


def test_hebb_agents_count_what_they_babbled(comparison):
    steps = Config.profile_named("paper").movement_steps
    assert steps == 224  # 8 s and four time constants of .8 s, in steps of 50 ms.
    for key in ("hebb-paper", "hebb-conjunctive"):
        one = comparison.result(key).trained[0]
        assert one.legal_movements == 500
        assert one.control_steps == one.movements * steps
        assert 0.1 < comparison.result(key).legal_rate < 0.3
        assert [point.control_steps for point in one.curve][-1] == one.control_steps
        assert len(one.curve) == 2


def test_ppo_counts_whole_movements_alike(comparison):
    pattern = comparison.result("ppo-pattern").trained[0]
    assert pattern.control_steps == 224 * pattern.movements
    posture = comparison.result("ppo-posture").trained[0]
    assert posture.curve[-1].control_steps == posture.control_steps


def test_json_holds_every_rate(comparison):
    document = json.loads(json.dumps(comparison.to_json(), allow_nan=False))
    assert document["paper"]["test"]["success"]["rate"] == 0.67
    for row in document["agents"]:
        assert sum(row["test"][name]["count"] for name in OUTCOMES) == 50
        assert sum(row["test"][name]["rate"] for name in OUTCOMES) == pytest.approx(1.0)


def test_the_table_fits_80_characters_and_loses_nothing(comparison):
    console = Console(width=80)
    with console.capture() as capture:
        console.print(comparison.table())
    printed = capture.get()
    assert "…" not in printed
    assert max(map(len, printed.splitlines())) <= 80
    for result in comparison.results:
        assert result.contender.title in printed
        assert result.contender.detail in printed
    assert ".640–.698" in printed


def test_seeds_are_pooled():
    two = compare(["random"], Settings(seeds=2, cases=50))
    one = two.results[0]
    assert len(one.trained) == len(one.tests) == 2
    assert one.tests[0] != one.tests[1]
    assert len(one.pooled.outcomes) == 100


def test_without_stable_baselines3_the_others_run(monkeypatch):
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    for name in list(sys.modules):
        if name in ("gym_babble.ppo", "gym_babble.sb3") or name.startswith("stable_baselines3."):
            monkeypatch.delitem(sys.modules, name)
    said = []
    found = compare(["ppo-pattern", "scripted"], SMALL, say=said.append)
    assert [result.contender.key for result in found.results] == ["scripted"]
    assert "gym-babble[sb3]" in found.skipped["ppo-pattern"]
    assert any("gym-babble[sb3]" in line for line in said)
    assert found.to_json()["skipped"][0]["agent"] == "ppo-pattern"
    console = Console(width=120)
    with console.capture() as capture:
        console.print(found.table())
    assert "gym-babble[sb3]" in capture.get()


def test_bad_settings_are_refused():
    with pytest.raises(ConfigError, match="nobody"):
        compare(["nobody"], SMALL)
    with pytest.raises(ConfigError, match="octopus"):
        compare(["random"], Settings(body="octopus"))
    with pytest.raises(ConfigError, match="seeds"):
        compare(["random"], Settings(seeds=0))
