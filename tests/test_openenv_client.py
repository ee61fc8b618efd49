"""OpenEnv's own package against the server: `make frameworks` has it, `make test` has not."""

from __future__ import annotations

import json
import urllib.request

import gymnasium
import numpy as np
import pytest
from serving import served

openenv = pytest.importorskip("openenv", reason="make frameworks has OpenEnv")

from jsonschema import Draft202012Validator  # noqa: E402
from openenv.cli._validation import validate_running_environment  # noqa: E402
from openenv.core import GenericEnvClient  # noqa: E402
from openenv.validation.parsers.openenv_yaml import OpenEnvYamlParser  # noqa: E402
from openenv.validation.policy import load_policy  # noqa: E402

FORMS = [
    ("BabbleReach-v0", {}),
    ("BabbleReachGoal-v0", {}),
    ("BabbleReach-v0", {"obs": "flat"}),
    ("BabbleReach-v0", {"obs": "retina", "retina_size": 36}),
    ("BabbleReachPattern-v0", {}),
    ("BabbleGrasp-v0", {}),
    ("BabbleGraspGoal-v0", {}),
]


def client(server):
    return GenericEnvClient(base_url=f"http://127.0.0.1:{server.port}").sync()


def document(server, path):
    with urllib.request.urlopen(f"http://127.0.0.1:{server.port}{path}") as page:
        return json.load(page)


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGrasp-v0"])
def test_its_client_plays_whole_episodes_of_gymnasium(env_id):
    env = gymnasium.make(env_id)
    env.action_space.seed(2)
    with served("--env", env_id) as server, client(server) as remote:
        for seed in (11, 12):
            result = remote.reset(seed=seed, episode_id=f"episode {seed}")
            observation, _ = env.reset(seed=seed)
            steps = 0
            while not result.done:
                action = env.action_space.sample()
                result = remote.step({"action": action.tolist()})
                observation, reward, terminated, truncated, _ = env.step(action)
                steps += 1
                assert result.reward == reward
                assert result.metadata["terminated"] == terminated
                assert result.metadata["truncated"] == truncated
                for name, sense in observation.items():
                    assert np.array_equal(np.float32(result.observation[name]), sense), name
            assert terminated or truncated
            state = remote.state()
            assert (state["episode_id"], state["step_count"]) == (f"episode {seed}", steps)
            with pytest.raises(RuntimeError, match="send a reset"):
                remote.step({"action": action.tolist()})


def test_its_client_hears_that_the_server_is_full_or_needs_a_token(monkeypatch):
    with served("--sessions", 1) as server, client(server) as first:
        first.reset()
        with client(server) as second, pytest.raises(RuntimeError, match="CAPACITY_REACHED"):
            second.reset()
        assert first.step({"action": [0.0, 0.0]}).done is False
    monkeypatch.setenv("GYM_BABBLE_TOKEN", "a-token-of-many-letters-for-this-test")
    with served() as server:
        with pytest.raises(ConnectionError, match="401"), client(server) as stranger:
            stranger.reset()
        headers = {"Authorization": "Bearer a-token-of-many-letters-for-this-test"}
        url = f"http://127.0.0.1:{server.port}"
        with GenericEnvClient(base_url=url, headers=headers).sync() as known:
            assert known.reset().done is False


@pytest.mark.parametrize("mode", ["simulation", "production"])
def test_a_running_server_is_valid(mode):
    with served("--openenv-mode", mode) as server:
        report = validate_running_environment(f"http://127.0.0.1:{server.port}")
    assert report["passed"], report
    assert report["mode"] == mode
    assert report["standard_profile"] == "openenv-http/1.x"


@pytest.mark.parametrize(("env_id", "options"), FORMS)
def test_what_is_shown_fits_the_schema(env_id, options):
    words = [word for name, value in options.items() for word in ("--option", f"{name}={value}")]
    with served("--env", env_id, *words) as server, client(server) as remote:
        checks = {}
        for name, schema in document(server, "/schema").items():
            Draft202012Validator.check_schema(schema)
            checks[name] = Draft202012Validator(schema)
        schemas = document(server, "/openapi.json")["components"]["schemas"]
        result = remote.reset(seed=1)
        state = remote.state()
        checks["state"].validate(state)
        said = {"seed": 1, "scenario": state["case"], "options": options, "env": env_id}
        Draft202012Validator(schemas["reset"]).validate(said)
        action = {"action": [1.0] * checks["action"].schema["properties"]["action"]["minItems"]}
        checks["action"].validate(action)
        steps = 0
        while steps < 10:
            shown = {**result.observation, "reward": result.reward, "done": result.done}
            checks["observation"].validate(shown)
            if result.done:
                break
            result, steps = remote.step(action), steps + 1
        assert steps > 0


def test_the_manifest_is_one_of_its_own(repository):
    manifest = OpenEnvYamlParser().parse(repository)
    low, high = manifest.reward.range
    assert low < -1 < 1 < high
    bounds = load_policy().bounds
    assert manifest.reward.floor_margin >= bounds.min_floor_margin
    assert manifest.resources.episode_timeout_s <= bounds.max_episode_timeout_s
