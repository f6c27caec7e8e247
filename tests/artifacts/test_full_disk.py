"""A disk that takes nothing any more: one line, and no run that is half written."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.durable import whole
from slidepipe.artifacts.store import Store
from slidepipe.errors import InputError, StoreError


def full(place: str | None = None) -> OSError:
    return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), place)


def make(store: Store, then: Callable[[], None], text: str = "a: 1\n") -> Draft:
    draft = store.draft(stage="plan", stage_version=1, experiment="a", parameters={})
    with draft:
        draft.add("plan", "plan.yaml").write_text(text)
        then()
    return draft


def test_a_run_that_cannot_be_published_is_kept_for_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_seal(_: object) -> str:
        raise full()

    store = Store(tmp_path / "data")
    monkeypatch.setattr("slidepipe.artifacts.draft.seal_of", no_seal)
    with pytest.raises(StoreError) as caught:
        make(store, lambda: None)
    assert str(caught.value) == (
        f"{store.root}: No space left on device; what was made is kept: slidepipe recover publishes it"
    )
    (staging,) = store.root.glob("runs/*/*")
    assert {path.name for path in staging.iterdir()} - {"diff.patch"} == {".owner.yaml", "plan.yaml"}


def test_what_was_made_before_the_disk_was_full_is_kept(tmp_path: Path) -> None:
    def fill() -> None:
        raise full()

    store = Store(tmp_path / "data")
    with pytest.raises(StoreError, match=r"No space left on device; what was made is kept: slidepipe recover"):
        make(store, fill)
    (staging,) = store.root.glob("runs/*/*")
    assert (staging / "plan.yaml").read_text() == "a: 1\n"


@pytest.mark.parametrize(("place", "named"), [("/elsewhere/b", "/elsewhere/b"), (None, "data")])
def test_a_file_that_cannot_be_written_leaves_nothing(tmp_path: Path, place: str | None, named: str) -> None:
    def fill() -> None:
        raise full(place)

    store = Store(tmp_path / "data")
    with pytest.raises(StoreError, match=rf"{named}: No space left on device$"):
        make(store, fill, text="")
    assert not store.root.exists()


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "a.html"
    path.write_text("before")

    def write(text: str, error: Exception | None) -> None:
        with whole(path) as draft:
            draft.write_text(text)
            if error is not None:
                raise error

    with pytest.raises(InputError, match=r"a\.html: cannot be written: No space left on device$"):
        write("half", full())
    assert (path.read_text(), list(tmp_path.iterdir())) == ("before", [path])
    write("whole", None)
    assert (path.read_text(), list(tmp_path.iterdir())) == ("whole", [path])
