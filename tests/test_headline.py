"""Table I and the hold rates are what README and docs say.

A small run of each variant is compared with the stored one of the same settings and more seeds. A
band has 3.5 standard errors on either side, from the spread of the stored seeds, which is taken as
no smaller than that of independent cases. So a change of the random draws passes, and a change of
the science (the rule, the camera, what counts as success) does not: then measure the results anew.
"""

import math
from statistics import fmean, stdev

import pytest

from gym_babble.paper.holding import hold_rates
from gym_babble.paper.table1 import table1
from gym_babble.study.rates import OUTCOMES
from results.stores import Stores

SIGMAS = 3.5
SEEDS = 2


def band(seeds, name):
    """Lowest and highest mean of two seeds that fits the stored seeds."""
    rates = [seed[name]["rate"] for seed in seeds]
    mean, cases = fmean(rates), fmean(seed["cases"] for seed in seeds)
    # As if two more cases had been played, one of each outcome: no rate of 0 or 1 is certain.
    likely = (mean * cases + 1) / (cases + 2)
    spread = max(stdev(rates), math.sqrt(likely * (1 - likely) / cases))
    error = spread * math.sqrt(1 / SEEDS + 1 / len(rates))
    return mean - SIGMAS * error, mean + SIGMAS * error


def assert_fits(found, stored, name, where):
    low, high = band(stored, name)
    rate = fmean(seed[name]["rate"] for seed in found)
    assert low <= rate <= high, f"{where}: {name} {rate:.3f} is not in [{low:.3f}, {high:.3f}]"


@pytest.fixture(scope="module")
def stored():
    return Stores()


@pytest.mark.parametrize("variant", ["paper", "conjunctive"])
def test_table_1(stored, variant):
    reference = stored["table1"][f"{variant}-4000"]
    table = table1(seeds=SEEDS, variant=variant, movements=reference["movements"]).to_json()
    for name in OUTCOMES:
        assert_fits(table["by_seed"], reference["by_seed"], name, variant)
    legal, known = (run["over_seeds"]["legal_rate"]["mean"] for run in (table, reference))
    assert legal == pytest.approx(known, abs=SIGMAS * math.sqrt(known * (1 - known) / 10_000))


def test_the_stored_tables_differ_by_learning_alone(stored):
    """The small run's reference is close to what the docs quote."""
    for variant in ("paper", "conjunctive"):
        small, whole = (stored["table1"][run] for run in (f"{variant}-4000", variant))
        success = [run["over_seeds"]["success"]["mean"] for run in (small, whole)]
        assert success[1] - 0.03 < success[0] < success[1] + 0.01


def test_hold_rates(stored):
    """Ten trials of each size: as many held as the stored rate makes likely."""
    reference = stored["sizes"]["tree"]
    found = hold_rates(10, diameters=[known["diameter"] for known in reference])
    for rate, known in zip(found, reference, strict=True):
        likely = (known["held"] + 1) / (known["trials"] + 2)
        error = math.sqrt(likely * (1 - likely) * (1 / 10 + 1 / known["trials"]))
        assert abs(rate["rate"] - known["rate"]) <= SIGMAS * error, rate
