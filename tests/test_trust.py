"""A user's file is data: what SECURITY.md says of files that are hostile, not only broken."""

from __future__ import annotations

import ast
import json
import pickle
import re
import subprocess
import sys
from copy import deepcopy

import pytest

from gym_babble import _core, load_agent
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import AgentFileError, ConfigError, SnapshotError

# What runs code that it is given, reads objects that may run code, or reaches the network.
NEVER_IMPORTED = {
    "code", "ctypes", "dill", "ftplib", "http", "joblib", "marshal", "pickle", "requests", "runpy",
    "shelve", "socket", "subprocess", "urllib", "yaml",
}  # fmt: skip
# Studies start a Python for each run, and read settings of rl-zoo3, with `safe_load` alone.
# A remote environment opens the connection that it is told to. The lab serves its page.
EXCEPT = {
    "lab/serving.py": {"http"},
    "remote/channel.py": {"socket"},
    "study/engine.py": {"subprocess"},
    "study/tuned/__init__.py": {"yaml"},
}
NEVER_CALLED = {"__import__", "compile", "eval", "exec"}
NEVER_OF_OS = re.compile(r"system|popen|startfile|(exec|posix_spawn|spawn)\w+")
# Rust has no eval; these are its programs, and its network, which the server alone has.
NEVER_IN_RUST = re.compile(r"\b(process::Command|Command::new|libloading)\b")
NETWORK_IN_RUST = re.compile(r"\bnet\b")


def sources(repository):
    package = repository / "gym_babble"
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package).as_posix()
        yield name, ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def imported(node):
    if isinstance(node, ast.Import):
        return {alias.name.partition(".")[0] for alias in node.names}
    if isinstance(node, ast.ImportFrom) and node.module:
        return {node.module.partition(".")[0]}
    return set()


def test_nothing_of_ours_unpickles_or_evaluates_and_only_servers_reach_the_network(repository):
    for name, nodes in sources(repository):
        for node in nodes:
            assert not imported(node) & NEVER_IMPORTED - EXCEPT.get(name, set()), name
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in NEVER_CALLED, name
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "os":
                assert not NEVER_OF_OS.fullmatch(node.attr), name
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "yaml":
                assert node.attr == "safe_load", name
    for path in (repository / "rust").glob("*/src/**/*.rs"):
        code = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        assert not NEVER_IN_RUST.search(code), path
        assert not NETWORK_IN_RUST.search(code) or "babble_server" in path.parts, path


class Payload:
    """What unpickling runs."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def test_a_pickle_in_any_files_place_is_refused_and_not_run(tmp_path):
    mark = tmp_path / "it-ran"
    attack = pickle.dumps(Payload(mark))
    pickle.loads(attack).close()  # noqa: S301
    assert mark.exists()  # The payload works ...
    mark.unlink()
    for ending in ("toml", "json", "safetensors", "pkl"):
        file = tmp_path / f"attack.{ending}"
        file.write_bytes(attack)
        with pytest.raises(AgentFileError):
            load_agent(file)
        with pytest.raises(ConfigError):
            _core.load_config(file)
    for env in (BabbleReachEnv(), BabbleGraspEnv()):
        env.reset(seed=0)
        with pytest.raises(SnapshotError):
            env.set_state(attack)
    assert not mark.exists()  # ... and was never run.


def leaves(value, path=()):
    """Paths of all the numbers in a document, a whole number apart from a real one."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves(part, (*path, key))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from leaves(part, (*path, index))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, value


CONFIG = json.loads(_core.profile_config("paper"))


@pytest.mark.parametrize("path", [".".join(map(str, path)) for path, _ in leaves(CONFIG)])
def test_every_number_of_a_config_has_a_highest_and_a_lowest_value(path):
    # One without would set how long a step takes or how much memory a picture needs.
    for sign in (1, -1):
        config = deepcopy(CONFIG)
        *way, last = (int(key) if key.isdigit() else key for key in path.split("."))
        place = config
        for key in way:
            place = place[key]
        huge = sign * 2**60
        place[last] = huge if isinstance(place[last], int) else float(huge)
        with pytest.raises(ConfigError) as caught:
            _core.complete_config(json.dumps(config))
        assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("text", ['{"a":' * 100_000, "[" * 100_000], ids=["objects", "arrays"])
def test_deep_nesting_is_refused(text, tmp_path):
    # In a process of its own, since a stack that overflows takes its process along.
    for ending in ("json", "toml"):
        file = tmp_path / f"deep.{ending}"
        file.write_text(text if ending == "json" else "a = " + text.replace('"a":', "a="))
        program = (
            "import sys, gym_babble\n"
            "try: gym_babble._core.load_config(sys.argv[1])\n"
            "except gym_babble.errors.ConfigError as error: print('refused', str(error)[:200])"
        )
        run = subprocess.run(
            [sys.executable, "-c", program, file], check=False, capture_output=True, text=True
        )
        assert run.stdout.startswith("refused"), (run.returncode, run.stderr)
