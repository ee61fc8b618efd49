"""`gym-babble serve` starts the server that comes with the package, and stops it."""

from __future__ import annotations

import signal
import subprocess
import sys
from urllib.request import urlopen

import pytest

SERVE = [sys.executable, "-c", "from gym_babble.cli import main; main()", "serve"]
DEADLINE_S = 60


@pytest.mark.skipif(sys.platform == "win32", reason="it has no such signals")
@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_until_it_is_stopped(stop):
    command = [*SERVE, "--port", "0"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True) as server:
        try:
            assert server.stdout is not None
            said, address = server.stdout.readline().rsplit(maxsplit=1)
            assert said == "listening on"
            with urlopen(f"http://{address}/metrics", timeout=DEADLINE_S) as answer:
                assert "gym_babble_sessions 0" in answer.read().decode()
            server.send_signal(stop)
            _, log = server.communicate(timeout=DEADLINE_S)
        finally:
            server.kill()
    assert server.returncode == 0, log


def run(*options):
    return subprocess.run(
        [*SERVE, *options], capture_output=True, text=True, timeout=DEADLINE_S, check=False
    )


def test_what_is_wrong_is_said():
    refused = run("--host", "0.0.0.0")  # noqa: S104 - it is refused
    assert refused.returncode == 1
    assert "needs an access token in GYM_BABBLE_TOKEN" in refused.stderr
    refused = run("--prot", "1")
    assert refused.returncode == 2
    assert "'--port'" in refused.stderr
    assert "--ping-seconds" in run("--help").stdout
