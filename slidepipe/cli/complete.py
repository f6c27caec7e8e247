"""What a shell offers when Tab is pressed: runs, names and experiments of the store, by the index alone; labs."""

# ruff: noqa: PLC0415, ARG001  # loaded when it is asked for; click's signature

from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.shell_completion import BashComplete, CompletionItem

if TYPE_CHECKING:
    from slidepipe.artifacts.entry import Entry

LIMIT = 50
STAGES = ("plan", "execute", "estimate", "iterate", "run")


class WholeWords(BashComplete):
    """Bash that does not break a word at ``:`` or ``@``, which stand in the names of runs."""

    source_template = "COMP_WORDBREAKS=${COMP_WORDBREAKS//[:@]/}\n" + BashComplete.source_template


def complete_run(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Ids that begin so (or whose random part does), the latest first, and names after ``@``; else files."""
    if incomplete.startswith("@"):
        names = ["@latest", *(f"@latest:{stage}" for stage in STAGES), *_names(_data(ctx))]
        return [CompletionItem(name) for name in names if name.startswith(incomplete)]
    found = [
        CompletionItem(one.run, help=f"{one.stage} {one.experiment} {one.state}") for one in _runs(ctx, incomplete)
    ]
    if found:
        return found
    return [CompletionItem(incomplete, type="file")]


def complete_experiment(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of the experiments that were run last."""
    names = dict.fromkeys(one.experiment for one in _runs(ctx, "", limit=1000))
    return [CompletionItem(name) for name in names if name.startswith(incomplete)]


def complete_subject(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of experiments; where none begins so, runs."""
    return complete_experiment(ctx, param, incomplete) or complete_run(ctx, param, incomplete)


def complete_lab(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Labs beside the experiment that was named before, or beside the experiments of this folder; else files."""
    from slidepipe.artifacts.lab_names import EXPERIMENTS, labs

    experiment = ctx.params.get("experiment")
    names = labs(Path(experiment).parent if experiment else EXPERIMENTS)
    found = [CompletionItem(name) for name in names if name.startswith(incomplete)]
    return found or [CompletionItem(incomplete, type="file")]


def complete_stage(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of the stages."""
    return [CompletionItem(stage) for stage in STAGES if stage.startswith(incomplete)]


def complete_document(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of the documents that have a schema."""
    from slidepipe.artifacts.documents import DOCUMENTS

    return [CompletionItem(name) for name in DOCUMENTS if name.startswith(incomplete)]


def _data(ctx: click.Context) -> Path:
    return Path(ctx.find_root().params.get("data") or "data")


def _runs(ctx: click.Context, begins: str, limit: int = LIMIT) -> "list[Entry]":
    from slidepipe.artifacts.index import Index
    from slidepipe.artifacts.query import Query

    return list(reversed(Index(_data(ctx)).find(Query(begins=begins, limit=limit)).entries))


def _names(data: Path) -> list[str]:
    from slidepipe.artifacts.refs import Refs
    from slidepipe.errors import SlidepipeError

    try:
        return [f"@{ref.name}" for ref in Refs(data / "refs").all()]
    except SlidepipeError:
        return []
