"""Synthetic trials: the paper's two motions, a hand that does not follow them exactly, and cameras.

The object is integrated with scipy's DOP853 and events for stick and slip, so nothing here shares code with the
estimators but the mechanics' closed forms.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.integrate import cumulative_simpson, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from slidepipe.estimation.request import EstimationRequest
from slidepipe.mechanics.dynamics import Block, sliding_acceleration
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane, finger_pose
from slidepipe.series import ClockSync, FrameSeries, MocapSeries, PoseSeries

BLOCK = Block(length=0.1, width=0.06, m=0.023)
PLANE = MotionPlane(np.array([0.5, 0.1, 0.3]), 1.1)
REST = 0.4
GRAVITY = 9.81
GRAVITY_VECTOR = np.array([0.0, -GRAVITY])


@dataclass(frozen=True)
class Case:
    """One example of the paper with the friction that the planner believes."""

    name: str
    f_N: float
    a: float
    r_start: tuple
    r_goal: tuple
    times: tuple

    def finger(self, mu=0.38):
        return SoftFinger(mu=mu, f_N=self.f_N, a=self.a, c=0.6)


CASE_A = Case("A", 1.25, 0.0174, (-0.01, -0.02, np.pi), (0.01, 0.02, np.pi), (0.3, 0.2, 1.1))
CASE_B = Case("B", 2.5, 0.05, (-0.01, 0.04, 0.75 * np.pi), (0.01, 0.04, np.pi), (0.3, 0.2, 0.3))
CORRECTION = Case("C", 1.25, 0.0174, (0.0079, 0.0158, np.pi), (0.01, 0.02, np.pi), (0.3, 0.1, 1.1))


@dataclass(frozen=True)
class Cameras:
    """What the cameras get wrong."""

    seed: int = 0
    position_noise_m: float = 0.0003
    angle_noise_rad: float = 0.003
    dropout_share: float = 0.02
    rate_hz: float = 360.0
    clock_offset_s: float = 12.3
    clock_drift_ppm: float = 20.0
    latency_jitter_s: float = 0.0004
    gap_s: tuple = ()
    outlier_share: float = 0.0
    joints_late_s: float = 0.0
    tilt_rad: float = 0.0


@dataclass(frozen=True)
class World:
    """The true motion on a 0.25 ms grid; ``stuck_until`` and ``stuck_from`` bound the main slide."""

    time: np.ndarray
    hand: np.ndarray
    object: np.ndarray
    slide: tuple
    kappa: float
    case: Case


def planned_hand(case):
    """The hand's motion on a 0.1 ms grid that would regrasp as planned: (time, pose)."""
    T1, T23, T4 = case.times
    r0, r1 = np.array(case.r_start), np.array(case.r_goal)
    s = np.arange(0.0, T23 + 5e-5, 1e-4)
    half = T23 / 2
    phase = np.where(s < half, 2 * s**2 / T23**2, 1 - 2 * (T23 - s) ** 2 / T23**2)
    r = r0 + phase[:, None] * (r1 - r0)
    acc = sliding_acceleration(BLOCK, case.finger(), np.zeros(len(s)), r, np.tile(r1 - r0, (len(s), 1)))
    alpha = acc[:, 2]
    spin, turn = _integrals(s, alpha)
    w0 = -(turn[-1] + spin[-1] * T4 / 2) / (T1 / 2 + T23 + T4 / 2)
    theta = w0 * T1 / 2 + w0 * s + turn
    acc = sliding_acceleration(BLOCK, case.finger(), theta, r, np.tile(r1 - r0, (len(s), 1)))
    dv, dx = (np.stack(parts, 1) for parts in zip(*[_integrals(s, a) for a in acc.T], strict=True))
    v0 = -(dx[-1] + dv[-1] * T4 / 2) / (T1 / 2 + T23 + T4 / 2)
    assert np.isclose(v0[2], w0)
    before = np.arange(-REST, T1, 1e-4)
    after = np.arange(T23 + 1e-4, T23 + T4 + REST, 1e-4)
    q1 = np.where((before > 0)[:, None], v0 * (before**2)[:, None] / (2 * T1), 0.0)
    q2 = v0 * T1 / 2 + v0 * s[:, None] + dx
    end_v = v0 + dv[-1]
    rest = np.clip(after - T23, 0.0, T4)[:, None]
    q3 = q2[-1] + end_v * rest - end_v * rest**2 / (2 * T4)
    q_o = np.concatenate([q1, q2, q3])
    r_all = np.concatenate([np.tile(r0, (len(q1), 1)), r, np.tile(r1, (len(q3), 1))])
    time = np.concatenate([before, T1 + s, T1 + after])
    return time, finger_pose(q_o, r_all)


