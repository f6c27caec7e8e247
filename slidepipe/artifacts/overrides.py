"""Values set from outside a file: ``--set object.mass_kg=0.03``."""

import copy
from collections.abc import Iterable
from dataclasses import replace

from slidepipe.artifacts.faults import key_text
from slidepipe.artifacts.strict_yaml import KeyPath, YamlDocument, parse_text
from slidepipe.artifacts.wording import describe
from slidepipe.errors import InputError


def apply_overrides(document: YamlDocument, overrides: Iterable[str]) -> YamlDocument:
    """Document with ``key.key=value`` set; the last one wins where two set the same.

    The value is YAML. That a key is known is found when the document is validated; the message then names the option.

    Raises
    ------
    InputError
        An override has no ``=``, its value is not YAML, or its path leads through something that is not a mapping.

    Examples
    --------
    >>> from slidepipe.artifacts.strict_yaml import loads
    >>> apply_overrides(loads("{friction: 0.4, lab: {seed: 1}}", "a.yaml"), ["friction=1e-1", "lab.seed=2"]).data
    {'friction': 0.1, 'lab': {'seed': 2}}
    """
    data, options = copy.deepcopy(document.data), dict(document.options)
    for override in overrides:
        option = f"--set {override}"
        path, value = _split(override, option)
        _put(data, path, value, option)
        options = {key: text for key, text in options.items() if key[: len(path)] != path}
        options[path] = option
    return replace(document, data=data, options=options)


def _split(override: str, option: str) -> tuple[KeyPath, object]:
    key, equals, text = override.partition("=")
    path = tuple(part.strip() for part in key.split("."))
    if not equals or not all(path):
        raise InputError(f"{option}: must read key=value or key.key=value")
    try:
        return path, parse_text(text, "value")
    except InputError as error:
        raise InputError(f"{option}: {error}") from None


def _put(data: dict[str, object], path: KeyPath, value: object, option: str) -> None:
    here = data
    for depth, key in enumerate(path[:-1], start=1):
        below = here.setdefault(str(key), {})
        if not isinstance(below, dict):
            name = key_text(path[:depth])
            raise InputError(f"{option}: {name} has no keys to set, it is {describe(below)}: set {name} itself")
        here = below
    here[str(path[-1])] = value
