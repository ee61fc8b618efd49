"""A film of two agents on the same test case: what each sees, recalls and does.

You learn to load agents that come with the package, to let them play a case, and to draw the film.
`gym-babble record` does the same without a program.
"""

import argparse
from pathlib import Path

from gym_babble import load_agent, scenarios
from gym_babble.agents.loading import acting_agent
from gym_babble.files import check_file, write_file
from gym_babble.viz.film import Film
from gym_babble.viz.scenes import play_scene
from gym_babble.viz.video import check_film, film_bytes

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--case", type=int, default=7, help="case of Table I")
parser.add_argument("--out", type=Path, default=Path("film.gif"), help="file: .gif, .mp4 or .png")
arguments = parser.parse_args()
check_file(arguments.out, "--out")
check_film(arguments.out)

agents = {
    "Sees the obstacle": load_agent("reach.hebb-paper"),
    "Sees obstacle and target": load_agent("reach.hebb-conjunctive"),
}
playing = {title: acting_agent(agent) for title, agent in agents.items()}
case = scenarios("table1", arguments.case + 1)[arguments.case]
scene = play_scene(playing, case, caption=f"case {arguments.case} of Table I")
film = Film([scene], width=360, fps=10, speed=2.0)
write_file(arguments.out, film_bytes(film, arguments.out.suffix))
outcomes = ", ".join(panel.episode.outcome for panel in scene.panels)
print(f"{arguments.out}: {len(film)} frames; {outcomes}")
