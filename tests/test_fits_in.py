"""What other libraries expect of an environment: Gymnasium's wrappers, seeds, options, tensors."""

from __future__ import annotations

import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from comparing import ALL_IDS, BATCHES, TASKS, assert_same
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import ArrayConversion as SingleConversion
from gymnasium.wrappers import vector as wrappers

from gym_babble.envs.interface import outcome_of
from gym_babble.errors import ActionError, ConfigError
from gym_babble.sb3 import BabbleVecEnv

each_task = pytest.mark.parametrize("task", TASKS)
each_mode = pytest.mark.parametrize("mode", AutoresetMode)
NATIVE_AND_SYNC = pytest.mark.parametrize("vectorization", [None, "sync"])


def made(vectorization: str | None, env_id: str, n: int, mode: AutoresetMode, **kwargs: Any) -> Any:
    """A batch in either way."""
    if vectorization is None:
        return gymnasium.make_vec(env_id, num_envs=n, autoreset_mode=mode, **kwargs)
    return gymnasium.make_vec(
        env_id,
        num_envs=n,
        vectorization_mode=vectorization,
        vector_kwargs={"autoreset_mode": mode},
        **kwargs,
    )


def leaves(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return [leaf for one in value.values() for leaf in leaves(one)]
    return [value]


# Tensors.


@NATIVE_AND_SYNC
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.DISABLED])
@pytest.mark.parametrize("env_id", ALL_IDS)
@pytest.mark.parametrize(
    "wrap",
    [wrappers.NumpyToTorch, lambda v: wrappers.ArrayConversion(v, env_xp=np, target_xp=torch)],
    ids=["NumpyToTorch", "ArrayConversion"],
)
def test_all_that_a_batch_gives_becomes_tensors(env_id, vectorization, mode, wrap):
    """At reset, in an episode and at its end. Catches infos that are texts."""
    plain = made(vectorization, env_id, 2, mode, max_episode_steps=3)
    envs = wrap(made(vectorization, env_id, 2, mode, max_episode_steps=3))
    shown = [plain.reset(seed=0)], [envs.reset(seed=0)]
    actions = torch.zeros(envs.action_space.shape)
    for _ in range(1 if "Pattern" in env_id else 3):
        shown[0].append(plain.step(actions.numpy()))
        shown[1].append(envs.step(actions))
    assert torch.all(shown[1][-1][2] | shown[1][-1][3])
    for ours, theirs in zip(*shown, strict=True):
        for array, tensor in zip(ours, theirs, strict=True):
            assert all(isinstance(leaf, torch.Tensor) for leaf in leaves(tensor))
            for one, other in zip(leaves(array), leaves(tensor), strict=True):
                assert_same(one, other.numpy())
    assert bool(shown[1][-1][4]["outcome"]["running"].any()) is False


@each_task
def test_the_infos_of_a_single_environment_become_tensors(task):
    env = SingleConversion(TASKS[task](), env_xp=np, target_xp=torch)
    _, info = env.reset(seed=0)
    assert info["outcome"]["running"].item() is True
    *_, info = env.step(torch.zeros(env.action_space.shape))
    assert all(isinstance(leaf, torch.Tensor) for leaf in leaves(info))


@each_task
def test_the_last_infos_of_a_same_step_reset_are_numbers(task):
    envs = BATCHES[task](3, autoreset_mode="SameStep", max_episode_steps=2)
    envs.reset(seed=0)
    for _ in range(2):
        *_, infos = envs.step(np.zeros(envs.action_space.shape))
    assert infos["final_info"]["outcome"]["timeout"].all()
    assert infos["outcome"]["running"].all()
    assert all(leaf.dtype.kind in "bf" for leaf in leaves(infos["final_info"]))


def test_an_outcome_is_one_of_those_of_the_task():
    env = gymnasium.make("BabbleReachPattern-v0")
    seen = set()
    for seed in range(40):
        env.reset(seed=seed)
        *_, info = env.step(env.action_space.sample())
        assert tuple(info["outcome"]) == env.unwrapped.interface.spec.outcomes
        assert sum(info["outcome"].values()) == 1
        assert info["outcome"]["success"] == info["is_success"]
        seen.add(outcome_of(info))
    assert len(seen) > 1


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64, torch.float16])
@each_task
def test_actions_are_read_from_tensors(task, dtype):
    single, batch = TASKS[task](), BATCHES[task](2)
    sb3 = BabbleVecEnv(f"Babble{task.title()}-v0", 2)
    width = single.action_space.shape[0]
    for env, shape in ((single, (width,)), (batch, (2, width)), (sb3, (2, width))):
        numbers = torch.linspace(-1, 1, int(np.prod(shape)), dtype=dtype).reshape(shape)
        seen = []
        for actions in (
            numbers.numpy(),
            numbers,
            numbers.clone().requires_grad_(),
            list(numbers.clone().requires_grad_()),
            tuple(numbers.tolist()),
        ):
            if env is sb3:
                env.seed(0)
                env.reset()
            else:
                env.reset(seed=0)
            seen.append(env.step(actions)[:2])
        for other in seen[1:]:
            assert_same(other, seen[0])


def test_a_tensor_that_numpy_cannot_read_is_an_action_error():
    env = gymnasium.make("BabbleReach-v0")
    env.reset(seed=0)
    for action in (torch.zeros(2, dtype=torch.bfloat16), torch.zeros(2, device="meta")):
        with pytest.raises(ActionError):
            env.step(action)


