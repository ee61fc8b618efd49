"""Environments on a server, for programs that learn somewhere else.

>>> from gym_babble.remote import RemoteVectorEnv
>>> envs = RemoteVectorEnv("BabbleReach-v0", 64, url="ws://127.0.0.1:8741")

`gym-babble serve` starts a server; `pip install 'gym-babble[remote]'` installs what a client needs.
"""

from gym_babble.remote.environments import DEFAULT_URL, RemoteEnv, RemoteVectorEnv

__all__ = ["DEFAULT_URL", "RemoteEnv", "RemoteVectorEnv"]
