"""Every example runs, in a short form, says what one learns, and ends in the line that it shall."""

import ast
import re
import runpy
import shlex
import sys

import pytest
import torch
from serving import served

SAME_BITS = {
    "hello_env.py": ("", r"collision after 24 steps of 50 ms, return -0\.742"),
    "film.py": ("--out {folder}/film.png", r".+/film\.png: 71 frames; joint_limit, success"),
    "babble.py": (
        "--movements 200 --cases 50 --picture {folder}/weights.png",
        r"success 0\.540 \[0\.404, 0\.670\]",
    ),
    "own_rule.py": ("--movements 20 --cases 20", r"covariance: success 0\.350 \[0\.181, 0\.567\]"),
    "own_agent.py": ("--cases 20", r"success 0\.650 \[0\.433, 0\.819\]"),
    "own_chunk.py": ("--babbles 5 --cases 4 --seeds 1", r"chunk: held 0\.500 \(0\.500\)"),
    "own_body.py": (
        "--movements 100 --cases 30",
        r"own body, elbow 5 to 90°: legal 0\.042, success 0\.500, .+",
    ),
    "own_object.py": (
        "--babbles 10 --cases 20",
        r"the chain, this ball: held 0\.600 \[0\.387, 0\.781\]",
    ),
    "vector_env.py": (
        "--num-envs 32 --steps 240",
        r"67 episodes of random actions ended, 57 by a collision",
    ),
    "save_and_restore.py": (
        "",
        r"100 movements, saved, 100 more: the weights of 200 movements: True",
    ),
}
"""Arguments of a short form, and its last line, which depends on our bits alone."""
PYTORCH = {
    "ppo.py": ("--steps 512 --cases 20", r"success [01]\.\d+ \[[01]\.\d+, .+\]"),
    "her.py": ("--steps 4000 --cases 20", r"success [01]\.\d+ \[[01]\.\d+, .+\]"),
    "pixels.py": ("--movements 1024 --cases 20", r"success [01]\.\d+ \[[01]\.\d+, .+\]"),
    "cleanrl_ppo.py": (
        "--steps 2000 --num-envs 16",
        r"success [01]\.\d\d in the last \d+ episodes",
    ),
}
"""Their last line depends on PyTorch's bits, too."""
ELSEWHERE = {
    "own_body.toml": "examples/own_body.py",
    "openenv_client.py": "tests/test_openenv.py",
    "server_client.mjs": "tests/test_openenv.py",
    "remote_env.py": "tests/test_examples.py",
    "rllib_ppo.py": "Makefile",
    "torchrl_ppo.py": "Makefile",
}
"""Where the others run: some need a server, some a framework (`make frameworks`)."""
RUST = ("babble_env/examples/make.rs", "babble_agent/examples/play.rs")
"""Tests of these crates run them."""
MOST_LINES = 79

# What a run prints depends on its bits, and two threads of PyTorch on a busy machine are slow.
torch.set_num_threads(1)


def test_every_example_runs_somewhere(repository):
    found = {path.name for path in (repository / "examples").iterdir() if path.is_file()}
    assert found == SAME_BITS.keys() | PYTORCH.keys() | ELSEWHERE.keys()
    for name, place in ELSEWHERE.items():
        assert name in (repository / place).read_text(encoding="utf-8"), (name, place)


def test_every_example_is_short_and_begins_with_what_one_learns(repository):
    paths = [repository / "rust" / name for name in RUST]
    for path in [*(repository / "examples").glob("*.*"), *paths]:
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= MOST_LINES, path
        if path.suffix == ".py":
            comment = ast.get_docstring(ast.parse(text))
        else:
            comment = re.match(r"(?:(?://!?|#).*\n)+", text)[0]
        if path.suffix != ".toml":
            assert "You learn" in comment, path


@pytest.mark.parametrize("name", [*SAME_BITS, *PYTORCH])
def test_last_line(name, repository, monkeypatch, capsys, tmp_path):
    arguments, expected = {**SAME_BITS, **PYTORCH}[name]
    words = shlex.split(arguments.format(folder=tmp_path))
    assert re.fullmatch(
        expected, last_line(repository / "examples" / name, words, monkeypatch, capsys)
    )


def test_the_example_with_a_server_plays_the_same_bits(repository, monkeypatch, capsys):
    with served() as server:
        path = repository / "examples" / "remote_env.py"
        last = last_line(path, ["--url", server.url, "--seed", "3"], monkeypatch, capsys)
    assert last == "a scripted agent held 16 of 16 balls there"


def last_line(path, words, monkeypatch, capsys):
    """What an example prints at its end."""
    monkeypatch.setattr(sys, "argv", [str(path), *words])
    runpy.run_path(str(path), run_name="__main__")
    return capsys.readouterr().out.strip().splitlines()[-1]
