"""Networks of stable-baselines3's models as files: they act alike, without PyTorch."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import gym_babble
from gym_babble.agents import PolicyNetwork, load_agent
from gym_babble.agents.loading import named_agent
from gym_babble.cli import main
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.export import export_policy
from gym_babble.lab import POLICIES
from gym_babble.study.evaluation import default_cases


@pytest.mark.parametrize("name", ["reach.ppo-pattern", "reach.ppo", "reach.sac", "grasp.ppo"])
def test_a_network_acts_as_its_model_does(name):
    # On what the model sees on its way; the order of sums is another, so the last bits are.
    loaded = named_agent(name)
    network = export_policy(loaded)
    env = loaded.arguments.batch(16)
    observation, _ = env.reset(seed=3)
    for _ in range(40):
        theirs, _ = loaded.agent.predict(observation, deterministic=True)
        ours, _ = network.predict(observation)
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-5)
        observation, *_ = env.step(theirs)


@pytest.mark.parametrize("task", ["reach", "grasp"])
def test_the_labs_networks_are_those_of_the_study(task):
    # With five significant bits of each weight.
    loaded = named_agent(f"{task}.ppo")
    data = (POLICIES / f"{task}.safetensors").read_bytes()
    assert data == export_policy(loaded, bits=5).to_bytes()


@pytest.mark.parametrize(
    ("task", "cases"), [("reach", 300), pytest.param("grasp", 1_000, marks=pytest.mark.slow)]
)
def test_the_labs_networks_succeed_as_often_as_the_models(task, cases):
    model = named_agent(f"{task}.ppo")
    test = default_cases(model.arguments, cases, 0, "test")
    rates = [
        gym_babble.evaluate(agent, cases=test).rate("success")
        for agent in (model.agent, load_agent(POLICIES / f"{task}.safetensors"))
    ]
    assert abs(rates[0] - rates[1]) * cases <= 2, rates


def test_a_network_knows_where_it_acts_and_is_loaded_as_any_agent(tmp_path):
    network = export_policy(named_agent("reach.ppo-pattern"))
    path = tmp_path / "network.safetensors"
    network.save(path)
    again = load_agent(path)
    assert isinstance(again, PolicyNetwork)
    assert again.algorithm == "PPO"
    assert again.interface.options["control"] == "pattern"
    assert path.read_bytes() == again.to_bytes() == copy.deepcopy(again).to_bytes()
    env = again.interface
    senses = np.full((2, 11), 0.25, np.float32)
    unpickled = pickle.loads(pickle.dumps(again))  # noqa: S301 - our own
    np.testing.assert_array_equal(again.predict(senses)[0], unpickled.predict(senses)[0])
    assert named_agent(str(path)).arguments.option("control") == env.options["control"]
    with pytest.raises(ConfigError, match="control 'pattern'"):
        load_agent(path, "BabbleReach-v0")
    with pytest.raises(ConfigError, match="another task"):
        load_agent(path, "BabbleGrasp-v0")


def test_a_broken_file_is_refused(tmp_path):
    data = (POLICIES / "reach.safetensors").read_bytes()
    path = tmp_path / "broken.safetensors"
    for broken in (data[:-1], data[:-1] + b"\x00" if data[-1] else data[:-1] + b"\x01"):
        path.write_bytes(broken)
        with pytest.raises(AgentFileError, match="broken"):
            load_agent(path)


def test_what_is_no_such_model_is_not_exported():
    with pytest.raises(ConfigError, match="only models of stable-baselines3"):
        export_policy(named_agent("random"))
    with pytest.raises(ConfigError, match="bits"):
        export_policy(named_agent("reach.ppo"), bits=1)


def test_bits_round_each_weight_to_nearest():
    network = export_policy(named_agent("reach.sac"), bits=4)
    tensors = gym_babble._core.read_tensors(
        PolicyNetwork.KEY,
        network.to_bytes(),
        [f"{i}.{kind}" for i in range(3) for kind in ("weight", "bias")],
    )[1]
    for values in tensors.values():
        mantissa, _ = np.frexp(values)
        np.testing.assert_array_equal(mantissa * 16, np.round(mantissa * 16))


def test_the_command_writes_the_file(tmp_path, capsys):
    path = tmp_path / "sac.safetensors"
    with pytest.raises(SystemExit) as ended:
        main(["export-policy", "reach.sac", str(path)])
    assert not ended.value.code
    assert "sac.safetensors" in capsys.readouterr().err
    assert path.read_bytes() == export_policy(named_agent("reach.sac")).to_bytes()


def test_a_network_needs_no_pytorch():
    program = (
        "import sys\n"
        "from gym_babble.agents import load_agent\n"
        "from gym_babble.lab import POLICIES\n"
        "load_agent(POLICIES / 'reach.safetensors').predict([0.5] * 11)\n"
        "assert 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
