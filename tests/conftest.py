"""What all tests share."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
# For `bench`, which is not installed; behind everything, so that an installed package stays first.
sys.path.append(str(ROOT))


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return ROOT
