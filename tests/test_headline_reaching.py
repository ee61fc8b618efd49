"""What docs/model.md says of reaching's readouts and of noise, in a small form.

Learning seeds and cases differ from the stored ones.
"""

import math
from statistics import fmean

import gymnasium as gym
import pytest

from gym_babble import HebbBabbling, evaluate, scenarios
from results.stores import Stores

PATTERN = "BabbleReachPattern-v0"
EARLY = {"rule": {"name": "hebb", "eta": 1.0, "w_max": 0.02}, "input_gain": 200.0}
CASES = 1_000
SEEDS = (40, 41)


@pytest.fixture(scope="module")
def stored():
    return Stores()


def success(agent, seed, config):
    cases = scenarios("table1", CASES, seed, config=config)
    return evaluate(agent, PATTERN, cases, config=config).rate("success")


def of(rows, **wanted):
    (found,) = (row for row in rows if wanted.items() <= row.items())
    return found


@pytest.mark.parametrize("body", ["paper", "icub"])
def test_an_agent_of_few_movements(stored, body):
    """Two seeds fit the stored five, and beat the default rule on the same babbles and cases."""
    known = of(
        stored["readouts"][body],
        network="obstacle x eye, Hebb",
        readout="peak",
        movements=250,
    )["by_seed"]
    rates = {}
    for name, brain in (("early", EARLY), ("default", None)):
        env = gym.make(PATTERN, config=body)
        agents = [HebbBabbling(env, "conjunctive", seed=k, brain=brain).learn(250) for k in SEEDS]
        rates[name] = [success(agent, 2_000 + agent.seed, body) for agent in agents]
    mean = fmean(known)
    spread = max(math.sqrt(mean * (1 - mean) / CASES), max(known) - min(known))
    error = spread * math.sqrt(1 / len(SEEDS) + 1 / len(known))
    assert fmean(rates["early"]) == pytest.approx(mean, abs=3.5 * error)
    assert fmean(rates["early"]) > fmean(rates["default"])


def test_noise_of_muscles_costs_what_is_stored(stored):
    """Success without and with it, of an agent of fewer movements than the stored ones."""
    rows = stored["changed_body"]["conjunctive"]
    agent = HebbBabbling(PATTERN, "conjunctive", seed=40, brain=EARLY).learn(250)
    for change, config in (("none", {}), ("noise of muscles", {"noise": {"motor_deg": 10.0}})):
        known = of(rows, change=change, movements=0)["success"]
        # More movements make an agent better by a few hundredths, with noise or without.
        there = agent.continue_in(gym.make(PATTERN, config=config))
        assert success(there, 2_000, config) == pytest.approx(known, abs=0.08), change
