"""The emulated cameras' stream: what they saw, over NatNet."""

from slidepipe.lab.camera_frame import CameraFrame, RigidPose
from slidepipe.lab.cameras import TICKS_PER_S
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.models import ModelDef, RigidBodyModel
from slidepipe.lab.natnet.server import NatNetServer, ServerSettings
from slidepipe.lab.natnet.settings import NatNetSettings, TrackedBody
from slidepipe.lab.protocols import BodyPose, MocapFrame
from slidepipe.lab.simulated import SimulatedLab

NOWHERE = (0.0, 0.0, 0.0)
UNTURNED = (0.0, 0.0, 0.0, 1.0)
FIRST_ID = 1


class MotiveOutlet:
    """A NatNet server that tells what a simulated lab's cameras saw, to be used in a ``with`` statement.

    Parameters
    ----------
    settings : NatNetSettings
        Those of the client that shall be served: the same names, numbers, ports and frames.
    lab : SimulatedLab
        Whose clock the server has.
    """

    def __init__(self, settings: NatNetSettings, lab: SimulatedLab) -> None:
        self._settings, self._lab = settings, lab
        self._ids = _numbers(settings.hand, settings.object)
        models = ModelDef(tuple(_model(body, self._ids[body.model]) for body in (settings.hand, settings.object)))
        served = ServerSettings(
            settings.server,
            clock_hz=round(TICKS_PER_S),
            transport=settings.transport,
            command_port=settings.command_port,
            data_port=settings.data_port,
            group=settings.group,
        )
        self._server = NatNetServer(served, models)

    def __enter__(self) -> "MotiveOutlet":
        self._server.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._server.close()

    def fileno(self) -> int:
        """For select: readable where somebody asks something."""
        return self._server.fileno()

    @property
    def clients(self) -> int:
        """How many clients get frames."""
        return len(self._server.clients)

    def poll(self, world_ns: int) -> None:
        """Answer what was asked."""
        self._server.poll(self._lab.camera_ticks(world_ns))

    def publish(self, frame: MocapFrame) -> None:
        """Send a frame."""
        hand, thing = self._settings.hand, self._settings.object
        bodies = (self._body(hand, frame.hand), self._body(thing, frame.object))
        self._server.publish(
            m.Frame(
                frame.frame,
                bodies=bodies,
                timestamp_s=frame.ticks / TICKS_PER_S,
                exposure_ticks=frame.ticks,
                received_ticks=frame.ticks,
                sent_ticks=self._lab.camera_ticks(frame.received_ns),
            )
        )

    def _body(self, tracked: TrackedBody, pose: BodyPose | None) -> m.RigidBody:
        number = self._ids[tracked.model]
        if pose is None:
            return m.RigidBody(number, NOWHERE, UNTURNED, params=0)
        x, y, z = (float(value) for value in pose.position_m)
        qx, qy, qz, qw = (float(value) for value in pose.quaternion_xyzw)
        ours = RigidPose((x, y, z), (qx, qy, qz, qw)).then(tracked.offset.inverse())
        seen = self._frame.from_base(ours)
        return m.RigidBody(number, seen.position_m, seen.quaternion_xyzw, mean_error_m=2e-4)

    @property
    def _frame(self) -> CameraFrame:
        return self._settings.frame


def _numbers(*bodies: TrackedBody) -> dict[str | int, int]:
    """Numbers of the bodies: those that the lab file gives, else free ones."""
    taken = {body.model for body in bodies if isinstance(body.model, int)}
    free = (number for number in range(FIRST_ID, FIRST_ID + 10) if number not in taken)
    return {body.model: body.model if isinstance(body.model, int) else next(free) for body in bodies}


def _model(body: TrackedBody, number: int) -> RigidBodyModel:
    return RigidBodyModel(body.model if isinstance(body.model, str) else f"body {number}", number)
