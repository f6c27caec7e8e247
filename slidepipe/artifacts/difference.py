"""What differs between two runs: how they were asked, by which code, and what came out."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from slidepipe.artifacts.manifest import InputRef, Manifest, Result
from slidepipe.artifacts.run import Run

SHORT = 12


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that is not the same; None where one of the runs does not have it."""

    name: str
    before: object
    after: object


@dataclass(frozen=True, slots=True)
class ResultPair:
    """A result of both runs, of the same unit, or of one of them."""

    name: str
    unit: str
    before: Result | None
    after: Result | None

    @property
    def change(self) -> float | None:
        """How much it grew; None where one is missing."""
        return None if self.before is None or self.after is None else self.after.value - self.before.value


@dataclass(frozen=True, slots=True)
class Difference:
    """What differs: the task (stage, parameters, seed, inputs), the code, and the results of either."""

    same_recipe: bool
    task: tuple[Change, ...]
    code: tuple[Change, ...]
    results: tuple[ResultPair, ...]


def difference(before: Run, after: Run) -> Difference:
    """Compare two runs."""
    old, new = before.manifest, after.manifest
    return Difference(
        same_recipe=old.recipe == new.recipe,
        task=tuple(_changes(_task(old), _task(new))),
        code=tuple(_changes(_code(old), _code(new))),
        results=tuple(_results(old, new)),
    )


def flat(values: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    """Mapping of mappings as one, with dotted keys.

    Examples
    --------
    >>> flat({"lab": {"seed": 1}, "friction": 0.4})
    {'lab.seed': 1, 'friction': 0.4}
    """
    found: dict[str, object] = {}
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            found |= flat(value, f"{prefix}{key}.")
        else:
            found[f"{prefix}{key}"] = value
    return found


def _task(told: Manifest) -> dict[str, object]:
    return {
        "stage": told.stage,
        "stage_version": told.stage_version,
        "experiment": told.experiment,
        "state": told.state.value,
        "seed": told.seed,
        **_inputs(told),
        **flat(told.parameters),
    }


def _inputs(told: Manifest) -> dict[str, str]:
    """Inputs by role; where several have one, they are counted."""
    found: dict[str, str] = {}
    for one in told.inputs:
        number = sum(earlier.role == one.role for earlier in told.inputs[: told.inputs.index(one)])
        found[f"input.{one.role}" if number == 0 else f"input.{one.role}.{number + 1}"] = _origin(one)
    return found


def _origin(one: InputRef) -> str:
    return f"{one.run or one.file} sha256 {one.sha256[:SHORT]}"


def _code(told: Manifest) -> dict[str, object]:
    code, environment = told.code, told.environment
    return {
        "slidepipe": code.version,
        "commit": None if code.commit is None else code.commit[:SHORT],
        "changed": code.dirty,
        "python": environment.python,
        "platform": environment.platform,
        "host": environment.host,
        **environment.packages,
    }


def _changes(before: Mapping[str, object], after: Mapping[str, object]) -> Iterator[Change]:
    for name in dict.fromkeys([*before, *after]):
        if before.get(name) != after.get(name):
            yield Change(name, before.get(name), after.get(name))


def _results(old: Manifest, new: Manifest) -> Iterator[ResultPair]:
    before = {(one.name, one.unit): one for one in old.results}
    after = {(one.name, one.unit): one for one in new.results}
    for name, unit in dict.fromkeys([*before, *after]):
        yield ResultPair(name, unit, before.get((name, unit)), after.get((name, unit)))
