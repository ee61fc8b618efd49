"""Environments on a server, as Gymnasium has them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

from gymnasium.vector import AutoresetMode

from gym_babble import _core
from gym_babble.checks import check_number, check_threads, plain, shown
from gym_babble.envs import BabbleEnv, BabbleVectorEnv
from gym_babble.envs.interface import Interface
from gym_babble.envs.member import BatchMember, check_state
from gym_babble.envs.registry import environment
from gym_babble.errors import ConfigError, ServerError
from gym_babble.remote.batch import RemoteBatch
from gym_babble.remote.session import Session

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.config import ConfigLike

__all__ = ["DEFAULT_URL", "RemoteEnv", "RemoteVectorEnv"]

DEFAULT_URL = "ws://127.0.0.1:8741"
LONGEST_S = 86_400.0


class RemoteInterface(Interface):
    """The interface of environments that another process steps."""

    @property
    def unconverged_steps(self) -> int | None:
        """None: the server does not tell."""
        return None


class _Remote:
    """What both have: a session in place of the core's batch."""

    _interface_class: ClassVar[type[Interface]] = RemoteInterface
    _interface: Interface
    _batch: Any

    def _call_at(self, env_id: str, url: str, token: str | None, timeout: float) -> None:
        """Notes where to call."""
        self._env_id = environment(env_id).id
        self._url = url
        self._token = token
        self._timeout = check_number("timeout", timeout, 0.1, LONGEST_S, "s")

    def _begin(self, num_envs: int, autoreset: AutoresetMode, threads: int | None) -> None:
        """Begins the session."""
        interface = self._interface
        asked = {
            "env": self._env_id,
            "num_envs": num_envs,
            "autoreset": autoreset.value,
            "config": json.loads(interface.task.config()),
            "options": interface.given,
            "threads": threads,
        }
        session = Session(self._url, self._token, self._timeout, asked)
        self._batch = RemoteBatch(interface, session, num_envs)
        made = session.made
        if made["spec"] != json.loads(interface.task.spec()):
            self._batch.close()
            raise ServerError(
                f"{self._url}: {self._env_id} of the server, version {made['version']}, is not "
                f"that of this package, version {_core.__version__}: install the same version"
            )

    def __getstate__(self) -> NoReturn:
        raise TypeError(
            "a remote environment cannot be copied or pickled, as its session is on the server: "
            "make another one, and continue there by set_state(get_state())"
        )


class RemoteEnv(_Remote, BabbleEnv):
    """An environment on a server.

    It gives the same bits as that of `gymnasium.make` with the same arguments, raises the same
    errors, and agents of this package take it like any other. If the connection breaks, the client
    connects again and goes on; no step is executed twice.
    """

    def __init__(
        self,
        env_id: str = "BabbleReach-v0",
        render_mode: str | None = None,
        *,
        url: str = DEFAULT_URL,
        token: str | None = None,
        timeout: float = 60.0,
        config: ConfigLike = "paper",
        **options: Any,
    ) -> None:
        """Makes the environment on the server.

        Args:
            env_id: A registered id.
            render_mode: As for the local environment.
            url: Address of the server; `wss://` through a proxy that has TLS.
            token: The server's access token, if it has one.
            timeout: How long to wait for a reply or for a new connection [s].
            config: As for the local environment; files are read here.
            options: Options of the environment.

        Raises:
            ConfigError: An argument is unknown, of a wrong kind or out of bounds.
            LimitError: It is beyond what the server allows.
            ServerError: The server cannot be reached, or refuses the connection.
        """
        self._call_at(env_id, url, token, timeout)
        super().__init__(render_mode, **_for_task(env_id, options), config=config)

    def _make_core(self) -> None:
        self._begin(1, AutoresetMode.DISABLED, None)
        self._member = BatchMember(self._interface, self._batch, 0)

    def close(self) -> None:
        """Ends the session on the server, and closes the window; calling it again is harmless."""
        super().close()
        self._batch.close()


class RemoteVectorEnv(_Remote, BabbleVectorEnv):
    """A batch of environments on a server, stepped together by one request.

    It gives the same bits as that of `gymnasium.make_vec` with the same arguments. If the
    connection breaks, the client connects again and goes on; no step is executed twice.
    """

    def __init__(
        self,
        env_id: str = "BabbleReach-v0",
        num_envs: int = 1,
        render_mode: str | None = None,
        *,
        url: str = DEFAULT_URL,
        token: str | None = None,
        timeout: float = 60.0,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        config: ConfigLike = "paper",
        **options: Any,
    ) -> None:
        """Makes the batch on the server.

        Args:
            env_id: A registered id.
            num_envs: How many environments.
            render_mode: As for the local batch.
            url: Address of the server; `wss://` through a proxy that has TLS.
            token: The server's access token, if it has one.
            timeout: How long to wait for a reply or for a new connection [s].
            autoreset_mode: When an ended episode begins anew.
            threads: Threads that step the batch on the server; as many as pay off there, if not
                given. Results do not depend on it.
            config: As for the local batch; files are read here.
            options: Options of the environments.

        Raises:
            ConfigError: An argument is unknown, of a wrong kind or out of bounds.
            LimitError: It is beyond what the server allows.
            ServerError: The server cannot be reached, or refuses the connection.
        """
        self._call_at(env_id, url, token, timeout)
        self._asked_threads = None if threads is None else check_threads(threads)
        super().__init__(
            num_envs,
            render_mode,
            **_for_task(env_id, options),
            autoreset_mode=autoreset_mode,
            config=config,
        )

    def _make_core(self) -> None:
        self._begin(self.num_envs, self.autoreset_mode, self._asked_threads)
        self._threads = self._batch.threads
        self._members = [BatchMember(self._interface, self._batch, i) for i in range(self.num_envs)]

    def get_state(self) -> list[bytes]:
        """The state of each environment, from which `set_state` continues bit for bit."""
        states: list[bytes] = self._batch.save_all()
        return states

    def set_state(self, states: Sequence[bytes]) -> None:
        """Continues each environment from a state.

        Raises:
            ConfigError: The states are not as many as the environments.
            SnapshotError: Bytes are not such a state; all environments are as they were.
        """
        if not isinstance(states, list | tuple) or len(states) != self.num_envs:
            raise ConfigError(f"states = {shown(states)} is not a list of {self.num_envs} states")
        for state in states:
            check_state(state)
        with self._batch:
            self._batch.load_all(states)
            for member in self._members:
                member.go_on()
            self._seeded = True

    def close_extras(self) -> None:
        """Ends the session on the server."""
        self._batch.close()


def _for_task(env_id: str, options: dict[str, Any]) -> dict[str, Any]:
    """The task of an id, and its options: those that the id presets, and those given."""
    row = environment(env_id)
    _core.check_fixed(env_id, json.dumps(plain(options, "")))
    return {"task": row.task, **row.presets, **options}
