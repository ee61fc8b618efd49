"""Checks of arguments: each error names the argument, its value and the bound."""

from gym_babble.checks.arguments import (
    check_choice,
    check_flag,
    check_number,
    check_path,
    check_seed,
    check_text,
    check_threads,
    check_whole,
    processors,
)
from gym_babble.checks.arrays import check_finite, numbers, shaped
from gym_babble.checks.plain import plain, shown

__all__ = [
    "check_choice",
    "check_finite",
    "check_flag",
    "check_number",
    "check_path",
    "check_seed",
    "check_text",
    "check_threads",
    "check_whole",
    "numbers",
    "plain",
    "processors",
    "shaped",
    "shown",
]
