"""Measures one case: a job as JSON on stdin, the result as JSON in the last line of stdout."""

from __future__ import annotations

import importlib
import json
import sys

if __name__ == "__main__":
    job = json.load(sys.stdin)
    module, _, function = job["function"].partition(":")
    measure = getattr(importlib.import_module(f"bench.{module}"), function)
    print("\n" + json.dumps(measure(job["seconds"], **job["arguments"])))
