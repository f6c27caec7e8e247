"""Lab files: those that are shipped, and what is refused."""

from pathlib import Path

import pytest

from slidepipe.artifacts.lab import LabDocument, find_lab, load_lab
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.errors import InputError, NotFoundError

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
LOOPBACK = (EXPERIMENTS / "labs" / "loopback.yaml").read_text()


@pytest.mark.parametrize("path", sorted((EXPERIMENTS / "labs").glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_labs_are_sound_and_come_back_equal(path: Path) -> None:
    lab = load_lab(path)
    assert lab.name == path.stem
    assert parse(LabDocument, loads(dump_model(lab), "a.yaml")) == lab


def test_labs_are_found_by_name_and_by_path(monkeypatch: pytest.MonkeyPatch) -> None:
    path = EXPERIMENTS / "labs" / "wam.yaml"
    assert find_lab("wam", EXPERIMENTS) == path
    assert find_lab(str(path), Path("elsewhere")) == path
    monkeypatch.chdir(EXPERIMENTS.parent)
    assert find_lab("wam", Path("elsewhere")) == Path("experiments/labs/wam.yaml")
    with pytest.raises(NotFoundError, match=r"^lab wan: no .*wan.yaml, there are loopback, wam; did you mean wam.$"):
        find_lab("wan", EXPERIMENTS)
    with pytest.raises(NotFoundError, match=r"^lab none.yaml: there is no such file$"):
        find_lab("none.yaml", EXPERIMENTS)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("dialect: bridge ", "dialect: brigde ", r"a.yaml:6:3: arm.dialect: must be 'positions', 'velocities' or 'br"),
        ("host: 127.0.0.1, port: 5555", "host: localhost, port: 5555", r"arm.local.host: must be an IPv4.*'localhost'"),
        ("port: 5556", "port: 5555", r"a.yaml:7:3: arm.local: must differ from arm.remote"),
        ("home_pose_rad: [1.074", "home_pose_rad: [3.0", r"home_pose_rad\[0\]: must be within .* and 2.6 rad, got 3"),
        ("home_pose_rad: [1.074, ", "home_pose_rad: [", r"arm.home_pose_rad: must have 7 entries, got 6"),
        ("quaternion_xyzw: [0.0, 0.0, 0.0, 1.0]", "quaternion_xyzw: [0.0, 0.0, 0.0, 2.0]",
         r"cameras.frame.quaternion_xyzw: must have the length 1, got 2"),
        ("arm_s: 0.02", "arm_s: 1.0", r"timeouts.arm_s: must be at most ten times arm.driver_timeout_s"),
        ("rest_s: 0.5", "rest_s: 0.1", r"pauses.rest_s: must be >= 0.5, got 0.1"),
        ("jump_rad: 0.05", "jumps_rad: 0.05", r"unknown key, did you mean jump_rad"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_its_place(old: str, new: str, words: str) -> None:
    assert old in LOOPBACK
    with pytest.raises(InputError, match=words):
        parse(LabDocument, loads(LOOPBACK.replace(old, new, 1), "a.yaml"))
