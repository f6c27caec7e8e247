from pathlib import Path

import numpy as np
import pytest

from figures.reading import assert_readable, line
from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.figures.sliding import SlidingPanel, draw_sliding

START, GOAL = np.array([-0.01, -0.02, np.pi]), np.array([0.01, 0.02, np.pi])
DEGREES = float(np.degrees(1.0))


def slide(time_s: np.ndarray, share: float = 1.0) -> np.ndarray:
    """Relative poses that go from start to goal between 0.3 s and 0.46 s, or as much of the way as it says."""
    done = np.clip((time_s - 0.3) / 0.16, 0.0, 1.0)[:, None]
    return START + share * (3 * done**2 - 2 * done**3) * (GOAL - START)


def wrapped(poses: np.ndarray) -> np.ndarray:
    return np.column_stack([poses[:, :2], (poses[:, 2] + np.pi) % (2 * np.pi) - np.pi])


def panel(title: str = "trial 1", **changes: object) -> SlidingPanel:
    random = np.random.default_rng(5)
    time_s, frames_s = np.arange(0.0, 1.0, 0.002), np.arange(-0.1, 1.1, 1 / 360)
    real = slide(frames_s, 0.6)
    values = {
        "title": title,
        "time_s": time_s,
        "planned": slide(time_s),
        "raw_time_s": frames_s,
        "raw": wrapped(real + random.normal(scale=[0.0004, 0.0004, 0.004], size=real.shape)),
        "smoothed_time_s": frames_s,
        "smoothed": real,
        "slide_s": (0.3, 0.46),
        "goal": GOAL,
        "truth": real,
        "position_tolerance_m": 0.001,
        "angle_tolerance_rad": 0.01,
    }
    return SlidingPanel(**(values | changes))


def words(sheet) -> list[str]:
    return [text.get_text() for text in sheet.figure.legends[0].get_texts()]


def test_what_is_drawn(tmp_path: Path, drawn) -> None:
    one = panel()
    draw_sliding([one, panel("trial 3")], tmp_path / "sliding.png")
    sheet = drawn[0]
    assert [row[0].get_ylabel() for row in sheet.axes] == ["$x$ (mm)", "$y$ (mm)", "$θ$ (°)"]
    assert words(sheet) == ["planned", "cameras", "smoothed", "true", "goal", "sliding", "tolerance"]
    for index, factor in enumerate((1e3, 1e3, DEGREES)):
        axes = sheet.axes[index][0]
        assert line(axes, style.WANTED).get_ydata() == pytest.approx(one.planned[:, index] * factor)
        assert line(axes, style.MEASURED).get_ydata() == pytest.approx(one.smoothed[:, index] * factor)
        assert line(axes, style.TRUE).get_ydata() == pytest.approx(one.truth[:, index] * factor)
        assert set(line(axes, style.GOAL).get_ydata()) == {GOAL[index] * factor}
        dots = line(axes, style.RAW)
        assert dots.get_ydata() == pytest.approx(one.smoothed[:, index] * factor, abs=5 * (0.4, 0.4, 0.23)[index])
        assert dots.get_linestyle() == "None"
        band = axes.patches[1].get_bbox()
        allowed = (1.0, 1.0, 0.01 * DEGREES)[index]
        assert (band.y0, band.y1) == pytest.approx((GOAL[index] * factor - allowed, GOAL[index] * factor + allowed))


@pytest.mark.parametrize("count", [1, 2])
def test_readable(tmp_path: Path, drawn, count: int) -> None:
    draw_sliding([panel(f"trial {number}: 13.42 mm and 0.4 mrad away") for number in range(count)], tmp_path / "a.png")
    assert_readable(drawn[0])


