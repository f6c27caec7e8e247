"""Which plain scalars of a YAML file are numbers, booleans or nothing: the core schema of YAML 1.2, and no more.

PyYAML follows YAML 1.1, where ``yes`` is a boolean, ``12:30:45`` is 45045, ``0123`` is 83, ``2026-11-23`` is a date and
``1e-05`` is text. Here ``1e-05`` is a number, ``0123`` is 123 and the rest is text.
"""

import re

import yaml

NULL, BOOL, INT, FLOAT, STR = (f"tag:yaml.org,2002:{name}" for name in ("null", "bool", "int", "float", "str"))

_PLAIN = (
    (NULL, r"^(?:~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    (BOOL, r"^(?:true|True|TRUE|false|False|FALSE)$", list("tTfF")),
    (INT, r"^(?:[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)$", list("-+0123456789")),
    (
        FLOAT,
        r"^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$",
        list("-+0123456789."),
    ),
)


def use_core_schema(cls: type[yaml.CSafeLoader] | type[yaml.CSafeDumper]) -> None:
    """Let a loader or dumper class tell plain scalars apart as YAML 1.2 does."""
    cls.yaml_implicit_resolvers = {}
    for tag, pattern, first in _PLAIN:
        cls.add_implicit_resolver(tag, re.compile(pattern), first)


def scalar(tag: str, text: str) -> object:
    """Value of a plain scalar that :func:`use_core_schema` gave this tag.

    Raises
    ------
    ValueError
        An integer of more digits than Python converts.

    Examples
    --------
    >>> scalar(FLOAT, "1e-05"), scalar(INT, "0123"), scalar(INT, "0x1f"), scalar(BOOL, "True")
    (1e-05, 123, 31, True)
    """
    if tag == NULL:
        return None
    if tag == BOOL:
        return text.lower() == "true"
    if tag == INT:
        return int(text, {"0x": 16, "0o": 8}.get(text[:2], 10))
    if tag == FLOAT:
        return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
    return text
