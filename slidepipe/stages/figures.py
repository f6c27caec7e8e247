"""Figures: the paper's pictures from our own runs, each with a caption, and its numbers beside ours."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.durable import folder, whole
from slidepipe.artifacts.store import Store
from slidepipe.errors import NotFoundError
from slidepipe.figures.paper import save_figure
from slidepipe.stages import paper_motions, paper_theory
from slidepipe.stages.figure_names import CAPTIONS, TITLES
from slidepipe.stages.paper_claims import claims
from slidepipe.stages.paper_page import captions_page, claims_page
from slidepipe.stages.paper_runs import PaperRuns
from slidepipe.stages.paper_theory import Drawn

DRAW: dict[str, Callable[[PaperRuns], Drawn]] = {
    "fig01": paper_theory.fig01,
    "fig02": paper_theory.fig02,
    "fig03": paper_theory.fig03,
    "fig04": paper_theory.fig04,
    "fig05": paper_theory.fig05,
    "fig06": paper_motions.fig06,
    "fig07": paper_motions.fig07,
    "fig08": paper_motions.fig08,
    "fig10": paper_motions.fig10,
    "fig11": paper_motions.fig11,
    "fig12": paper_motions.fig12,
}


@dataclass(frozen=True, slots=True)
class FiguresRequest:
    """Which figures to draw into which folder, all where ``names`` is empty; ``table`` is the page of numbers."""

    names: Sequence[str]
    directory: Path
    experiments: Path
    store: Store
    report: Callable[[str], None]
    table: Path | None = None
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FigureWritten:
    """A figure's caption and its files."""

    name: str
    title: str
    caption: str
    paths: tuple[Path, ...]


NEEDED = ("paper_linear.yaml", "paper_rotational.yaml")
"""The paper's experiment files."""


def run(request: FiguresRequest) -> tuple[FigureWritten, ...]:
    """Draw figures; runs that they need are taken from the store, or made.

    Raises
    ------
    NotFoundError
        One of the paper's experiment files is not in the folder.
    InputError
        A file stands where the folder shall be.
    """
    if not all((request.experiments / name).is_file() for name in NEEDED):
        raise NotFoundError(f"{request.experiments}: must hold {', '.join(NEEDED)} (--experiments PATH)")
    runs = PaperRuns(request.experiments, request.store, request.report, request.command)
    folder(request.directory)
    written = tuple(_draw(name, runs, request.directory) for name in request.names or TITLES)
    text = captions_page([(one.name, one.title, one.caption) for one in written])
    _put(request.directory / CAPTIONS, text)
    if request.table is not None:
        folder(request.table.parent)
        _put(request.table, claims_page(claims(runs)))
    return written


def _draw(name: str, runs: PaperRuns, directory: Path) -> FigureWritten:
    drawn = DRAW[name](runs)
    return FigureWritten(name, TITLES[name], drawn.caption, save_figure(drawn.figure, directory, name))


def _put(path: Path, text: str) -> None:
    with whole(path) as draft:
        draft.write_text(text, encoding="utf-8")
