"""``slidepipe lab``: look at a laboratory, or play one."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import signal
import time
from dataclasses import asdict
from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.complete import complete_lab
from slidepipe.cli.exits import MEANINGS, ExitCode
from slidepipe.cli.session import Report

command = options.verbs(
    "lab",
    "Look at a laboratory, or play one.\n\n"
    "A laboratory is a file, experiments/labs/NAME.yaml: addresses, rates, frames and limits. Both commands have a "
    "help of their own, and take --json.",
    example="slidepipe lab check loopback",
    exits={ExitCode.LAB: MEANINGS[ExitCode.LAB]},
)


@options.verb(
    "check",
    "Connect to a lab's arm and cameras and say what is found; nothing moves.",
    example="slidepipe lab check loopback",
    exits={ExitCode.OK: "both are there and sound", ExitCode.LAB: "one of them is not: it says which, and why"},
)
@click.argument("name", metavar="NAME", shell_complete=complete_lab)
@options.as_json
@click.pass_context
def check(ctx: click.Context, *, name: str, as_json: bool) -> None:
    """Listen, and show what was heard."""
    from slidepipe.cli.views.lab import check_view
    from slidepipe.stages.lab_check import run

    found = run(name)
    facts = [asdict(fact) for fact in found.facts]
    report = Report("slidepipe.lab_check_result/1", None, {"lab": found.lab.name, "sound": found.sound, "facts": facts})
    report.put(check_view(found), as_json=as_json)
    if not found.sound:
        ctx.exit(ExitCode.LAB)


@options.verb(
    "serve",
    "Play a lab in real time: the simulated world behind the arm's wire and the cameras' stream.\n\n"
    "It ends with Ctrl-C, and then says how it kept time. A FAULT is KIND=STRENGTH, or KIND=STRENGTH@START with the "
    "seconds after the arm was linked; KIND is loss, duplication, reordering, occlusion, blindness or swap (shares), "
    "jitter (mean, s), drift (ppm), freeze, stall or unlink (how long, s).",
    example="slidepipe lab serve experiments/regrasp.yaml --lab loopback",
    exits={ExitCode.OK: "it was ended", ExitCode.LAB: "a port is taken, or the address is not this machine's"},
)
@click.argument("experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path))
@click.option("--lab", metavar="NAME", required=True, shell_complete=complete_lab,
              help="A lab file, or its name in labs beside the experiment.")  # fmt: skip
@click.option(
    "--fault", "faults", metavar="FAULT", multiple=True, help="What shall go wrong; may be given several times."
)
@click.option("--for", "duration_s", metavar="SECONDS", type=click.FloatRange(min=0.1), help="End after so long.")
@options.overrides("--set lab.friction=0.45; only keys of lab")
@options.as_json
def serve(
    *,
    experiment: Path,
    lab: str,
    faults: tuple[str, ...],
    duration_s: float | None,
    overrides: tuple[str, ...],
    as_json: bool,
) -> None:
    """Serve until it is enough."""
    from slidepipe.cli.views.lab import serve_view
    from slidepipe.lab.faults import Fault
    from slidepipe.stages.serve import ServeRequest, run

    enough = _Enough()
    request = ServeRequest(
        experiment=experiment,
        lab=lab,
        stop=lambda: enough.said,
        ready=lambda line: render.note(f"serving {line}; Ctrl-C ends it"),
        overrides=overrides,
        faults=tuple(Fault.parse(fault) for fault in faults),
        duration_s=duration_s,
    )
    started = time.monotonic()
    result = run(request)
    content = {**asdict(result), "served_s": time.monotonic() - started}
    Report("slidepipe.lab_serve_result/1", None, content).put(serve_view(result), as_json=as_json)


class _Enough:
    """Whether Ctrl-C was pressed, or the process was told to end: the world is left between two ticks."""

    def __init__(self) -> None:
        self.said = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._say)

    def _say(self, *_: object) -> None:
        self.said = True


command.add_command(check)
command.add_command(serve)
