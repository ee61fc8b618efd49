"""The comparison: what each row holds, and what happens where an extra is missing."""

import json
import sys
from contextlib import contextmanager

import pytest
from rich.console import Console

from gym_babble import evaluate, scenarios
from gym_babble.config import Config
from gym_babble.errors import ConfigError, StudyError
from gym_babble.study import learning
from gym_babble.study.compare import compare
from gym_babble.study.comparison import TrainedResult
from gym_babble.study.contenders import CONTENDERS, Settings
from gym_babble.study.rates import OUTCOMES
from gym_babble.study.stored import STUDIES, Study
from gym_babble.study.tasks import GRASP

SMALL = Settings(cases=50, movements=500, ppo_steps=1)
SMALL_GRASPING = Settings(task="grasp", cases=8, babbles=60, ppo_steps=1)


@pytest.fixture(scope="module")
def comparison():
    return compare(None, SMALL)


@contextmanager
def few_validations():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learning, "VALIDATION_CASES", 4)
        yield


@pytest.fixture(scope="module")
def grasping():
    with few_validations():
        return compare(None, SMALL_GRASPING)


def printed(comparison, width=80):
    console = Console(width=width)
    with console.capture() as capture:
        console.print(comparison.table())
    return capture.get()


def test_all_contenders_take_part_in_their_order(comparison):
    assert [result.contender.key for result in comparison.results] == [
        contender.key for contender in CONTENDERS["reach"]
    ]
    assert not comparison.skipped


def test_each_agent_is_tested_on_the_same_cases(comparison):
    cases = scenarios("table1", 50)
    for result in comparison.results:
        one = result.trained[0]
        again = evaluate(one.agent, cases=cases)
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
        assert one.accepted == 500
        assert one.control_steps == one.trials * steps
        assert 0.1 < comparison.result(key).accepted_rate < 0.3
        assert [point.control_steps for point in one.curve][-1] == one.control_steps
        assert len(one.curve) == 2


def test_ppo_counts_whole_movements_alike(comparison):
    pattern = comparison.result("ppo-pattern").trained[0]
    assert pattern.control_steps == 224 * pattern.trials
    posture = comparison.result("ppo-posture").trained[0]
    assert posture.curve[-1].control_steps == posture.control_steps


def test_json_holds_every_rate(comparison):
    document = json.loads(json.dumps(comparison.to_json(), allow_nan=False))
    assert document["paper"]["test"]["success"]["rate"] == 0.67
    for row in document["agents"]:
        (test,) = row["test_by_seed"]
        assert sum(test[name]["count"] for name in OUTCOMES) == 50
        assert sum(row["test"][name]["mean"] for name in OUTCOMES) == pytest.approx(1.0)
        assert "by_size" not in test


def test_the_tables_fit_80_characters_and_lose_nothing(comparison, grasping):
    for one in (comparison, grasping):
        told = printed(one)
        assert "…" not in told
        assert max(map(len, told.splitlines())) <= 80
        for result in one.results:
            assert result.contender.title in told
            assert result.contender.detail in told
    assert ".640–.698" in printed(comparison)
    assert "examples/ppo_study.py --task grasp" in printed(grasping, 400)


def test_grasping_leaves_out_who_must_be_asked_for(grasping):
    keys = [result.contender.key for result in grasping.results]
    assert keys == ["hebb-paper", "ppo-stored", "scripted", "random"]
    assert not grasping.skipped


def test_agents_of_grasping_are_tested_on_the_same_cases(grasping):
    cases = scenarios("palm_side", 8)
    for result in grasping.results:
        if isinstance(result, TrainedResult) and result.contender.key != "random":
            assert evaluate(result.trained[0].agent, cases=cases) == result.tests[0]
    # Who knows the geometry grasps, who acts at random does not: the rows are not exchanged.
    assert grasping.result("scripted").rates_by_seed[0]["success"]["count"] == 8
    assert grasping.result("random").rates_by_seed[0]["success"]["count"] == 0


def test_hebb_grasping_counts_what_it_babbled(grasping):
    result = grasping.result("hebb-paper")
    (one,) = result.trained
    assert one.accepted == 60 <= one.trials
    assert one.control_steps == 160 * one.trials  # 8 s in steps of 50 ms.
    assert result.accepted_rate == 60 / one.trials
    assert one.curve[-1].control_steps == one.control_steps
    assert len(one.curve) == 2


def test_ppo_learns_to_grasp_when_it_is_asked_for():
    with few_validations():
        (result,) = compare(["ppo-posture"], SMALL_GRASPING).results
    (one,) = result.trained
    assert one.control_steps == 8_192  # One rollout.
    assert one.curve[-1].control_steps == one.control_steps
    assert result.rates_by_seed[0]["cases"] == 8


def test_json_of_grasping_holds_every_rate_and_where_the_stored_row_is_from(grasping):
    document = json.loads(json.dumps(grasping.to_json(), allow_nan=False))
    assert (document["task"], document["protocol"]) == ("grasp", "palm_side")
    assert document["babbles"] == 60
    assert "movements" not in document
    for test in (test for row in document["agents"] for test in row["test_by_seed"]):
        assert sum(test[name]["count"] for name in GRASP.outcomes) == test["cases"]
        assert test["palm_reach"]["count"] <= test["reach"]["count"] <= test["cases"]
        assert test["success"]["count"] <= test["reach"]["count"]
    hebb = document["agents"][0]
    assert hebb["training_by_seed"][0]["kept_babbles"] == 60
    assert hebb["kept_rate"] == 60 / hebb["training_by_seed"][0]["babbles"]
    stored = document["agents"][1]["stored"]
    assert stored["command"].startswith("python examples/ppo_study.py --task grasp")
    assert stored["presets"]["grasp"]["env_id"] == "BabbleGrasp-v0"


