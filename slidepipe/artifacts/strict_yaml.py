"""YAML that means what it says: read strictly, with positions for messages; written so that it reads back exactly."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from slidepipe.artifacts.wording import describe, nearest
from slidepipe.artifacts.yaml_loader import StrictLoader
from slidepipe.artifacts.yaml_scalars import STR, use_core_schema
from slidepipe.errors import InputError, NotFoundError

KeyPath = tuple[str | int, ...]

MAX_BYTES = 4 * 2**20
"""Largest YAML file that is read; artifacts stay far below, long series are recordings."""

WIDTH = 120
_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True)
class YamlDocument:
    """A YAML mapping and where it came from.

    Attributes
    ----------
    name : str
        Path of the file, as messages show it.
    data : dict
        Plain dicts, lists, text, numbers, booleans and None.
    text : str
        The file as it was read.
    options : Mapping[KeyPath, str]
        Values that were set from outside, each with the option that did it.
    """

    name: str
    data: dict[str, object]
    text: str
    options: Mapping[KeyPath, str]

    def where(self, path: KeyPath) -> str:
        """Place of a key for a message: ``file.yaml:14:9``, or the option that set it.

        A key that is not in the file is placed at the nearest key above it.
        """
        for length in range(len(path), 0, -1):
            if path[:length] in self.options:
                return self.options[path[:length]]
        marks = self._marks(path)
        if len(marks) < len(path):
            beneath = [text for key, text in self.options.items() if key[: len(path)] == path]
            if beneath:
                return beneath[0]
        return f"{self.name}:{_line_column(marks[-1] if marks else None)}"

    def position(self, path: KeyPath) -> str:
        """``line:column`` of a key (of the item, in a list), or of the nearest above it, counted from one."""
        marks = self._marks(path)
        return _line_column(marks[-1] if marks else None)

    def _marks(self, path: KeyPath) -> list[Any]:
        """Find the marks of the keys along the path, as far as they are in the file."""
        node, marks = yaml.compose(self.text, StrictLoader), []
        for key in path:
            found = _child(node, key)
            if found is None:
                break
            mark, node = found
            marks.append(mark)
        return marks


def load(path: Path) -> YamlDocument:
    """Read a YAML file whose root is a mapping.

    Raises
    ------
    InputError
        It is a directory, not UTF-8, empty, too long, not YAML, or not a mapping.
    NotFoundError
        There is no such file.
    """
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        meant = nearest(path.stem, {one.stem: str(one) for one in path.parent.glob("*.yaml")})
        raise NotFoundError(f"{path}: no such file{meant}") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory, a YAML file is needed") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"{path}: {len(raw)} bytes are too many for a YAML file, at most {MAX_BYTES} are read")
    try:
        return loads(raw.decode("utf-8"), str(path))
    except UnicodeDecodeError as error:
        place = _place(raw[: error.start].decode("utf-8"))
        raise InputError(f"{path}:{place}: byte 0x{raw[error.start]:02x} is not UTF-8 text") from None


def loads(text: str, name: str) -> YamlDocument:
    r"""Read YAML text whose root is a mapping; ``name`` stands for the file in messages.

    Examples
    --------
    >>> loads("friction: 1e-05", "a.yaml").data
    {'friction': 1e-05}
    >>> loads("a: 1\na: 2", "a.yaml")
    Traceback (most recent call last):
    slidepipe.errors.InputError: a.yaml:2:1: a: duplicate key, first given at line 1
    """
    data = parse_text(text, name)
    if data is None:
        raise InputError(f"{name}: is empty, a mapping of keys to values is needed")
    if not isinstance(data, dict):
        raise InputError(f"{name}:1:1: must be a mapping of keys to values, got {describe(data)}")
    return YamlDocument(name=name, data=data, text=text, options={})


def parse_text(text: str, name: str) -> object:
    """Value of YAML text, None where it is empty; ``name`` stands for the file in messages."""
    strange = _UNPRINTABLE.search(text)
    if strange:
        place = _place(text[: strange.start()])
        raise InputError(f"{name}:{place}: character U+{ord(strange.group()):04X} is not allowed in YAML")
    loader = StrictLoader(text)
    try:
        return loader.document()
    except yaml.MarkedYAMLError as error:
        place = _line_column(error.problem_mark or error.context_mark)
        raise InputError(f"{name}:{place}: {_problem(error, text)}") from None
    finally:
        loader.dispose()


def dump(data: object) -> str:
    """Write plain data as YAML: block style, keys in the order given, lists of a few numbers on one line.

    Examples
    --------
    >>> print(dump({"mass_kg": 1e-05, "origin_m": [0.5, 0.0, 0.3], "model": "yes"}), end="")
    mass_kg: 1.0e-05
    origin_m: [0.5, 0.0, 0.3]
    model: 'yes'
    """
    return str(
        yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120, default_flow_style=False)
    )


class _Dumper(yaml.CSafeDumper):
    """Writes what :class:`StrictLoader` reads back, and what a reader of YAML 1.1 does not mistake either."""

    def ignore_aliases(self, data: object) -> bool:  # noqa: ARG002  # aliases are not read, so none are written
        return True

    def number(self, data: float) -> yaml.ScalarNode:
        return self.represent_float(float(data))

    def whole(self, data: int) -> yaml.ScalarNode:
        return self.represent_int(int(data))

    def words(self, data: str) -> yaml.ScalarNode:
        text = str(data)
        return self.represent_scalar(STR, text, style=None if _plain_elsewhere(text) else "'")

    def items(self, data: Sequence[object]) -> yaml.SequenceNode:
        short = len(data) <= 8 and all(isinstance(item, int | float) for item in data)
        return self.represent_sequence("tag:yaml.org,2002:seq", data, flow_style=short)


_YAML_1_1 = yaml.resolver.Resolver()


@lru_cache(maxsize=4096)
def _plain_elsewhere(text: str) -> bool:
    """Whether a reader of YAML 1.1 takes this for text without quotes; keys come again and again."""
    resolve: Any = _YAML_1_1.resolve
    return bool(resolve(yaml.ScalarNode, text, (True, False)) == STR)


use_core_schema(_Dumper)
_Dumper.add_representer(str, _Dumper.words)
_Dumper.add_representer(list, _Dumper.items)
_Dumper.add_representer(tuple, _Dumper.items)
_Dumper.add_multi_representer(str, _Dumper.words)
_Dumper.add_multi_representer(float, _Dumper.number)
_Dumper.add_multi_representer(int, _Dumper.whole)


def _child(node: yaml.Node | None, key: str | int) -> tuple[Any, yaml.Node] | None:
    if isinstance(node, yaml.MappingNode):
        for key_node, value in node.value:
            if key_node.value == key:
                return key_node.start_mark, value
    if isinstance(node, yaml.SequenceNode) and isinstance(key, int) and key < len(node.value):
        return node.value[key].start_mark, node.value[key]
    return None


def _problem(error: yaml.MarkedYAMLError, text: str) -> str:
    mark = error.problem_mark
    line = text.splitlines()[mark.line : mark.line + 1] if mark else []
    if mark and "cannot start any token" in (error.problem or "") and line and line[0][mark.column :][:1] == "\t":
        return "a tab cannot indent YAML: use spaces"
    hint = next((hint for problem, hint in _HINTS.items() if problem in (error.problem or "")), None)
    if hint is None:
        return " ".join(part for part in (error.context, error.problem) if part)
    apart = error.context_mark is not None and _line_column(error.context_mark) != _line_column(mark)
    begun = f" in what begins at {_line_column(error.context_mark)}" if apart else ""
    return f"{error.problem}{begun}: {hint}"


_HINTS = {
    "mapping values are not allowed": "text with a colon needs quotes, a key its own line and a space after the colon",
    "could not find expected ':'": "a key needs a colon and a space after it",
    "did not find expected key": "the keys of a mapping begin in the same column, and a quote is closed on its line",
    "did not find expected ',' or": "a comma stands between entries, and a bracket closes them",
    "cannot start any token": "text that begins with such a character needs quotes",
    "unexpected end of stream": "a quote or bracket that was opened is not closed",
}
"""What is mostly the matter where the parser says this."""


def _line_column(mark: Any) -> str:
    return f"{mark.line + 1}:{mark.column + 1}" if mark else "1:1"


def _place(before: str) -> str:
    """``line:column`` of what follows this text."""
    return f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"
