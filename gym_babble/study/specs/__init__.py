"""The studies that the docs quote, as files; `gym-babble study list` names them."""

from __future__ import annotations

from pathlib import Path

__all__ = ["SPECS"]

SPECS = {path.stem: path for path in sorted(Path(__file__).parent.glob("*.toml"))}
"""The files by name."""
