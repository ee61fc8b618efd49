"""The lab, a page for the browser: its files, and the records of what was done there."""

from __future__ import annotations

from pathlib import Path

__all__ = ["PAGE", "POLICIES"]

PAGE = Path(__file__).parent / "page"
"""Folder of the built page. A package that was built without Node has none."""

POLICIES = Path(__file__).parent / "policies"
"""Folder of the networks that the lab knows by name: PPO's of the published study."""
