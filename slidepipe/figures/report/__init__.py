"""The report: one HTML page without anything from elsewhere; pictures are SVG, the animation is a small script."""

import base64
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from slidepipe.figures import style

REM_PER_INCH = 9.0
"""Pictures of two columns fill the page; those of one are no larger, so that letters are the same everywhere."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table of words; ``titles`` hold what a cell says when it is pointed at, where that is more."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marks: tuple[str, ...] = ()
    """One class for each row, such as ``lost``."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, what it shows in words for those who cannot see it, and its caption."""

    title: str
    figure: Figure
    caption: str


@dataclass(frozen=True, slots=True)
class Scene:
    """One trial's animation: poses in {w}, m and rad, and friction in {f}, moments divided by the patch's radius.

    Attributes
    ----------
    name : str
    time_s : list of float
        From the start of the motion.
    object, finger, friction : list of three numbers for each time
    planned : list of three numbers for each time
        The relative pose as planned, mm and degrees, beside ``relative``.
    relative : list of three numbers for each time
    slide_s : two of float, optional
    block_m : two of float
    semi_axes_n : three of float
    """

    name: str
    time_s: Sequence[float]
    object: Sequence[Sequence[float]]
    finger: Sequence[Sequence[float]]
    friction: Sequence[Sequence[float]]
    relative: Sequence[Sequence[float]]
    slide_s: tuple[float, float] | None
    block_m: tuple[float, float]
    semi_axes_n: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class ReportPage:
    """Everything on the page, in its order."""

    title: str
    subtitle: str
    warnings: tuple[str, ...]
    experiment: tuple[tuple[str, str], ...]
    experiment_yaml: str
    trials: Table
    convergence: Picture | None
    scenes: tuple[Scene, ...]
    estimates: Table
    notes: tuple[str, ...]
    pictures: tuple[Picture, ...]
    provenance: Table
    hashes: Table
    made: str


def render_report(page: ReportPage) -> str:
    """Return the page as HTML; equal pages make equal bytes."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters["svg"] = _svg
    environment.filters["wide"] = lambda figure: round(REM_PER_INCH * figure.get_figwidth(), 1)
    parts: Mapping[str, Any] = {
        "page": page,
        "style": Markup(_text("page.css")),  # noqa: S704  # our own file
        "script": Markup(_text("animation.js")),  # noqa: S704
        "scenes": Markup(_script_json([asdict(scene) for scene in page.scenes])),  # noqa: S704  # escaped below
    }
    return environment.get_template("page.html").render(parts)


def _text(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _script_json(value: object) -> str:
    """JSON that cannot end the script element that it stands in."""
    text = json.dumps(value, separators=(",", ":"), allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _svg(figure: Figure) -> str:
    """A figure as the address of an image, so that the names inside one cannot meet those of another."""
    stream = io.BytesIO()
    with style.applied():
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return "data:image/svg+xml;base64," + base64.b64encode(stream.getvalue()).decode("ascii")
