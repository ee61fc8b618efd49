"""The process of one run: `python -m gym_babble.study.worker`, called by `gym_babble.study.engine`.

It reads the run from stdin, writes shares of progress to stdout, and writes the run into its store.
It ends when nobody reads its progress any more.
"""

from __future__ import annotations

import json
import os
import sys

from gym_babble.study.run import RunSpec, execute
from gym_babble.study.store import Store

__all__ = ["main"]


def main() -> None:
    """Does one run."""
    order = json.load(sys.stdin)
    pipe = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # What an agent prints must not come between.

    def progress(share: float) -> None:
        try:
            print(share, file=pipe)
        except BrokenPipeError:
            os._exit(1)

    spec = RunSpec.from_json(order["spec"])
    record, file = execute(spec, progress)
    Store(order["store"]).write(spec, record, file)


if __name__ == "__main__":
    main()
