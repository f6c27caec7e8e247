from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from slidepipe.errors import InputError
from slidepipe.figures.estimated import EstimatePicture, Posterior, Trace, draw_estimate

TIME_S = np.arange(-0.1, 0.9, 1 / 360)
NOISE = np.array([3e-4, 3e-4, 3e-3])


def trace(title: str) -> Trace:
    random = np.random.default_rng(1)
    smoothed = np.column_stack([0.1 * np.sin(TIME_S), np.zeros_like(TIME_S), np.ones_like(TIME_S)])
    raw = smoothed + NOISE * random.normal(size=smoothed.shape)
    raw[50:60] = np.nan
    return Trace(title, raw, smoothed, NOISE)


def picture(**changes: object) -> EstimatePicture:
    values = {
        "title": "Estimate",
        "time_s": TIME_S,
        "traces": (trace("hand"), trace("object"), trace("finger")),
        "slide_s": (0.3, 0.45),
        "posterior": Posterior(20.6, 0.05, (20.5, 20.7), 30.0),
        "missing_because": None,
    }
    return EstimatePicture(**(values | changes))


@pytest.mark.parametrize(
    "changes",
    [{}, {"slide_s": None, "posterior": None, "missing_because": "no slide: " + 30 * "the speed stayed low "}],
)
def test_same_estimate_same_picture_with_and_without_friction(tmp_path: Path, changes: dict[str, object]) -> None:
    paths = [tmp_path / "a.png", tmp_path / "b.png"]
    for path in paths:
        draw_estimate(picture(**changes), path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    with Image.open(paths[0]) as drawn:
        assert drawn.size == (2700, 1548)


def test_residuals_count_in_standard_deviations() -> None:
    residual = trace("hand").residual
    assert np.isnan(residual[50:60]).all()
    assert np.nanstd(residual, axis=0) == pytest.approx([1.0, 1.0, 1.0], abs=0.15)


def test_what_cannot_be_drawn() -> None:
    with pytest.raises(InputError, match="either a posterior or the reason why there is none"):
        picture(missing_because="nothing slid")
    with pytest.raises(InputError, match="raw poses of hand must be one pose"):
        picture(time_s=TIME_S[1:])
