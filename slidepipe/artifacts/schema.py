"""Artifacts as typed records: every one begins with ``schema: slidepipe.NAME/VERSION`` and is validated whole.

A file of an older version is never rewritten. It is brought up in memory by pure functions, one for each version, which
stand in :data:`UPCASTS`.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import groupby
from types import MappingProxyType
from typing import Any, ClassVar, TypeVar

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, ValidationError, model_serializer

from slidepipe.artifacts.faults import Fault, faults_of, key_text
from slidepipe.artifacts.strict_yaml import YamlDocument, dump
from slidepipe.artifacts.wording import describe
from slidepipe.errors import InputError, NewerSchemaError

Data = dict[str, object]

UPCASTS: dict[tuple[str, int], Callable[[Data], Data]] = {}
"""For (schema name, version): the function that makes the next version's data of that version's data."""

_HEADER = re.compile(r"(slidepipe\.[a-z_]+)/([1-9][0-9]{0,5})")


class Record(BaseModel):
    """Base of everything that stands in an artifact: immutable, exact about types, unknown keys refused.

    A whole number may stand where a number is asked for; infinities and NaN may not.

    Attributes
    ----------
    LATER : frozenset of str
        Keys that joined after a version was released: written only where they are not what was meant without them.
    """

    LATER: ClassVar[frozenset[str]] = frozenset()

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False)

    @model_serializer(mode="wrap")
    def _without_unsaid(self, handler: SerializerFunctionWrapHandler) -> dict[str, object]:
        written: dict[str, object] = handler(self)
        fields = type(self).model_fields
        unsaid = {name for name in self.LATER if getattr(self, name) == fields[name].default}
        return {name: value for name, value in written.items() if name not in unsaid}


class Artifact(Record):
    """Base of a whole document.

    Attributes
    ----------
    SCHEMA : str
        Name of the schema, ``slidepipe.plan`` say.
    VERSION : int
        The version that this code writes.
    """

    SCHEMA: ClassVar[str]
    VERSION: ClassVar[int] = 1

    def faults(self) -> Iterator[Fault]:
        """Find what is wrong between values that are each right by themselves."""
        yield from ()


AnyArtifact = TypeVar("AnyArtifact", bound=Artifact)


def parse(model: type[AnyArtifact], document: YamlDocument) -> AnyArtifact:
    """Validate a document.

    Raises
    ------
    InputError
        It is another schema, or breaks this one; one line for every fault.
    NewerSchemaError
        It was written by a newer slidepipe.
    """
    version = _version(model, document)
    data = {key: value for key, value in document.data.items() if key != "schema"}
    for old in range(version, model.VERSION):
        data = UPCASTS[model.SCHEMA, old](data)
    try:
        artifact = model.model_validate(_frozen(data))
    except ValidationError as error:
        raise _input_error(document, faults_of(error, model)) from None
    faults = list(artifact.faults())
    if faults:
        raise _input_error(document, faults)
    return artifact


def dump_model(artifact: Artifact, written: Mapping[str, str] = MappingProxyType({})) -> str:
    """Document as YAML text, its schema first; :func:`parse` reads back an equal one.

    Parameters
    ----------
    artifact : Artifact
    written : Mapping[str, str]
        YAML of keys of which it is known already.
    """
    data = {"schema": f"{artifact.SCHEMA}/{artifact.VERSION}", **artifact.model_dump(exclude=set(written))}
    parts: list[str] = []
    said = [key for key in ("schema", *type(artifact).model_fields) if key in written or key in data]
    for _, keys in groupby(said, written.__contains__):
        names = list(keys)
        parts += [written[key] for key in names] if names[0] in written else [dump({key: data[key] for key in names})]
    return "".join(parts)


def schema_name(document: YamlDocument) -> str | None:
    """Name of the schema that a document says it has, without its version; None where it says none.

    Examples
    --------
    >>> from slidepipe.artifacts.strict_yaml import loads
    >>> schema_name(loads("schema: slidepipe.plan/1", "a.yaml"))
    'slidepipe.plan'
    """
    header = document.data.get("schema")
    match = _HEADER.fullmatch(header) if isinstance(header, str) else None
    return match[1] if match else None


def _version(model: type[Artifact], document: YamlDocument) -> int:
    wanted = f"{model.SCHEMA}/{model.VERSION}"
    if "schema" not in document.data:
        raise InputError(f"{document.where(())}: schema: required key is missing, it must be {wanted}")
    header = document.data["schema"]
    match = _HEADER.fullmatch(header) if isinstance(header, str) else None
    if match is None or match[1] != model.SCHEMA:
        raise InputError(f"{document.where(('schema',))}: schema: must be {wanted}, got {describe(header)}")
    version = int(match[2])
    if version > model.VERSION:
        place = document.where(("schema",))
        raise NewerSchemaError(f"{place}: schema: {header} was written by a newer slidepipe, this one reads {wanted}")
    return version


def _input_error(document: YamlDocument, faults: list[Fault]) -> InputError:
    return InputError(*(f"{document.where(fault.place)}: {key_text(fault.path)}: {fault.message}" for fault in faults))


def _frozen(value: object) -> Any:
    """Copy of the data with tuples for lists, as immutable records hold them."""
    if isinstance(value, dict):
        return {key: _frozen(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(_frozen(item) for item in value)
    return value
