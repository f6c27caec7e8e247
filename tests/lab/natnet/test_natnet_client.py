"""Client and server over loopback."""

import math
import socket
import time
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
import pytest
from natnet_stage import BLOCK, CLOCK_HZ, HAND, LOOPBACK, MODELS, free_port, playing, ticks, towards, until

from slidepipe.errors import LabError
from slidepipe.lab.camera_frame import CameraFrame, RigidPose, UpAxis
from slidepipe.lab.host_clock import HostClock
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.client import NatNetClient
from slidepipe.lab.natnet.codec import encode
from slidepipe.lab.natnet.connection import MOST_AT_ONCE
from slidepipe.lab.natnet.models import ModelDef, RigidBodyModel
from slidepipe.lab.natnet.server import NatNetServer
from slidepipe.lab.natnet.settings import NatNetSettings, TrackedBody, Transport
from slidepipe.lab.natnet.version import NatNetVersion
from slidepipe.lab.protocols import MocapFrame, MotionCapture

pytestmark = pytest.mark.realtime

UNIT = (0.0, 0.0, 0.0, 1.0)
AS_IT_IS = CameraFrame(UpAxis.Z)
SLACK_NS = 20_000_000
"""A busy machine may stop the server's thread between reading its clock and answering."""
VERSIONS = [NatNetVersion.parse(text) for text in ("2.5", "2.9", "3.0", "3.1", "4.0", "4.1")]


def hand(x: float = 1.0, quaternion: tuple[float, ...] = UNIT, params: int = 1) -> m.RigidBody:
    return m.RigidBody(HAND, (x, 2.0, 3.0), quaternion, params=params)


def block(x: float = 4.0) -> m.RigidBody:
    return m.RigidBody(BLOCK, (x, 5.0, 6.0), UNIT)


def taken(client: NatNetClient, count: int) -> list[MocapFrame]:
    frames: list[MocapFrame] = []

    def enough() -> bool:
        frames.extend(client.take())
        return len(frames) >= count

    until(enough)
    return frames


@pytest.mark.parametrize("transport", list(Transport))
@pytest.mark.parametrize("version", VERSIONS, ids=str)
def test_frames_arrive(transport: Transport, version: NatNetVersion) -> None:
    with playing(transport, version) as stage, NatNetClient(towards(stage, frame=AS_IT_IS), HostClock()) as client:
        cameras: MotionCapture = client
        sent = [stage.publish(hand(float(x)), block(), timestamp_s=1.0 + x) for x in range(5)]
        frames = taken(client, 5)
        assert client.version == version
        assert client.models.bodies[1].name == "block"
        assert [frame.frame for frame in frames] == [1, 2, 3, 4, 5]
        assert [frame.hand.position_m.tolist() for frame in frames] == [[x, 2.0, 3.0] for x in range(5)]
        assert frames[0].object.position_m.tolist() == [4.0, 5.0, 6.0]
        if version >= NatNetVersion(3, 0):
            assert cameras.ticks_per_s == CLOCK_HZ
            assert [frame.ticks for frame in frames] == [frame.exposure_ticks for frame in sent]
        else:
            assert cameras.ticks_per_s == 1e6
            assert [frame.ticks for frame in frames] == [1_000_000 * (1 + x) for x in range(5)]
            assert cameras.echo() is None
        assert client.counts.frames.taken == 5
        assert client.counts.malformed == client.counts.foreign == client.counts.hand_missing == 0


def test_stamps_are_of_arrival_and_clocks_agree() -> None:
    """Both ends share one machine: the mapping of ticks must give the time at which a frame was sent."""
    clock = HostClock()
    with playing() as stage, NatNetClient(towards(stage), clock) as client:
        before_ns, frame = clock.now_ns(), stage.publish(hand(), block())
        after_ns = clock.now_ns()
        time.sleep(0.05)
        late_ns = clock.now_ns()
        (arrived,) = taken(client, 1)
        assert before_ns <= arrived.received_ns < late_ns, "the kernel's stamp, not the time of reading"
        told_ns = client.camera_clock.host_ns(frame.exposure_ticks)
        assert before_ns - SLACK_NS <= told_ns <= after_ns + SLACK_NS


def test_echoes_do_not_wait_and_are_told_once() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        while client.echo() is not None:
            pass
        exchanges = []

        def told() -> bool:
            client.take()
            exchange = client.echo()
            exchanges.extend([exchange] if exchange else [])
            return len(exchanges) >= 20

        until(told)
        stamps = [exchange.sent_ns for exchange in exchanges]
        assert stamps == sorted(set(stamps))
        assert all(exchange.sent_ns < exchange.received_ns for exchange in exchanges)
        assert np.all(np.diff([exchange.ticks for exchange in exchanges]) >= 0)
        assert exchanges[-1].ticks <= ticks()


