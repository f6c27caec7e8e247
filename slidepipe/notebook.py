"""slidepipe in a notebook or a script: the stages as functions, and runs as pandas DataFrames.

``import slidepipe`` alone loads nothing; the first use of one of these names does. Everything that a function returns
is a frozen record or a DataFrame in SI units, and everything that goes wrong is a :mod:`slidepipe.errors` error.

Examples
--------
>>> import slidepipe
>>> import tempfile
>>> store = tempfile.mkdtemp()
>>> planned = slidepipe.plan("experiments/regrasp.yaml", {"friction": 0.4}, data=store)
>>> trial = slidepipe.execute(planned.run, data=store)
>>> told = slidepipe.estimate(trial.run, data=store)
>>> abs(told.document.friction.mu.value - 0.4256) < 0.005  # what the simulated world has
True
>>> slidepipe.runs(data=store)["stage"].tolist()
['plan', 'execute', 'estimate']
"""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import pandas as pd

from slidepipe.artifacts.query import Query
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.stages import campaign as _campaign
from slidepipe.stages import estimate as _estimate
from slidepipe.stages import execute as _execute
from slidepipe.stages import iterate as _iterate
from slidepipe.stages import plan as _plan
from slidepipe.stages.campaign import CampaignResult
from slidepipe.stages.estimate import EstimateResult
from slidepipe.stages.execute import ExecuteResult
from slidepipe.stages.frames import Trial, runs_frame, trial_frames
from slidepipe.stages.iterate import IterateResult
from slidepipe.stages.plan import PlanResult

__all__ = [
    "CampaignResult",
    "EstimateResult",
    "ExecuteResult",
    "IterateResult",
    "PlanResult",
    "Run",
    "Store",
    "Trial",
    "estimate",
    "execute",
    "iterate",
    "open_store",
    "plan",
    "read_trial",
    "run",
    "runs",
]

Settings = Mapping[str, object]
"""Keys of the experiment, dotted, and the values to set: ``{"lab.friction": 0.45}``."""
Reference = str | Run
"""A run, or what the command line takes for one: an id, its beginning, ``@latest``, ``@NAME`` or a path."""
PathLike = str | os.PathLike[str]


def open_store(data: PathLike | None = None) -> Store:
    """Open the run store below a directory, by default ``SLIDEPIPE_DATA`` or ``data`` as the command line does.

    Raises
    ------
    InputError
        The directory is a file.
    StoreError
        It is damaged, or a newer slidepipe made it.
    """
    return Store(Path(data if data is not None else os.environ.get("SLIDEPIPE_DATA") or "data"))


def plan(
    experiment: PathLike, settings: Settings | None = None, *, data: PathLike | None = None, force: bool = False
) -> PlanResult:
    """Plan the three-phase motion of an experiment file, or take the plan from the store if it was planned before.

    Raises
    ------
    InputError
        The experiment file or a setting is wrong.
    InfeasibleError
        No motion within the limits: names them.
    """
    request = _plan.PlanRequest(Path(experiment), open_store(data), _overrides(settings), force=force)
    return _plan.run(request)


def execute(plan: Reference, settings: Settings | None = None, *, data: PathLike | None = None) -> ExecuteResult:
    """Execute a plan in the lab; settings may change keys of ``lab`` alone.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no plan.
    InputError
        A setting does not concern the lab.
    """
    return _execute.run(_execute.ExecuteRequest(_reference(plan), open_store(data), _overrides(settings)))


def estimate(trial: Reference, *, data: PathLike | None = None, force: bool = False) -> EstimateResult:
    """Estimate from a trial, a run or the path of a recording, where the finger ended and the friction.

    Raises
    ------
    NotFoundError
        There is no such run or file, or it holds no recording.
    EstimationError
        The recording does not tell.
    """
    return _estimate.run(_estimate.EstimateRequest(_reference(trial), open_store(data), force=force))


def iterate(
    estimate: Reference,
    *,
    way: Literal["goal", "posterior", "learned"] | None = None,
    data: PathLike | None = None,
    force: bool = False,
) -> IterateResult:
    """Plan the next trial from an estimate; the result has neither run nor document where the goal is reached.

    Raises
    ------
    RefusedError
        The object was lost, or no motion is within the limits.
    """
    request = _iterate.IterateRequest(_reference(estimate), open_store(data), way=way, force=force)
    return _iterate.run(request)


def run(
    experiment: PathLike, settings: Settings | None = None, *, trials: int | None = None, data: PathLike | None = None
) -> CampaignResult:
    """Go round the whole loop until the goal is reached, at most so many trials.

    Raises
    ------
    InputError
        The experiment file or a setting is wrong.
    InfeasibleError
        The first motion breaks a limit.
    """
    request = _campaign.CampaignRequest(
        Path(experiment), open_store(data), report=lambda _: None, overrides=_overrides(settings), trials=trials
    )
    return _campaign.run(request)


def runs(
    *,
    experiment: str | None = None,
    stage: str | None = None,
    states: Sequence[str] = (),
    limit: int | None = None,
    data: PathLike | None = None,
) -> pd.DataFrame:
    """Runs of the store by id, the earliest finished first.

    Parameters
    ----------
    experiment, stage : str, optional
        Only runs of these.
    states : sequence of str
        Only runs that ended so: ``complete``, ``lost``, ``failed``, ``interrupted``.
    limit : int, optional
        Only the last so many.

    Returns
    -------
    DataFrame
        Columns ``stage``, ``experiment``, ``state``, ``started``, ``finished`` (UTC), ``seed``, ``recipe``, ``inputs``,
        ``directory``, and one for each result, with ``NAME_std`` where it has a standard deviation. Units of the
        results stand in ``frame.attrs["units"]``, runs that cannot be read in ``frame.attrs["damaged"]``.
    """
    query = Query(experiment=experiment, stage=stage, states=tuple(states), limit=limit)
    return runs_frame(open_store(data), query)


def read_trial(trial: Reference, *, data: PathLike | None = None) -> Trial:
    """Poses and joints of a trial as DataFrames, on a time that starts with the motion.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no recording.
    InputError
        The recording is damaged.
    """
    return trial_frames(open_store(data).get(_reference(trial)))


def _overrides(settings: Settings | None) -> tuple[str, ...]:
    return tuple(f"{key}={json.dumps(value)}" for key, value in (settings or {}).items())


def _reference(run: Reference) -> str:
    return run if isinstance(run, str) else str(run.directory.resolve())
