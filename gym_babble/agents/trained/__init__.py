"""Agents of the published study that come with the package, by name: TASK.LABEL, as in the study.

They are those of its first seed. `load_agent`, `evaluate` and the commands take their names.
`python -m results.run published` writes them.
"""

from __future__ import annotations

from pathlib import Path

from gym_babble.errors import AgentFileError

__all__ = ["FOLDER", "TRAINED", "trained_file"]

FOLDER = Path(__file__).parent
"""Folder of their files."""

TRAINED = (
    *("reach.hebb-paper", "reach.hebb-conjunctive", "reach.ppo-pattern", "reach.ppo", "reach.sac"),
    *("grasp.hebb-paper", "grasp.ppo"),
)
"""Their names."""


def trained_file(name: str) -> Path:
    """The file of a trained agent.

    Raises:
        AgentFileError: The installation does not have it.
    """
    found = [
        path for end in (".safetensors.xz", ".zip") if (path := FOLDER / f"{name}{end}").is_file()
    ]
    if not found:
        raise AgentFileError(f"{name}: its file is not in {FOLDER}: install the package anew")
    return found[0]
