"""PPO's presets and what `train_ppo` says of its runs."""

import json
import re

import gymnasium as gym
import numpy as np
import pytest
import torch
from stable_baselines3.common.callbacks import BaseCallback

from gym_babble import evaluate, scenarios
from gym_babble.errors import ConfigError
from gym_babble.study.ppo import train_ppo
from gym_babble.study.presets import PRESETS


def test_learns_whole_movements():
    trained = train_ppo("pattern", seed=3, steps=6_000, validation_cases=50, validations=3)
    assert trained.movements == trained.agent.num_timesteps == 6_144
    assert trained.control_steps == 6_144 * 224  # (8 + 4 · 40/50) s at 50 ms
    assert [point.steps for point in trained.curve] == [2_048, 4_096, 6_144]
    assert trained.curve[-1].seconds == pytest.approx(trained.seconds)
    result = evaluate(trained.agent, cases=scenarios("table1", 200))
    assert result.rate("success") > 0.7


def test_counts_control_steps_and_episodes():
    trained = train_ppo("delta_posture", steps=8_192, validation_cases=0)
    assert trained.control_steps == 8_192
    assert 8_192 / 240 < trained.movements < 8_192
    assert trained.curve == ()


def test_same_seed_same_agent():
    agents = [
        train_ppo("pattern", seed=s, steps=1_024, validation_cases=0).agent for s in (1, 1, 2)
    ]
    first, again, other = (agent.policy.state_dict()["action_net.weight"] for agent in agents)
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_validation_does_not_change_what_is_learnt():
    agents = [train_ppo("pattern", steps=1_024, validation_cases=n).agent for n in (0, 20)]
    one, two = (agent.policy.state_dict()["action_net.weight"] for agent in agents)
    assert torch.equal(one, two)


def test_grasping_is_validated_on_its_own_protocol():
    trained = train_ppo("grasp", steps=1, validation_cases=6, validations=1)
    assert trained.control_steps == 8_192
    cases = scenarios("palm_side", 6, split="validation")
    result = evaluate(trained.agent, cases=cases)
    assert [point.success for point in trained.curve] == [result.rate("success")]


def test_a_preset_is_data():
    told = {name: json.loads(json.dumps(preset.to_json())) for name, preset in PRESETS.items()}
    assert told["delta_posture"]["settings"]["learning_rate"] == [2.5e-3, 0.0]
    assert told["grasp"]["policy"]["activation_fn"] == "ReLU"
    assert told["grasp"].keys() == vars(PRESETS["grasp"]).keys()


@pytest.mark.parametrize("name", PRESETS)
def test_sees_its_senses_and_no_others(name):
    preset = PRESETS[name]
    agent = train_ppo(name, steps=1, validation_cases=0).agent
    observation, _ = gym.make(preset.env_id).reset(seed=0)
    action = agent.predict(observation, deterministic=True)[0]
    for sense, value in observation.items():
        changed = {**observation, sense: value + np.float32(0.3)}
        same = np.array_equal(agent.predict(changed, deterministic=True)[0], action)
        assert same == (sense not in preset.senses)


def test_threads_of_torch_are_as_before():
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    train_ppo("pattern", steps=1, validation_cases=0)
    assert torch.get_num_threads() == 2
    torch.set_num_threads(before)


def test_a_callback_can_stop():
    class Stop(BaseCallback):
        def _on_step(self):
            return False

    trained = train_ppo("pattern", steps=100_000, validation_cases=0, callback=Stop())
    assert trained.agent.num_timesteps == PRESETS["pattern"].num_envs


@pytest.mark.parametrize(
    ("arguments", "named"),
    [(("walk",), "walk"), (("pattern", 0), "steps"), (("pattern", 10, -1), "validation_cases")],
)
def test_bad_arguments(arguments, named):
    names = ("preset", "steps", "validation_cases")
    with pytest.raises(ConfigError, match=named):
        train_ppo(**dict(zip(names, arguments, strict=False)))


@pytest.mark.parametrize("name", ["pattern", "delta_posture", "grasp"])
def test_the_settings_for_rl_zoo3_are_the_presets(repository, name):
    preset = PRESETS[name]
    text = (repository / "gym_babble" / "study" / "tuned" / "ppo.yml").read_text(encoding="utf-8")
    block = re.search(rf"^{preset.env_id}:\n((?:  .+\n)+)", text, re.MULTILINE)[1]
    found = dict(line.strip().split(": ", 1) for line in block.splitlines())
    numbers = {
        key: float(re.sub("!!float |lin_", "", value))
        for key, value in found.items()
        if not key.startswith("policy")
    }
    rate = preset.settings["learning_rate"]
    expected = {**preset.settings, "learning_rate": getattr(rate, "start", rate)}
    assert found["learning_rate"].startswith("lin_") == hasattr(rate, "start")
    assert numbers == {"n_timesteps": preset.steps, "n_envs": preset.num_envs, **expected}
    policy = preset.policy
    assert found["policy_kwargs"] == (
        f"dict(activation_fn=nn.{policy['activation_fn'].__name__}, "
        f"net_arch={policy['net_arch']}, log_std_init={policy['log_std_init']})"
    )
