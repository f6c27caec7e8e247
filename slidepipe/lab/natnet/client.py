"""The lab's cameras over NatNet: implements ``MotionCapture`` without ever making the loop wait."""

import math
from collections import deque
from dataclasses import dataclass
from types import TracebackType

from slidepipe.errors import LabError
from slidepipe.lab.camera_clock import CameraClock
from slidepipe.lab.host_clock import TellsTime
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.bodies import WatchedBody
from slidepipe.lab.natnet.connection import Connection
from slidepipe.lab.natnet.echoes import Echoes
from slidepipe.lab.natnet.models import ModelDef
from slidepipe.lab.natnet.sequence import FrameSequence, StreamCounts, Verdict
from slidepipe.lab.natnet.settings import NatNetSettings, Transport
from slidepipe.lab.natnet.version import NEWEST, OLDEST, NatNetVersion
from slidepipe.lab.protocols import ClockExchange, MocapFrame

KEEP_ALIVE_NS = 1_000_000_000
"""How often the server hears that we are there, and is asked again for models that changed."""
FIRST_EXCHANGES = 10
CLOCK_SINCE = NatNetVersion(3, 0)
"""Before, frames had a time in seconds, here told in microseconds, and there was no echo."""
OLD_TICKS_PER_S = 1e6


@dataclass(frozen=True, slots=True)
class ClientCounts:
    """What came over the wire so far.

    Attributes
    ----------
    frames : StreamCounts
    malformed : int
        Datagrams of the server that are no packets.
    foreign : int
        Datagrams from elsewhere, all ignored.
    hand_missing, object_missing : int
        Frames without the body.
    model_changes : int
        How often the server's list of models changed.
    echoes_lost : int
        Echoes without an answer.
    """

    frames: StreamCounts
    malformed: int
    foreign: int
    hand_missing: int
    object_missing: int
    model_changes: int
    echoes_lost: int


