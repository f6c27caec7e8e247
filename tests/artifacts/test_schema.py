import json
import re
from typing import ClassVar

import pytest

from slidepipe.artifacts import schema
from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.json_schema import json_schema
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.schema import Artifact, Record, dump_model, parse
from slidepipe.artifacts.shapes import IN_WORDS
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.errors import InputError, NewerSchemaError


class Part(Record):
    mass_kg: float
    label: str | None = None


class Thing(Artifact):
    SCHEMA: ClassVar[str] = "slidepipe.thing"
    VERSION: ClassVar[int] = 3

    part: Part
    parts: tuple[Part, ...] = ()
    turns: tuple[float, float] | None = None


def thing(text: str) -> Thing:
    return parse(Thing, loads(f"schema: slidepipe.thing/3\n{text}", "t.yaml"))


def refused(text: str) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        thing(text)
    return caught.value.lines


def test_whole_numbers_stand_for_numbers_and_come_back_equal():
    made = thing("part: {mass_kg: 1}\nparts: [{mass_kg: 2, label: x}]\nturns: [1, 2.5]")
    assert made == Thing(part=Part(mass_kg=1.0), parts=(Part(mass_kg=2.0, label="x"),), turns=(1.0, 2.5))
    assert isinstance(made.part.mass_kg, float)
    assert parse(Thing, loads(dump_model(made), "t.yaml")) == made


def test_all_faults_at_once_each_with_its_place():
    text = "part:\n  mas_kg: 1\nparts:\n- {mass_kg: .nan}\n- {mass_kg: true, label: 3, colour: red}\nturns: [1]\nx: 1"
    assert refused(text) == (
        "t.yaml:2:1: part.mass_kg: required key is missing",
        "t.yaml:3:3: part.mas_kg: unknown key, did you mean mass_kg?",
        "t.yaml:5:4: parts[0].mass_kg: must be a finite number of kg, got nan",
        "t.yaml:6:4: parts[1].mass_kg: must be a number of kg, got true",
        "t.yaml:6:19: parts[1].label: must be text, got 3",
        "t.yaml:6:29: parts[1].colour: unknown key, allowed are mass_kg, label",
        "t.yaml:7:1: turns: must have 2 entries, got 1",
        "t.yaml:8:1: x: unknown key, allowed are part, parts, turns",
    )


def test_kinds_of_values():
    assert refused("part: [1]") == ("t.yaml:2:1: part: must be a mapping of keys to values, got a list",)
    assert refused("part: ~") == ("t.yaml:2:1: part: must be a mapping of keys to values, got nothing",)
    assert refused("part: {mass_kg: 1}\nparts: 3") == ("t.yaml:3:1: parts: must be a list, got 3",)
    assert refused("part: {mass_kg: '1'}") == ("t.yaml:2:8: part.mass_kg: must be a number of kg, got '1'",)
    assert refused("part: {mass_kg: 1}\nturns: [1, 2, 3]") == ("t.yaml:3:1: turns: must have 2 entries, got 3",)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("", "t.yaml:1:1: schema: required key is missing, it must be slidepipe.thing/3"),
        ("schema: slidepipe.plan/1", "t.yaml:1:1: schema: must be slidepipe.thing/3, got 'slidepipe.plan/1'"),
        ("schema: thing", "t.yaml:1:1: schema: must be slidepipe.thing/3, got 'thing'"),
        ("schema: 3", "t.yaml:1:1: schema: must be slidepipe.thing/3, got 3"),
        ("schema: slidepipe.thing/0", "t.yaml:1:1: schema: must be slidepipe.thing/3, got 'slidepipe.thing/0'"),
    ],
)
def test_other_schemas(header, message):
    with pytest.raises(InputError) as caught:
        parse(Thing, loads(f"{header}\npart: {{mass_kg: 1}}", "t.yaml"))
    assert caught.value.lines == (message,)


def test_newer_versions_are_refused():
    with pytest.raises(NewerSchemaError) as caught:
        parse(Thing, loads("schema: slidepipe.thing/4", "t.yaml"))
    assert str(caught.value) == (
        "t.yaml:1:1: schema: slidepipe.thing/4 was written by a newer slidepipe, this one reads slidepipe.thing/3"
    )


def test_older_versions_are_brought_up_one_by_one(monkeypatch):
    steps = {
        ("slidepipe.thing", 1): lambda data: {"part": {"mass_g": data["mass_g"]}},
        ("slidepipe.thing", 2): lambda data: {"part": {"mass_kg": data["part"]["mass_g"] / 1000}},
    }
    monkeypatch.setattr(schema, "UPCASTS", steps)
    document = loads("schema: slidepipe.thing/1\nmass_g: 23", "t.yaml")
    assert parse(Thing, document) == Thing(part=Part(mass_kg=0.023))
    assert document.data == {"schema": "slidepipe.thing/1", "mass_g": 23}


def set_over(*overrides: str) -> Thing:
    document = loads("schema: slidepipe.thing/3\npart: {mass_kg: 1}", "t.yaml")
    made = parse(Thing, apply_overrides(document, overrides))
    assert document.data == {"schema": "slidepipe.thing/3", "part": {"mass_kg": 1}}
    return made


def test_overrides_are_yaml_and_the_last_wins():
    made = set_over("part.mass_kg=1", "part.mass_kg=1e-05", "part.label='1'", "turns=[1, 2]")
    assert made == Thing(part=Part(mass_kg=1e-05, label="1"), turns=(1.0, 2.0))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("part.mass=1", "--set part.mass=1: part.mass: unknown key, did you mean mass_kg?"),
        ("prat.mass_kg=1", "--set prat.mass_kg=1: prat: unknown key, did you mean part?"),
        ("part.mass_kg=x", "--set part.mass_kg=x: part.mass_kg: must be a number of kg, got 'x'"),
        ("part.mass_kg=", "--set part.mass_kg=: part.mass_kg: must be a number of kg, got nothing"),
        ("part={label: x}", "--set part={label: x}: part.mass_kg: required key is missing"),
        ("part.mass_kg.x=", "--set part.mass_kg.x=: part.mass_kg has no keys to set, it is 1: set part.mass_kg itself"),
        ("part.mass_kg", "--set part.mass_kg: must read key=value or key.key=value"),
        ("part..x=1", "--set part..x=1: must read key=value or key.key=value"),
        ("turns=[1", ("--set turns=[1: value:2:1: did not find expected ',' or ']' in what begins at 1:1: "
         "a comma stands between entries, and a bracket closes them")),
        ("schema=slidepipe.plan/1", ("--set schema=slidepipe.plan/1: schema: must be slidepipe.thing/3, "
         "got 'slidepipe.plan/1'")),
    ],
)  # fmt: skip
def test_overrides_that_are_refused(override, message):
    with pytest.raises(InputError) as caught:
        set_over(override)
    assert caught.value.lines == (message,)


def test_an_override_of_a_whole_mapping_forgets_those_below():
    with pytest.raises(InputError) as caught:
        set_over("part.mass_kg=2", "part={mass_kg: x}")
    assert caught.value.lines == ("--set part={mass_kg: x}: part.mass_kg: must be a number of kg, got 'x'",)


def test_every_pattern_is_told_in_words():
    patterns = set(
        re.findall(r'"pattern": ("[^\n]*"),?\n', json.dumps([json_schema(one) for one in DOCUMENTS], indent=1))
    )
    assert patterns
    assert {json.loads(pattern) for pattern in patterns} <= set(IN_WORDS)
