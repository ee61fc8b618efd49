"""Lesson 8: any sound work is right, and what is unsound is named."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

import gym_babble
from gym_babble import course
from gym_babble.course.own_work import CASES, held_out, movements_of_agents, solved

REACH = "BabbleReachPattern-v0"


def eq7(a, a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    return eta * np.outer(a - a_mean, g - g_mean) * (w_max - abs(w))


def without_input_mean(a, a_mean, g, _g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    return eta * np.outer(a - a_mean, g) * (w_max - abs(w))


def without_output_mean(a, _a_mean, g, g_mean, w, eta, w_max):  # noqa: PLR0917 - a rule's
    return eta * np.outer(a, g - g_mean) * (w_max - abs(w))


@pytest.mark.parametrize("rule", [without_input_mean, without_output_mean])
def test_own_rules_that_beat_chance_are_right(rule):
    assert course.check("8.1", rule).right


def noisy(*arguments):
    return without_input_mean(*arguments) * np.random.default_rng().uniform(0.9, 1.1)


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        (eq7, "This is Eq. 7"),
        (lambda a, _m, g, _n, w, e, b: e * np.outer(a, g) * (b - abs(w)), "plain Hebb"),
        (lambda _a, _m, _g, _n, w, _e, _b: np.zeros_like(w), "is not above"),
        (noisy, "acts differently"),
        (lambda _a, _m, _g, _n, w, _e, _b: w * np.nan, "not finite"),
        ("covariance", "no function"),
    ],
)
def test_unsound_rules_are_named(rule, said):
    result = course.check("8.1", rule)
    assert result.state == "wrong"
    assert said in repr(result)


def test_a_rule_with_blanks_is_not_answered_yet():
    assert course.check("8.1", lambda *_: ...).state == "unanswered"


class Curves:
    """Curves to a side."""

    def __init__(self, seed):
        self.seed = seed

    def predict(self, observation):
        b1 = 0.5 if observation["obstacle"][0] > 0 else -0.5
        return np.array([b1, -b1], np.float32)


class Batched(Curves):
    """Takes whole batches, as stable-baselines3's agents do."""

    def predict(self, observation, state=None, episode_start=None, deterministic=True):
        del episode_start, deterministic
        b1 = np.where(observation["obstacle"][:, 0] > 0, 0.5, -0.5)
        return np.stack([b1, -b1], axis=1), state


@pytest.mark.parametrize(
    "make",
    [
        Curves,
        Batched,
        lambda seed: gym_babble.HebbBabbling(REACH, seed=seed).learn(100),
        lambda seed: gym_babble.NearestNeighbours(REACH, seed=seed).learn(100),
    ],
)
def test_agents_of_all_kinds_that_beat_chance_are_right(make):
    assert course.check("8.2", make).right


class Drifts(Curves):
    """Draws from a generator without a seed."""

    def predict(self, observation):
        del observation
        return np.random.default_rng().uniform(-1, 1, 2)


class Straight(Curves):
    """Moves straight on, into the obstacle."""

    def predict(self, observation):
        del observation
        return np.zeros(2)


class Wide(Curves):
    """Wants more than there is."""

    def predict(self, observation):
        del observation
        return np.array([3.0, 3.0])


class One(Curves):
    """Gives one number."""

    def predict(self, observation):
        del observation
        return np.zeros(1)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (Drifts, "acts differently"),
        (Straight, "is not above"),
        (Wide, "between -1 and 1"),
        (One, "expected (200, 2)"),
        (Curves(0), "`MyAgent`, not `MyAgent()`"),
        (lambda _seed: 3, "no method `predict`"),
        (lambda: Curves(0), "TypeError"),
    ],
)
def test_unsound_agents_are_named(make, said):
    result = course.check("8.2", make)
    assert result.state == "wrong"
    assert said in repr(result)


def test_an_agent_with_blanks_is_not_answered_yet():
    class Blank(Curves):
        def predict(self, observation):
            del observation
            return ...

    assert course.check("8.2", Blank).state == "unanswered"
    assert course.check("8.2", lambda _seed: ...).state == "unanswered"


def test_replayed_movements_solve_what_the_agent_solved():
    played = gym_babble.evaluate(Curves(0), REACH, held_out())
    assert solved(movements_of_agents(Curves)["first"]) == played.count("success")
    assert len(played) == CASES


