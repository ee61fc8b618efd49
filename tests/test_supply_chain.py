"""What the package is made from: pinned, from the registries alone, and none of it run unseen.

`make deny` holds the Rust dependencies to deny.toml, zizmor the workflows to what is safe.
"""

from __future__ import annotations

import json
import re
import subprocess
from collections import defaultdict
from pathlib import Path

import pytest

PIN = re.compile(r"[a-z0-9][a-z0-9.-]*==[\w.+!]+( ; .+)?")
USES = re.compile(r"uses: *([\w./-]+)@(\S+)(.*)")


@pytest.mark.parametrize("name", ["constraints.txt", "constraints-oldest.txt"])
def test_constraints_are_pins_and_nothing_else(name, repository):
    # An index, a URL, a file or a range lets something else in than the release that was tested.
    lines = (repository / name).read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if not line.startswith("#")]
    assert len(pins) > 1
    assert not [line for line in pins if not PIN.fullmatch(line)]


@pytest.mark.parametrize(
    "line",
    [
        "numpy>=1.26",
        "numpy==1.26.*",
        "numpy",
        "numpy @ https://example.org/numpy.whl",
        "--index-url https://example.org/simple",
        "-e .",
        "numpy==1.26.4 --hash=sha256:0",
    ],
)
def test_the_scan_knows_a_pin(line):
    assert not PIN.fullmatch(line)
    assert PIN.fullmatch("numpy==1.26.4 ; python_full_version < '3.11'")


def test_every_action_is_pinned_by_hash_and_the_same_everywhere(repository):
    pins = defaultdict(set)
    for workflow in sorted((repository / ".github" / "workflows").glob("*.yml")):
        for action, version, comment in USES.findall(workflow.read_text(encoding="utf-8")):
            assert re.fullmatch(r"[0-9a-f]{40}", version), (workflow.name, action)
            assert re.fullmatch(r" # v\d+\.\d+\.\d+", comment), (workflow.name, action)
            pins[action].add((version, comment))
    assert len(pins) > 2
    assert not {action: found for action, found in pins.items() if len(found) > 1}


def test_no_crate_of_ours_has_unsafe_code_or_runs_code_when_it_is_built(repository):
    command = ["cargo", "metadata", "--no-deps", "--offline", "--format-version", "1"]
    run = subprocess.run(command, cwd=repository, check=True, capture_output=True, text=True)
    for package in json.loads(run.stdout)["packages"]:
        kinds = {kind for target in package["targets"] for kind in target["kind"]}
        assert not kinds & {"custom-build", "proc-macro"}, package["name"]
        manifest = Path(package["manifest_path"]).read_text(encoding="utf-8")
        assert "\n[lints]\nworkspace = true\n" in manifest, package["name"]
    workspace = (repository / "Cargo.toml").read_text(encoding="utf-8")
    assert '\n[workspace.lints.rust]\nunsafe_code = "forbid"\n' in workspace
