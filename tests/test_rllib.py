"""RLlib's new API stack on the native batch: `make frameworks` has RLlib, `make test` has not."""

from __future__ import annotations

import importlib
import subprocess
import sys

import numpy as np
import pytest
from gymnasium import spaces

from gym_babble import evaluate, scenarios
from gym_babble.envs import BabbleVectorEnv
from gym_babble.envs.registry import ENVIRONMENTS
from gym_babble.errors import ConfigError

FORMS = [(row.id, {}) for row in ENVIRONMENTS]
FORMS += [("BabbleReach-v0", {"obs": "flat"}), ("BabbleReach-v0", {"obs": "retina"})]


def test_without_rllib_the_message_says_what_to_install():
    program = """
import sys
sys.modules["ray"] = None
try:
    import gym_babble.rllib
except ImportError as error:
    print(type(error).__name__, error)
"""
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    assert run.stdout.startswith("MissingExtraError RLlib is not installed")
    assert "'gym-babble[rllib]'" in run.stdout


@pytest.fixture(scope="module")
def rllib():
    """The module, with Ray on this machine."""
    ray = pytest.importorskip("ray", reason="only `make frameworks` has Ray")
    pytest.importorskip("ray.rllib")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_worker_niceness", "0")  # A busy machine leaves others no time.
        ray.init("local", num_cpus=2, include_dashboard=False, logging_level="error")
    yield importlib.import_module("gym_babble.rllib")
    ray.shutdown()


@pytest.fixture
def ppo():
    """RLlib's config of PPO."""
    pytest.importorskip("ray", reason="only `make frameworks` has Ray")
    return importlib.import_module("ray.rllib.algorithms.ppo").PPOConfig()


@pytest.fixture
def algorithm_of(rllib, ppo):
    """Builds a small PPO for an id, and stops it."""
    built = []

    def build(env_id, num_envs=4, runners=0, **options):
        config = rllib.native_batch(ppo, env_id, num_envs, **options)
        config.env_runners(num_env_runners=runners).debugging(seed=0)
        config.training(train_batch_size_per_learner=64, minibatch_size=32, num_epochs=1)
        built.append(config.build_algo())
        return built[-1]

    yield build
    for algorithm in built:
        algorithm.stop()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("env_id", "options"), FORMS)
def test_every_id_learns_in_the_native_batch(env_id, options, algorithm_of):
    algorithm = algorithm_of(env_id, **options)
    envs = algorithm.env_runner.env.unwrapped
    assert isinstance(envs, BabbleVectorEnv)
    assert envs.num_envs == 4
    runners = algorithm.train()["env_runners"]
    assert runners["num_env_steps_sampled_lifetime"] >= 64
    # Nothing that the environment shows is left out.
    seen = algorithm.get_module().observation_space
    assert spaces.flatdim(seen) == spaces.flatdim(envs.single_observation_space)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("env_id", ["BabbleGrasp-v0", "BabbleReachGoal-v0"])
def test_the_agent_acts_as_rllib_does(env_id, rllib, algorithm_of):
    # A wrong order of the senses would give other actions.
    algorithm = algorithm_of(env_id)
    agent, envs = rllib.RLlibAgent(algorithm), algorithm.env_runner.env
    reset, step, seen, compared = envs.reset, envs.step, [], 0

    def resets(**words):
        result = reset(**words)
        seen.append(result[0])
        return result

    def steps(actions):
        nonlocal compared
        mine, _ = agent.predict(seen[-1], deterministic=True)
        np.testing.assert_allclose(mine, actions, atol=1e-5)
        first, _ = agent.predict({name: row[0] for name, row in seen[-1].items()}, None, None, True)
        np.testing.assert_allclose(first, actions[0], atol=1e-5)
        compared += len(mine)
        result = step(actions)
        seen.append(result[0])
        return result

    envs.reset, envs.step = resets, steps
    algorithm.env_runner.sample(num_timesteps=80, explore=False)
    assert compared >= 80


@pytest.mark.filterwarnings("ignore")
def test_the_success_rate_is_that_of_the_episodes(algorithm_of):
    # In pattern control an episode is one movement, and its reward is 1 for success.
    runners = algorithm_of("BabbleReachPattern-v0", num_envs=16).train()["env_runners"]
    assert 0.0 < runners["success_rate"] < 1.0
    assert runners["success_rate"] == pytest.approx(runners["episode_return_mean"])


@pytest.mark.filterwarnings("ignore")
def test_a_runner_in_another_process_and_a_test_of_what_it_learnt(rllib, algorithm_of):
    algorithm = algorithm_of("BabbleReachPattern-v0", num_envs=16, runners=1, config="icub")
    algorithm.train()
    agent = rllib.RLlibAgent(algorithm)
    cases = scenarios("table1", 20, split="validation", config="icub")
    assert len(evaluate(agent, cases=cases)) == 20


@pytest.mark.filterwarnings("ignore")
def test_a_wrong_argument_is_an_error_before_ray_starts_anything(rllib, ppo):
    with pytest.raises(ConfigError, match="obs"):
        rllib.native_batch(ppo, "BabbleReach-v0", obs="sense")
    with pytest.raises(ConfigError, match="NEXT_STEP"):
        rllib.native_batch(ppo, "BabbleReach-v0", autoreset_mode="SameStep")


@pytest.mark.filterwarnings("ignore")
def test_connectors_that_the_agent_does_not_know_are_an_error(rllib, algorithm_of):
    algorithm = algorithm_of("BabbleReachPattern-v0", obs="flat")
    vars(algorithm.config)["_env_to_module_connector"] = print
    with pytest.raises(ConfigError, match="flatten"):
        rllib.RLlibAgent(algorithm)