def _integrals(s, f):
    first = cumulative_simpson(f, x=s, initial=0.0)
    return first, cumulative_simpson(first, x=s, initial=0.0)


def real_hand(case, seed, *, error_m=0.001, blur_s=0.004, swing_rad=0.0):
    """The hand as an arm would move it: blurred in time, and off by smooth errors while it moves.

    It may swing about the contact besides while the block slides: then the slide turns now more and now less.
    """
    rng = np.random.default_rng([seed, 77])
    time, pose = planned_hand(case)
    blurred = gaussian_filter1d(pose, blur_s / 1e-4, axis=0, mode="nearest") if blur_s else pose
    total = sum(case.times)
    window = np.where((time > 0) & (time < total), np.sin(np.pi * np.clip(time / total, 0, 1)) ** 2, 0.0)
    error = np.zeros_like(pose)
    for axis, scale in enumerate((error_m, error_m, 5 * error_m)):
        for frequency in (1.5, 3.0, 6.0):
            size = scale * rng.normal() / np.sqrt(3) * 1.5 / frequency
            error[:, axis] += size * np.sin(2 * np.pi * frequency * time + rng.uniform(0, 2 * np.pi))
    every = slice(None, None, 10)
    error *= window[:, None]
    error[:, 2] += _swing(case, time, swing_rad)
    return CubicSpline(time[every], (blurred + error)[every], bc_type="clamped")


def _swing(case, time, size):
    share = np.clip((time - case.times[0]) / case.times[1], 0, 1)
    return size * np.sin(4 * np.pi * share) * np.sin(np.pi * share) ** 2


@lru_cache
def patch_friction(exponent):
    """Friction over its largest, and moment over the largest, of a round patch by the angle of its motion.

    The motion slides with the cosine and turns, times the largest moment over the largest force, with the sine. Every
    point of the patch pulls against its own motion, and all are simply added up.
    """
    share = (np.arange(600) + 0.5) / 600
    r, turn = share[:, None], 2 * np.pi * share
    weight = r * (1 - r**exponent) ** (1 / exponent) if np.isfinite(exponent) else r
    weight = weight / (weight.sum() * len(turn))
    rho = float(np.sum(weight * r) * len(turn))
    angles = np.linspace(0, np.pi / 2, 181)
    force, moment = np.empty((2, len(angles)))
    for at, angle in enumerate(angles):
        spin = np.sin(angle) / rho
        along, across = np.cos(angle) - spin * r * np.sin(turn), spin * r * np.cos(turn)
        speed = np.hypot(along, across) + 1e-15
        force[at] = np.sum(weight * along / speed)
        moment[at] = np.sum(weight * r * (across * np.cos(turn) - along * np.sin(turn)) / speed) / rho
    return CubicSpline(angles, np.stack([force, moment], axis=1))


def simulate(case, mu, seed, *, growth=0.0, static=1.0, exponent=None, **hand_options):
    """Integrate the object under the true friction, event by event.

    Friction grows with speed by ``growth`` (s/m), and a block that sticks holds ``static`` times as much. The limit
    surface is the ellipsoid, or that of a round patch with the pressure's ``exponent``.
    """
    hand = real_hand(case, seed, **hand_options)
    finger = case.finger(mu)
    kappa, rho = mu * case.f_N / BLOCK.m, 0.6 * case.a
    time = np.arange(hand.x[0], hand.x[-1] - 1e-9, 2.5e-4)
    contact = _Contact(hand, kappa, rho, growth, static)
    contact.patch = None if exponent is None else patch_friction(exponent)
    q_o = np.empty((len(time), 3))
    t, r, slides = time[0], np.array(case.r_start), []
    done = 0
    while done < len(time):
        slip = contact.first_slip(time[time >= t - 1e-12], r)
        stop = len(time) if slip is None else int(np.searchsorted(time, slip))
        q_o[done:stop] = contact.stuck_object(time[done:stop], r)
        done = stop
        if slip is None:
            break
        solution = contact.slide(slip, r, time[-1])
        t = solution.t[-1]
        stop = int(np.searchsorted(time, t))
        q_o[done:stop] = solution.sol(time[done:stop])[:3].T
        done = stop
        new = contact.relative(t, solution.y[:, -1])
        slides.append((slip, t, np.linalg.norm((new - r) * [1, 1, rho])))
        r = new
    main = max(slides, key=lambda s: s[2]) if slides else None
    assert finger.mu == mu
    return World(time, hand(time), q_o, main, kappa, case)


