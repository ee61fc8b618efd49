"""The seeds of `reset` are Gymnasium's, from which the core draws as NumPy does."""

from __future__ import annotations

from gymnasium.utils.seeding import np_random
from hypothesis import example, given
from hypothesis import strategies as st

from gym_babble import _core
from gym_babble.envs import BabbleReachEnv, BabbleReachVectorEnv


@given(st.integers(0, 2**64 - 1))
@example(0)
@example(2**32 - 1)
@example(2**32)
@example(2**64 - 1)
def test_streams_begin_with_the_number_that_numpy_draws(seed):
    # A lost upper word, a sign bit, or a product that does not wrap would show.
    assert _core.stream_seed(seed) == int(np_random(seed)[0].integers(2**63))


@given(st.lists(st.integers(0, 2**64 - 1), min_size=2, max_size=2))
def test_each_environment_of_a_batch_has_the_cases_of_its_seed(seeds):
    envs, env = BabbleReachVectorEnv(2), BabbleReachEnv()
    envs.reset(seed=seeds)
    for scenario, seed in zip(envs.call("scenario"), seeds, strict=True):
        env.reset(seed=seed)
        assert env.scenario == scenario
        assert env.np_random_seed == seed
        assert env.np_random.bit_generator.state == np_random(seed)[0].bit_generator.state


def test_an_unseeded_environment_tells_the_seed_that_it_drew():
    env, again = BabbleReachEnv(), BabbleReachEnv()
    env.reset()
    again.reset(seed=env.np_random_seed)
    assert env.scenario == again.scenario
    env.reset()
    again.reset()
    assert env.scenario == again.scenario
    assert env.np_random_seed == again.np_random_seed
