"""Words for what pydantic finds wrong: what was got, what is allowed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from types import UnionType
from typing import TYPE_CHECKING, Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from slidepipe.artifacts.shapes import IN_WORDS
from slidepipe.artifacts.strict_yaml import KeyPath
from slidepipe.artifacts.wording import describe, unit_of

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong: the key's path, and the message about it."""

    path: KeyPath
    message: str

    @property
    def place(self) -> KeyPath:
        """Path of what to point at."""
        return self.path


@dataclass(frozen=True, slots=True)
class MissingKey(Fault):
    """A key that is not there; it is the mapping that lacks it that can be pointed at."""

    @property
    def place(self) -> KeyPath:
        """Path of the mapping that lacks the key."""
        return self.path[:-1]


def key_text(path: KeyPath) -> str:
    """Path as messages show it.

    Examples
    --------
    >>> key_text(("arm", "posture_rad", 3))
    'arm.posture_rad[3]'
    """
    text = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path)
    return text.removeprefix(".")


def faults_of(error: ValidationError, model: type[BaseModel]) -> list[Fault]:
    """Say in our words what pydantic found wrong with the data of a ``model``."""
    details = error.errors(include_url=False)
    return [_fault_of(detail, model) for detail in details if not _is_echo(detail)]


def _is_echo(error: "ErrorDetails") -> bool:
    """Whether a list is called too short only because an entry of it is wrong."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def _fault_of(error: "ErrorDetails", model: type[BaseModel]) -> Fault:
    path, kind = error["loc"], error["type"]
    if kind == "missing" and isinstance(path[-1], int):
        return Fault(path[:-1], f"must have {_tuple_length(path, model)} entries, got {len(error['input'])}")
    if kind == "missing":
        return MissingKey(path, "required key is missing")
    if kind == "extra_forbidden":
        return Fault(path, _unknown(path, model))
    words = _WORDS.get(kind)
    context = {**error.get("ctx", {}), "unit": _unit(path)}
    if words is None:
        return Fault(path, f"{error['msg']}, got {describe(error['input'])}")
    return Fault(path, f"{words(context)}, got {_got(error['input'], context)}")


def _got(value: object, context: Mapping[str, Any]) -> str:
    if "actual_length" in context:
        return str(context["actual_length"])
    measured = isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
    return f"{describe(value)} {context['unit']}".rstrip() if measured else describe(value)


def _unit(path: KeyPath) -> str:
    """Unit of what a key holds, or the list that it holds."""
    return unit_of(next((key for key in reversed(path) if isinstance(key, str)), ""))


def _kind(kind: str, context: Mapping[str, Any]) -> str:
    return f"must be a {kind} of {context['unit']}" if context["unit"] else f"must be a {kind}"


def _number(value: float) -> str:
    return f"{value:g}"


_WORDS: dict[str, Callable[[Mapping[str, Any]], str]] = {
    "greater_than": lambda c: f"must be > {_number(c['gt'])}",
    "greater_than_equal": lambda c: f"must be >= {_number(c['ge'])}",
    "less_than": lambda c: f"must be < {_number(c['lt'])}",
    "less_than_equal": lambda c: f"must be <= {_number(c['le'])}",
    "float_type": lambda c: _kind("number", c),
    "finite_number": lambda c: _kind("finite number", c),
    "int_type": lambda c: _kind("whole number", c),
    "int_from_float": lambda c: _kind("whole number", c),
    "string_type": lambda _: "must be text",
    "bool_type": lambda _: "must be true or false",
    "tuple_type": lambda _: "must be a list",
    "model_type": lambda _: "must be a mapping of keys to values",
    "dict_type": lambda _: "must be a mapping of keys to values",
    "literal_error": lambda c: f"must be {c['expected']}",
    "too_short": lambda c: f"must have {c['min_length']} entries",
    "too_long": lambda c: f"must have {c['max_length']} entries",
    "string_pattern_mismatch": lambda c: f"must be {IN_WORDS[c['pattern']]}",
}


def _unknown(path: KeyPath, model: type[BaseModel]) -> str:
    allowed = list(_model_at(model, path[:-1]).model_fields)
    near = get_close_matches(str(path[-1]), allowed, n=1)
    hint = f"did you mean {near[0]}?" if near else f"allowed are {', '.join(allowed)}"
    return f"unknown key, {hint}"


def _model_at(model: type[BaseModel], path: KeyPath) -> type[BaseModel]:
    """Type of the model that sits at a path inside ``model``."""
    for key in path:
        if isinstance(key, str) and key in model.model_fields:
            model = _model_in(model.model_fields[key].annotation) or model
    return model


def _tuple_length(path: KeyPath, model: type[BaseModel]) -> int:
    """Count the entries that the list at the key before the path's last one has in ``model``."""

    def length(annotation: object) -> int:
        if get_origin(annotation) is tuple:
            return len(get_args(annotation))
        return max((length(part) for part in get_args(annotation)), default=0)

    return length(_model_at(model, path[:-2]).model_fields[str(path[-2])].annotation)


def _model_in(annotation: object) -> type[BaseModel] | None:
    """Return the model that an annotation such as ``Model | None`` or ``tuple[Model, ...]`` speaks of."""
    if isinstance(annotation, type) and not get_args(annotation) and issubclass(annotation, BaseModel):
        return annotation
    if isinstance(annotation, UnionType) or get_args(annotation):
        return next((found for part in get_args(annotation) if (found := _model_in(part))), None)
    return None
