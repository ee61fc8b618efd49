"""OpenEnv's JSON on the server: the same episodes as in Gymnasium, its errors, routes and limits.

`make frameworks` plays with OpenEnv's own client: tests/test_openenv_client.py.
"""

from __future__ import annotations

import json
import re
import runpy
import shutil
import subprocess
import sys
import urllib.error
import urllib.request

import gymnasium
import numpy as np
import pytest
from processes import PATIENCE_S
from serving import served
from websockets.sync.client import connect

FORMS = [
    ("BabbleReach-v0", {}),
    ("BabbleReachGoal-v0", {}),
    ("BabbleReach-v0", {"obs": "flat", "control": "torque"}),
    ("BabbleReach-v0", {"obs": "retina", "retina_size": 36}),
    ("BabbleReachPattern-v0", {}),
    ("BabbleGrasp-v0", {}),
    ("BabbleGraspGoal-v0", {}),
]


@pytest.fixture(scope="module")
def server():
    with served("--env", "BabbleReach-v0") as server:
        yield server


class Client:
    """A session."""

    def __init__(self, socket):
        self.socket = socket

    def ask(self, kind, data=None):
        message = {"type": kind} if data is None else {"type": kind, "data": data}
        self.socket.send(json.dumps(message))
        return json.loads(self.socket.recv(PATIENCE_S))

    def done(self, kind, data=None):
        reply = self.ask(kind, data)
        assert reply["type"] != "error", reply
        return reply["data"]

    def refused(self, kind, data=None):
        reply = self.ask(kind, data)
        assert reply["type"] == "error", reply
        return reply["data"]


@pytest.fixture
def client(server):
    with connect(f"{server.url}/ws", proxy=None) as socket:
        yield Client(socket)


def request(server, path, body=None):
    """Status and JSON of a reply over HTTP."""
    data = None if body is None else json.dumps(body).encode()
    url = f"http://127.0.0.1:{server.port}{path}"
    try:
        with urllib.request.urlopen(url, data, timeout=PATIENCE_S) as reply:
            return reply.status, json.load(reply)
    except urllib.error.HTTPError as error:
        text = error.read()
        return error.code, json.loads(text) if text else None


def assert_shown(shown, observation, info, terminated, truncated):
    """What a client reads as float32 and float64 are the very bits of Gymnasium's."""
    if not isinstance(observation, dict):
        observation = {"observation": observation}
    names = set(shown["observation"]) - {"metadata"}
    assert names == set(observation)
    for name, expected in observation.items():
        got = np.array(shown["observation"][name], expected.dtype)
        assert got.shape == expected.shape
        assert got.tobytes() == expected.tobytes(), name
    metadata = shown["metadata"]
    assert metadata == shown["observation"]["metadata"]
    assert (metadata["terminated"], metadata["truncated"]) == (terminated, truncated)
    assert shown["done"] == (terminated or truncated)
    plain = {
        name: part.tolist() if isinstance(part, np.ndarray) else part for name, part in info.items()
    }
    assert metadata["info"] == plain


@pytest.mark.parametrize(("env_id", "options"), FORMS)
def test_an_episode_is_gymnasiums_bit_for_bit(client, env_id, options):
    # Without Gymnasium's TimeLimit, which says that it cut off an episode of one step.
    env = gymnasium.make(env_id, **options).unwrapped
    env.action_space.seed(1)
    asked = {"env": env_id, "options": options, "seed": 5}
    shown = client.done("reset", asked)
    assert_shown(shown, *env.reset(seed=5), False, False)
    assert shown["reward"] is None
    for _ in range(25):
        action = env.action_space.sample()
        shown = client.done("step", {"action": action.tolist()})
        observation, reward, terminated, truncated, info = env.step(action)
        assert shown["reward"] == reward
        assert_shown(shown, observation, info, terminated, truncated)
        if terminated or truncated:
            # The stream of cases goes on, as Gymnasium's does.
            assert_shown(client.done("reset"), *env.reset(), False, False)


def test_the_state_has_the_case_and_the_seed(client):
    env = gymnasium.make("BabbleGrasp-v0")
    env.reset(seed=3)
    client.done("reset", {"env": "BabbleGrasp-v0", "seed": 3, "episode_id": "mine"})
    client.done("step", {"action": [0.0] * 4})
    state = client.done("state")
    for name, part in state["case"].items():
        assert np.array_equal(env.unwrapped.scenario[name], part), name
    assert (state["episode_id"], state["step_count"]) == ("mine", 1)
    assert (state["env"], state["seed"]) == ("BabbleGrasp-v0", 3)


