"""``slidepipe import``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from collections.abc import Callable
from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain

POSE = "POSE"
WHAT_IT_TELLS = (
    "imported: there are no joints, so how well the arm followed is not known; time is the cameras' own; an estimate "
    "tells the grips, the slide and the friction all the same"
)


def pose_option(name: str, text: str) -> Callable[[options.Callback], options.Callback]:
    """Make an option that takes a pose."""
    option: Callable[[options.Callback], options.Callback] = click.option(
        name, type=(float,) * 7, metavar=POSE, help=text
    )
    return option


@options.verb(
    "import",
    "Import poses that another tool recorded as a trial: Motive's CSV export, or a ROS 2 bag of stamped poses.\n\n"
    "The trial belongs to a plan: a run that --plan names, or one that is made from --experiment. An estimate takes "
    "from it where to look. Poses must be in the arm's base frame, or be brought there by --up and --cameras-in-base. "
    "A POSE is seven numbers: x y z in m, and a unit quaternion x y z w.",
    example="slidepipe import take.csv --plan @latest --hand hand --object block",
    exits={
        ExitCode.OK: "imported, and the object was held to the end",
        ExitCode.NO: "the object was lost, or the experiment has no plan",
    },
)
@click.argument("source", metavar="FILE", type=click.Path(path_type=Path))
@click.option("--plan", metavar="RUN", help="The plan that the trial followed.")
@click.option("--experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path), help="Plan this experiment.")
@click.option("--hand", required=True, metavar="NAME", help="Rigid body of the export, or topic of the bag.")
@click.option("--object", "thing", required=True, metavar="NAME", help="The same for the object.")
@click.option("--up", type=click.Choice(["y", "z"]), help="Axis that points up.  [default: y for CSV, z for a bag]")
@pose_option("--cameras-in-base", "Pose of the cameras' frame in the arm's base frame, its z up.")
@pose_option("--hand-offset", "Pose of the finger frame in the hand's body, its z up.")
@pose_option("--object-offset", "Pose of the object frame in the object's body.")
@click.option(
    "--motion",
    type=(float, float),
    metavar="FROM TO",
    help="When it moved, s.  [default: found by the hand]",
)
@options.as_json
@click.pass_context
def command(
    ctx: click.Context,
    *,
    source: Path,
    plan: str | None,
    experiment: Path | None,
    hand: str,
    thing: str,
    up: str | None,
    cameras_in_base: tuple[float, ...] | None,
    hand_offset: tuple[float, ...] | None,
    object_offset: tuple[float, ...] | None,
    motion: tuple[float, float] | None,
    as_json: bool,
) -> None:
    """Import, and show the trial."""
    from slidepipe.cli.views.trial import trial_view
    from slidepipe.stages.import_trial import ImportRequest, camera_frame, pose, run
    from slidepipe.stages.motion_times import MotionTimes

    session: Session = ctx.obj
    result = run(
        ImportRequest(
            source=source,
            plan=_plan(session, plan, experiment),
            hand=hand,
            object=thing,
            store=session.store(),
            frame=camera_frame(source, up, cameras_in_base),
            hand_offset=pose("--hand-offset", hand_offset),
            object_offset=pose("--object-offset", object_offset),
            motion_s=None if motion is None else MotionTimes(*motion),
            command=session.command,
        )
    )
    content = {
        "document": plain(result.document),
        "motion_starts_s": result.motion_s.start_s,
        "motion_ends_s": result.motion_s.stop_s,
    }
    report = Report("slidepipe.import_result/1", result.run, content)
    report.put(trial_view(result.document, None, result.run), as_json=as_json)
    render.note(f"motion from {result.motion_s.start_s:.3f} s to {result.motion_s.stop_s:.3f} s after the first frame")
    render.note(WHAT_IT_TELLS)
    if result.document.outcome == "lost":
        ctx.exit(ExitCode.NO)


def _plan(session: Session, plan: str | None, experiment: Path | None) -> str:
    """Run that holds the plan; made where only an experiment is given."""
    if (plan is None) == (experiment is None):
        raise click.UsageError("say which plan the trial belongs to: --plan RUN or --experiment EXPERIMENT.yaml")
    if plan is not None:
        return plan
    from slidepipe.stages.plan import PlanRequest, run

    made = run(PlanRequest(Path(str(experiment)), session.store(), command=session.command))
    note_reuse(session, made.run, reused=made.reused)
    return made.run.id
