"""Exceptions, each also a builtin that one would expect.

`gymnasium.error.ResetNeeded` is raised, as by Gymnasium itself, for a step outside of an episode.
"""

__all__ = [
    "ActionError",
    "AgentFileError",
    "BabbleError",
    "BusyError",
    "ConfigError",
    "DivergedError",
    "LimitError",
    "MissingExtraError",
    "ScenarioError",
    "ServerError",
    "ServerTimeoutError",
    "SessionLostError",
    "SnapshotError",
    "StudyError",
]


class BabbleError(Exception):
    """Base of all exceptions of this package."""


class ConfigError(BabbleError, ValueError):
    """A config field or option is unknown, of a wrong type or out of bounds."""


class ActionError(BabbleError, ValueError):
    """An action is NaN, infinite or of a wrong shape or type. Nothing was stepped."""


class ScenarioError(BabbleError, ValueError):
    """A case asked for cannot be played."""


class BusyError(BabbleError, RuntimeError):
    """An environment or agent was used by two threads at once. The later call changed nothing."""


class SnapshotError(BabbleError, ValueError):
    """Bytes are not a state of this environment. The environment is as it was."""


class AgentFileError(BabbleError, ValueError):
    """A file is not a learned agent of this package."""


class StudyError(BabbleError, ValueError):
    """A stored study does not fit what is compared."""


class DivergedError(BabbleError, ArithmeticError):
    """An agent's weights became NaN or infinite while it learnt."""


class ServerError(BabbleError, ConnectionError):
    """A server of environments cannot be reached, refuses the client, or has a fault."""


class ServerTimeoutError(ServerError, TimeoutError):
    """A server did not answer in time. Whether it executed the request is unknown."""


class SessionLostError(ServerError):
    """The session of a remote environment has ended on the server: make a new environment."""


class LimitError(BabbleError, RuntimeError):
    """A request is beyond what a server allows."""


class MissingExtraError(BabbleError, ImportError):
    """An optional dependency is not installed."""

    def __init__(self, module: str, extra: str) -> None:
        super().__init__(
            f"{module} is not installed; install it with: pip install 'gym-babble[{extra}]'"
        )
