"""The entry point: a group of verbs, each of which is loaded when it is asked for."""

import keyword
import os
import sys
from collections.abc import Callable
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any

import click
from click.shell_completion import add_completion_class

from slidepipe import __version__
from slidepipe.cli import complete, render
from slidepipe.cli.exits import ExitCode, exit_code
from slidepipe.cli.session import Session
from slidepipe.errors import UNWRITABLE, SlidepipeError

VERBS = (
    "plan",
    "execute",
    "estimate",
    "iterate",
    "run",
    "sweep",
    "calibrate",
    "surface",
    "lab",
    "figures",
    "report",
    "view",
    "ls",
    "show",
    "log",
    "diff",
    "annotate",
    "ref",
    "verify",
    "repair",
    "gc",
    "schema",
    "export",
    "import",
    "recover",
)
"""The commands in the order in which help shows them; each is ``slidepipe.cli.NAME``, or ``NAME_`` for a keyword."""

_COMMAND = "slidepipe.command"


_EPILOG = """\
A RUN is a run id, its beginning, @latest, @latest:STAGE, a given name (@NAME), or the path of a run's directory.

\b
Completion of commands and runs with Tab:
  eval "$(_SLIDEPIPE_COMPLETE=bash_source slidepipe)"    (bash; zsh_source, fish_source)
"""


class Verbs(click.Group):
    """Loads a verb when it is asked for, and turns errors into a line and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002  # click's signature
        """Names of the verbs."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002  # click's signature
        """Load a verb; None where there is none of this name."""
        if cmd_name not in VERBS:
            return None
        command: click.Command = import_module(f"slidepipe.cli.{_module(cmd_name)}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the verb; a misspelt one is told with what may have been meant."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            near = get_close_matches(args[0], VERBS, n=1)
            meant = f" Did you mean {near[0]}?" if near else ""
            raise click.UsageError(f"{error.message}{meant}", ctx) from None

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Keep the command line as it was typed, for the manifests."""
        ctx.meta[_COMMAND] = ("slidepipe", *args)
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the verb; an error that slidepipe raises on purpose is one line and a code, never a traceback."""
        render.forgive_encoding()
        render.hear()
        try:
            return _flushed(lambda: super(Verbs, self).invoke(ctx))
        except click.NoSuchOption as error:
            raise _misplaced(self, error) or error from None
        except SlidepipeError as error:
            render.fail(error)
            ctx.exit(exit_code(error))
        except KeyboardInterrupt as interrupt:
            render.note(": ".join(["interrupted", *map(str, interrupt.args)]))
            ctx.exit(ExitCode.INTERRUPTED)
        except BrokenPipeError:
            _hush()
            ctx.exit(ExitCode.BROKEN_PIPE)
        except OSError as error:
            if error.errno not in UNWRITABLE:
                raise
            if error.filename is None:
                _hush()
            render.note(f"error: {error.filename or 'standard output'}: {error.strerror}")
            ctx.exit(ExitCode.STORE)


@click.group(
    cls=Verbs,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=_EPILOG,
)
@click.option(
    "--data",
    type=click.Path(path_type=Path),
    default=Path("data"),
    show_default=True,
    envvar="SLIDEPIPE_DATA",
    show_envvar=True,
    help="Directory of the run store.",
)
@click.version_option(__version__, prog_name="slidepipe", message="%(prog)s %(version)s")
@click.pass_context
def cli(ctx: click.Context, data: Path) -> None:
    """Plan, execute, estimate and iterate a dynamic in-hand regrasp."""
    ctx.obj = Session(data=data, command=ctx.meta[_COMMAND])


def main() -> None:
    """Run the command line."""
    add_completion_class(complete.WholeWords)
    cli(prog_name="slidepipe")


def _misplaced(group: click.Group, error: click.NoSuchOption) -> click.UsageError | None:
    """Say where an option belongs that was given after the verb, and is one of the group; None where it is not."""
    option = next((one for one in group.params if error.option_name in one.opts), None)
    if option is None or error.ctx is None:
        return None
    takes = "" if isinstance(option, click.Option) and option.is_flag else f" {option.make_metavar(error.ctx)}"
    program, _, verb = error.ctx.command_path.partition(" ")
    where = f"{program} {error.option_name}{takes} {verb}"
    return click.UsageError(f"{error.option_name} is an option of {program} itself, before the command: {where}")


def _module(verb: str) -> str:
    return f"{verb}_" if keyword.iskeyword(verb) else verb


def _flushed(work: Callable[[], Any]) -> Any:
    """Do it, and write stdout out: a reader that is gone is noticed here, not when Python ends."""
    try:
        return work()
    finally:
        sys.stdout.flush()


def _hush() -> None:
    """Nobody reads stdout any more: write nothing more to it, not even when Python ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
