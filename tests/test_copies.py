"""Copies and pickles hold what an environment or agent was made from, not where that came from."""

from __future__ import annotations

import copy
import json
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from comparing import BATCHES, TASKS, assert_same
from hypothesis import given, settings
from hypothesis import strategies as st
from stable_baselines3.common.vec_env import VecEnv

from gym_babble import Config, HebbBabbling, Oracle, Random, Scripted
from gym_babble.sb3 import BabbleVecEnv

COPIERS = {"deepcopy": copy.deepcopy, "pickle": lambda x: pickle.loads(pickle.dumps(x))}  # noqa: S301
MAKERS: dict[str, Any] = {
    "single": lambda **options: gymnasium.make("BabbleGrasp-v0", **options),
    "batch": lambda **options: gymnasium.make_vec("BabbleGrasp-v0", num_envs=2, **options),
    "vec_env": lambda **options: BabbleVecEnv("BabbleGrasp-v0", 2, **options),
    "hebb": lambda **options: HebbBabbling(gymnasium.make("BabbleGrasp-v0", **options)),
    **{
        agent.__name__.lower(): lambda agent=agent, **options: agent(
            gymnasium.make("BabbleGrasp-v0", **options)
        )
        for agent in (Oracle, Random, Scripted)
    },
}
each_copier = pytest.mark.parametrize("copier", COPIERS.values(), ids=COPIERS)
each_maker = pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)


def interface(made):
    if isinstance(made, VecEnv):
        return made.envs.unwrapped.interface
    return getattr(made, "unwrapped", made).interface


def config_of(made):
    return json.loads(interface(made).task.config())


def begin(made):
    """Resets environments; agents have nothing to reset."""
    if hasattr(made, "reset"):
        made.reset() if isinstance(made, VecEnv) else made.reset(seed=0)
    return made


@each_copier
@each_maker
def test_a_file_changed_or_removed_since_changes_no_copy(make, copier, tmp_path, monkeypatch):
    path = tmp_path / "thin.toml"
    path.write_text("[body.obstacle]\nradius_m = 0.02\n")
    # A worker may have another folder, where a relative path leads elsewhere.
    monkeypatch.chdir(tmp_path)
    made = begin(make(config="thin.toml"))
    before = config_of(made)
    kept = pickle.dumps(made)
    path.write_text("[body.obstacle]\nradius_m = 0.03\n")
    assert config_of(copier(made)) == before
    path.unlink()
    assert config_of(copier(made)) == before
    monkeypatch.chdir("/")
    assert config_of(copier(made)) == before
    assert config_of(pickle.loads(kept)) == before  # noqa: S301


@each_copier
@each_maker
def test_a_dict_or_list_changed_since_changes_no_copy(make, copier):
    config = {"profile": "icub", "grasp": {"hold_steps": 10}}
    diameters = [0.03, 0.05]
    made = begin(make(config=config, diameters=diameters))
    before = config_of(made)
    config["grasp"]["hold_steps"] = 11
    diameters.append(0.04)
    # Neither a list that the interface shows, nor a config's dict, is a way in.
    interface(made).options["diameters"].append(0.06)
    again = copier(made)
    assert config_of(again) == config_of(made) == before
    assert interface(again).options["diameters"] == [0.03, 0.05]


@each_copier
def test_a_configs_own_dict_changed_since_changes_no_copy(copier):
    config = Config()
    env = gymnasium.make("BabbleReach-v0", config=config)
    env.reset(seed=0)
    config.body.joints.clear()
    assert config_of(copier(env)) == config_of(env)


@pytest.mark.parametrize("task", TASKS)
@settings(max_examples=20)
@given(kp=st.floats(30.0, 80.0), radius=st.floats(0.011, 0.03))
def test_a_copy_of_any_numbers_goes_on_to_the_bit(task, kp, radius):
    # Numbers pass through text: each must come back with all its digits.
    config = {"body": {"muscles": {"kp": kp}, "obstacle": {"radius_m": radius}}}
    for kind in (TASKS, BATCHES):
        env = kind[task](config=config)
        env.reset(seed=0)
        action = np.full(env.action_space.shape, 0.3, np.float32)
        env.step(action)
        again = pickle.loads(pickle.dumps(env))  # noqa: S301
        assert again.interface.task.config() == env.interface.task.config()
        for _ in range(5):
            assert_same(env.step(action), again.step(action))


@each_copier
def test_copies_are_independent(copier):
    env = gymnasium.make("BabbleGrasp-v0", diameters=[0.03])
    env.reset(seed=0)
    again = copier(env)
    again.unwrapped.interface.options["diameters"].append(0.05)
    assert env.unwrapped.interface.options["diameters"] == [0.03]
    assert again.unwrapped.interface.task is not env.unwrapped.interface.task


@each_copier
def test_an_agent_and_its_environment_copied_together_share_the_interface(copier):
    env = gymnasium.make("BabbleGrasp-v0")
    env.reset(seed=0)
    again, agent = copier((env, Scripted(env)))
    assert agent.interface is again.unwrapped.interface