@pytest.mark.parametrize(
    ("ball", "said"),
    [
        ({"diameter_cm": 11}, ""),
        ({"diameter_cm": np.float64(11.0), "friction": 0.7}, ""),
        ({"diameter_cm": 6}, "too easy"),
        ({"diameter_cm": 16}, "too hard"),
        ({"diameter_cm": 200}, "cannot be tried"),
        ({"diameter_cm": 6, "friction": -1}, "cannot be tried"),
        ({"diameter": 11}, "no diameter"),
        ({"diameter_cm": "11"}, "no diameter"),
        ({"diameter_cm": 11, "colour": "red"}, "'colour'"),
        (11, "A dict is expected"),
    ],
)
def test_a_ball_is_right_that_is_held_at_times(ball, said):
    result = course.check("8.3", ball)
    assert result.right == (said == "")
    assert said in repr(result)


def hurried():
    return gym.wrappers.TransformReward(gym.make("BabbleReach-v0"), lambda reward: reward - 0.01)


class Hidden(gym.ObservationWrapper):
    """Hides the obstacle."""

    def observation(self, observation):
        return {**observation, "obstacle": np.zeros(2, np.float32)}


class Doubled(gym.ActionWrapper):
    """Moves half as far."""

    def action(self, action):
        return action / 2


class Line(gym.Env):
    """A task without this package's robot: be in the middle of a line."""

    observation_space = gym.spaces.Box(-1, 1, (1,), np.float32)
    action_space = gym.spaces.Box(-1, 1, (1,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        del options
        self.place, self.steps = self.np_random.uniform(-1, 1, 1).astype(np.float32), 0
        return self.place, {}

    def step(self, action):
        self.place = np.clip(self.place + action / 10, -1, 1).astype(np.float32)
        self.steps += 1
        return self.place, -abs(float(self.place[0])), False, self.steps >= 20, {}


class Drifting(Line):
    """Draws without a seed."""

    def step(self, action):
        seen, reward, *rest = super().step(action)
        return seen, reward + np.random.default_rng().normal(), *rest


class Endless(Line):
    """Never ends."""

    def step(self, action):
        return *super().step(action)[:3], False, {}


class Untrue(Line):
    """Shows what is not in its space."""

    def reset(self, **arguments):
        return super().reset(**arguments)[0] + 5, {}


class Unpaid(Line):
    """Pays in words."""

    def step(self, action):
        seen, _, *rest = super().step(action)
        return seen, "well done", *rest


def weak():
    return gym.make(REACH, config={"body": {"muscles": {"kp": 10.0}}})


@pytest.mark.parametrize(
    "make",
    [
        hurried,
        lambda: Doubled(gym.make("BabbleReach-v0")),
        lambda: Hidden(gym.make(REACH)),
        weak,
        Line,
    ],
)
def test_tasks_of_all_kinds_are_right(make):
    assert course.check("8.4", make).right


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: gym.make("BabbleReach-v0"), "what the original does"),
        (lambda: Hidden(gym.make("BabbleGrasp-v0")), "is not in `observation_space`"),
        (Drifting, "rewards differ"),
        (Endless, "did not end"),
        (Untrue, "is not in `observation_space`"),
        (Unpaid, "is no number"),
        (lambda: 3, "no `gymnasium.Env`"),
        (gym.make("BabbleReach-v0"), "no function"),
    ],
)
def test_unsound_tasks_are_named(make, said):
    result = course.check("8.4", make)
    assert result.state == "wrong"
    assert said in repr(result)


REPORT = {
    "question": "Does the rule need the mean?",
    "prediction": "No, because it is nearly zero.",
    "cases": 200,
    "mine": [150, 151, 152],
    "baseline": [120, 121, 122],
    "conclusion": "better",
}


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"mine": (150, 152, np.int64(151), 149)},
        {"mine": [120, 121, 122], "conclusion": "cannot say"},
        {"mine": [90, 91, 92], "conclusion": "worse"},
    ],
)
def test_a_conclusion_that_follows_is_right(changed):
    assert course.check("8.5", REPORT | changed).right


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"conclusion": "cannot say"}, "does not follow"),
        ({"mine": [100, 121, 142]}, "does not follow"),
        ({"conclusion": "best"}, "conclusion is unknown"),
        ({"mine": [150, 151]}, "2 seeds"),
        ({"mine": [0.75, 0.76, 0.75]}, "no list of whole numbers"),
        ({"mine": [250, 150, 150]}, "more successes than cases"),
        ({"cases": 20}, "no whole number from 100"),
        ({"question": "Why?"}, "question is too short"),
        ({"note": "x"}, "'note'"),
    ],
)
def test_unsound_reports_are_named(changed, said):
    result = course.check("8.5", REPORT | changed)
    assert result.state == "wrong"
    assert said in repr(result)


def test_a_report_with_blanks_is_not_answered_yet():
    assert course.check("8.5", REPORT | {"mine": ...}).state == "unanswered"
