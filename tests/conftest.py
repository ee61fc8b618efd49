"""What all tests share."""

import sys
from pathlib import Path

import pytest
from hypothesis import settings

from gym_babble.cli import main
from gym_babble.paper.table2 import TableTwo, table2

ROOT = Path(__file__).resolve().parent.parent
# For `bench`, which is not installed; behind everything, so that an installed package stays first.
sys.path.append(str(ROOT))

# Property tests draw the same values in each run, so that a test that passes once passes always;
# `make fuzz` draws others. A busy machine is no reason to fail.
settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile("fuzz", deadline=None, print_blob=True)
settings.load_profile("fixed")


@pytest.fixture(scope="session")
def table_two() -> TableTwo:
    """A small Table II of two seeds; results/stores.py has the same with more."""
    return table2(seeds=2, cases=40, babbles=200, hold_trials=3)


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return ROOT


@pytest.fixture
def run(capsys):
    """Runs the command line; gives exit code, stdout and stderr."""

    def run(*words):
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        printed = capsys.readouterr()
        return ended.value.code, printed.out, printed.err

    return run
