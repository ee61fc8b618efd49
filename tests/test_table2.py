"""Table II, Figures 7 and 8, and what the eye sees, in small."""

import csv
import io
import json

import numpy as np
import pytest
from rich.console import Console

from gym_babble import HebbBabbling, scenarios
from gym_babble.paper import fig7, fig8, holding, sight
from gym_babble.paper import table2 as grasping
from gym_babble.paper.tables import table2_tables
from gym_babble.study.outcomes import wilson


def test_rates_are_those_of_the_tests(table_two):
    document = json.loads(json.dumps(table_two.to_json()))
    rows = list(csv.DictReader(io.StringIO(table_two.to_csv())))
    for size in document["sizes"]:
        for protocol, found in size["tests"].items():
            means, by_seed = found["over_seeds"], found["by_seed"]
            assert means["seeds"] == len(by_seed)
            for fact in grasping.FACTS:
                rates = [seed[fact]["rate"] for seed in by_seed]
                assert means[fact]["mean"] == pytest.approx(np.mean(rates))
                assert (means[fact]["min"], means[fact]["max"]) == (min(rates), max(rates))
                for seed in by_seed:  # The interval is that of the seed's own cases.
                    count, cases = seed[fact]["count"], seed["cases"]
                    interval = (seed[fact]["low"], seed[fact]["high"])
                    assert interval == wilson(count, cases)
            # A palm that touches is a part that touches, and what is held was touched.
            for seed in by_seed:
                assert seed["held"]["count"] <= seed["reach"]["count"]
                assert seed["palm_reach"]["count"] <= seed["reach"]["count"]
            of_row = [r for r in rows if r["protocol"] == protocol]
            of_row = [r for r in of_row if float(r["diameter_m"]) == size["diameter"]]
            assert len(of_row) == len(by_seed)


def test_every_grid_case_is_played_once_for_each_seed(table_two):
    for size in table_two.sizes:
        played = sum(case["diameter"] == size.diameter for case in scenarios("table2"))
        assert [len(test.outcomes) for test in size.tests["table2"].values()] == [played, played]
        assert size.hands.shape == (2 * played, 2)


def test_the_small_object_closes_the_hand_further(table_two):
    small, big = table_two.sizes
    assert (small.babbled.mean(axis=0) < big.babbled.mean(axis=0) - 10).all()
    assert (np.abs(small.hands.mean(axis=0) - small.babbled.mean(axis=0)) < 10).all()


def test_the_reflex_holds(table_two):
    assert [rate["diameter"] for rate in table_two.hold] == list(holding.HOLD_DIAMETERS_M)
    for rate in table_two.hold:
        assert rate["held"] == rate["trials"] == 3
        assert rate["penetration_mm"] < 3.0


def test_a_first_seed_goes_on_where_an_earlier_table_ended(table_two):
    second = grasping.table2(seed=1, seeds=1, cases=40, babbles=200, hold_trials=0)
    for size, whole in zip(second.sizes, table_two.sizes, strict=True):
        for protocol, tests in size.tests.items():
            of_seed_1 = {seed: test for seed, test in whole.tests[protocol].items() if seed == 1}
            assert tests == of_seed_1


@pytest.mark.slow
def test_the_reflex_holds_in_90_of_100(capsys):
    rates = holding.hold_rates(100)
    with capsys.disabled():
        print([(rate["diameter"], rate["held"]) for rate in rates])
    assert all(rate["held"] >= 90 for rate in rates)


def test_tables_show_both_sizes_beside_the_paper(table_two):
    console = Console(width=100, record=True, file=io.StringIO())
    for part in table2_tables(table_two.to_json()):
        console.print(part)
    text = console.export_text()
    seeds = ("2 seeds", "seed 0", "seed 1")
    for known in ("36.99", "46.34", ".715", ".111", "2.4 cm, thumb", "6 cm, palm_side", *seeds):
        assert known in text


def test_trajectories_end_at_touched_objects():
    agent = HebbBabbling("BabbleGrasp-v0", seed=1).learn(60)
    cases = [case for case in scenarios("fig7") if case["diameter"] == 0.06][::20]
    palms = fig7.trajectories(agent, cases)
    assert [one.case for one in palms] == cases
    for one in palms:
        near = np.linalg.norm(one.palm - np.array(one.case["object"]), axis=1).min()
        if one.held:
            assert one.reach
            assert near < 0.03 + 0.06
    figure = fig7.draw(palms)
    (axes,) = figure.axes
    assert len(axes.patches) == len({one.case["object"] for one in palms})
    assert f"{sum(one.held for one in palms)} grasped" in axes.get_title(loc="left")


def test_fig8_shows_the_agents_own_weights():
    agent = HebbBabbling("BabbleGrasp-v0", seed=1).learn(60)
    figure = fig8.draw(agent, eye=(0.5, 0.8))
    outward = next(ax for ax in figure.axes if "eye neuron" in ax.get_title(loc="left"))
    shown = outward.images[0].get_array()
    expected = agent.weights["reach.weights"][:, 16 * 21 + 10].reshape(21, 21)
    np.testing.assert_array_equal(shown, expected)


def test_fig8_is_a_mexican_hat():
    # Around the peak the weights are negative, and more so than far away, as in the paper's figure.
    hat = fig8.weights_by_distance(HebbBabbling("BabbleGrasp-v0", seed=1).learn(150))
    surround, far = hat[3:6].mean(), hat[12:20].mean()
    assert hat[0] > 0.15
    assert surround < -0.03
    assert surround < far - 0.02
    # A rule that learns once in a babble leaves a plateau.
    once = HebbBabbling("BabbleGrasp-v0", seed=1, brain={"learning_period_s": None}).learn(150)
    plateau = fig8.weights_by_distance(once)
    assert plateau[0] > 0.15
    assert plateau[3:6].mean() > plateau[12:20].mean() - 0.01


def test_eye_views_are_of_both_sizes():
    seen = sight.eye_views(size=63)
    assert [name for name, _ in seen] == ["2.4 cm", "6 cm"]
    red = [np.sum(image[1][..., 0] > 2 * image[1][..., 1].astype(int)) for _, image in seen]
    assert red[1] > 4 * red[0] > 0
    assert len(sight.draw(seen).axes) == 6
