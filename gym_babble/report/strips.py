"""The section with a movement or a grasp, frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.loading import acting_agent
from gym_babble.report.agents import hebb_agents
from gym_babble.viz.episode import play
from gym_babble.viz.video import contact_sheet, png

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gym_babble.report.data import TaskRuns

__all__ = ["strip_section"]

FRAMES = 6
"""Pictures of a strip."""


def strip_section(task: TaskRuns) -> Iterator[dict[str, Any]]:
    """The success of the best Hebb agent that shows most; nothing without a Hebb agent."""
    agents = hebb_agents(task)
    if not agents:
        return
    agent, hebb = max(agents, key=lambda pair: pair[0].happened("success")[0].mean())
    cases, solved = agent.runs[0].spec.cases(), agent.happened("success")[0]
    reaching = task.spec.task == "reach"
    worth = _visibility if reaching else _size
    chosen = [case for case, success in zip(cases, solved, strict=True) if success]
    case: Any = max(chosen or cases, key=worth)
    episode = play(acting_agent(hebb), case)
    eye = episode.env.picture("eye", (630, 630), 0)
    moments = np.linspace(0, episode.moments - 1, FRAMES).round().astype(int).tolist()
    frames = [episode.env.picture("third_person", (600, 600), k) for k in moments]
    if reaching:  # The arm stays in the middle.
        frames = [frame[60:400, 80:420] for frame in frames]
    among = f"{len(chosen):,} successes in {len(cases):,} tests" if chosen else "tests, all failed"
    why = (
        "a long way in the middle of the picture"
        if reaching
        else "the first of the biggest objects"
    )
    what = "movement" if reaching else "grasp"
    yield {
        "title": f"A {what}",
        "text": f"{agent.title[0]}, seed {agent.seeds[0]}, on case {case['index']}: "
        f"{episode.outcome.replace('_', ' ')}. Chosen from {among}: {why}.",
        "legend": False,
        "panels": [],
        "broad": [],
        "photos": [
            (png(eye), f"The eye's view before the {what}: 630 × 630 pixels, 120°."),
            (png(contact_sheet(frames)), f"The {what}, row by row."),
        ],
    }


def _visibility(case: Any) -> float:
    """How much a case of reaching shows: best is a long path near the picture's middle."""
    start, target = np.array(case["start"]), np.array(case["target"])
    middle = 0.5 * (start + target)
    return float(np.linalg.norm(target - start) - np.linalg.norm(middle - (0.0, 0.3)))


def _size(case: Any) -> float:
    """How much a case of grasping shows: best is a big object."""
    return float(case["diameter"])
