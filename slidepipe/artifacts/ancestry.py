"""What a run was made from, and what that was made from."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.errors import NotFoundError, StoreError


@dataclass(frozen=True, slots=True)
class Ancestor:
    """One run of an ancestry.

    Attributes
    ----------
    run : Run or None
        None where it is not in the store, or cannot be read.
    parents : tuple of str
        Runs that it was made from, those that its inputs reach in another way left out.
    outside : tuple of str
        Files from outside the store that went in.
    """

    id: str
    run: Run | None
    parents: tuple[str, ...] = ()
    outside: tuple[str, ...] = ()


def ancestry(store: Store, runs: Iterable[Run]) -> dict[str, Ancestor]:
    """Runs and everything that they were made from, by id, each before what it was made from."""
    found: dict[str, Ancestor] = {}
    waiting: list[tuple[str, Run | None]] = [(run.id, run) for run in runs]
    while waiting:
        run_id, run = waiting.pop(0)
        if run_id in found:
            continue
        found[run_id] = _ancestor(run_id, run)
        waiting += [(parent, _get(store, parent)) for parent in found[run_id].parents if parent not in found]
    return found


def direct(ancestors: Mapping[str, Ancestor], run_id: str) -> tuple[str, ...]:
    """Parents of a run without those that another of its parents was made from.

    Examples
    --------
    >>> chain = {"c": Ancestor("c", None, ("b", "a")), "b": Ancestor("b", None, ("a",)), "a": Ancestor("a", None)}
    >>> direct(chain, "c")
    ('b',)
    """
    parents = ancestors[run_id].parents
    return tuple(one for one in parents if not any(one in _above(ancestors, other) for other in parents))


def outside(ancestors: Mapping[str, Ancestor], run_id: str) -> tuple[str, ...]:
    """Files that a run was made from, without those that one of its ancestors was made from."""
    above = _above(ancestors, run_id)
    return tuple(file for file in ancestors[run_id].outside if all(file not in ancestors[one].outside for one in above))


def _above(ancestors: Mapping[str, Ancestor], run_id: str) -> set[str]:
    above, waiting = set[str](), [run_id]
    while waiting:
        for parent in ancestors[waiting.pop()].parents:
            if parent not in above:
                above.add(parent)
                waiting.append(parent)
    return above


def _ancestor(run_id: str, run: Run | None) -> Ancestor:
    if run is None:
        return Ancestor(run_id, None)
    inputs = run.manifest.inputs
    parents = dict.fromkeys(one.run for one in inputs if one.run is not None)
    return Ancestor(run_id, run, tuple(parents), tuple(one.file for one in inputs if one.run is None))


def _get(store: Store, run_id: str) -> Run | None:
    try:
        return store.get_exactly(run_id)
    except (NotFoundError, StoreError):
        return None
