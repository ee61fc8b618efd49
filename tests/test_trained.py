"""The trained agents of the package: those of the published study, by name."""

import numpy as np
import pytest

import gym_babble
from gym_babble.agents import trained
from gym_babble.agents.loading import named_agent
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.study.store import Store
from results import published

CASES = 30


@pytest.fixture(scope="module")
def runs():
    return {run.spec.name: run for run in Store(published.FOLDER).runs()}


@pytest.mark.parametrize("name", trained.TRAINED)
def test_a_trained_agent_does_what_its_run_did(name, runs):
    run = runs[f"{name}.0"]
    loaded = named_agent(name)
    cases = run.spec.cases()[:CASES]
    result = gym_babble.evaluate(loaded.agent, cases=cases)
    test = run.record["test"]
    stored = [test["outcomes"][int(digit)] for digit in test["outcome"][:CASES]]
    found = [str(outcome) for outcome in result.outcomes]
    # Networks of PyTorch give other last bits on other processors.
    differ = sum(a != b for a, b in zip(stored, found, strict=True))
    assert differ <= (0 if "hebb" in name else 3)


@pytest.mark.parametrize("name", trained.TRAINED)
def test_it_is_loaded_by_name_and_small(name):
    agent = gym_babble.load_agent(name)
    env = named_agent(name).arguments.single()
    observation, _ = env.reset(seed=0)
    action, _ = agent.predict(observation, deterministic=True)
    assert np.shape(action) == env.action_space.shape
    assert trained.trained_file(name).stat().st_size < 2**21


def test_the_folder_has_these_files_alone():
    files = {path.name for path in trained.FOLDER.iterdir() if path.suffix in (".xz", ".zip")}
    assert files == {trained.trained_file(name).name for name in trained.TRAINED}


def test_a_trained_model_refuses_another_environment():
    gym_babble.load_agent("reach.ppo", "BabbleReachSparse-v0")
    with pytest.raises(ConfigError, match="it has learnt from observations"):
        gym_babble.load_agent("reach.ppo", "BabbleGrasp-v0")


def test_a_missing_file_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(trained, "FOLDER", tmp_path)
    with pytest.raises(AgentFileError, match=r"reach\.sac: its file is not in .+ install"):
        gym_babble.load_agent("reach.sac")


def test_an_unknown_name_lists_the_trained_ones():
    with pytest.raises(FileNotFoundError, match=r"reach\.pp0: no such file.+reach\.ppo"):
        named_agent("reach.pp0")


def test_a_packed_file_that_is_damaged_is_refused(tmp_path, monkeypatch):
    packed = trained.trained_file("reach.hebb-paper").read_bytes()
    path = tmp_path / "agent.safetensors.xz"
    path.write_bytes(packed)
    whole = gym_babble.HebbBabbling.load(path)
    assert whole.to_bytes() == gym_babble.load_agent("reach.hebb-paper").to_bytes()
    for data, problem in (
        (packed[:-100], "cut short"),
        (packed[:500] + bytes(500) + packed[1000:], "orrupt"),
    ):
        path.write_bytes(data)
        with pytest.raises(AgentFileError, match=problem):
            gym_babble.load_agent(path)
    path.write_bytes(packed)
    monkeypatch.setattr("gym_babble.files.read.MOST_BYTES", 1_000)
    with pytest.raises(AgentFileError, match="more than 1,000 bytes"):
        gym_babble.load_agent(path)
