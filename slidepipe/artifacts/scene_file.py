"""A trial as a scene for Foxglove: frames, the block and the arm, in a file to be opened beside the recording."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from slidepipe.artifacts.messages import Kind
from slidepipe.artifacts.recording_writer import BASE_FRAME, RecordingWriter
from slidepipe.series import FloatArray, IntArray, PoseSeries

TRANSFORMS, SCENE = Kind(FrameTransforms), Kind(SceneUpdate)
FRAMES_TOPIC, BODIES_TOPIC, ARM_TOPIC = "/scene/frames", "/scene/bodies", "/scene/arm"
GREY, RED, CREAM = (0.35, 0.39, 0.43), (0.70, 0.15, 0.12), (0.94, 0.91, 0.86)


@dataclass(frozen=True, slots=True)
class SceneSeries:
    """What moves in the base frame, m: poses of hand and block, and points along the arm (K, P, 3) at times (K,)."""

    hand: PoseSeries
    block: PoseSeries
    block_size_m: FloatArray
    arm_stamp_ns: IntArray
    arm_m: FloatArray


def write_scene(path: Path, scene: SceneSeries, trial: str) -> None:
    """Write it in the order of time.

    Raises
    ------
    StoreError
        The file exists or cannot be written.
    """
    frames = [
        (int(stamp), TRANSFORMS, FRAMES_TOPIC, _transform(int(stamp), name, poses, index))
        for name, poses in (("hand", scene.hand), ("block", scene.block))
        for index, stamp in enumerate(poses.stamp_ns)
    ]
    arm = [
        (int(t), SCENE, ARM_TOPIC, _arm(int(t), points))
        for t, points in zip(scene.arm_stamp_ns, scene.arm_m, strict=True)
    ]
    first = min(stamp for stamp, *_ in (*frames, *arm))
    bodies = [(first, SCENE, BODIES_TOPIC, _bodies(first, scene.block_size_m))]
    with RecordingWriter(path, {"trial": trial}) as writer:
        for stamp, kind, topic, message in sorted([*bodies, *frames, *arm], key=lambda entry: entry[0]):
            payload = message.SerializeToString(deterministic=True)
            writer.add(topic, kind, payload, stamp_ns=stamp, log_ns=stamp)


def _transform(stamp_ns: int, name: str, poses: PoseSeries, index: int) -> Any:
    message = FrameTransforms()
    one = message.transforms.add(parent_frame_id=BASE_FRAME, child_frame_id=name)
    _stamp(one, stamp_ns)
    one.translation.x, one.translation.y, one.translation.z = poses.position_m[index]
    turn = one.rotation
    turn.x, turn.y, turn.z, turn.w = poses.quaternion_xyzw[index]
    return message


def _bodies(stamp_ns: int, size_m: FloatArray) -> Any:
    """The block in its own frame and a ball where the finger touches; both go where their frames go."""
    message = SceneUpdate()
    cube = _entity(message, stamp_ns, "block", "block").cubes.add()
    cube.size.x, cube.size.y, cube.size.z = size_m
    ball = _entity(message, stamp_ns, "finger", "hand").spheres.add()
    ball.size.x = ball.size.y = ball.size.z = 0.012
    for body, colour in ((cube, CREAM), (ball, RED)):
        body.pose.orientation.w = 1.0
        _paint(body.color, colour)
    return message


def _arm(stamp_ns: int, points: FloatArray) -> Any:
    message = SceneUpdate()
    line = _entity(message, stamp_ns, "arm", BASE_FRAME).lines.add(type=LinePrimitive.LINE_STRIP, thickness=0.025)
    line.pose.orientation.w = 1.0
    _paint(line.color, GREY)
    for point in points:
        line.points.add(x=point[0], y=point[1], z=point[2])
    return message


def _entity(message: Any, stamp_ns: int, name: str, frame_id: str) -> Any:
    entity = message.entities.add(id=name, frame_id=frame_id, frame_locked=True)
    _stamp(entity, stamp_ns)
    return entity


def _stamp(message: Any, stamp_ns: int) -> None:
    message.timestamp.seconds, message.timestamp.nanos = divmod(stamp_ns, 10**9)


def _paint(color: Any, rgb: tuple[float, float, float]) -> None:
    color.r, color.g, color.b = rgb
    color.a = 1.0
