from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from slidepipe.errors import InputError
from slidepipe.figures.repeatability import RepeatabilityPicture, draw_repeatability

START, GOAL = np.array([-0.01, 0.04, 2.356]), np.array([0.01, 0.04, 3.1416])


def picture(count: int, **changes: object) -> RepeatabilityPicture:
    random = np.random.default_rng(1)
    noise = random.normal(size=(count, 3)) * [0.002, 0.004, 0.2]
    values = {
        "start": np.tile(START, (count, 1)),
        "goal": np.tile(GOAL, (count, 1)),
        "initial": np.tile(START, (count, 1)),
        "final": GOAL + noise,
        "outlying": np.arange(count) == 1,
        "position_tolerance_m": 0.001,
    }
    return RepeatabilityPicture(**(values | changes))


@pytest.mark.parametrize("count", [1, 2, 12])
def test_any_number_of_trials_makes_the_same_picture_each_time(tmp_path: Path, count: int) -> None:
    paths = [tmp_path / "a.png", tmp_path / "b.png"]
    for path in paths:
        draw_repeatability(picture(count), path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    with Image.open(paths[0]) as drawn:
        assert drawn.size == (2340, 882)


def test_trials_without_an_initial_pose_are_drawn(tmp_path: Path) -> None:
    draw_repeatability(picture(3, initial=np.full((3, 3), np.nan)), tmp_path / "a.png")


def test_the_turn_is_counted_from_the_planned_start_within_half_a_turn() -> None:
    poses = np.tile(START, (2, 1))
    poses[:, 2] += 0.1 - 2.0 * np.pi
    assert picture(2).shown(poses) == pytest.approx(np.tile([-10.0, 40.0, np.degrees(0.1)], (2, 1)))


def test_what_cannot_be_drawn() -> None:
    with pytest.raises(InputError, match="there are no trials to draw"):
        picture(0)
    with pytest.raises(InputError, match=r"goal must be \(2, 3\), got \(3,\)"):
        picture(2, goal=GOAL)
