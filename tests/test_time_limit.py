"""A time limit is what one asks for: the same in every way of making an environment."""

from __future__ import annotations

from functools import partial
from typing import Any

import gymnasium
import numpy as np
import pytest
from comparing import ALL_IDS, ENVIRONMENTS, GRASP_IDS, IDS, REGIONS
from gymnasium.wrappers import TimeAwareObservation, TimeLimit

from gym_babble.envs import BabbleEnv, BabbleGraspEnv, BabbleReachEnv
from gym_babble.envs.registry import environment
from gym_babble.errors import ConfigError
from gym_babble.sb3 import BabbleVecEnv

MAKERS: dict[str, Any] = {
    "make": gymnasium.make,
    "make again": lambda env_id, **kwargs: gymnasium.make(gymnasium.make(env_id, **kwargs).spec),
    "native": partial(gymnasium.make_vec, num_envs=1),
    "async": partial(gymnasium.make_vec, num_envs=1, vectorization_mode="async"),
    "sync": partial(gymnasium.make_vec, num_envs=1, vectorization_mode="sync"),
    "sb3": partial(BabbleVecEnv, num_envs=1),
}


def last_time(observation: Any) -> float:
    """The sense `time`, of any form of observation."""
    if "time" in observation:
        return float(np.ravel(observation["time"])[0])
    return float("nan")


def play(env: Any) -> tuple[int, bool, float]:
    """Steps of an episode that does nothing, whether it was truncated, and the last `time`."""
    if isinstance(env, BabbleVecEnv):
        return play_sb3(env)
    env.reset(seed=1, options={"obstacle": None})
    still = np.zeros(env.action_space.shape, np.float32)
    for k in range(1, 2_000):
        observation, _, terminated, truncated, _ = env.step(still)
        if np.any(terminated) or np.any(truncated):
            return k, bool(np.all(truncated)), last_time(observation)
    raise AssertionError("no end")


def play_sb3(env: BabbleVecEnv) -> tuple[int, bool, float]:
    env.seed(1)
    env.set_options({"obstacle": None})
    env.reset()
    for k in range(1, 2_000):
        _, _, dones, infos = env.step(np.zeros((1, *env.action_space.shape), np.float32))
        if dones[0]:
            last = last_time(infos[0]["terminal_observation"])
            return k, infos[0]["TimeLimit.truncated"], last
    raise AssertionError("no end")


@pytest.mark.parametrize("steps", [9, 260])
@pytest.mark.parametrize("of", MAKERS)
@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGraspGoal-v0", "BabbleGraspFull-v0"])
def test_a_limit_below_and_above_the_ids_is_kept(env_id, of, steps):
    """Catches a limit that Gymnasium keeps from the core, which then ends at 240."""
    form = {"obs": "senses"} if "Goal" in env_id else {}
    played = play(MAKERS[of](env_id, max_episode_steps=steps, **form))
    assert played == (steps, True, 1.0)


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_every_id_has_its_limit(env_id):
    limit = environment(env_id).max_episode_steps
    assert gymnasium.spec(env_id).max_episode_steps == limit
    env = gymnasium.make(env_id)
    assert env.spec.max_episode_steps == limit
    assert env.unwrapped.spec.max_episode_steps == limit
    assert env.get_wrapper_attr("_max_episode_steps") == limit
    assert env.unwrapped._max_episode_steps == limit
    assert env.unwrapped.interface.spec.max_episode_steps == limit
    # LeRobot reads it by this name.
    for mode in (None, "sync"):
        envs = gymnasium.make_vec(env_id, num_envs=2, vectorization_mode=mode)
        assert envs.call("_max_episode_steps") == (limit, limit)
        assert envs.spec.max_episode_steps == limit
    assert BabbleVecEnv(env_id, 2).get_attr("_max_episode_steps") == [limit, limit]
    TimeAwareObservation(gymnasium.make(env_id), flatten=False, dict_time_key="elapsed").reset()


