"""What the verbs have in common: how their help reads, and the options that more than one of them takes."""

from collections.abc import Callable, Mapping

import click

from slidepipe.cli.complete import complete_lab, complete_run
from slidepipe.cli.exits import MEANINGS, ExitCode

Callback = Callable[..., None]

ALWAYS = (ExitCode.OK, ExitCode.USAGE, ExitCode.INTERRUPTED)
READS_STORE = (ExitCode.INPUT, ExitCode.NOT_FOUND, ExitCode.STORE)


def verb(name: str, does: str, *, example: str, exits: Mapping[ExitCode, str]) -> Callable[[Callback], click.Command]:
    """Make a command whose help says what it does, shows an example and names its exit codes.

    Parameters
    ----------
    name, does, example : str
        ``does`` is what it does, in one sentence, and after a blank line anything else worth knowing.
    exits : Mapping[ExitCode, str]
        What the codes mean that mean something special here, or that only this verb ends with.
    """
    return click.command(name, help=does, short_help=does.partition("\n")[0], epilog=_epilog(example, exits))


def verbs(name: str, does: str, *, example: str, exits: Mapping[ExitCode, str]) -> click.Group:
    """Make a command that has commands of its own; see :func:`verb`."""
    return click.Group(name, help=does, short_help=does.partition("\n")[0], epilog=_epilog(example, exits))


def _epilog(example: str, exits: Mapping[ExitCode, str]) -> str:
    meanings = {code: MEANINGS[code] for code in (*ALWAYS, *READS_STORE)} | dict(exits)
    codes = "\n".join(f"  {code:<4d} {meanings[code]}" for code in sorted(meanings))
    return f"\b\nExample:\n  {example}\n\n\b\nExit codes:\n{codes}"


as_json: Callable[[Callback], Callback] = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object instead."
)
force: Callable[[Callback], Callback] = click.option(
    "--force", is_flag=True, help="Compute it even where an equal run is there already."
)
way: Callable[[Callback], Callback] = click.option(
    "--way",
    type=click.Choice(["goal", "posterior", "learned"]),
    help="What to learn from a trial: the goal alone, the friction too, or the arm as well.  "
    "[default: as the experiment says]",
)
all_limits: Callable[[Callback], Callback] = click.option(
    "--all", "all_limits", is_flag=True, help="Show every limit, not only the nearest."
)


lab: Callable[[Callback], Callback] = click.option(
    "--lab",
    metavar="NAME",
    shell_complete=complete_lab,
    help="A lab file, or its name in experiments/labs.  [default: the simulated lab in virtual time]",
)
yes: Callable[[Callback], Callback] = click.option("--yes", is_flag=True, help="Move a real arm without asking.")


def overrides(example: str) -> Callable[[Callback], Callback]:
    """Make the option that sets keys of the experiment."""
    option: Callable[[Callback], Callback] = click.option(
        "--set",
        "overrides",
        metavar="KEY=VALUE",
        multiple=True,
        callback=_with_equals,
        help=f"Set a key of the experiment: {example}.",
    )
    return option


def _with_equals(ctx: click.Context, param: click.Parameter, settings: tuple[str, ...]) -> tuple[str, ...]:  # noqa: ARG001
    """Refuse what has no value before the word behind it is taken for an argument too many."""
    for one in settings:
        if "=" not in one:
            raise click.BadParameter(f"must read KEY=VALUE in one word: {one}=...")
    return settings


runs_argument: Callable[[Callback], Callback] = click.argument(
    "runs", metavar="[RUN]...", nargs=-1, shell_complete=complete_run
)


def run_argument(name: str) -> Callable[[Callback], Callback]:
    """Make the argument that names a run; a shell completes it."""
    argument: Callable[[Callback], Callback] = click.argument(name, metavar=name.upper(), shell_complete=complete_run)
    return argument