def test_frames_that_are_missing_repeated_late_and_frozen_are_counted() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        first = stage.publish(hand(), number=10)
        taken(client, 1)
        stage.again(first)
        stage.publish(hand(), number=13)
        assert [frame.frame for frame in taken(client, 1)] == [13]
        stage.publish(hand(), number=12)
        stage.publish(hand(), number=14, exposure_ticks=first.exposure_ticks)
        stage.publish(hand(), number=15)
        sixteenth = ticks()
        stage.publish(hand(), number=17)
        stage.publish(hand(), number=16, exposure_ticks=sixteenth)
        time.sleep(0.02)
        assert [frame.frame for frame in taken(client, 3)] == [15, 16, 17], "put in order where they came together"
        counts = client.counts.frames
        assert (counts.taken, counts.missing, counts.repeated, counts.late, counts.frozen) == (5, 3, 1, 1, 1)


def test_a_server_that_counts_anew_is_followed() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        stage.publish(hand(), number=50_000)
        taken(client, 1)
        stage.publish(hand(), number=1)
        assert [frame.frame for frame in taken(client, 1)] == [1]
        assert client.take_notices() == ["the cameras began to count their frames anew, at 1"]
        assert client.take_notices() == []
        assert client.counts.frames.restarts == 1
        assert client.counts.frames.missing == 0


@pytest.mark.parametrize(
    "body",
    [
        hand(params=0),
        hand(x=math.nan),
        hand(quaternion=(0.0, 0.0, 0.0, 0.5)),
        m.RigidBody(99, (0.0, 0.0, 0.0), UNIT),
    ],
    ids=["not tracked", "not a number", "no rotation", "another body"],
)
def test_a_body_that_was_not_tracked_is_none(body: m.RigidBody) -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        stage.publish(body, block())
        (frame,) = taken(client, 1)
        assert frame.hand is None
        assert frame.object is not None
        assert (client.counts.hand_missing, client.counts.object_missing) == (1, 0)


def test_bodies_are_found_by_name_and_by_number() -> None:
    with playing() as stage, NatNetClient(towards(stage, hand=BLOCK, thing="hand"), HostClock()) as client:
        stage.publish(hand(), block())
        (frame,) = taken(client, 1)
        assert frame.object.position_m.tolist() == [1.0, -3.0, 2.0]
        assert frame.hand.position_m.tolist() == [4.0, -6.0, 5.0]


def test_models_that_change_are_asked_for_again() -> None:
    with playing() as stage, NatNetClient(towards(stage, frame=AS_IT_IS), HostClock()) as client:
        stage.publish(hand(), block())
        taken(client, 1)
        stage.set_models(ModelDef((RigidBodyModel("block", HAND), RigidBodyModel("hand", BLOCK))))
        stage.publish(hand(), block())

        def learned() -> bool:
            client.take()
            return client.models.bodies[0].name == "block"

        until(learned)
        stage.publish(hand(), block())
        (frame,) = taken(client, 1)
        assert frame.object.position_m.tolist() == [1.0, 2.0, 3.0]
        assert client.take_notices() == ["the cameras' list of models has changed"]
        stage.set_models(ModelDef((RigidBodyModel("block", HAND),)))
        stage.publish(hand(), block())
        notices: list[str] = []

        def told() -> bool:
            client.take()
            notices.extend(client.take_notices())
            return len(notices) == 2

        until(told)
        assert notices[1] == "the hand is no longer among the cameras' models"
        stage.publish(hand(), block())
        assert taken(client, 1)[0].hand is None
        assert client.counts.model_changes == 2


def test_a_server_that_goes_on_saying_so_is_asked_once() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        for _ in range(3):
            stage.publish(hand(), block(), params=int(m.FrameFlags.MODELS_CHANGED))
            taken(client, 1)
        assert client.counts.model_changes == 1


def test_a_flood_is_taken_in_pieces() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        for _ in range(100):
            stage.publish(hand(), block())
        first = client.take()
        assert 0 < len(first) <= 2 * MOST_AT_ONCE
        assert [frame.frame for frame in first + taken(client, 100 - len(first))] == list(range(1, 101))
        assert client.counts.frames.missing == 0


