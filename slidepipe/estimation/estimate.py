"""One trial from recording to estimate: clock, plane, smoothing, slide, resting grasp, friction."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation import remarks
from slidepipe.estimation.clock import ClockFit, fit_clock
from slidepipe.estimation.friction import FrictionEstimate, FrictionFinding, fit_friction, sliding_window
from slidepipe.estimation.gate import rough_noise
from slidepipe.estimation.hand_clock import JointClock, fit_joint_clock
from slidepipe.estimation.plane import to_plane
from slidepipe.estimation.poses import Tracks, align
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.rest import RestFinding, RestPose, find_rest
from slidepipe.estimation.slide import Slide, SlideFinding, find_slide, sliding_speed
from slidepipe.estimation.slide_ends import RelativePath, refine_ends
from slidepipe.estimation.smoothing import SmoothedSeries, rest_noise, smooth
from slidepipe.estimation.weak_form import SlideWindow
from slidepipe.series import BoolArray

AROUND_SLIDE_S = 0.06
FEWEST_REST_FRAMES = 20
LONGEST_GAP_S = 0.05
MOST_REPEATED = 0.5
OTHER_BODY_M, OTHER_BODY_RAD = 0.03, 0.6


@dataclass(frozen=True, slots=True)
class Estimate:
    """What one trial tells. Times in ``slide`` and ``friction`` are seconds since ``tracks.stamp_ns[0]``.

    Attributes
    ----------
    clock : ClockFit
        Camera ticks to host time.
    joints : JointClock or None
        What is left between the cameras' clock and the joint log's, already taken off the stamps, and the turn of
        gravity in the cameras' plane; None where no joints were given.
    tracks : Tracks
        Measured planar poses on the camera frames, host time.
    hand, object, relative : SmoothedSeries
        Smoothed {f} and {b} in {w}, and r_f_b.
    initial, final : RestPose or None
        r_f_b at rest before and after the motion; None with a reason.
    lost : str or None
        Why there is no final relative pose: the object is gone or still moves.
    initial_reason : str or None
        Why there is no initial relative pose.
    slide : Slide or None
        The main piece of sliding; None if the object did not slide measurably.
    slide_reason : str or None
        Why there is no slide.
    slide_threshold_m_s : float
        Sliding slower than this was not told from noise.
    friction : FrictionEstimate or None
        None if there is no slide or it does not tell.
    friction_reason : str or None
        Why there is no friction.
    not_told : tuple of str
        What the motion cannot tell.
    notes : tuple of str
        What looks odd, and what to keep in mind.
    """

    clock: ClockFit
    joints: JointClock | None
    tracks: Tracks
    hand: SmoothedSeries
    object: SmoothedSeries
    relative: SmoothedSeries
    initial: RestPose | None
    final: RestPose | None
    lost: str | None
    initial_reason: str | None
    slide: Slide | None
    slide_reason: str | None
    slide_threshold_m_s: float
    friction: FrictionEstimate | None
    friction_reason: str | None
    not_told: tuple[str, ...]
    notes: tuple[str, ...]

    def host_ns(self, time_s: float) -> int:
        """Host stamp of a time in seconds since the first frame."""
        return int(self.tracks.stamp_ns[0]) + round(time_s * 1e9)


def estimate(request: EstimationRequest) -> Estimate:
    """Estimate one trial from its recording alone.

    Raises
    ------
    InputError
        A recording that contradicts itself: clocks or frames that go back, numbers that are not finite.
    EstimationError
        A recording too short or too empty for anything; an object that is lost or does not slide is no error.
    """
    clock = fit_clock(request.mocap.clock)
    bodies = (
        to_plane("hand", request.mocap.hand, request.plane),
        to_plane("object", request.mocap.object, request.plane),
    )
    frames = request.mocap.frames
    tracks = align(frames, clock.to_host(frames.ticks), *bodies, request.relative_angle_rad)
    joints = _joints(request, tracks)
    if joints is not None:
        tracks = replace(tracks, stamp_ns=tracks.stamp_ns - round(1e9 * joints.offset_s))
        laws = replace(request.laws, gravity_angle_rad=joints.tilt_rad, gravity_angle_sd_rad=joints.tilt_sd_rad)
        request = replace(request, laws=laws)
    segments = _segments(request, tracks)
    _really_seen(tracks, segments)
    initial = find_rest(tracks, segments.before, "before the motion")
    final = find_rest(tracks, segments.after, "after the motion")
    motion = _motion(request, tracks, segments, final)
    friction = _friction(request, tracks, motion)
    _same_body(request, initial)
    return Estimate(
        clock=clock,
        joints=joints,
        tracks=tracks,
        hand=motion.hand,
        object=motion.object,
        relative=motion.relative,
        initial=initial.rest,
        final=final.rest,
        lost=final.reason,
        initial_reason=initial.reason,
        slide=motion.found.slide,
        slide_reason=motion.found.reason,
        slide_threshold_m_s=motion.found.threshold_m_s,
        friction=friction.friction,
        friction_reason=friction.reason,
        not_told=remarks.not_told(request, friction),
        notes=remarks.notes(request, tracks, bodies, motion.found, friction),
    )


def _joints(request: EstimationRequest, tracks: Tracks) -> JointClock | None:
    """Offset and tilt by the joints; stamps that go back are told."""
    series = request.joint_hand
    if series is None:
        return None
    if len(series.stamp_ns) < FEWEST_REST_FRAMES:
        raise EstimationError(
            f"joints: {len(series.stamp_ns)} states were recorded, at least {FEWEST_REST_FRAMES} are needed"
        )
    back = np.flatnonzero(np.diff(series.stamp_ns) <= 0)
    if len(back):
        raise InputError(f"joints: the clock goes back after state {back[0]}; stamps must increase")
    if not (np.isfinite(series.position_m).all() and np.isfinite(series.quaternion_xyzw).all()):
        raise InputError("joints: the hand's pose by the joints is not finite: a joint angle is not a number")
    pose = request.plane.project(series.position_m, Rotation.from_quat(series.quaternion_xyzw).as_matrix())
    joints_s = (series.stamp_ns - tracks.stamp_ns[0]) * 1e-9
    return fit_joint_clock(tracks.time_s, tracks.hand, rough_noise(tracks.hand), joints_s, pose)


def _really_seen(tracks: Tracks, segments: "_Segments") -> None:
    """Refuse an object that stands still to the last bit while the hand moves: its last pose was sent over and over."""
    seen = np.flatnonzero(segments.moving & tracks.relative.valid)
    still = (np.diff(tracks.object.pose[seen], axis=0) == 0.0).all(axis=1)
    moved = (np.diff(tracks.hand.pose[seen], axis=0) != 0.0).any(axis=1)
    repeated = int(np.count_nonzero(still & moved))
    if repeated > MOST_REPEATED * len(seen):
        raise InputError(
            f"object poses: {repeated} of {len(seen)} frames during the motion repeat the pose before to the last bit, "
            f"at most {100.0 * MOST_REPEATED:g} % are possible: the cameras had lost the object and sent its last pose"
        )


def _same_body(request: EstimationRequest, initial: RestFinding) -> None:
    """Refuse an object that is not where the plan begins: the cameras tracked another body by its name."""
    if request.start_relative_pose is None or initial.rest is None:
        return
    away = initial.rest.pose - request.start_relative_pose
    turn = abs((away[2] + np.pi) % (2.0 * np.pi) - np.pi)
    distance = float(np.hypot(away[0], away[1]))
    if distance > OTHER_BODY_M or turn > OTHER_BODY_RAD:
        raise InputError(
            f"object poses: the finger is {1e3 * distance:.0f} mm and {turn:.2f} rad from where the plan begins, at "
            f"most {1e3 * OTHER_BODY_M:g} mm and {OTHER_BODY_RAD:g} rad are possible: the cameras tracked "
            "another body, or their frame is not the arm's: slidepipe calibrate finds it"
        )


@dataclass(frozen=True, slots=True)
class _Segments:
    before: BoolArray
    moving: BoolArray
    after: BoolArray


@dataclass(frozen=True, slots=True)
class _Motion:
    hand: SmoothedSeries
    object: SmoothedSeries
    relative: SmoothedSeries
    found: SlideFinding


def _segments(request: EstimationRequest, tracks: Tracks) -> _Segments:
    before = tracks.stamp_ns < request.motion_start_ns
    after = tracks.stamp_ns > request.motion_stop_ns
    moving = ~before & ~after
    seen = {
        "at rest before the motion": before & tracks.hand.valid,
        "during the motion": moving & tracks.relative.valid,
        "at rest after the motion": after & tracks.hand.valid,
    }
    for when, mask in seen.items():
        if np.count_nonzero(mask) < FEWEST_REST_FRAMES:
            raise EstimationError(
                f"poses: {np.count_nonzero(mask)} frames with the bodies in them {when}, "
                f"at least {FEWEST_REST_FRAMES} are needed"
            )
    return _Segments(before, moving, after)


def _motion(request: EstimationRequest, tracks: Tracks, segments: _Segments, final: RestFinding) -> _Motion:
    """Smooth everything and find the slide; r_f_b a second time, with the process noise of the slide itself."""
    held = segments.before if final.rest is None else segments.before | segments.after
    time_s, moving = tracks.time_s, segments.moving
    hand = smooth(time_s, tracks.hand, rest_noise(tracks.hand, segments.before | segments.after), moving)
    body = smooth(time_s, tracks.object, rest_noise(tracks.object, held), moving)
    noise = rest_noise(tracks.relative, held)
    relative = smooth(time_s, tracks.relative, noise, moving)
    found = find_slide(time_s, relative, request.rho_m, moving & _in_hand(request, tracks, relative))
    if found.slide is not None:
        near = (time_s > found.slide.start_s - AROUND_SLIDE_S) & (time_s < found.slide.stop_s + AROUND_SLIDE_S)
        relative = smooth(time_s, tracks.relative, noise, near)
        found = find_slide(time_s, relative, request.rho_m, moving & _in_hand(request, tracks, relative))
    if found.slide is not None:
        found = replace(found, slide=_with_ends(found.slide, tracks, relative, request.rho_m))
    return _Motion(hand, body, relative, found)


def _with_ends(slide: Slide, tracks: Tracks, relative: SmoothedSeries, rho_m: float) -> Slide:
    during = (tracks.time_s >= slide.start_s) & (tracks.time_s <= slide.stop_s)
    top = int(np.argmax(np.where(during, sliding_speed(relative, rho_m), 0.0)))
    path = RelativePath(tracks.time_s, tracks.relative, relative.noise)
    return refine_ends(slide, path, float(tracks.time_s[top]))


def _in_hand(request: EstimationRequest, tracks: Tracks, relative: SmoothedSeries) -> BoolArray:
    """Frames with the contact no further out than the block's corners, away from long gaps."""
    on_block = (
        np.hypot(relative.pose[:, 0], relative.pose[:, 1]) < np.hypot(request.block.length, request.block.width) / 2
    )
    seen = tracks.time_s[tracks.relative.valid]
    after = np.minimum(np.searchsorted(seen, tracks.time_s), len(seen) - 1)
    gap = np.diff(seen, prepend=seen[:1])[after]
    return np.asarray(on_block & (gap < LONGEST_GAP_S) & (tracks.time_s <= seen[-1]))


def _friction(request: EstimationRequest, tracks: Tracks, motion: _Motion) -> FrictionFinding:
    slide = motion.found.slide
    if slide is None:
        return FrictionFinding(None, motion.found.reason)
    inside = sliding_window(tracks.time_s, motion.relative, slide, request.rho_m)
    window = SlideWindow(
        time_s=tracks.time_s,
        hand=tracks.hand,
        object=tracks.object,
        hand_smooth=motion.hand,
        object_smooth=motion.object,
        relative_smooth=motion.relative,
        inside=inside,
        usable=_in_hand(request, tracks, motion.relative),
    )
    return fit_friction(request, slide, window)