@pytest.mark.parametrize("env_id", ALL_IDS)
def test_every_way_shows_the_limit_that_was_given(env_id):
    limit = 1 if "Pattern" in env_id else 33
    env = gymnasium.make(env_id, max_episode_steps=33)
    envs = gymnasium.make_vec(env_id, num_envs=1, max_episode_steps=33)
    assert env.unwrapped._max_episode_steps == limit
    assert envs.spec.max_episode_steps == limit
    assert BabbleVecEnv(env_id, 1, max_episode_steps=33).get_attr("_max_episode_steps") == [limit]


def test_a_wrappers_limit_can_be_left_off():
    env = gymnasium.make("BabbleReach-v0", max_episode_steps=-1)
    assert not isinstance(env, TimeLimit)
    assert play(env) == (240, True, 1.0)


def test_the_limit_of_another_environments_make_is_not_ours(monkeypatch):
    """A class that is made within another's constructor has its own limit."""

    class Outer(gymnasium.Env):
        action_space = observation_space = gymnasium.spaces.Discrete(2)

        def __init__(self) -> None:
            self.inner = self._inner()

        def _inner(self) -> BabbleEnv:
            return BabbleReachEnv()

    monkeypatch.setitem(
        gymnasium.registry, "Outer-v0", gymnasium.envs.registration.EnvSpec("Outer-v0", Outer)
    )
    outer = gymnasium.make("Outer-v0", max_episode_steps=7, disable_env_checker=True)
    assert outer.unwrapped.inner._max_episode_steps == 240


def test_a_class_of_your_own_gets_the_limit_too(monkeypatch):
    class Mine(BabbleReachEnv):
        def __init__(self, **kwargs: Any) -> None:
            super().__init__(**kwargs)

    spec = gymnasium.envs.registration.EnvSpec("Mine-v0", Mine, max_episode_steps=12)
    monkeypatch.setitem(gymnasium.registry, "Mine-v0", spec)
    assert play(gymnasium.make("Mine-v0")) == (12, True, 1.0)
    assert play(gymnasium.make("Mine-v0", max_episode_steps=300)) == (300, True, 1.0)


@pytest.mark.parametrize("steps", [0, 2.5, 10**7])
def test_a_limit_out_of_bounds_is_refused(steps):
    with pytest.raises(ConfigError, match="max_episode_steps"):
        gymnasium.make("BabbleReach-v0", max_episode_steps=steps)


def test_a_class_has_the_limit_of_its_region():
    limits = [BabbleGraspEnv(region=region)._max_episode_steps for region in REGIONS]
    assert limits == [240, 500]
    assert play(BabbleGraspEnv(region="full", max_episode_steps=20)) == (20, True, 1.0)


@pytest.mark.parametrize("make", [gymnasium.make, gymnasium.make_vec])
def test_what_decides_the_limit_is_the_ids(make):
    """Catches an id whose option changes the limit behind Gymnasium's back."""
    with pytest.raises(ConfigError, match="use BabbleGraspFull-v0"):
        make(GRASP_IDS[0], region="full")
    with pytest.raises(ConfigError, match="use BabbleGrasp-v0, BabbleGraspSparse-v0"):
        make("BabbleGraspFull-v0", region="palm_side")
    with pytest.raises(ConfigError, match="use BabbleReach-v0"):
        make(IDS[3], control="posture")
    make("BabbleGraspFull-v0", region="full")


def test_the_full_region_takes_the_other_forms_too():
    env = gymnasium.make("BabbleGraspFull-v0", obs="goal", reward="sparse")
    assert env.unwrapped.interface.options["region"] == "full"
    assert env.spec.max_episode_steps == 500


def test_limits_are_those_of_the_registry():
    limits = {row.id: row.max_episode_steps for row in ENVIRONMENTS}
    reach = {**dict.fromkeys(IDS[:3], 240), IDS[3]: 1}
    assert limits == {**reach, **dict.fromkeys(GRASP_IDS[:3], 240), GRASP_IDS[3]: 500}