class _Contact:
    """Stick and slip of the block under a hand that is given as a spline."""

    def __init__(self, hand, kappa, rho, growth, static):
        self.patch = None
        self.hand, self.kappa, self.rho, self.growth, self.static = hand, kappa, rho, growth, static
        self.per_inertia = BLOCK.m / BLOCK.inertia

    def stuck_object(self, time, r):
        q_f = self.hand(time)
        theta = q_f[:, 2] - r[2]
        c, s = np.cos(theta), np.sin(theta)
        offset = np.stack([c * r[0] - s * r[1], s * r[0] + c * r[1]], 1)
        return np.concatenate([q_f[:, :2] - offset, theta[:, None]], 1)

    def need(self, time, r):
        """Friction (per m kappa, moment also per rho) that sticking takes."""
        q_o, acc, w = self.stuck_object(time, r), self.hand(time, 2), self.hand(time, 1)[:, 2]
        d = self.hand(time)[:, :2] - q_o[:, :2]
        alpha = acc[:, 2]
        a_o = acc[:, :2] - alpha[:, None] * np.stack([-d[:, 1], d[:, 0]], 1) + (w**2)[:, None] * d
        f = (a_o - GRAVITY_VECTOR) / self.kappa
        moment = alpha / (self.per_inertia * self.kappa) - (d[:, 0] * f[:, 1] - d[:, 1] * f[:, 0])
        return np.concatenate([f, moment[:, None] / self.rho], 1)

    def first_slip(self, time, r):
        over = np.flatnonzero(np.linalg.norm(self.need(time, r), axis=1) > self.static)
        if not len(over):
            return None
        last = time[over[0]]
        fine = np.linspace(last - 2.5e-4, last, 200)
        return fine[np.argmax(np.linalg.norm(self.need(fine, r), axis=1) > self.static)]

    def slide(self, start, r, end):
        at = np.array([start])
        q_o = self.stuck_object(at, r)[0]
        u = self.need(at, r)[0] / np.linalg.norm(self.need(at, r)[0])
        dq_f = self.hand(start, 1)
        d = self.hand(start)[:2] - q_o[:2]
        tiny = 2e-4 * u * [1, 1, 1 / self.rho]
        w = dq_f[2] - tiny[2]
        v = dq_f[:2] - w * np.array([-d[1], d[0]]) - tiny[:2]

        def stops(t, y):
            return np.linalg.norm(self.slip(t, y)) - 1e-4

        stops.terminal, stops.direction = True, -1
        y0 = np.concatenate([q_o, v, [w]])
        return solve_ivp(
            self.rate, (start, end), y0, "DOP853", events=stops, rtol=1e-8, atol=1e-9, max_step=2e-3, dense_output=True
        )

    def slip(self, t, y):
        """Sliding velocity in {w}, the spin times rho."""
        d, dq_f = self.hand(t)[:2] - y[:2], self.hand(t, 1)
        v = dq_f[:2] - y[3:5] - y[5] * np.array([-d[1], d[0]])
        return np.array([v[0], v[1], self.rho * (dq_f[2] - y[5])])

    def rate(self, t, y):
        s = self.slip(t, y)
        u = s / np.linalg.norm(s)
        if self.patch is not None:
            sliding = np.hypot(u[0], u[1])
            force, moment = self.patch(np.arctan2(abs(u[2]), sliding))
            u = np.array([*(force * u[:2] / max(sliding, 1e-12)), np.copysign(moment, u[2])])
        d = self.hand(t)[:2] - y[:2]
        kappa = self.kappa * (1.0 + self.growth * np.linalg.norm(s))
        turn = kappa * self.per_inertia * (self.rho * u[2] + d[0] * u[1] - d[1] * u[0])
        return np.array([y[3], y[4], y[5], kappa * u[0], kappa * u[1] - GRAVITY, turn])

    def relative(self, t, y):
        q_f = self.hand(t)
        d, c, s = q_f[:2] - y[:2], np.cos(y[2]), np.sin(y[2])
        return np.array([c * d[0] + s * d[1], -s * d[0] + c * d[1], q_f[2] - y[2]])


