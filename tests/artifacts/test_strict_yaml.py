import math
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from slidepipe.artifacts.strict_yaml import dump, load, loads
from slidepipe.errors import InputError, NotFoundError

SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text()
TREES = st.recursive(SCALARS, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=25)


def refused(text: str) -> str:
    with pytest.raises(InputError) as caught:
        loads(text, "f.yaml")
    assert len(caught.value.lines) == 1
    assert "\n" not in str(caught.value)
    return str(caught.value)


@settings(deadline=None)
@given(st.dictionaries(st.text(), TREES))
def test_dump_and_load_give_back_the_same(data):
    back = loads(dump(data), "f.yaml").data
    assert back == data
    assert repr(back) == repr(data)


@settings(deadline=None)
@given(st.dictionaries(st.text(st.characters(codec="ascii"), min_size=1), SCALARS, min_size=1))
def test_other_readers_take_text_for_text(data):
    words = {key: value for key, value in data.items() if isinstance(value, str)}
    back = yaml.load(dump(words), yaml.CSafeLoader)
    assert back == words


@settings(deadline=None)
@given(st.floats(allow_nan=False))
def test_floats_keep_every_bit(value):
    back = loads(dump({"a": value}), "f.yaml").data["a"]
    assert isinstance(back, float)
    assert math.copysign(1.0, back) == math.copysign(1.0, value)
    assert back == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-05", 1e-05), ("1E5", 1e5), ("5.", 5.0), (".5", 0.5), ("-.inf", -math.inf),
        ("0123", 123), ("+5", 5), ("0x1F", 31), ("0o17", 15), ("0b1", "0b1"), ("1_000", "1_000"),
        ("12:30:45", "12:30:45"), ("2026-11-23", "2026-11-23"), ("2026-11-23T09:30:12Z", "2026-11-23T09:30:12Z"),
        ("yes", "yes"), ("no", "no"), ("on", "on"), ("off", "off"), ("y", "y"), ("TRUE", True), ("false", False),
        ("~", None), ("", None), ("'1'", "1"), ("=", "="), ("<<", "<<"),
    ],
)  # fmt: skip
def test_plain_scalars(text, value):
    got = loads(f"a: {text}", "f.yaml").data["a"]
    assert got == value
    assert type(got) is type(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "f.yaml: is empty, a mapping of keys to values is needed"),
        ("# nothing\n", "f.yaml: is empty, a mapping of keys to values is needed"),
        ("- 1", "f.yaml:1:1: must be a mapping of keys to values, got a list"),
        ("a: 1\nb: {c: 2, c: 3}", "f.yaml:2:11: c: duplicate key, first given at line 2"),
        ("a: 1\n\na: 2", "f.yaml:3:1: a: duplicate key, first given at line 1"),
        ("1: 2", "f.yaml:1:1: a key must be text, got 1"),
        ("a: &x [1]\nb: *x", "f.yaml:2:4: alias *x is not allowed: write the value out"),
        ("a: !!python/name:os.system", ("f.yaml:1:4: tag tag:yaml.org,2002:python/name:os.system is not allowed: "
         "write the value plainly")),
        ("a: 1\n---\nb: 2", "f.yaml:2:1: a second document begins here, one is allowed"),
        ("a: [1\nb: 2",
         ("f.yaml:2:2: did not find expected ',' or ']' in what begins at 1:4: a comma stands between entries, and a "
         "bracket closes them")),
        ("a: {b: 0,1, c: 2}", "f.yaml:1:10: a key must be text, got 1: a number has a point, not a comma"),
        ("a: 1\nb:2\nc: 3", ("f.yaml:3:1: could not find expected ':' in what begins at 2:1: a key needs a colon and a "
         "space after it")),
        ("a: @b", ("f.yaml:1:4: found character that cannot start any token: text that begins with such a "
         "character needs quotes")),
        ("a:\n  b: 1\n c: 2", ("f.yaml:3:2: did not find expected key in what begins at 1:1: the keys of a mapping "
         "begin in the same column, and a quote is closed on its line")),
        ("a: 'x", ("f.yaml:1:6: found unexpected end of stream in what begins at 1:4: a quote or bracket "
         "that was opened is not closed")),
        ("a: b: c", ("f.yaml:1:5: mapping values are not allowed in this context: text with a colon needs quotes, "
         "a key its own line and a space after the colon")),
        ("a: 1\nb: \x07", "f.yaml:2:4: character U+0007 is not allowed in YAML"),
        ("a: " + "9" * 5000, f"f.yaml:1:4: '{'9' * 56}... is too long for a number"),
        ("[" * 900, "f.yaml:1:34: nested deeper than 32 levels"),
        ("{a: " * 100_000, "f.yaml:1:130: nested deeper than 32 levels"),
    ],
)  # fmt: skip
def test_messages(text, message):
    assert refused(text) == message


@settings(deadline=None)
@given(st.text(alphabet="ab1:,[]{}-'\"\n #&*!|>%@\t?.~"))
def test_any_text_is_read_or_refused_in_one_line(text):
    try:
        loads(text, "f.yaml")
        said = "nothing"
    except InputError as error:
        said = str(error)
    assert "\n" not in said


def test_files_that_cannot_be_read(tmp_path: Path):
    with pytest.raises(InputError) as directory:
        load(tmp_path)
    assert str(directory.value) == f"{tmp_path}: is a directory, a YAML file is needed"
    with pytest.raises(NotFoundError) as missing:
        load(tmp_path / "a.yaml")
    assert str(missing.value) == f"{tmp_path / 'a.yaml'}: no such file"
    path = tmp_path / "b.yaml"
    path.write_bytes("ä: 1\nb: ".encode() + b"\xff")
    with pytest.raises(InputError) as coded:
        load(path)
    assert str(coded.value) == f"{path}:2:4: byte 0xff is not UTF-8 text"
    path.write_bytes(b"a: " + b"x" * 2**22)
    with pytest.raises(InputError, match="bytes are too many for a YAML file, at most 4194304 are read"):
        load(path)


def test_positions_are_those_of_the_keys():
    document = loads("a:\n  b: {c: 1, d: [5, 6]}\n", "f.yaml")
    assert document.position(()) == "1:1"
    assert document.position(("a", "b")) == "2:3"
    assert document.position(("a", "b", "d")) == "2:13"
    assert document.position(("a", "b", "d", 1)) == "2:20"
    assert document.position(("a", "b", "missing")) == "2:3"
    assert document.where(("a", "b", "c")) == "f.yaml:2:7"


def test_layout_of_what_is_written():
    data = {"z": [1, 2.5], "a": {"name": "x", "long": list(range(9)), "mixed": ["b", 1]}, "on": "off", "e": []}
    assert dump(data) == (
        "z: [1, 2.5]\na:\n  name: x\n  long:\n  - 0\n  - 1\n  - 2\n  - 3\n  - 4\n  - 5\n  - 6\n  - 7\n  - 8\n"
        "  mixed:\n  - b\n  - 1\n'on': 'off'\ne: []\n"
    )