def test_lines_differ_by_more_than_their_colour(tmp_path: Path, drawn) -> None:
    draw_sliding([panel()], tmp_path / "a.png")
    axes = drawn[0].axes[0][0]
    patterns = {(one.get_linestyle(), str(one._unscaled_dash_pattern), one.get_marker()) for one in axes.lines}
    assert len(patterns) == len(axes.lines) == 5


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_everything_is_in_the_turn_of_the_goal(tmp_path: Path, drawn, turns: int) -> None:
    whole = np.array([0.0, 0.0, 2 * np.pi * turns])
    one = panel(planned=panel().planned + whole, truth=panel().truth - whole)
    draw_sliding([one], tmp_path / "a.png")
    axes = drawn[0].axes[2][0]
    for look in (style.WANTED, style.RAW, style.MEASURED, style.TRUE):
        assert line(axes, look).get_ydata() == pytest.approx(180.0, abs=2.0)


def test_no_truth_no_word_of_it(tmp_path: Path, drawn) -> None:
    draw_sliding([panel(truth=None)], tmp_path / "a.png")
    assert "true" not in words(drawn[0])
    assert len(drawn[0].axes[0][0].lines) == 4


def test_truth_with_its_own_times(tmp_path: Path, drawn) -> None:
    times_s = np.arange(0.0, 1.0, 0.01)
    draw_sliding([panel(truth=slide(times_s), truth_time_s=times_s)], tmp_path / "a.png")
    assert line(drawn[0].axes[0][0], style.TRUE).get_xdata() == pytest.approx(times_s)


def test_an_object_that_flies_away_does_not_flatten_the_plan(tmp_path: Path, drawn) -> None:
    one = panel()
    astray = one.smoothed + np.outer(np.clip(one.smoothed_time_s - 0.5, 0.0, None) ** 2, [9.0, -20.0, 40.0])
    draw_sliding([panel(smoothed=astray, truth=None)], tmp_path / "a.png")
    low, high = drawn[0].axes[0][0].get_ylim()
    assert (low, high) == pytest.approx((-11.0, 40.0), abs=6.0)


def test_nothing_is_drawn_of_an_object_that_left_the_fingers(tmp_path: Path, drawn) -> None:
    time_s = np.arange(-0.1, 1.1, 1 / 360)
    away = np.maximum(0.0, np.sin(np.pi * np.clip((time_s - 0.3) / 0.5, 0.0, 1.0)))  # m: it leaves, and passes by again
    real = slide(time_s)
    real[:, 0] += away
    draw_sliding([panel(smoothed=real, truth=real)], tmp_path / "sliding.png")
    shown = line(drawn[0].axes[1][0], style.MEASURED).get_ydata()
    gone = np.flatnonzero(away > 0.5)[0]
    assert np.isnan(shown[gone:]).all()
    assert shown[time_s < 0.3] == pytest.approx(real[time_s < 0.3, 1] * 1e3)


def test_a_few_outliers_do_not_stretch_the_scale(tmp_path: Path, drawn) -> None:
    raw = panel().raw.copy()
    raw[[7, 90]] += [0.02, 0.02, 0.3]
    draw_sliding([panel(raw=raw), panel()], tmp_path / "a.png")
    assert drawn[0].axes[0][0].get_ylim()[1] < 15.0


def test_nothing_seen(tmp_path: Path, drawn) -> None:
    nothing = {"raw_time_s": np.zeros(0), "raw": np.zeros((0, 3))}
    nothing |= {"smoothed_time_s": np.zeros(0), "smoothed": np.zeros((0, 3))}
    draw_sliding([panel(**nothing, truth=None, slide_s=None)], tmp_path / "a.png")
    assert drawn[0].axes[0][0].get_ylim() == pytest.approx((-11.0, 12.0), abs=2.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"planned": np.zeros((4, 3))}, "plan of trial 1 must be one pose"),
        ({"raw": np.zeros((4, 3))}, "raw poses of trial 1 must be one pose"),
        ({"smoothed": np.zeros((4, 3))}, "smoothed poses of trial 1 must be one pose"),
        ({"truth": np.zeros((4, 3))}, "truth of trial 1 must be one pose"),
        ({"time_s": np.zeros(0), "planned": np.zeros((0, 3))}, "must have 2 poses at least, got 0"),
    ],
)
def test_shapes_that_do_not_fit(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        panel(**changes)
