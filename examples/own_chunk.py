"""A chunk of your own, added to the chain of own_chain.py: the agent that misses tries again.

After the hand has closed, the chunk asks the senses of touch whether fingers and palm, or fingers
and thumb, feel the object. If they have felt nothing for some steps, the hand opens, the arm goes
back to where it advanced from, and the chain begins anew with what is seen now.
"""

import argparse
from typing import Any

import numpy as np
from own_chain import Chain

import gym_babble

PATIENCE = 50  # Control steps without a grip, after which it tries again.
RETURN = 30  # Control steps for opening the hand and going back.


class Persistent(Chain):
    """The chain, and a chunk behind it."""

    def predict(self, observation: Any, state: Any, episode_start: Any, _: Any = None) -> Any:
        """As the chain, unless the hand is closed and empty."""
        touch = np.atleast_2d(observation["touch"]) > 0
        grip = touch[:, 2] & (touch[:, 0] | touch[:, 1])
        start = np.broadcast_to(np.asarray(episode_start, bool), len(touch))
        if state is None:
            state = {"chain": None, "empty": np.zeros(len(touch)), "back": np.zeros(len(touch))}
        chain, empty, back = state["chain"], state["empty"], state["back"]
        empty[start] = back[start] = 0
        closed = np.zeros(len(touch), bool) if chain is None else chain["touched"][:, 0] > 0
        empty[:] = np.where(closed & ~grip & (back == 0), empty + 1, 0)
        back[empty > PATIENCE] = RETURN
        again = start | (back == 1)
        back[:] = np.maximum(back - 1, 0)
        actions, chain = super().predict(observation, chain, again)
        opened = np.hstack([chain["before"], np.zeros((len(touch), 2))])
        home = self.joints.actions(opened, observation)
        actions = np.where((back > 0)[:, None], home, np.atleast_2d(actions))
        state["chain"] = chain
        return (actions if np.ndim(episode_start) else actions[0]), state


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--babbles", type=int, default=100, help="babbles to learn from")
    parser.add_argument("--cases", type=int, default=200, help="test cases")
    arguments = parser.parse_args()
    cases = gym_babble.scenarios("palm_side", arguments.cases, 2000, diameters=[0.024])
    agent = Persistent().learn(arguments.babbles)
    for limit in (240, 400):
        plain = Chain()
        plain.weights, plain.use = agent.weights, agent.use
        held = [
            gym_babble.evaluate(one, cases=cases, max_episode_steps=limit).rate("held")
            for one in (plain, agent)
        ]
        print(f"{limit} steps: held {held[0]:.3f} by the chain, {held[1]:.3f} with the chunk")
