"""The command line `gym-babble`.

Results go to stdout; progress and messages go to stderr. Invalid input ends with exit code 2, any
other failure with 1, and each prints one line that names the fault.
"""

from gym_babble.cli.app import app, main

__all__ = ["app", "main"]
