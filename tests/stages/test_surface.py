"""From files of force and motion to a fitted surface in the store."""

from pathlib import Path

import numpy as np
import pytest

from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.surface import COLUMNS, SurfaceDocument
from slidepipe.errors import EstimationError, InputError, NotFoundError
from slidepipe.mechanics.grasp_surface import GraspSurface
from slidepipe.mechanics.limit_surface import PointContact
from slidepipe.stages import surface

SUPPORTS = """\
schema: slidepipe.supports/1
name: block
supports:
- {x_m: 0.05, y_m: 0.0, share: 0.5}
- {x_m: -0.03, y_m: 0.04, share: 0.2}
- {x_m: -0.02, y_m: -0.05, share: 0.3}
"""


@pytest.fixture
def files(tmp_path: Path) -> surface.SurfaceRequest:
    random, shares = np.random.default_rng(2), (0.5, 0.2, 0.3)
    exact = GraspSurface([PointContact(1.0, 4.0 * one) for one in shares], [[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.05]])
    step = random.normal(size=(12, 3)) * [0.01, 0.01, 0.2]
    rows = np.hstack([exact.friction(step), step])[:, ::-1]
    lines = [",".join(COLUMNS[::-1]), *(",".join(map(repr, row.tolist())) for row in rows)]
    (tmp_path / "pushes.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "supports.yaml").write_text(SUPPORTS)
    return surface.SurfaceRequest(tmp_path / "pushes.csv", tmp_path / "supports.yaml", Store(tmp_path / "data"))


def test_fit_is_stored_with_its_inputs_and_reused(files: surface.SurfaceRequest) -> None:
    result = surface.run(files)
    assert result.document.friction_n == pytest.approx(4.0, rel=1e-6)
    assert [one.share for one in result.document.supports] == [0.5, 0.2, 0.3]
    assert parse(SurfaceDocument, load(result.run.file("surface"))) == result.document
    assert [one.role for one in result.run.manifest.inputs] == ["pairs", "supports"]
    again = surface.run(files)
    assert (again.reused, again.document) == (True, result.document)


def test_shares_that_are_not_given_are_fitted(files: surface.SurfaceRequest) -> None:
    text = SUPPORTS
    for share in ("0.5", "0.2", "0.3"):
        text = text.replace(f", share: {share}", "")
    files.supports.write_text(text)
    document = surface.run(files).document
    assert not document.shares_given
    assert [one.share for one in document.supports] == pytest.approx([0.5, 0.2, 0.3], abs=1e-6)


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("supports", "share: 0.2", "share: 0.4", r"supports.yaml:3:1: supports: shares must add up to 1, got 1.2"),
        ("supports", ", share: 0.2", "", r"supports.yaml:3:1: supports: share must be given for all supports or"),
        ("supports", "supports:\n", "supports: []\nmore:\n", r"supports.yaml:3:1: supports: "),
        ("pairs", "step_rad", "step_deg", r"pushes.csv:1:1: the header must name force_x_n, .*, got step_deg,"),
    ],
)
def test_bad_files_are_told_by_line(files: surface.SurfaceRequest, file: str, old: str, new: str, message: str) -> None:
    path = getattr(files, file)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        surface.run(files)
    assert not files.store.root.exists()


@pytest.mark.parametrize(
    ("field", "message"),
    [("a lot", r"pushes.csv:3:1: must be a finite number, got 'a lot'"), ("nan", "got 'nan'"),
     ("1.0,2.0", "pushes.csv:3:1: must have 6 fields, got 7")],
)  # fmt: skip
def test_bad_fields_are_told_by_line_and_column(files: surface.SurfaceRequest, field: str, message: str) -> None:
    lines = files.pairs.read_text().splitlines()
    lines[2] = ",".join([field, *lines[2].split(",")[1:]])
    files.pairs.write_text("\n".join(lines))
    with pytest.raises(InputError, match=message):
        surface.run(files)


def test_too_few_pushes_and_no_file(files: surface.SurfaceRequest) -> None:
    files.pairs.write_text("\n".join(files.pairs.read_text().splitlines()[:5]))
    with pytest.raises(EstimationError, match="4 pairs, at least 10 are needed"):
        surface.run(files)
    files.pairs.unlink()
    with pytest.raises(NotFoundError, match="no such file"):
        surface.run(files)
    assert not files.store.root.exists()
