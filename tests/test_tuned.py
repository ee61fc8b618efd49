"""The tuned settings: read as rl-zoo3 reads them, without running their text."""

import json
from pathlib import Path
from statistics import mean

import pytest
from stable_baselines3 import HerReplayBuffer
from stable_baselines3.common.utils import LinearSchedule
from torch import nn

from gym_babble.envs.registry import ENVIRONMENTS
from gym_babble.errors import ConfigError
from gym_babble.study.trainers.base import Order
from gym_babble.study.trainers.sb3 import SB3Trainer
from gym_babble.study.trainers.sb3_models import setting_names
from gym_babble.study.tuned import ALGORITHMS, converted, tuned_ids, tuned_settings

ALL = [(algorithm, env_id) for algorithm in ALGORITHMS for env_id in tuned_ids(algorithm)]
# What rl-zoo3 takes out of a file's block before it makes the model.
OF_THE_TRAINING = {"n_timesteps", "n_envs", "env_kwargs", "noise_type", "noise_std"}


@pytest.mark.parametrize(("algorithm", "env_id"), ALL)
def test_a_model_has_the_settings_of_its_file(algorithm, env_id):
    task = "grasp" if "Grasp" in env_id else "reach"
    trainer = SB3Trainer(Order(task=task, seed=0, budget=0, env_id=env_id), algorithm)
    settings = tuned_settings(algorithm, env_id)
    model = trainer.agent
    assert model.env.num_envs == settings["n_envs"]
    for name, value in settings.get("env_kwargs", {}).items():
        assert trainer.arguments.option(name) == value
    for name, value in converted(settings).items():
        if name in ("gamma", "gae_lambda", "n_steps", "batch_size", "n_epochs", "tau"):
            assert getattr(model, name) == value
        if name == "policy_kwargs":
            assert value.items() <= model.policy_kwargs.items()
        if name == "learning_rate":
            start = value.start if isinstance(value, LinearSchedule) else value
            assert model.lr_schedule(1.0) == start
        if name == "replay_buffer_class":
            assert type(model.replay_buffer) is value
    if "noise_std" in settings:
        assert model.action_noise._sigma == pytest.approx(settings["noise_std"])


@pytest.mark.parametrize(("algorithm", "env_id"), ALL)
def test_each_block_is_of_a_known_environment_and_has_known_settings(algorithm, env_id):
    assert env_id in {row.id for row in ENVIRONMENTS}
    known = {*setting_names(algorithm), *OF_THE_TRAINING}
    assert tuned_settings(algorithm, env_id).keys() <= known


TUNING = Path(__file__).parent.parent / "docs" / "studies" / "tuning"


@pytest.mark.parametrize("path", sorted(TUNING.glob("*.json")), ids=lambda path: path.stem)
def test_the_files_follow_from_the_search(path):
    record = json.loads(path.read_text(encoding="utf-8"))
    trials = record["trials"]
    assert 1 <= len(trials) <= 20
    assert sum(trial["cpu_seconds"] for trial in trials) <= 2 * 3_600
    assert min(record["plan"]["seeds"]) >= 100  # Those of reported results begin at 0.
    best = max(trials, key=lambda trial: mean(trial["success"]))["settings"]
    found = tuned_settings(record["algorithm"], record["env_id"])
    assert {**found, "n_timesteps": 0} == {**best, "n_timesteps": 0}


def test_changing_what_was_read_changes_no_later_reading():
    tuned_settings("ppo", "BabbleReach-v0")["n_envs"] = 1
    assert tuned_settings("ppo", "BabbleReach-v0")["n_envs"] == 128


def test_rl_zoo3s_strings_become_objects():
    found = converted(
        {
            "learning_rate": "lin_2e-3",
            "clip_range": 0.2,
            "policy": "MultiInputPolicy",
            "policy_kwargs": "dict(net_arch=dict(pi=[8], qf=[9, 9]), activation_fn=nn.ReLU, "
            "log_std_init=-1.5, use_expln=True)",
            "replay_buffer_class": "HerReplayBuffer",
            "replay_buffer_kwargs": "{'n_sampled_goal': 4}",
        }
    )
    assert found.pop("learning_rate")(0.25) == pytest.approx(0.5e-3)
    assert found == {
        "clip_range": 0.2,
        "policy": "MultiInputPolicy",
        "policy_kwargs": {
            "net_arch": {"pi": [8], "qf": [9, 9]},
            "activation_fn": nn.ReLU,
            "log_std_init": -1.5,
            "use_expln": True,
        },
        "replay_buffer_class": HerReplayBuffer,
        "replay_buffer_kwargs": {"n_sampled_goal": 4},
    }


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').abort()",
        "dict(a=__import__('os').abort())",
        "dict(activation_fn=nn.functional)",
        "dict(activation_fn=os.abort)",
        "dict(net_arch=[exit()])",
        "dict(**{'a': 1})",
        "dict([('a', 1)])",
        "{**{'a': 1}}",
        "OtherBuffer",
        "dict(a=",
        "",
    ],
)
@pytest.mark.parametrize("name", ["policy_kwargs", "replay_buffer_class"])
def test_other_text_is_an_error_and_never_runs(name, text):
    with pytest.raises(ConfigError, match=f"{name} = .+ is not of the form"):
        converted({name: text})


@pytest.mark.parametrize("text", ["fast", "lin_", "lin_x", "cos_1e-3", "1e-3"])
def test_a_schedule_is_a_number_or_linear(text):
    with pytest.raises(ConfigError, match="learning_rate"):
        converted({"learning_rate": text})


def test_unknown_algorithms_and_environments_are_named():
    with pytest.raises(ConfigError, match=r"algorithm = 'dqn' is not one of ppo, sac, td3"):
        tuned_ids("dqn")
    with pytest.raises(ConfigError, match=r"BabbleReachSparse-v0.+no tuned settings.+Pattern"):
        tuned_settings("ppo", "BabbleReachSparse-v0")
