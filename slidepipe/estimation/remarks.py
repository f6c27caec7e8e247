"""What an estimate says in words: what the motion left open, and what looks odd."""

import numpy as np

from slidepipe.estimation.friction import FrictionEstimate, FrictionFinding
from slidepipe.estimation.plane import PlanarBody
from slidepipe.estimation.poses import Tracks
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.slide import SlideFinding

OFF_PLANE_M = 0.002
OFF_PLANE_RAD = 0.05


def not_told(request: EstimationRequest, friction: FrictionFinding) -> tuple[str, ...]:
    """Say what this motion leaves open, whatever was assumed in its place."""
    found = friction.friction
    if found is None:
        return ("friction",)
    force, mass = f"{request.normal_force_n:g} N", f"{request.block.m:g} kg"
    said = [
        f"mu apart from f_N / m: mu is with the assumed normal force {force} and mass {mass}, and as wrong as these are"
    ]
    if found.growth is None:
        change = 10.0 * found.per_growth
        said.append(f"whether friction grows with speed: for 0.1 s/m of growth kappa would change by {change:+.1f} %")
    said.extend(_left_open(found))
    said.append(
        "the torsion constant and the contact radius: only their product is told"
        if found.rho_told
        else f"the slide hardly turned: it tells nothing of the torsion, rho is the assumed {request.rho_m:g} m"
    )
    return tuple(said)


def _left_open(found: FrictionEstimate) -> list[str]:
    """Say of what was asked for that it could not be told."""
    asked = (
        (found.growth, "the growth of friction with speed", "{:+.2f} ± {:.2f} s/m"),
        (found.static_share, "mu_s / mu_k", "{:.2f} ± {:.2f}"),
        (found.inverse_exponent, "the pressure exponent", "1/k = {:.2f} ± {:.2f}, of 0 to 1"),
    )
    return [
        f"{name} could not be told: {form.format(one.value, one.sd)}"
        for one, name, form in asked
        if one is not None and not one.told
    ]


def notes(
    request: EstimationRequest,
    tracks: Tracks,
    bodies: tuple[PlanarBody, PlanarBody],
    found: SlideFinding,
    friction: FrictionFinding,
) -> tuple[str, ...]:
    """Say what looks odd, and what to keep in mind."""
    said = []
    if friction.friction is not None and not friction.friction.sticks_alike:
        said.append("the block sticks otherwise than its sliding friction says: only the slide itself was used")
    if found.slide is not None:
        start, stop = (int(tracks.stamp_ns[0]) + s * 1e9 for s in (found.slide.start_s, found.slide.stop_s))
        if stop < request.slide_start_ns or start > request.slide_stop_ns:
            said.append("the main slide lies wholly outside the planned sliding phase")
        if found.slide.pieces > 1:
            said.append(f"the object slid in {found.slide.pieces} pieces: the longest is reported")
    if tracks.spikes:
        said.append(f"{tracks.spikes} poses far from their neighbours were left out")
    for name, body in zip(("hand", "object"), bodies, strict=True):
        distance, tilt = float(np.median(np.abs(body.distance_m))), float(np.median(body.tilt_rad))
        if distance > OFF_PLANE_M or tilt > OFF_PLANE_RAD:
            said.append(f"the {name} was {distance * 1e3:.1f} mm and {tilt * 1e3:.0f} mrad off the motion plane")
    return tuple(said)
