"""An estimate as a person reads it."""

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.estimate import EstimateDocument, FrictionEstimate
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.values import UncertainPose
from slidepipe.cli.views.tables import (
    NONE,
    angle_mrad,
    columns,
    facts,
    fixed,
    friction,
    friction_interval,
    heading,
    interval,
    length_mm,
    near,
    number,
    planar,
)


def estimate_view(estimate: EstimateDocument, run: Run) -> list[RenderableType]:
    """Relative poses with one standard deviation, the slide, the friction with its interval, and what to be wary of."""
    return [
        heading(f"estimate {run.id}", f"of trial {estimate.trial}"),
        _poses(estimate),
        "",
        facts([*_lost(estimate), *_friction(estimate), *_recording(estimate)]),
        "",
        str(run.directory / "estimate.yaml"),
        *(str(run.directory / output.file) for output in run.manifest.outputs if output.role == "figure"),
    ]


def _poses(estimate: EstimateDocument) -> Table:
    names = ("x mm", "y mm", "theta mrad")
    table = columns("finger on the object (± one standard deviation)", *names, numbers=names)
    table.add_row("before", *_uncertain(estimate.initial_relative_pose))
    table.add_row("after", *_uncertain(estimate.final_relative_pose, beside=estimate.initial_relative_pose))
    return table


def _lost(estimate: EstimateDocument) -> list[tuple[str, str]]:
    return [] if estimate.lost is None else [("lost", estimate.lost)]


def _uncertain(pose: UncertainPose | None, beside: UncertainPose | None = None) -> tuple[str, str, str]:
    if pose is None:
        return NONE, NONE, NONE
    x, y, theta = planar(near(pose.vector, (beside or pose).vector))
    return (
        f"{x} ± {length_mm(pose.x_std_m)}",
        f"{y} ± {length_mm(pose.y_std_m)}",
        f"{theta} ± {angle_mrad(pose.theta_std_rad)}",
    )


def _friction(estimate: EstimateDocument) -> list[tuple[str, str]]:
    found = estimate.friction
    if found is None:
        return [("friction", f"not estimated: {estimate.friction_missing_because}")]
    kappa, mu, taken = found.kappa_m_s2, found.mu, found.assumed
    force, mass = number(taken.normal_force_n, "N"), number(1e3 * taken.mass_kg, "g")
    ends = interval(kappa.interval_95, "m/s²")
    return [
        ("kappa = mu f_N / m", f"{number(kappa.value)} ± {kappa.std:.2g} m/s², 95 % interval {ends}"),
        ("mu", f"{friction(mu.value)}, 95 % interval {friction_interval(mu.interval_95)}"),
        ("assumed for mu", f"f_N {force}, mass {mass}, rho {length_mm(taken.rho_m)} mm"),
        *_torsion(found),
        *_laws(found),
        *_budget(found),
    ]


def _torsion(found: FrictionEstimate) -> list[tuple[str, str]]:
    rho = found.rho_m
    return [] if rho is None else [("rho = c a", f"{1e3 * rho.value:.2f} ± {1e3 * rho.std:.2f} mm")]


def _laws(found: FrictionEstimate) -> list[tuple[str, str]]:
    asked = (
        ("mu_s / mu_k", found.static_share, ""),
        ("growth with speed", found.growth_s_m, "s/m"),
        ("1/k of the pressure", found.inverse_exponent, ""),
    )
    return [
        (name, f"{one.value:.3f} ± {one.std:.2g}, 95 % interval {interval(one.interval_95, unit)}".rstrip())
        for name, one, unit in asked
        if one is not None
    ]


def _budget(found: FrictionEstimate) -> list[tuple[str, str]]:
    if found.mu_budget is None:
        return []
    shares = found.mu_budget
    kappa, force = _per_cent(shares.kappa_relative_std), _per_cent(shares.normal_force_relative_std)
    mass, total = _per_cent(shares.mass_relative_std), _per_cent(shares.mu_relative_std)
    return [("± of mu in all", f"{total}: motion {kappa}, f_N {force} and mass {mass} if known as well as that")]


def _per_cent(share: float) -> str:
    return f"{100.0 * share:.2g} %"


def _joints(estimate: EstimateDocument) -> list[tuple[str, str]]:
    found = estimate.joints
    if found is None:
        return []
    offset = f"{1e3 * found.offset_s:.3f} ± {1e3 * found.offset_std_s:.3f} ms"
    return [("cameras after joints", f"{offset}, gravity turned by {1e3 * found.gravity_angle_rad:.1f} mrad")]


def _recording(estimate: EstimateDocument) -> list[tuple[str, str]]:
    slide, clock = estimate.slide, estimate.clock
    offset, left = f"offset {clock.offset_s:.6f} s", f"residual {number(1e3 * clock.residual_std_s, 'ms')}"
    return [
        ("slide", f"from {fixed(slide.start_s, 3)} s to {fixed(slide.stop_s, 3)} s" if slide else "nothing slid"),
        ("frames used", str(estimate.frames_used)),
        ("cameras' clock", f"{offset}, rate {number(clock.rate_ppm, 'ppm')}, {left}"),
        *_joints(estimate),
        *(("not told", text) for text in estimate.not_told),
        *(("note", text) for text in estimate.notes),
    ]