# Gymnasium's wrappers of batches.


@NATIVE_AND_SYNC
def test_gymnasiums_wrappers_of_batches(vectorization):
    """A stack of wrappers gives on the native batch what it gives on single environments."""

    def stacked(vectorization: str | None) -> Any:
        envs = made(vectorization, "BabbleReach-v0", 3, AutoresetMode.NEXT_STEP, obs="flat")
        envs = wrappers.RecordEpisodeStatistics(envs)
        envs = wrappers.RescaleAction(envs, np.float32(-2.0), np.float32(2.0))
        envs = wrappers.ClipAction(envs)
        envs = wrappers.NormalizeObservation(envs)
        envs = wrappers.TransformObservation(envs, lambda obs: np.clip(obs, -5, 5))
        envs = wrappers.NormalizeReward(envs, gamma=0.9)
        return wrappers.ClipReward(envs, -3, 3)

    envs, single = stacked(vectorization), stacked("sync")
    assert_same(envs.reset(seed=4), single.reset(seed=4))
    assert envs.single_action_space.low[0] == -np.inf
    ends = 0
    actions = np.random.default_rng(0)
    for _ in range(300):
        chosen = actions.uniform(-2.5, 2.5, (3, 2)).astype(np.float32)
        ours, theirs = envs.step(chosen), single.step(chosen)
        for one, other in zip(ours[:4], theirs[:4], strict=True):
            np.testing.assert_allclose(one, other, atol=1e-6)
        if "episode" in ours[4]:
            ends += np.count_nonzero(ours[4]["_episode"])
            assert_same(ours[4]["episode"]["r"], theirs[4]["episode"]["r"])
            assert_same(ours[4]["episode"]["l"], theirs[4]["episode"]["l"])
    assert ends > 3


def test_infos_as_a_list():
    envs = wrappers.DictInfoToList(gymnasium.make_vec("BabbleGrasp-v0", num_envs=2))
    _, infos = envs.reset(seed=0)
    _, info = gymnasium.make("BabbleGrasp-v0").reset(seed=1)
    assert [outcome_of(one) for one in infos] == ["running"] * 2
    np.testing.assert_equal(infos[1], info)


# Attributes that runners read.


@each_mode
def test_the_autoreset_mode_is_where_gymnasium_has_it(mode):
    for vectorization in (None, "sync"):
        envs = made(vectorization, "BabbleReach-v0", 2, mode)
        assert envs.autoreset_mode is mode
        assert envs.metadata["autoreset_mode"] is mode


@each_task
def test_seeds_are_those_of_the_single_environments(task):
    env_id = f"Babble{task.title()}-v0"
    native, sync = (made(v, env_id, 3, AutoresetMode.NEXT_STEP) for v in (None, "sync"))
    assert native.np_random_seed == (-1,) * 3
    for seed in (7, [4, 9, 2]):
        assert_same(native.reset(seed=seed)[0], sync.reset(seed=seed)[0])
        assert native.np_random_seed == sync.np_random_seed
        assert native.get_attr("np_random_seed") == native.np_random_seed
    assert native.np_random_seed == (4, 9, 2)
    native.reset(seed=[None, 5, None])
    assert native.np_random_seed == (4, 5, 2)
    native.reset()
    assert native.np_random_seed == (4, 5, 2)
    native.set_state(native.get_state())
    assert native.np_random_seed == (-1,) * 3


@each_task
def test_unseeded_batches_tell_the_seeds_that_they_drew(task):
    env_id = f"Babble{task.title()}-v0"
    first, again = (made(None, env_id, 3, AutoresetMode.NEXT_STEP) for _ in range(2))
    shown, _ = first.reset()
    seeds = list(first.np_random_seed)
    assert len(set(seeds)) == 3
    assert_same(again.reset(seed=seeds)[0], shown)
    assert_same(made(None, env_id, 3, AutoresetMode.NEXT_STEP).reset(seed=seeds)[0], shown)


# Options of others.

FOREIGN = {"lerobot_new_rollout": True, "max_length": 4, 7: None}


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGraspGoal-v0"])
def test_options_of_others_are_ignored_with_one_warning_each(env_id):
    for env in (
        gymnasium.make(env_id),
        *(made(v, env_id, 1, AutoresetMode.SAME_STEP) for v in (None, "sync")),
    ):
        expected = env.reset(seed=3, options={})
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            shown = env.reset(seed=3, options=dict(FOREIGN))
            env.reset(seed=3, options=dict(FOREIGN))
        assert_same(shown, expected)
        told = [str(one.message) for one in caught if issubclass(one.category, UserWarning)]
        assert len(told) == 3
        assert all(
            f"'{name}' is ignored; there are scenario, start" in text
            for name, text in zip(FOREIGN, told, strict=True)
        )


def test_our_options_still_hold_beside_those_of_others():
    env = gymnasium.make("BabbleReach-v0")
    with pytest.warns(UserWarning, match="'new_rollout' is ignored"):
        env.reset(seed=0, options={"obstacle": None, "new_rollout": True})
    assert env.unwrapped.scenario["obstacle"] is None


@pytest.mark.parametrize("name", ["obstacles", "Target", "scenarios", "reset_masks", "object"])
def test_near_misses_of_our_options_are_errors(name):
    for env in (gymnasium.make("BabbleReach-v0"), gymnasium.make_vec("BabbleReach-v0", num_envs=2)):
        with pytest.raises(ConfigError, match=name):
            env.reset(options={name: None})
