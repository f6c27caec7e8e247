import json
import re
from pathlib import Path

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from slidepipe.arm.kinematics import link_points
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.artifacts import messages, recording_reader
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.scene_file import ARM_TOPIC, BODIES_TOPIC, FRAMES_TOPIC
from slidepipe.artifacts.store import Store
from slidepipe.errors import InputError, NotFoundError
from slidepipe.figures import replay
from slidepipe.stages.view import ViewRequest, replay_of, run

RECORDED = Path(__file__).resolve().parents[2] / "data" / "recorded" / "linear-3800-seed103" / "trial.mcap"
LAYOUT = Path(recording_reader.__file__).with_name("foxglove-layout.json")


def test_the_arm_ends_where_the_cameras_see_the_hand():
    told = replay_of(read_recording(RECORDED), "trial")
    hand = np.column_stack([np.interp(told.arm_stamp_ns, told.hand.stamp_ns, axis) for axis in told.hand.position_m.T])
    inside = (told.arm_stamp_ns > told.hand.stamp_ns[0]) & (told.arm_stamp_ns < told.hand.stamp_ns[-1])
    away = np.linalg.norm(told.arm_m[:, -1] - hand, axis=1)[inside]
    assert np.sqrt(np.mean(away**2)) < 0.002
    assert told.relative[0] == pytest.approx([-10.0, -20.0, 180.0], abs=2.0)


def test_the_points_along_the_arm_are_as_far_apart_as_its_links():
    points = link_points(nominal_model(Tool(0.1, 0.0)), np.random.default_rng(1).uniform(-0.8, 0.8, (20, 7)))
    span = np.linalg.norm(np.diff(points, axis=1), axis=2)
    np.testing.assert_allclose(span - span[0], 0.0, atol=1e-12)
    assert points.shape == (20, 8, 3)
    assert np.linalg.norm(points[:, 3] - points[:, 0], axis=1) == pytest.approx(np.hypot(0.55, 0.045))


def test_a_recording_is_written_for_the_viewer_and_can_be_read_back(tmp_path: Path):
    rerun = pytest.importorskip("rerun", reason="rerun is not installed: the extra 'view' (make test installs it)")
    path = tmp_path / "trial.rrd"
    result = run(ViewRequest(str(RECORDED), Store(tmp_path / "data"), path))
    assert path.read_bytes().startswith(b"RRF2")
    assert [one.name for one in tmp_path.iterdir()] == ["trial.rrd"]
    assert result.name == "linear-3800-seed103"
    assert rerun is not None


def test_the_scene_is_what_was_recorded():
    pytest.importorskip("rerun", reason="rerun is not installed: the extra 'view' (make test installs it)")
    told = replay_of(read_recording(RECORDED), "trial")
    sent: dict[str, int] = {}

    class Stream:
        def log(self, path: str, *_: object, static: bool) -> None:
            assert static
            sent[path] = 0

        def send_columns(self, path: str, indexes: list, columns: object) -> None:
            sent[path] = len(indexes[0].times)
            assert columns

    replay._log(Stream(), told)
    assert sent["world/hand"] == len(told.hand.stamp_ns)
    assert sent["world/block"] == len(told.block.stamp_ns)
    assert sent["world/arm"] == len(told.arm_m)
    assert {f"joints/measured/j{joint}" for joint in range(1, 8)} <= set(sent)
    assert sent["relative/theta_deg"] == len(told.relative)


def test_the_scene_for_foxglove_has_the_block_where_it_was_seen(tmp_path: Path):
    path = tmp_path / "scene.mcap"
    run(ViewRequest(str(RECORDED), Store(tmp_path / "data"), path))
    told, scene = replay_of(read_recording(RECORDED), "trial"), read_recording(path)
    frames = [FrameTransforms.FromString(one).transforms[0] for one in scene.payloads(FRAMES_TOPIC)]
    block = [one for one in frames if one.child_frame_id == "block"]
    seen = [[one.translation.x, one.translation.y, one.translation.z] for one in block]
    np.testing.assert_array_equal(seen, told.block.position_m)
    assert {one.parent_frame_id for one in frames} == {"base"}
    (bodies,) = [SceneUpdate.FromString(one) for one in scene.payloads(BODIES_TOPIC)]
    assert {one.frame_id for one in bodies.entities} == {one.child_frame_id for one in frames}
    size = bodies.entities[0].cubes[0].size
    assert [size.x, size.y, size.z] == list(told.block_size_m)
    arm = [SceneUpdate.FromString(one).entities[0].lines[0].points for one in scene.payloads(ARM_TOPIC)]
    np.testing.assert_array_equal([[[p.x, p.y, p.z] for p in one] for one in arm], told.arm_m)
    assert np.all(np.diff(np.concatenate([scene.log_ns(FRAMES_TOPIC)])) >= 0)


def test_what_cannot_be_shown_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    store = Store(tmp_path / "data")
    with pytest.raises(
        InputError, match=r"^--save a\.txt: must end in \.rrd \(for rerun\) or \.mcap \(for Foxglove\)$"
    ):
        run(ViewRequest(str(RECORDED), store, Path("a.txt")))
    with pytest.raises(InputError, match=r"a\.rrd: cannot be written: No such file or directory"):
        run(ViewRequest(str(RECORDED), store, tmp_path / "none" / "a.rrd"))
    monkeypatch.setitem(__import__("sys").modules, "rerun", None)
    with pytest.raises(NotFoundError, match=r"^rerun is not installed: pip install 'slidepipe\[view\]'$"):
        run(ViewRequest(str(RECORDED), store, tmp_path / "a.rrd"))
    assert not list(tmp_path.iterdir())


def test_every_path_of_the_foxglove_layout_is_in_the_files(regrasp, tmp_path: Path):
    layout = json.loads(LAYOUT.read_text())
    store = regrasp[1]
    topics = {}
    files = [
        store.runs(stage=stage)[-1].file(role) for stage, role in (("execute", "recording"), ("estimate", "smoothed"))
    ]
    files.append(tmp_path / "scene.mcap")
    run(ViewRequest("@latest:execute", store, files[-1]))
    for file in files:
        recording = read_recording(file)
        topics.update({topic: recording._topic(topic) for topic in recording.topic_names})
    shown = [one["value"] for panel in layout["configById"].values() for one in panel.get("paths", [])]
    assert len(shown) > 20
    for path in shown:
        topic, *fields = re.split(r"\.(?![^/]*/)", path)
        kind = next(one for one in vars(messages).values() if getattr(one, "name", None) == topics[topic].schema)
        described = kind.message.DESCRIPTOR
        for name in fields:
            field = described.fields_by_name[name.partition("[")[0]]
            described = field.message_type
    scene = layout["configById"]["3D!scene"]
    assert set(scene["topics"]) <= set(topics)
    assert {topics[name].schema for name in scene["topics"]} == {"foxglove.PoseInFrame", "foxglove.SceneUpdate"}
    panels = re.findall(r'"(\w+!\w+)"', json.dumps(layout["layout"]))
    assert sorted(panels) == sorted(layout["configById"])


def test_without_a_display_a_file_is_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rerun", reason="rerun is not installed: the extra 'view' (make test installs it)")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(NotFoundError, match=r"^the viewer needs a display, and there is none: --save FILE\.rrd"):
        run(ViewRequest(str(RECORDED), Store(tmp_path / "data")))
