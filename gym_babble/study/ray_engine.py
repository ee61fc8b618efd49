"""Does the runs of a study on a cluster of Ray; the driver alone writes the study's folder."""

from __future__ import annotations

import platform
from typing import TYPE_CHECKING, Any

from gym_babble.errors import MissingExtraError, StudyError
from gym_babble.study.run import RunSpec, execute, failed
from gym_babble.study.versions import EXTRAS, code_hash, physics_hash, versions

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gym_babble.study.store import Store
    from gym_babble.study.watch import Watch

__all__ = ["execute_there", "run_on_ray", "what_decides"]

RETRIES = 3
"""Times that a run starts again after its node or its process has died."""


def run_on_ray(
    waiting: Sequence[RunSpec],
    store: Store,
    watch: Watch,
    address: str | None,
    environment: Mapping[str, str],
) -> None:
    """Does the runs as tasks of Ray, each on one processor and in a process of its own.

    A run whose node dies starts again elsewhere. A run whose agent fails does not.

    Args:
        waiting: The runs.
        store: Where finished runs are written, on this machine.
        watch: Hears which runs have ended; called from this thread.
        address: The cluster's address, "auto" for the one that this machine belongs to. If None,
            that one if there is any, else a cluster of this machine alone.
        environment: Environment variables of each run.

    Raises:
        ConnectionError: There is no cluster at the address.
        MissingExtraError: Ray is not installed.
        OSError: A file cannot be written.
        StudyError: A node has other versions than this machine, or lacks this package.
    """
    try:
        import ray
    except ImportError as error:
        raise MissingExtraError("Ray", "ray") from error
    connected = ray.is_initialized()
    if not connected:
        ray.init(address=address, log_to_driver=False, logging_level="error")
    # A process that has done a run is not used again: the next one begins without its leftovers.
    task = ray.remote(
        num_cpus=1,
        max_calls=1,
        max_retries=RETRIES,
        retry_exceptions=False,
        runtime_env={"env_vars": dict(environment)},
    )(execute_there)
    here = what_decides()
    running = {task.remote(spec.to_json(), here): spec for spec in waiting}
    try:
        while running:
            (ended, *_), _ = ray.wait(list(running), num_returns=1)
            spec = running.pop(ended)
            record, file = _result(ray, ended, spec)
            store.write(spec, record, file)
            watch.end(spec, record)
    finally:
        for one in running:
            ray.cancel(one, force=True)
        if not connected:
            ray.shutdown()


def what_decides() -> dict[str, str | None]:
    """All that the result of a run depends on, besides its spec: versions, code and physics."""
    names = ("gym-babble", "python", "gymnasium", "numpy", *EXTRAS["sb3"])
    found = versions()
    decisive = {name: found[name] for name in names}
    return {**decisive, "code": code_hash(), "physics": physics_hash()}


def execute_there(
    document: dict[str, Any], wanted: dict[str, str | None]
) -> tuple[dict[str, Any], tuple[str, bytes] | None]:
    """Does a run on a node.

    Args:
        document: The run, as `RunSpec.to_json` described it.
        wanted: `what_decides` of the driver.

    Raises:
        StudyError: They differ here.
    """
    found = what_decides()
    differing = [
        f"{name} {found.get(name)} instead of {wanted.get(name)}"
        for name in {**wanted, **found}
        if found.get(name) != wanted.get(name)
    ]
    if differing:
        raise StudyError(
            f"node {platform.node()} has {', '.join(differing)}: install there what this machine "
            "has, and resume the study"
        )
    return execute(RunSpec.from_json(document))


def _result(ray: Any, ended: Any, spec: RunSpec) -> tuple[dict[str, Any], tuple[str, bytes] | None]:
    """What a task of Ray has returned, or the record of a run whose process died each time.

    Raises:
        StudyError: The node cannot do any run.
    """
    errors = ray.exceptions
    try:
        return ray.get(ended)  # type: ignore[no-any-return]
    except errors.RayTaskError as error:
        # `execute` makes a record of all that an agent raises: this comes from the node.
        raise StudyError(_message(error)) from error
    except errors.RuntimeEnvSetupError as error:
        raise StudyError(f"a node cannot start a run: {error}") from error
    except errors.RayError as error:
        said = f"its process or its node died {RETRIES + 1} times: {type(error).__name__}"
        return failed(spec, said, str(error)), None


def _message(error: Any) -> str:
    """A node's own message, or why it could not begin."""
    if isinstance(error.cause, StudyError):
        return str(error.cause)
    last = str(error).strip().splitlines()[-1]
    return f"a node cannot run this version of gym-babble: {last}"
