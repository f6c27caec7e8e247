"""``slidepipe ref``."""

# what computes is imported when it is called, so that help is there at once

from dataclasses import asdict

import click

from slidepipe.cli import options, render
from slidepipe.cli.complete import complete_run
from slidepipe.cli.session import Session


@options.verb(
    "ref",
    "Give a run a name, which then stands for it as @NAME.\n\n"
    "Without a RUN the name is shown, without a NAME all are. "
    "A name belongs to the experiment of its run, and means another run when it is given again. gc keeps what has a "
    "name, and all that it was made from.",
    example="slidepipe ref best @latest:run",
    exits={},
)
@click.argument("name", required=False, metavar="[NAME]")
@click.argument("run", required=False, metavar="[RUN]", shell_complete=complete_run)
@click.option("--delete", is_flag=True, help="Take the name away; the run stays.")
@options.as_json
@click.pass_obj
def command(session: Session, *, name: str | None, run: str | None, delete: bool, as_json: bool) -> None:
    """Set, show or take away a name."""
    store = session.store()
    if delete and (name is None or run is not None):
        raise click.UsageError("--delete takes a NAME, and no RUN")
    if name is None:
        refs = store.refs.all()
    elif delete:
        refs = (store.refs.delete(name),)
    elif run is None:
        refs = (store.refs.find(name),)
    else:
        refs = (store.refs.set(name.removeprefix("@"), store.get(run)),)
    if as_json:
        render.put_json("slidepipe.refs/1", {"refs": [asdict(ref) for ref in refs], "deleted": delete})
        return
    render.put([f"@{ref.experiment}/{ref.name}  {ref.run}{'  (taken away)' if delete else ''}" for ref in refs])
    if not refs:
        render.note("no names")
