"""Puts what Sphinx does not make into a built site: the lab's page and cargo's docs.

`python docs/_ext/beside.py build/site`
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LAB = ROOT / "gym_babble" / "lab" / "page"
RUST = ROOT / "target" / "doc"
NO_LAB = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>The lab was not built</title>
<h1>The lab was not built</h1>
<p>This copy of the site was built without Node, which the lab's page needs.
<a href="../lab.html">The lab</a> says how to build it.</p></html>
"""
INDEX = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Crates</title>
<meta http-equiv="refresh" content="0; url=../api/index.html#rust">
<p><a href="../api/index.html#rust">The crates</a></p></html>
"""


def main(site: Path) -> None:
    """Copies both, and says loudly if the lab is missing."""
    for name in ("lab", "rust"):
        shutil.rmtree(site / name, ignore_errors=True)
    if (LAB / "index.html").is_file():
        shutil.copytree(LAB, site / "lab")
    else:
        print("!!! THE SITE IS WITHOUT THE LAB: its page was not built", file=sys.stderr)
        (site / "lab").mkdir()
        (site / "lab" / "index.html").write_text(NO_LAB, encoding="utf-8")
    shutil.copytree(RUST, site / "rust", ignore=shutil.ignore_patterns(".*"))
    (site / "rust" / "index.html").write_text(INDEX, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
