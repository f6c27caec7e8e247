"""Builds plain data from YAML's events, strictly."""

from typing import Any

import yaml

from slidepipe.artifacts.wording import describe
from slidepipe.artifacts.yaml_scalars import STR, scalar, use_core_schema

MAX_DEPTH = 32


class StrictLoader(yaml.CSafeLoader):
    """Reads one document of mappings with text keys, lists and plain scalars.

    Not by PyYAML's own composer: that one lets a duplicate key win, follows aliases, and overruns the stack of the
    process on deeply nested input.
    """

    def document(self) -> object:
        """Value of the one document, None where there is none; raises yaml.MarkedYAMLError."""
        self._take()
        if self.check_event(yaml.StreamEndEvent):
            return None
        self._take()
        data = self._value(0)
        self._take()
        if not self.check_event(yaml.StreamEndEvent):
            raise _fault("a second document begins here, one is allowed", self.peek_event())
        return data

    def _take(self) -> Any:
        return self.get_event()

    def _value(self, depth: int) -> object:
        event = self._take()
        if depth > MAX_DEPTH:
            raise _fault(f"nested deeper than {MAX_DEPTH} levels", event)
        if isinstance(event, yaml.AliasEvent):
            raise _fault(f"alias *{event.anchor} is not allowed: write the value out", event)
        if event.tag is not None:
            raise _fault(f"tag {event.tag} is not allowed: write the value plainly", event)
        if isinstance(event, yaml.MappingStartEvent):
            return self._mapping(depth)
        if isinstance(event, yaml.SequenceStartEvent):
            return self._sequence(depth)
        return self._scalar(event)

    def _mapping(self, depth: int) -> dict[str, object]:
        data: dict[str, object] = {}
        lines: dict[str, int] = {}
        while not self.check_event(yaml.MappingEndEvent):
            event: Any = self.peek_event()
            key = self._value(depth + 1)
            if not isinstance(key, str):
                alone = getattr(self.peek_event(), "value", None) == ""
                comma = ": a number has a point, not a comma" if alone and isinstance(key, int) else ""
                raise _fault(f"a key must be text, got {describe(key)}{comma}", event)
            if key in data:
                raise _fault(f"{key}: duplicate key, first given at line {lines[key]}", event)
            lines[key] = event.start_mark.line + 1
            data[key] = self._value(depth + 1)
        self._take()
        return data

    def _sequence(self, depth: int) -> list[object]:
        data: list[object] = []
        while not self.check_event(yaml.SequenceEndEvent):
            data.append(self._value(depth + 1))
        self._take()
        return data

    def _scalar(self, event: Any) -> object:
        resolve: Any = self.resolve
        tag = resolve(yaml.ScalarNode, event.value, event.implicit) if event.implicit[0] else STR
        try:
            return scalar(tag, event.value)
        except ValueError:
            raise _fault(f"{describe(event.value)} is too long for a number", event) from None


def _fault(problem: str, event: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)


use_core_schema(StrictLoader)
