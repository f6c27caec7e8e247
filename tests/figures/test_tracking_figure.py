from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from figures.reading import assert_readable, line
from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.figures.tracking import TrackingPanel, draw_tracking

TIME_S = np.linspace(0.0, 1.2, 601)
REFERENCE = np.column_stack([0.1 * TIME_S, 0.05 * TIME_S**2, 3.0 + 0.3 * TIME_S])


def panel(
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0), title: str = "trial 1", **changes: object
) -> TrackingPanel:
    """Measured from 0.1 s before to 0.1 s after the motion, off its reference by so much, angles within half a turn."""
    time_s = np.arange(-0.1, 1.3, 1 / 360)
    measured = np.column_stack([np.interp(time_s, TIME_S, column) for column in REFERENCE.T]) + offset
    measured[:, 2] = (measured[:, 2] + np.pi) % (2 * np.pi) - np.pi
    values = {
        "title": title,
        "time_s": TIME_S,
        "reference": REFERENCE,
        "measured_time_s": time_s,
        "measured": measured,
        "slide_s": (0.3, 0.5),
    }
    return TrackingPanel(**(values | changes))


def test_the_error_is_the_distance_and_the_turn_at_the_same_moment() -> None:
    one = panel((0.003, -0.004, 0.02))
    inside = (one.measured_time_s >= 0.0) & (one.measured_time_s <= TIME_S[-1])
    assert one.error[inside] == pytest.approx(np.tile([0.005, 0.02], (inside.sum(), 1)), abs=1e-12)
    assert np.isnan(one.error[~inside]).all()


def test_what_is_drawn(tmp_path: Path, drawn) -> None:
    draw_tracking([panel((0.003, -0.004, 0.02)), panel(title="trial 4")], tmp_path / "tracking.png")
    axes = drawn[0].axes
    assert [len(row) for row in axes] == [2] * 5
    assert [row[0].get_ylabel() for row in axes] == ["$x$ (mm)", "$y$ (mm)", "$θ$ (°)", "error (mm)", "error (mrad)"]
    assert [one.get_title() for one in axes[0]] == ["trial 1", "trial 4"]
    for row, factor in zip(axes[:3], (1e3, 1e3, np.degrees(1.0)), strict=True):
        index = axes.index(row)
        assert line(row[0], style.WANTED).get_ydata() == pytest.approx(REFERENCE[:, index] * factor)
        away = (0.003, -0.004, 0.02)[index] * factor
        assert line(row[0], style.MEASURED).get_ydata()[100] == pytest.approx(
            np.interp(panel().measured_time_s[100], TIME_S, REFERENCE[:, index]) * factor + away
        )
    assert axes[3][0].get_title(loc="right") == "rms 5.00 mm, peak 5.00 mm"
    assert axes[4][0].get_title(loc="right") == "rms 20.00 mrad, peak 20.00 mrad"
    assert [patch.get_extents().x0 for patch in axes[0][0].patches] == [axes[0][0].transData.transform((0.3, 0))[0]]


@pytest.mark.parametrize("count", [1, 2])
def test_readable(tmp_path: Path, drawn, count: int) -> None:
    draw_tracking(
        [panel((0.003, -0.004, 0.02), title=f"trial {number}") for number in range(count)], tmp_path / "a.png"
    )
    assert_readable(drawn[0])
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.format == "PNG"
        assert min(picture.info["dpi"]) > 150.0
        assert picture.width > 1000


def test_panels_of_different_turns_share_a_scale(tmp_path: Path, drawn) -> None:
    other = REFERENCE - [0.0, 0.0, 2 * np.pi]
    draw_tracking([panel(), panel(reference=other)], tmp_path / "a.png")
    first, second = drawn[0].axes[2]
    assert line(first, style.WANTED).get_ydata() == pytest.approx(line(second, style.WANTED).get_ydata())
    assert np.ptp(first.get_ylim()) < 30.0


def test_no_line_across_lost_frames(tmp_path: Path, drawn) -> None:
    whole = panel()
    kept = np.abs(whole.measured_time_s - 0.6) > 0.05
    lossy = panel(measured_time_s=whole.measured_time_s[kept], measured=whole.measured[kept])
    draw_tracking([lossy], tmp_path / "a.png")
    shown = line(drawn[0].axes[0][0], style.MEASURED)
    assert np.isnan(shown.get_ydata()).sum() == 1
    assert shown.get_xdata()[np.isnan(shown.get_ydata())] == pytest.approx(0.55, abs=0.01)


def test_nothing_measured_and_nothing_slid(tmp_path: Path, drawn) -> None:
    empty = panel(measured_time_s=np.zeros(0), measured=np.zeros((0, 3)), slide_s=None)
    draw_tracking([empty], tmp_path / "a.png")
    assert drawn[0].axes[3][0].get_title(loc="right") == ""
    assert list(drawn[0].axes[0][0].patches) == []


def test_same_content_same_bytes(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        draw_tracking([panel()], tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_no_panels(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no panels to draw"):
        draw_tracking([], tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"reference": REFERENCE[:, :2]}, r"reference of trial 1 must be one pose .* got \(601, 2\) for \(601,\)"),
        ({"measured": np.zeros((2, 3))}, "measurement of trial 1 must be one pose"),
        ({"time_s": np.zeros(1), "reference": np.zeros((1, 3))}, "must have 2 poses at least, got 1"),
    ],
)
def test_shapes_that_do_not_fit(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        panel(**changes)