def test_what_is_no_json_is_refused_and_the_session_goes_on(client):
    client.done("reset", {"seed": 0})
    for message, code in [("{", "INVALID_JSON"), (b"\x93", "INVALID_JSON"), ("{}", "UNKNOWN_TYPE")]:
        client.socket.send(message)
        reply = json.loads(client.socket.recv(PATIENCE_S))
        assert reply["data"]["code"] == code
    assert client.refused("step", {"action": [0.0]})["code"] == "VALIDATION_ERROR"
    assert client.done("step", {"action": [0.0, 0.0]})["reward"] is not None
    client.socket.send(json.dumps({"type": "close"}))
    with pytest.raises(Exception, match="1000"):
        client.socket.recv(PATIENCE_S)


def test_a_full_server_says_so_after_the_handshake():
    with served("--sessions", 1) as server, connect(f"{server.url}/ws", proxy=None) as first:
        Client(first).done("reset")
        with connect(f"{server.url}/ws", proxy=None) as second:
            refused = json.loads(second.recv(PATIENCE_S))["data"]
            assert refused["code"] == "CAPACITY_REACHED"
            assert (refused["active_sessions"], refused["max_sessions"]) == (1, 1)
            with pytest.raises(Exception, match="1013"):
                second.recv(PATIENCE_S)
        assert Client(first).done("step", {"action": [0.0, 0.0]})["done"] is False


def test_routes_over_http(server):
    assert request(server, "/health") == (200, {"status": "healthy"})
    status, metadata = request(server, "/metadata")
    assert (status, metadata["name"]) == (200, "BabbleReach-v0")
    status, shown = request(server, "/reset", {"seed": 5})
    observation, info = gymnasium.make("BabbleReach-v0").reset(seed=5)
    assert status == 200
    assert_shown(shown, observation, info, False, False)
    assert request(server, "/state")[1]["episode_id"] is None
    status, refused = request(server, "/step", {"action": {"action": [0.0, 0.0]}})
    assert status == 409
    assert "/ws" in refused["detail"]
    assert request(server, "/step", {"action": {"action": "up"}})[0] == 422
    assert request(server, "/reset", {"seed": -1})[0] == 422
    assert request(server, "/mcp", {})[1]["jsonrpc"] == "2.0"


def test_production_has_no_control_over_http():
    with served("--openenv-mode", "production") as server:
        paths = request(server, "/openapi.json")[1]["paths"]
        for path in ("/reset", "/step", "/state"):
            assert path not in paths
            assert request(server, path)[0] == 404
        with connect(f"{server.url}/ws", proxy=None) as socket:
            assert Client(socket).done("reset")["done"] is False


def test_the_manifest_is_current(repository):
    program = "from gym_babble import _core; raise SystemExit(_core.serve(['openenv-yaml']))"
    made = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert made.stdout == (repository / "openenv.yaml").read_text(encoding="utf-8")


def expected(env_id, seed):
    """Steps and return of the episode that the examples play."""
    env = gymnasium.make(env_id, control="posture")
    env.reset(seed=seed)
    total, steps, ended = 0.0, 0, False
    while not ended:
        _, reward, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
        total, steps, ended = total + float(reward), steps + 1, terminated or truncated
    outcome = next(name for name, is_so in info["outcome"].items() if is_so)
    return f"{outcome} after {steps} steps, return {total!r}"


def test_the_python_example_plays_the_same_episode(server, repository, monkeypatch, capsys):
    words = ["openenv_client.py", "--url", server.url, "--seed", "3"]
    monkeypatch.setattr(sys, "argv", words)
    runpy.run_path(str(repository / "examples" / "openenv_client.py"), run_name="__main__")
    assert capsys.readouterr().out.splitlines()[-1] == expected("BabbleReach-v0", 3)


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGrasp-v0"])
def test_the_javascript_example_plays_the_same_episode(server, repository, env_id):
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    version = subprocess.run([node, "--version"], check=True, capture_output=True, text=True).stdout
    major = int(re.match(r"v(\d+)", version)[1])
    if major < 20:
        pytest.skip(f"node {version.strip()} has no WebSocket: 20 has")
    flags = ["--experimental-websocket"] if major < 22 else []
    script = repository / "examples" / "server_client.mjs"
    played = subprocess.run(
        [node, *flags, script, server.url, env_id, "3"],
        check=True,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert played.stdout.strip() == expected(env_id, 3)