def record(world, cameras):
    """What the cameras write of a true motion."""
    rng = np.random.default_rng([cameras.seed, 5])
    host_zero = 0.7
    time = np.arange(world.time[0] + 1e-3, world.time[-1] - 1e-3, 1 / cameras.rate_hz)
    ticks = _ticks(time - world.time[0] + host_zero, cameras)
    seen = []
    for body in (world.hand, world.object):
        pose = CubicSpline(world.time, body)(time)
        valid = rng.uniform(size=len(time)) > cameras.dropout_share
        if cameras.gap_s:
            valid &= ~((time > cameras.gap_s[0]) & (time < cameras.gap_s[1]))
        if cameras.tilt_rad:
            pose = _tilted(pose, cameras.tilt_rad)
        position, quaternion = _poses(pose, rng, cameras)
        _spoil(position, quaternion, cameras)
        seen.append((valid, (position, quaternion)))
    host = np.round(1e9 * (time - world.time[0] + host_zero)).astype(np.int64)
    received = host + 6_000_000 + np.round(1e9 * rng.exponential(cameras.latency_jitter_s, len(time))).astype(np.int64)
    frame = np.arange(100, 100 + len(time))
    bodies = [
        PoseSeries(received[valid], position[valid], quaternion[valid], frame[valid])
        for valid, (position, quaternion) in seen
    ]
    frames = FrameSeries(frame, ticks, received, seen[0][0], seen[1][0])
    return MocapSeries(frames, bodies[0], bodies[1], _echoes(host[-1] / 1e9, rng, cameras))


def _tilted(pose, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * pose[:, 0] - s * pose[:, 1], s * pose[:, 0] + c * pose[:, 1], pose[:, 2] + angle], axis=1)


def _spoil(position, quaternion, cameras):
    """Gross outliers: a pose anywhere within 1 to 100 mm and up to half a turn of the true one."""
    rng = np.random.default_rng([cameras.seed, len(position), round(1e9 * abs(position[0, 0]))])
    wrong = np.flatnonzero(rng.uniform(size=len(position)) < cameras.outlier_share)
    size = 10.0 ** rng.uniform(-3.0, -1.0, (len(wrong), 1))
    position[wrong] += size * rng.normal(size=(len(wrong), 3))
    turn = Rotation.from_rotvec(15.0 * size * rng.normal(size=(len(wrong), 3)))
    if len(wrong):
        quaternion[wrong] = (turn * Rotation.from_quat(quaternion[wrong])).as_quat()


def joint_hand(world, late_s):
    """The hand by the joint log at 500 Hz, whose clock is behind by ``late_s``; encoders have hardly any noise."""
    time = np.arange(world.time[0] + 1e-3, world.time[-1] - 1e-3, 0.002)
    position, matrix = PLANE.lift(CubicSpline(world.time, world.hand)(time))
    stamps = np.round(1e9 * (time - world.time[0] + 0.7 - late_s)).astype(np.int64)
    return PoseSeries(stamps, position, Rotation.from_matrix(matrix).as_quat(), np.arange(len(time)))


def _ticks(host_s, cameras):
    own = (host_s + cameras.clock_offset_s) * (1 + cameras.clock_drift_ppm * 1e-6)
    return np.round(own * 1e7).astype(np.int64)


def _poses(pose, rng, cameras):
    position, matrix = PLANE.lift(pose)
    position = position + rng.normal(size=position.shape) * cameras.position_noise_m
    turn = Rotation.from_rotvec(rng.normal(size=position.shape) * cameras.angle_noise_rad)
    quaternion = (turn * Rotation.from_matrix(matrix)).as_quat()
    return position, quaternion * rng.choice([-1.0, 1.0], size=(len(pose), 1))


def _echoes(end_s, rng, cameras):
    sent = np.concatenate([np.linspace(0.0, 0.6, 40), np.arange(0.8, end_s, 0.25), np.linspace(end_s, end_s + 0.6, 40)])
    out = 1e-4 + rng.exponential(cameras.latency_jitter_s, len(sent))
    back = 1e-4 + rng.exponential(cameras.latency_jitter_s, len(sent))
    to_ns = 1e9
    return ClockSync(
        np.round(sent * to_ns).astype(np.int64),
        _ticks(sent + out, cameras),
        np.round((sent + out + back) * to_ns).astype(np.int64),
        1e7,
    )


def request(world, cameras, **changes):
    """The request that the stage would make for a recorded world."""
    case = world.case
    T1, T23, T4 = case.times
    zero = 0.7 + REST

    def stamp(seconds):
        return round(1e9 * (zero + seconds - cameras.joints_late_s))

    values = {
        "mocap": record(world, cameras),
        "joint_hand": joint_hand(world, cameras.joints_late_s),
        "start_relative_pose": np.array(case.r_start),
        "plane": PLANE,
        "block": BLOCK,
        "normal_force_n": case.f_N,
        "rho_m": 0.6 * case.a,
        "believed_kappa": 0.38 * case.f_N / BLOCK.m,
        "relative_angle_rad": case.r_start[2],
        "slide_start_ns": stamp(T1),
        "slide_stop_ns": stamp(T1 + T23),
        "motion_start_ns": stamp(-0.01),
        "motion_stop_ns": stamp(T1 + T23 + T4 + 0.01),
    }
    return EstimationRequest(**(values | changes))
