"""Answers that are settings, such as numbers of a brain: a dict that JSON can hold."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from gym_babble.checks import plain, shown
from gym_babble.course.answers import UnsuitableError
from gym_babble.errors import ConfigError

__all__ = ["Settings"]

MOST_LETTERS = 2_000
"""Letters of the settings as JSON."""


class Settings:
    """A dict of settings; its data is the JSON text."""

    def observe(self, answer: Any) -> str:
        """The settings as JSON, with sorted keys."""
        if not isinstance(answer, Mapping):
            raise UnsuitableError(
                f'Your answer is {shown(answer)}. A dict is expected, such as {{"sigma": 1.0}}.'
            )
        try:
            text = json.dumps(plain(answer, "answer"), sort_keys=True, allow_nan=False)
        except (ConfigError, TypeError, ValueError) as error:
            raise UnsuitableError(f"Your answer holds what is no setting: {error}.") from error
        if len(text) > MOST_LETTERS:
            raise UnsuitableError(f"Your answer has more than {MOST_LETTERS:,} letters.")
        return text

    def read(self, value: Any) -> str:
        """The settings as JSON, from a handed-in file."""
        if not isinstance(value, str) or len(value) > MOST_LETTERS:
            raise UnsuitableError(f"A text of at most {MOST_LETTERS:,} letters is expected.")
        try:
            settings = json.loads(value)
        except (ValueError, RecursionError) as error:
            raise UnsuitableError(f"The settings are no JSON: {error}.") from error
        return self.observe(settings)
