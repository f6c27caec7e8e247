"""Out to other tools and back in: what comes back is estimated as the recording itself is."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from motive_by_hand import write_take
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import Recording, read_recording
from slidepipe.artifacts.store import Store
from slidepipe.errors import InputError, NotFoundError
from slidepipe.lab.camera_frame import CameraFrame, RigidPose, UpAxis
from slidepipe.stages import estimate, export, import_trial, plan
from slidepipe.stages.motion_times import MotionTimes

RECORDED = Path(__file__).resolve().parents[2] / "data" / "recorded"
TRIAL = next(RECORDED.glob("linear-3800-*")) / "trial.mcap"


@pytest.fixture(scope="module")
def recording() -> Recording:
    return read_recording(TRIAL)


@pytest.fixture(scope="module")
def direct() -> estimate.RecordedEstimate:
    return estimate.estimate_recording(TRIAL)


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory, experiments: Path) -> tuple[Store, str]:
    store = Store(tmp_path_factory.mktemp("import") / "data")
    return store, plan.run(plan.PlanRequest(experiments / "paper_linear.yaml", store)).run.id


@pytest.fixture
def bag(tmp_path: Path, planned: tuple[Store, str]) -> Path:
    directory = tmp_path / "bag"
    export.run(export.ExportRequest(str(TRIAL), planned[0], ros2=directory))
    return directory


def request(planned: tuple[Store, str], source: Path, hand: str, thing: str) -> import_trial.ImportRequest:
    frame = import_trial.camera_frame(source, None, None)
    return import_trial.ImportRequest(source, planned[1], hand, thing, planned[0], frame)


def same_estimate(planned: tuple[Store, str], run_id: str, direct: estimate.RecordedEstimate) -> None:
    found = estimate.run(estimate.EstimateRequest(run_id, planned[0])).document
    told, kappa = found.final_relative_pose, found.friction.kappa_m_s2
    assert (told.x_m, told.y_m) == pytest.approx(tuple(direct.estimate.final.pose[:2]), abs=2e-4)
    assert told.theta_rad == pytest.approx(direct.estimate.final.pose[2], abs=2e-3)
    assert kappa.value == pytest.approx(direct.estimate.friction.kappa_m_s2, abs=kappa.std)
    assert found.clock.residual_std_s == 0.0


def test_tables_hold_every_number(tmp_path: Path, recording: Recording, planned: tuple[Store, str]) -> None:
    directory = tmp_path / "tables"
    (written,) = export.run(export.ExportRequest(str(TRIAL), planned[0], csv=directory))
    assert set(written.files) == {
        "provenance.yaml", "plan.yaml", "experiment.yaml", "mocap_hand.csv", "mocap_object.csv", "mocap_frame.csv",
        "mocap_clock.csv", "joints_commanded.csv", "joints_measured.csv", "events.csv",
    }  # fmt: skip
    poses, hand = recording.mocap().hand, pd.read_csv(directory / "mocap_hand.csv")
    np.testing.assert_array_equal(hand[["x_m", "y_m", "z_m"]], poses.position_m)
    np.testing.assert_array_equal(hand[["qx", "qy", "qz", "qw"]], poses.quaternion_xyzw)
    np.testing.assert_array_equal(hand["stamp_ns"], poses.stamp_ns)
    joints, measured = recording.joints(topics.MEASURED), pd.read_csv(directory / "joints_measured.csv")
    np.testing.assert_array_equal(measured[[f"j{n}_position_rad" for n in range(1, 8)]], joints.position_rad)
    np.testing.assert_array_equal(measured[[f"j{n}_effort_n_m" for n in range(1, 8)]], joints.effort_n_m)
    frames = pd.read_csv(directory / "mocap_frame.csv")
    np.testing.assert_array_equal(frames["ticks"], recording.mocap().frames.ticks)
    assert pd.read_csv(directory / "events.csv")["message"].tolist() == ["motion starts", "motion ends"]
    assert (directory / "plan.yaml").read_bytes() == recording.attachment("plan.yaml")


def test_rosbags_opens_the_bag(bag: Path, recording: Recording) -> None:
    with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        types = {one.topic: (one.msgtype, one.msgcount) for one in reader.connections}
        assert types[topics.HAND] == ("geometry_msgs/msg/PoseStamped", len(recording.payloads(topics.HAND)))
        assert types[topics.MEASURED] == ("sensor_msgs/msg/JointState", len(recording.payloads(topics.MEASURED)))
        assert types[topics.FRAME][0] == "slidepipe_msgs/msg/MocapFrame"
        assert sum(count for _, count in types.values()) == recording.message_count
        rows = {topic: [] for topic in types}
        for connection, log_ns, data in reader.messages():
            rows[connection.topic].append((log_ns, reader.deserialize(data, connection.msgtype)))
    hand = recording.mocap().hand
    assert [one.pose.position.x for _, one in rows[topics.HAND]] == hand.position_m[:, 0].tolist()
    assert [one.pose.orientation.w for _, one in rows[topics.HAND]] == hand.quaternion_xyzw[:, 3].tolist()
    stamps = [10**9 * one.header.stamp.sec + one.header.stamp.nanosec for _, one in rows[topics.HAND]]
    assert stamps == hand.stamp_ns.tolist()
    assert [log for log, _ in rows[topics.HAND]] == recording.log_ns(topics.HAND).tolist()
    joints = recording.joints(topics.MEASURED)
    np.testing.assert_array_equal([one.position for _, one in rows[topics.MEASURED]], joints.position_rad)
    assert [one.ticks for _, one in rows[topics.FRAME]] == recording.mocap().frames.ticks.tolist()
    assert [one.msg for _, one in rows[topics.EVENTS]] == ["motion starts", "motion ends"]


def test_another_decoder_reads_the_bag(bag: Path, recording: Recording) -> None:
    reading = pytest.importorskip("mcap_ros2.reader", reason="mcap-ros2-support is not installed: make check-peers")
    path = bag / "bag.mcap"
    hand = [one.ros_msg.pose.position.y for one in reading.read_ros2_messages(str(path), topics=[topics.HAND])]
    assert hand == recording.mocap().hand.position_m[:, 1].tolist()


def test_a_bag_is_estimated_as_the_recording_is(bag: Path, planned, recording, direct) -> None:
    result = import_trial.run(request(planned, bag, topics.HAND, topics.OBJECT))
    assert result.document.outcome == "held"
    assert result.document.lab == "imported"
    told = read_recording(result.run.file("recording")).metadata["slidepipe.run"]
    assert (told["lab"], told["up"], told["hand"], told["source"]) == ("imported", "z", topics.HAND, str(bag))
    assert result.document.tracking_error is None
    events = {event.message: event.stamp_ns for event in recording.events()}
    first_ns = int(recording.mocap().hand.stamp_ns[0])
    assert result.motion_s.start_s == pytest.approx(1e-9 * (events["motion starts"] - first_ns), abs=0.1)
    assert result.motion_s.stop_s == pytest.approx(1e-9 * (events["motion ends"] - first_ns), abs=0.15)
    same_estimate(planned, result.run.id, direct)


@pytest.mark.parametrize("units", ["Meters", "Millimeters"])
def test_a_take_of_motive_is_estimated_as_the_recording_is(tmp_path, planned, recording, direct, units: str) -> None:
    take = write_take(recording, tmp_path / "take.csv", units=units)
    result = import_trial.run(request(planned, take, "hand", "block"))
    assert result.document.frames.taken == len(recording.mocap().frames.frame)
    assert result.document.frames.hand_missing == int(np.sum(~recording.mocap().frames.hand_valid))
    assert [one.role for one in result.run.manifest.inputs] == ["plan", "experiment", "source"]
    same_estimate(planned, result.run.id, direct)


def test_where_the_cameras_are_and_when_it_moved_can_be_said(tmp_path, planned, recording) -> None:
    """A take whose cameras stand elsewhere, and whose bodies have other frames, comes back to the same."""
    take = write_take(recording, tmp_path / "take.csv")
    asked = request(planned, take, "hand", "block")
    moved = RigidPose((1.0, -2.0, 0.5), (0.0, 0.0, 0.6, 0.8))
    plain = import_trial.run(replace(asked, motion_s=MotionTimes(0.5, 2.1)))
    placed = import_trial.run(replace(asked, frame=CameraFrame(UpAxis.Y, moved), motion_s=MotionTimes(0.5, 2.1)))
    before, after = (read_recording(one.run.file("recording")).mocap().object for one in (plain, placed))
    expected = [moved.then(RigidPose(tuple(point))).position_m for point in before.position_m[:5]]
    np.testing.assert_allclose(after.position_m[:5], expected, atol=1e-12)
    shifted = replace(asked, object_offset=RigidPose((0.1, 0.0, 0.0)), motion_s=MotionTimes(0.5, 2.1))
    offset = read_recording(import_trial.run(shifted).run.file("recording")).mocap().object
    np.testing.assert_allclose(np.linalg.norm(offset.position_m - before.position_m, axis=1), 0.1, atol=1e-6)


def broken(take: Path, change) -> Path:
    take.write_text(change(take.read_text()))
    return take


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "x" + text, r"take\.csv:1:1: is no CSV export of Motive: must begin with Format Version$"),
        (lambda text: text.replace("Millimeters", "Feet"), r"\.csv:1: Length Units: must be one of .*, got 'Feet'$"),
        (lambda text: text.replace("Quaternion", "XYZ"), r"Rotation Type: must be Quaternion, got 'XYZ': export"),
        (lambda text: text.replace("Global", "Local"), r"Coordinate Space: must be Global, got 'Local'"),
        (lambda text: text.replace(",block", ",box"), r"has no rigid body block, there are: hand, box$"),
        (lambda text: text.replace("Rigid Body", "Marker"), r"has no rigid bodies: export the take with them$"),
        (lambda text: text.replace("\n9,", "\n8,"), r"take\.csv:\d+: Frame must increase from row to row$"),
        (lambda text: text.replace("1.0,2.0,3.0,1.0,", "1.0,2.0,3.0,1.0,?", 1), r"\.csv:8: column 15: must be"),
        (lambda text: "\n".join(text.splitlines()[:7]), r"take\.csv: holds no frames$"),
    ],
)  # fmt: skip
def test_a_take_that_is_wrong(tmp_path: Path, planned, recording: Recording, change, message: str) -> None:
    take = broken(write_take(recording, tmp_path / "take.csv"), change)
    with pytest.raises(InputError, match=message):
        import_trial.run(request(planned, take, "hand", "block"))


def test_a_bag_that_is_wrong(tmp_path: Path, bag: Path, planned) -> None:
    with pytest.raises(NotFoundError, match=r"nowhere: no such bag$"):
        import_trial.run(request(planned, tmp_path / "nowhere", "a", "b"))
    with pytest.raises(InputError, match=r"has no stamped poses on /a, there are: /mocap/hand, /mocap/object$"):
        import_trial.run(request(planned, bag, "/a", "/b"))
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"empty: is no ROS 2 bag that can be read: "):
        import_trial.run(request(planned, tmp_path / "empty", "a", "b"))


def test_bodies_of_different_moments_are_refused(tmp_path: Path, planned) -> None:
    store, path = get_typestore(Stores.ROS2_HUMBLE), tmp_path / "apart"
    types, name = store.types, "geometry_msgs/msg/TransformStamped"
    vector, unit = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0), types["geometry_msgs/msg/Quaternion"](0, 0, 0, 1)
    with Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        for topic, shift_ns in (("/hand", 0), ("/block", 1_000_000)):
            connection = writer.add_connection(topic, name, typestore=store)
            for number in range(100):
                stamp = types["builtin_interfaces/msg/Time"](1, 2_777_778 * number + shift_ns)
                header = types["std_msgs/msg/Header"](stamp, "map")
                message = types[name](header, "body", types["geometry_msgs/msg/Transform"](vector, unit))
                writer.write(connection, number, store.serialize_cdr(message, name))
    with pytest.raises(InputError, match=r"/hand and /block are never stamped alike: they must come"):
        import_trial.run(request(planned, path, "/hand", "/block"))


def test_nothing_is_overwritten(tmp_path: Path, planned) -> None:
    (tmp_path / "there").mkdir()
    for where in ({"csv": tmp_path / "there"}, {"ros2": tmp_path / "there"}):
        with pytest.raises(InputError, match=r"there: exists already, name a directory that does not$"):
            export.run(export.ExportRequest(str(TRIAL), planned[0], **where))
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


@pytest.mark.parametrize(("start_s", "stop_s"), [(-0.1, 1.0), (1.0, 1.0), (2.0, 1.0), (float("nan"), 1.0)])
def test_a_motion_that_cannot_be(start_s: float, stop_s: float) -> None:
    with pytest.raises(InputError, match=r"^motion: must start at 0 s or later, and end after that"):
        MotionTimes(start_s, stop_s)
