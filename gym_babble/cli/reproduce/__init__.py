"""`gym-babble reproduce`: the paper's tables and figures."""

import typer

from gym_babble.cli.reproduce import grasping, reaching

__all__ = ["reproduce"]

reproduce = typer.Typer(help="Reproduce a table or a figure of the paper.")
reproduce.command("table1")(reaching.table1)
reproduce.command("fig2")(reaching.fig2)
reproduce.command("fig4")(reaching.fig4)
reproduce.command("fig5")(reaching.fig5)
reproduce.command("table2")(grasping.table2)
reproduce.command("fig7")(grasping.fig7)
reproduce.command("fig8")(grasping.fig8)
reproduce.command("sight")(grasping.sight)
