"""Servers of environments that do nothing, by other packages: `python -m bench.servers NAME`.

Each prints where it listens as its first line.
"""

from __future__ import annotations

import socket
import sys
from typing import Any

import numpy as np

from bench.wire import FLOATS


def echo() -> None:
    """A plain TCP socket that sends back what it gets."""
    listener = socket.create_server(("127.0.0.1", 0))
    print(listener.getsockname()[1], flush=True)
    link, _ = listener.accept()
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    while data := link.recv(65_536):
        link.sendall(data)


def openenv(port: str) -> None:
    """OpenEnv's server."""
    import uvicorn
    from openenv.core.env_server.http_server import create_app
    from openenv.core.env_server.interfaces import Environment
    from openenv.core.env_server.types import Action, Observation, State

    class Act(Action):  # type: ignore[misc] # It carries no types.
        values: list[float]

    class Seen(Observation):  # type: ignore[misc]
        values: list[float] = []

    class Nothing(Environment):  # type: ignore[misc]
        SUPPORTS_CONCURRENT_SESSIONS = True

        def reset(self, seed: Any = None, episode_id: Any = None, **_: Any) -> Seen:
            del seed, episode_id
            return Seen(values=[0.5] * FLOATS, done=False, reward=0.0)

        def step(self, action: Act, timeout_s: Any = None, **_: Any) -> Seen:
            del action, timeout_s
            return Seen(values=[0.5] * FLOATS, done=False, reward=0.0)

        @property
        def state(self) -> State:
            return State(episode_id="0", step_count=0)

    print(f"http://127.0.0.1:{port}", flush=True)
    app = create_app(Nothing, Act, Seen, env_name="nothing")
    uvicorn.run(app, host="127.0.0.1", port=int(port), log_level="error")


def dm_env_rpc() -> None:
    """A server on dm_env_rpc's library, gRPC."""
    from concurrent import futures

    import grpc
    from dm_env_rpc.v1 import dm_env_rpc_pb2, dm_env_rpc_pb2_grpc, tensor_utils

    class Servicer(dm_env_rpc_pb2_grpc.EnvironmentServicer):  # type: ignore[misc]
        def Process(self, requests: Any, context: Any) -> Any:  # noqa: N802 - its name
            del context
            observation = np.zeros(FLOATS, np.float32)
            for request in requests:
                tensor_utils.unpack_tensor(request.step.actions[1])
                answer = dm_env_rpc_pb2.EnvironmentResponse()
                answer.step.state = dm_env_rpc_pb2.RUNNING
                answer.step.observations[1].CopyFrom(tensor_utils.pack_tensor(observation))
                answer.step.observations[2].CopyFrom(tensor_utils.pack_tensor(np.float32(0)))
                yield answer

    server = grpc.server(futures.ThreadPoolExecutor(max_workers=1))
    dm_env_rpc_pb2_grpc.add_EnvironmentServicer_to_server(Servicer(), server)
    port = server.add_secure_port("localhost:0", grpc.local_server_credentials())
    server.start()
    print(port, flush=True)
    server.wait_for_termination()


def rlmesh(port: str) -> None:
    """RLMesh's server."""
    from rlmesh import EnvServer

    from bench.peers import Nothing

    print(f"127.0.0.1:{port}", flush=True)
    EnvServer(Nothing(), f"127.0.0.1:{port}").serve()


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