def test_axes_and_frames() -> None:
    """A hand one metre up and two to the right of cameras half a metre above the base, turned by 90 degrees."""
    turned = RigidPose((0.0, 0.0, 0.5), (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4)))
    frame = CameraFrame(UpAxis.Y, turned)
    pose = RigidPose((0.3, 1.7, 1.5), (0.1, 0.7, -0.1, 0.7))
    size = math.hypot(*pose.quaternion_xyzw)
    pose = RigidPose(pose.position_m, tuple(number / size for number in pose.quaternion_xyzw))
    back = frame.from_base(frame.to_base(pose))
    np.testing.assert_allclose(back.position_m, pose.position_m, atol=1e-12)
    np.testing.assert_allclose(back.quaternion_xyzw, pose.quaternion_xyzw, atol=1e-12)
    seen = frame.to_base(RigidPose((2.0, 1.0, 0.0)))
    np.testing.assert_allclose(seen.position_m, (0.0, 2.0, 1.5), atol=1e-12)
    np.testing.assert_allclose(seen.quaternion_xyzw, turned.quaternion_xyzw, atol=1e-12)
    offset = TrackedBody("hand", RigidPose((0.1, 0.0, 0.0)))
    with playing() as stage:
        settings = replace(towards(stage, frame=frame), hand=offset)
        with NatNetClient(settings, HostClock()) as client:
            stage.publish(m.RigidBody(HAND, (2.0, 1.0, 0.0), UNIT), block())
            (one,) = taken(client, 1)
            np.testing.assert_allclose(one.hand.position_m, (0.0, 2.1, 1.5), atol=1e-7)


def test_what_comes_from_elsewhere_or_is_damaged_is_counted_and_ignored() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        (address,) = stage.server.clients
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.bind(("127.0.0.2", 0))
            other.sendto(b"\7\0\0\0", (address.host, address.port))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as same:
            same.bind((LOOPBACK, 0))
            same.sendto(b"\7\0\0\0", (address.host, address.port))
        stage.publish(hand(), block())
        assert len(taken(client, 1)) == 1
        assert (client.counts.foreign, client.counts.malformed) == (1, 1)


def test_frames_to_the_data_port_are_taken_as_well() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        frame = stage.publish(hand(), block())
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
            server.bind((LOOPBACK, 0))
            server.sendto(encode(frame, client.version), (LOOPBACK, stage.server.settings.data_port))
        time.sleep(0.01)
        taken(client, 1)
        until(lambda: not client.take() and client.counts.frames.repeated == 1)


def test_a_server_that_was_started_anew_sends_frames_again() -> None:
    port = free_port()
    with ExitStack() as until_the_end:
        with playing(port=port) as stage:
            client = until_the_end.enter_context(NatNetClient(towards(stage), HostClock()))
            stage.publish(hand(), block())
            taken(client, 1)
        stage = until_the_end.enter_context(playing(port=port))
        stage.frame = 1

        def known() -> bool:
            client.take()
            return bool(stage.server.clients)

        until(known)
        stage.publish(hand(), block())
        assert len(taken(client, 1)) == 1


def test_nobody_answers() -> None:
    port = free_port()
    settings = NatNetSettings(
        LOOPBACK, LOOPBACK, TrackedBody("hand"), TrackedBody("block"), command_port=port, data_port=0, timeout_s=0.3
    )
    with pytest.raises(LabError, match=rf"^cameras at 127\.0\.0\.1:{port}: no answer within 0\.3 s$"):
        NatNetClient(settings, HostClock()).__enter__()


def test_a_body_that_is_not_there_is_named_with_those_that_are() -> None:
    with (
        playing() as stage,
        pytest.raises(LabError, match=r"has no rigid body box for the object, there are: hand \(3\), block \(7\)$"),
    ):
        NatNetClient(towards(stage, thing="box"), HostClock()).__enter__()


def test_a_version_that_is_too_old_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with playing() as stage:
        told = m.ServerInfo("Motive", (1, 0, 0, 0), (2, 1, 0, 0))
        monkeypatch.setattr(NatNetServer, "_info", lambda _self: told)
        with pytest.raises(LabError, match=r"speaks NatNet 2\.1, from 2\.5 to 4\.1 is understood$"):
            NatNetClient(towards(stage), HostClock()).__enter__()


def test_sockets_are_bound_to_the_interface_alone() -> None:
    with playing() as stage, NatNetClient(towards(stage), HostClock()) as client:
        bound = [one.address.host for one in client._wire._sockets] + [stage.server.address.host]
        assert bound == [LOOPBACK] * 3
    with playing(Transport.MULTICAST) as stage, NatNetClient(towards(stage), HostClock()) as client:
        bound = [one.address.host for one in client._wire._sockets]
        assert bound == [LOOPBACK, "239.255.42.99"], "a group's socket hears nothing but the group"


def test_an_interface_that_is_not_ours() -> None:
    settings = NatNetSettings(LOOPBACK, "203.0.113.9", TrackedBody(1), TrackedBody(2))
    with pytest.raises(LabError, match=r"^203\.0\.113\.9:0: cannot listen there: Cannot assign requested address$"):
        NatNetClient(settings, HostClock())


def test_a_client_says_goodbye() -> None:
    with playing() as stage:
        with NatNetClient(towards(stage), HostClock()):
            assert len(stage.server.clients) == 1
        until(lambda: not stage.server.clients)
    assert MODELS.bodies[0].id == HAND