class NatNetClient:
    """Cameras that speak NatNet, to be used in a ``with`` statement, which connects and says goodbye.

    Parameters
    ----------
    settings : NatNetSettings
    clock : TellsTime
        The host's clock, the same that the rest of the lab uses.

    Raises
    ------
    LabError
        The address is not this machine's, or the port is taken. On entering: nobody answers in time, the server's
        version is not spoken, or it does not know a body.
    """

    def __init__(self, settings: NatNetSettings, clock: TellsTime) -> None:
        self._settings, self._clock = settings, clock
        self._wire = Connection(settings, clock)
        self._info: m.ServerInfo | None = None
        self._models: ModelDef | None = None
        self._hand, self._object = (
            WatchedBody(role, asked, settings.frame)
            for role, asked in (("hand", settings.hand), ("object", settings.object))
        )
        self._sequence, self._echoes = FrameSequence(), Echoes()
        self._arrived: list[_Arrived] = []
        self._notices: deque[str] = deque(maxlen=100)
        self._changes = self._touched_ns = 0
        self._models_stale, self._changed, self._heard = False, False, True

    def __enter__(self) -> "NatNetClient":
        try:
            self._connect()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def info(self) -> m.ServerInfo:
        """What the server said of itself."""
        if self._info is None:
            raise LabError(f"{self._wire.name}: is not connected")
        return self._info

    @property
    def version(self) -> NatNetVersion:
        """Version of the stream."""
        return self._wire.version

    @property
    def models(self) -> ModelDef:
        """The server's models as it told them last."""
        if self._models is None:
            raise LabError(f"{self._wire.name}: is not connected")
        return self._models

    @property
    def ticks_per_s(self) -> float:
        """Rate of the cameras' clock."""
        stream = self.info.stream
        return OLD_TICKS_PER_S if stream is None else float(stream.clock_hz)

    @property
    def counts(self) -> ClientCounts:
        """What came over the wire so far."""
        return ClientCounts(
            frames=self._sequence.counts,
            malformed=self._wire.malformed,
            foreign=self._wire.foreign,
            hand_missing=self._hand.missing,
            object_missing=self._object.missing,
            model_changes=self._changes,
            echoes_lost=self._echoes.lost,
        )

    @property
    def camera_clock(self) -> CameraClock:
        """The server's clock on the host's, from the echoes of connecting and since."""
        return self._echoes.clock

    def take(self) -> list[MocapFrame]:
        """Frames that have arrived since the last call, oldest first; returns at once."""
        self._pump()
        self._keep_in_touch()
        arrived, self._arrived = sorted(self._arrived, key=_Arrived.order), []
        return [told for one in arrived if (told := self._judged(one)) is not None]

    def echo(self) -> ClockExchange | None:
        """Ask for the cameras' clock; returns at once, with the oldest answer that was not told yet, or None."""
        if self.version >= CLOCK_SINCE:
            sent_ns = self._clock.now_ns()
            self._wire.send(m.EchoRequest(sent_ns))
            self._echoes.sent(sent_ns)
        return self._echoes.next()

    def take_notices(self) -> list[str]:
        """What a person may want to know of the stream, since the last call."""
        notices = list(self._notices)
        self._notices.clear()
        return notices

    def close(self) -> None:
        """Say goodbye and close the sockets; a closed client stays closed."""
        if self._info is not None:
            self._wire.send(m.Disconnect())
            self._info = None
        self._wire.close()

    def _connect(self) -> None:
        self._wire.ask_until(self._knows_server, _GREETING, "no answer")
        self._agree_on_version()
        self._wire.ask_until(self._knows_models, m.ModelDefRequest(), "does not tell its models")
        for body in (self._hand, self._object):
            if body.id is None:
                there = ", ".join(f"{one.name} ({one.id})" for one in self.models.bodies) or "none"
                raise LabError(
                    f"{self._wire.name}: has no rigid body {body.asked.model} for the {body.role}, there are: {there}"
                )
        self._synchronise()

    def _knows_server(self) -> bool:
        self._pump()
        return self._info is not None

    def _knows_models(self) -> bool:
        self._pump()
        return self._models is not None

    def _agree_on_version(self) -> None:
        major, minor = self.info.natnet_version[:2]
        version = NatNetVersion(major, minor)
        if version > NEWEST and self._settings.transport is Transport.UNICAST:
            self._wire.send(m.Request(f"Bitstream,{NEWEST}"))
            version = NEWEST
        if not OLDEST <= version <= NEWEST:
            raise LabError(f"{self._wire.name}: speaks NatNet {version}, from {OLDEST} to {NEWEST} is understood")
        if version >= CLOCK_SINCE and (self.info.stream is None or not self.info.stream.clock_hz):
            raise LabError(f"{self._wire.name}: does not tell the rate of its clock")
        self._wire.version = version

    def _synchronise(self) -> None:
        """Exchange a few echoes, so that the first frame already has a time."""
        self._echoes = Echoes(self.ticks_per_s)
        if self.version < CLOCK_SINCE:
            return
        told = 0

        def enough() -> bool:
            nonlocal told
            self._pump()
            told += self.echo() is not None
            return told >= FIRST_EXCHANGES

        self._wire.ask_until(enough, m.KeepAlive(), "does not answer echoes")

    def _pump(self) -> None:
        for received in self._wire.receive():
            match received.message:
                case m.Frame() as frame:
                    self._heard = True
                    if self._models is not None:
                        self._arrived.append(_Arrived(frame, received.stamp_ns))
                case m.EchoResponse() as response:
                    self._echoes.answered(response, received.stamp_ns)
                case ModelDef() as models:
                    self._learn(models)
                case m.ServerInfo() as info if self._info is None:
                    self._info = info

    def _learn(self, models: ModelDef) -> None:
        known, self._models, self._models_stale = self._models, models, False
        for body in (self._hand, self._object):
            body.find(models)
        if known is None or known == models:
            return
        self._notices.append("the cameras' list of models has changed")
        for body in (self._hand, self._object):
            if body.id is None:
                self._notices.append(f"the {body.role} is no longer among the cameras' models")

    def _judged(self, arrived: "_Arrived") -> MocapFrame | None:
        frame = arrived.frame
        ticks = self._ticks(frame)
        verdict = self._sequence.judge(frame.number, ticks)
        if verdict is Verdict.RESTARTED:
            self._notices.append(f"the cameras began to count their frames anew, at {frame.number}")
        if verdict not in (Verdict.NEW, Verdict.RESTARTED):
            return None
        changed = bool(frame.params & m.FrameFlags.MODELS_CHANGED)
        if changed and not self._changed:  # some servers say so in more than one frame
            self._changes += 1
            self._models_stale = True
            self._wire.send(m.ModelDefRequest())
        self._changed = changed
        hand, thing = self._hand.pose(frame.bodies), self._object.pose(frame.bodies)
        return MocapFrame(frame.number, ticks, arrived.stamp_ns, hand, thing)

    def _ticks(self, frame: m.Frame) -> int:
        if self.version >= CLOCK_SINCE:
            return frame.exposure_ticks
        return round(OLD_TICKS_PER_S * frame.timestamp_s) if math.isfinite(frame.timestamp_s) else 0

    def _keep_in_touch(self) -> None:
        now_ns = self._clock.now_ns()
        if now_ns - self._touched_ns < KEEP_ALIVE_NS:
            return
        self._touched_ns = now_ns
        # A server that was started anew does not know us any more.
        self._wire.send(m.KeepAlive() if self._heard else _GREETING)
        self._heard = False
        if self._models_stale:
            self._wire.send(m.ModelDefRequest())


_WANTED = (NEWEST.major, NEWEST.minor, 0, 0)
_GREETING = m.Connect("Ping", (1, 0, 0, 0), _WANTED, wanted_version=_WANTED)


@dataclass(frozen=True, slots=True)
class _Arrived:
    frame: m.Frame
    stamp_ns: int

    def order(self) -> int:
        return self.frame.number