def test_results_of_grasping_are_split_by_size(grasping):
    # One rate for both sizes misleads: the big object is held, and the small one is missed.
    cases = scenarios("palm_side", 8)
    for result in grasping.results:
        if not isinstance(result, TrainedResult):
            continue
        (rates,), (test,) = result.rates_by_seed, result.tests
        assert list(rates["by_size"]) == ["2.4 cm", "6 cm"]
        for size, diameter in (("2.4 cm", 0.024), ("6 cm", 0.06)):
            of_size = [
                outcome
                for case, outcome in zip(cases, test.outcomes, strict=True)
                if case["diameter"] == diameter
            ]
            assert rates["by_size"][size]["cases"] == len(of_size)
            assert rates["by_size"][size]["success"]["count"] == of_size.count("success")
        assert [row.title for row in result.rows] == ["", "2.4 cm", "6 cm"]
    assert "6 cm" in printed(grasping)


def test_the_stored_row_is_the_studys(grasping):
    study = Study.read(STUDIES / "ppo_grasp.json")
    result = grasping.result("ppo-stored")
    for rates, run in zip(result.rates_by_seed, study.runs, strict=True):
        assert {name: rates[name]["count"] for name in GRASP.rates} | {
            "cases": rates["cases"]
        } == run.counts
    # Seeds are not pooled: their mean and range, then a row with each one's own interval.
    first, *rest = [row for row in result.rows if "cm" not in row.title]
    success = [run.counts["success"] / run.counts["cases"] for run in study.runs]
    assert first.rates["success"]["rate"] == pytest.approx(sum(success) / len(success))
    assert first.rates["success"]["low"] == min(success)
    assert first.rates["success"]["high"] == max(success)
    assert [row.title for row in rest] == [f"seed {run.seed}" for run in study.runs]
    assert [row.rates["success"]["rate"] for row in rest] == success
    assert [len(one.curve) for one in result.trained] == [len(run.curve) for run in study.runs]
    assert not isinstance(result, TrainedResult)


def test_the_study_is_a_whole_one():
    # Catches a trial run that was left in the package.
    study = Study.read(STUDIES / "ppo_grasp.json")
    assert [run.seed for run in study.runs] == [0, 1, 2]
    for run in study.runs:
        assert run.steps == 2_500_000
        assert run.counts["cases"] == 1000


def test_a_study_is_read_as_it_was_written(tmp_path):
    study = Study.read(STUDIES / "ppo_grasp.json")
    study.write(tmp_path / "study.json")
    assert Study.read(tmp_path / "study.json") == study
    for broken in ("", "[]", "{}", '{"runs": [{"seed": 0}]}'):
        (tmp_path / "study.json").write_text(broken)
        with pytest.raises(StudyError, match=r"study\.json: not a stored study"):
            Study.read(tmp_path / "study.json")


def test_a_study_of_another_body_is_left_out():
    found = compare(["ppo-stored"], Settings(task="grasp", config="icub", cases=1))
    assert not found.results
    assert "paper" in found.skipped["ppo-stored"]


def test_seeds_are_not_pooled():
    # As if they were cases, they would look far more certain than they are.
    settings = Settings(seed=5, seeds=2, cases=50)
    (one,) = compare(["random"], settings).results
    assert one.seeds == (5, 6)
    assert len(one.trained) == len(one.tests) == 2
    assert one.tests[0] != one.tests[1]
    rates = [test.rate("success") for test in one.tests]
    told = one.to_json()
    assert told["test"]["success"]["mean"] == pytest.approx(sum(rates) / 2)
    assert (told["test"]["success"]["min"], told["test"]["success"]["max"]) == (
        min(rates),
        max(rates),
    )
    for seed, test, row in zip((5, 6), one.tests, told["test_by_seed"], strict=True):
        assert (row["seed"], row["cases"]) == (seed, 50)
        assert (row["success"]["low"], row["success"]["high"]) == test.interval("success")
        assert test.cases == tuple(scenarios("table1", 50, seed))
    assert [row.title for row in one.rows] == ["", "seed 5", "seed 6"]


def test_without_stable_baselines3_the_others_run(monkeypatch):
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    for name in list(sys.modules):
        if name in (
            "gym_babble.study.trainers.sb3",
            "gym_babble.sb3",
        ) or name.startswith("stable_baselines3."):
            monkeypatch.delitem(sys.modules, name)
    said = []
    found = compare(["ppo-pattern", "scripted"], SMALL, log=said.append)
    assert [result.contender.key for result in found.results] == ["scripted"]
    assert "gym-babble[sb3]" in found.skipped["ppo-pattern"]
    assert any("gym-babble[sb3]" in line for line in said)
    assert found.to_json()["skipped"][0]["agent"] == "ppo-pattern"
    assert "gym-babble[sb3]" in printed(found, 120)


def test_bad_settings_are_refused():
    with pytest.raises(ConfigError, match="nobody"):
        compare(["nobody"], SMALL)
    with pytest.raises(ConfigError, match="octopus"):
        compare(["random"], Settings(config="octopus"))
    with pytest.raises(ConfigError, match="seeds"):
        compare(["random"], Settings(seeds=0))
    with pytest.raises(ConfigError, match="seed"):
        compare(["random"], Settings(seed=-1))
    with pytest.raises(ConfigError, match="babbles"):
        compare(["random"], Settings(task="grasp", babbles=0))
    with pytest.raises(ConfigError, match="fly"):
        compare(["random"], Settings(task="fly"))
    with pytest.raises(ConfigError, match="oracle"):
        compare(["oracle"], Settings(task="grasp"))
