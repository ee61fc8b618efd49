"""`gym-babble export-policy`."""

from pathlib import Path
from typing import Annotated

import typer

from gym_babble.agents.loading import named_agent
from gym_babble.cli.arguments import ControlName, EnvId, OwnConfig, given_options
from gym_babble.cli.output import name_files
from gym_babble.export import export_policy as exported
from gym_babble.files import check_file, write_file

__all__ = ["export_policy"]


def export_policy(
    model: Annotated[
        str,
        typer.Argument(
            help="A zip of stable-baselines3 (which contains pickled Python: use only files you "
            "trust), or reach.ppo, grasp.ppo and others that come with the package."
        ),
    ],
    out: Annotated[Path, typer.Argument(help="File to write, .safetensors.")],
    *,
    bits: Annotated[
        int,
        typer.Option(min=2, max=24, help="Significant bits of a weight; fewer pack smaller."),
    ] = 24,
    env_id: EnvId = None,
    control: ControlName = None,
    config: OwnConfig = None,
) -> None:
    """Write the network of PPO, A2C, SAC or TD3 as a file for the lab: it acts without PyTorch."""
    check_file(out, "OUT")
    options = given_options(control=control)
    loaded = named_agent(model, env_id=env_id, config=config, options=options)
    write_file(out, exported(loaded, bits=bits).to_bytes())
    name_files([out])
