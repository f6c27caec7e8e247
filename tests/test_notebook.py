"""slidepipe as a library: what a notebook imports, and what it gets."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import slidepipe
from slidepipe.errors import InputError, NotFoundError

EXPERIMENT = Path(__file__).resolve().parents[1] / "experiments" / "regrasp.yaml"


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store with one trial, planned, executed and estimated without the command line."""
    data = tmp_path_factory.mktemp("notebook") / "data"
    planned = slidepipe.plan(EXPERIMENT, {"friction": 0.4, "lab.seed": 3}, data=data)
    trial = slidepipe.execute(planned.run, {"lab.friction": 0.42}, data=data)
    slidepipe.estimate(trial.run.id, data=data)
    return data


def test_the_stages(data: Path) -> None:
    again = slidepipe.plan(EXPERIMENT, {"friction": 0.4, "lab.seed": 3}, data=data)
    assert again.reused
    assert again.document.believed.friction == 0.4
    following = slidepipe.iterate("@latest:estimate", way="goal", data=data)
    assert following.document.trial == 2
    assert following.document.believed.friction == 0.4
    with pytest.raises(InputError, match=r"^--set friction=\"high\": friction: must be a number, got 'high'$"):
        slidepipe.plan(EXPERIMENT, {"friction": "high"}, data=data)
    with pytest.raises(NotFoundError):
        slidepipe.read_trial("@latest:execute", data=data / "nothing")


def test_runs(data: Path) -> None:
    frame = slidepipe.runs(data=data)
    assert frame["stage"].tolist()[:3] == ["plan", "execute", "estimate"]
    assert frame.index.name == "run"
    assert (frame["finished"] >= frame["started"]).all()
    assert str(frame["finished"].dt.tz) == "UTC"
    assert frame["seed"].tolist()[1] == 3
    assert frame["seed"].isna().tolist()[0]
    assert frame["believed_friction"].iloc[0] == 0.4
    assert frame["kappa_std"].iloc[2] > 0.0
    assert frame.attrs["units"]["kappa"] == "m/s^2"
    assert frame.attrs["damaged"] == []
    trial = slidepipe.runs(stage="execute", states=["complete", "lost"], limit=1, data=data)
    assert trial["inputs"].iloc[0] == (frame.index[0],)


def test_no_runs(tmp_path: Path) -> None:
    frame = slidepipe.runs(data=tmp_path / "nothing")
    assert len(frame) == 0
    assert frame.columns[0] == "stage"
    assert not (tmp_path / "nothing").exists()


def test_a_trial(data: Path) -> None:
    trial = slidepipe.read_trial("@latest:execute", data=data)
    assert trial.experiment.lab.friction == 0.42
    assert trial.document.lab == "simulated"
    for frame in (trial.hand, trial.object, trial.relative_pose):
        assert frame.columns.tolist() == ["x_m", "y_m", "theta_rad"]
        assert frame.index.name == "time_s"
        assert np.isfinite(frame.to_numpy()).all()
    assert len(trial.measured.columns) == 21
    assert trial.measured.index.tolist() == trial.commanded.index.tolist()
    assert np.allclose(np.diff(trial.measured.index), 0.002)
    before = trial.relative_pose.loc[:0.0].mean()
    after = trial.relative_pose.iloc[-50:].mean()
    for pose, true in ((before, trial.truth.initial_relative_pose), (after, trial.truth.final_relative_pose)):
        assert abs(pose["x_m"] - true.x_m) < 2e-4
        assert abs(pose["y_m"] - true.y_m) < 2e-4
    gap = (trial.measured - trial.commanded).filter(like="position")
    assert isinstance(gap, pd.DataFrame)
    assert 0.0 < gap.abs().to_numpy().max() < 0.1


def test_the_import_loads_nothing() -> None:
    heavy = "{'numpy', 'pandas', 'click', 'pydantic'}"
    code = f"import slidepipe, sys; print(sorted({heavy} & set(sys.modules)), dir(slidepipe))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.startswith("[] [")
    assert "'read_trial'" in done.stdout


def test_what_is_not_there() -> None:
    with pytest.raises(AttributeError, match=r"^module 'slidepipe' has no attribute 'recover'$"):
        _ = slidepipe.recover


def test_every_name_is_there() -> None:
    for name in slidepipe.__all__:
        assert getattr(slidepipe, name).__doc__ or name == "__version__"
