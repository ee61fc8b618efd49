"""How far can an agent come that sees the direction of the obstacle alone, as the paper's does?

Learning cases vote, each with a weight that falls with the distance between what is seen in it and
in the test: the b1 that succeeds in most of them is tried. Such a vote needs neither maps nor a
rule. What it misses is not in the input; what the paper's agent misses beyond that is lost by its
rule and its readout. docs/model.md has the results.
"""

import argparse
import json

import gymnasium as gym
import numpy as np

from gym_babble import HebbBabbling, evaluate, scenarios

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--cases", type=int, default=10_000, help="learning cases of the vote")
parser.add_argument("--tests", type=int, default=1_000, help="cases of each seed, from 1,000 on")
parser.add_argument("--seeds", type=int, default=5, help="seeds of learning, from 20 on")
parser.add_argument("--movements", type=int, default=20_000, help="legal movements of the agent")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

PATTERN = "BabbleReachPattern-v0"
B1 = np.linspace(0.02, 0.98, 33)
# Widths of the vote [deg, % of the eye's range]; the best on validation cases is taken.
WIDTHS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8)


def played(cases: list) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Obstacle (n, 2) [deg] and eye (n, 2) [%] of each case, and which b1 succeed (n, 33)."""
    envs = gym.make_vec(PATTERN, num_envs=len(cases), autoreset_mode="Disabled")
    succeeds = np.zeros((len(cases), len(B1)), bool)
    for k, b1 in enumerate(B1):
        senses, _ = envs.reset(options={"scenario": cases})
        action = np.array([2 * b1 - 1, 1 - 2 * b1], np.float32)
        _, reward, *_ = envs.step(np.tile(action, (len(cases), 1)))
        succeeds[:, k] = reward > 0
    envs.close()
    return np.degrees(senses["obstacle"]), 100 * senses["eye"], succeeds


def vote(seen: np.ndarray, succeeds: np.ndarray, tests: np.ndarray, width: float) -> np.ndarray:
    """Index of the b1 that the learning cases vote for in each test."""
    chosen = []
    for some in np.array_split(tests, max(1, len(tests) // 250)):
        squares = ((some[:, None] - seen[None]) ** 2).sum(axis=2)
        near = np.exp(-squares / (2 * width**2)) + 1e-12
        chosen.append((near @ succeeds).argmax(axis=1))
    return np.concatenate(chosen)


def rates_of(sees: list[int], learning: tuple, tests: list[tuple]) -> list[float]:
    """Success in each of the tests of a vote on the percepts `sees`, 0 obstacle and 1 eye."""
    seen = np.hstack([learning[i] for i in sees])
    rates = []
    for test in tests:
        others = np.hstack([test[i] for i in sees])
        by_width = [vote(seen, learning[2], others, width) for width in WIDTHS]
        rates.append([test[2][np.arange(len(others)), chosen].mean() for chosen in by_width])
    best = int(np.argmax(rates[0]))  # The first are validation cases.
    return [rate[best] for rate in rates[1:]]


def rates_of_side(tests: list[tuple]) -> list[float]:
    """Success in each of the tests of one curve, always as wide, to the side that succeeds."""
    rates, half = [], len(B1) // 2
    for *_, succeeds in tests:
        left = succeeds[:, half:].any(axis=1, keepdims=True)
        rates.append(np.where(left, succeeds[:, half:], succeeds[:, half::-1]).mean(axis=0))
    best = int(np.argmax(rates[0]))
    return [rate[best] for rate in rates[1:]]


learning = played(scenarios("table1", arguments.cases, 900, split="validation"))
drawn = [scenarios("table1", arguments.tests, 901, split="validation")]
drawn += [scenarios("table1", arguments.tests, 1_000 + k) for k in range(arguments.seeds)]
tests = [played(cases) for cases in drawn]
constant = int(learning[2].mean(axis=0).argmax())
hebb = []
for seed, cases in enumerate(drawn[1:], start=20):
    agent = HebbBabbling(PATTERN, seed=seed).learn(arguments.movements)
    hebb.append(evaluate(agent, PATTERN, cases).rate("success"))
rates = {
    "constant": [test[2][:, constant].mean() for test in tests[1:]],
    "hebb": hebb,
    "vote_obstacle": rates_of([0], learning, tests),
    "vote_eye": rates_of([1], learning, tests),
    "vote_obstacle_eye": rates_of([0, 1], learning, tests),
    "side": rates_of_side(tests),
    "any": [test[2].any(axis=1).mean() for test in tests[1:]],
}
if arguments.json:
    found = {
        name: {"success": float(np.mean(by_seed)), "by_seed": [float(rate) for rate in by_seed]}
        for name, by_seed in rates.items()
    }
    print(json.dumps(found))
else:
    print("| choice of b1 | success | by seed |")
    print("| --- | --- | --- |")
    for name, by_seed in rates.items():
        each = ", ".join(f"{rate:.3f}" for rate in by_seed)
        print(f"| {name} | {np.mean(by_seed):.3f} | {each} |")
