"""The words around export, import and recover; what they do is tested with their stages."""

import json
from pathlib import Path

import pytest

TRIAL = next((Path(__file__).resolve().parents[2] / "data" / "recorded").glob("linear-3800-*")) / "trial.mcap"


def test_export_names_what_it_wrote(call, tmp_path: Path) -> None:
    where = tmp_path / "tables"
    result = call("export", str(TRIAL), "--csv", str(where))
    assert result.exit_code == 0
    assert result.stderr == ""
    assert result.stdout.splitlines() == sorted(str(path) for path in where.iterdir())
    again = call("export", str(TRIAL), "--csv", str(where))
    assert again.exit_code == 3
    assert again.stderr == f"error: {where}: exists already, name a directory that does not\n"


def test_export_as_json(call, tmp_path: Path) -> None:
    result = call("export", str(TRIAL), "--csv", str(tmp_path / "a"), "--json")
    told = json.loads(result.stdout)
    assert list(told) == ["schema", "exported"]
    assert told["schema"] == "slidepipe.export_result/1"
    assert [one["directory"] for one in told["exported"]] == [str(tmp_path / "a")]
    assert "mocap_hand.csv" in told["exported"][0]["files"]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["export", "@latest"], "Error: say what to write: --ros2 DIR, --csv DIR, or both"),
        (["import", "a.csv", "--hand", "h", "--object", "o"], "Error: say which plan the trial belongs to: "),
        (["import", "a.csv", "--plan", "p", "--object", "o"], "Error: Missing option '--hand'"),
        (["import", "a.csv", "--plan", "p", "--hand", "h", "--object", "o", "--up", "x"], "Invalid value for '--up'"),
        (["import", "a.csv", "--plan", "p", "--hand", "h", "--object", "o", "--hand-offset", "1"], "requires 7"),
        (["recover", "a", "b"], "Error: Got unexpected extra argument (b)"),
    ],
)  # fmt: skip
def test_wrong_usage(call, arguments: list[str], complaint: str) -> None:
    result = call(*arguments)
    assert result.exit_code == 2
    assert complaint in result.stderr


def test_a_pose_without_a_rotation(call) -> None:
    pose = ["--cameras-in-base", "0", "0", "0", "0", "0", "0", "0"]
    result = call("import", "a.csv", "--plan", "p", "--hand", "h", "--object", "o", *pose)
    assert result.exit_code == 3
    assert result.stderr == "error: --cameras-in-base: the quaternion must be of length 1, got 0\n"


def test_recover_a_recording_where_it_lies(call, tmp_path: Path) -> None:
    path = tmp_path / ("a" * 100) / "a.mcap"
    path.parent.mkdir()
    data = TRIAL.read_bytes()
    path.write_bytes(data)
    sound = call("recover", str(path))
    assert sound.exit_code == 0
    assert sound.stdout.splitlines()[-1].split()[1::2] == [str(path), "nothing"], "neither is cut"
    assert path.read_bytes() == data
    path.write_bytes(data[: len(data) // 2])
    cut = json.loads(call("recover", str(path), "--json").stdout)
    assert cut["schema"] == "slidepipe.recover_result/1"
    (recording,) = cut["recovered"][0]["recordings"]
    assert recording["path"] == str(path)
    assert recording["messages"] > 1000
    assert recording["fault"].startswith("byte ")
    assert json.loads(call("recover", str(path), "--json").stdout)["recovered"][0]["recordings"][0]["fault"] is None
