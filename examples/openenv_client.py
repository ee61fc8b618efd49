"""An episode by OpenEnv's protocol: JSON over a WebSocket, with no package but `websockets`.

You learn the messages of an episode. Start a server first: `gym-babble serve`.
"""

import argparse
import json
from typing import Any

from websockets.sync.client import ClientConnection, connect


def ask(socket: ClientConnection, kind: str, **data: Any) -> dict[str, Any]:
    """The data of the server's reply to a message."""
    socket.send(json.dumps({"type": kind, "data": data} if data else {"type": kind}))
    reply = json.loads(socket.recv())
    if reply["type"] == "error":
        raise RuntimeError(f"{reply['data']['code']}: {reply['data']['message']}")
    return reply["data"]


def main() -> None:
    """Plays with all joints drawn to the middle of their ranges, and prints how it ended."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--url", default="ws://127.0.0.1:8741")
    parser.add_argument("--env", default="BabbleReach-v0")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with connect(f"{arguments.url}/ws", proxy=None) as socket:
        options = {"control": "posture"}
        shown = ask(socket, "reset", env=arguments.env, seed=arguments.seed, options=options)
        print("senses:", ", ".join(name for name in shown["observation"] if name != "metadata"))
        width = len(shown["observation"]["stretch"])
        total = 0.0
        while not shown["done"]:
            shown = ask(socket, "step", action=[0.0] * width)
            total += shown["reward"]
        state = ask(socket, "state")
        outcome = shown["metadata"]["info"]["outcome"]
        ended = next(name for name, is_so in outcome.items() if is_so)
        print(f"{ended} after {state['step_count']} steps, return {total!r}")
        socket.send(json.dumps({"type": "close"}))


if __name__ == "__main__":
    main()
