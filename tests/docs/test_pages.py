"""What the README and the docs tell a reader to type does what they say, in order, in a folder of its own."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
import yaml
from click.testing import CliRunner

from slidepipe.artifacts.lab import LabDocument
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.strict_yaml import dump, loads
from slidepipe.cli.main import cli
from tests.docs.reading import ROOT, Block, blocks, inline_code

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
RUN = [ROOT / "README.md", ROOT / "docs" / "tutorial.md", ROOT / "docs" / "hardware.md"]
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


@pytest.mark.parametrize("path", RUN, ids=lambda path: path.name)
def test_every_block(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(ROOT / "experiments", tmp_path / "experiments")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    names: dict[str, object] = {}
    printed = ""
    for block in blocks(path):
        match block.language:
            case "sh" if "dry" in block.options:
                check_words(block.text, block.place)
            case "sh":
                printed = run_shell(block)
            case "python":
                exec(compile(block.text, block.place, "exec"), names)  # noqa: S102  # our own page
            case "yaml" if "file" in block.options:
                Path(block.options["file"]).write_text(block.text, encoding="utf-8")
            case "yaml":
                check_part(block)
            case "text" if "output" in block.options:
                check_output(block, printed)


def run_shell(block: Block) -> str:
    """Do each line; slidepipe's own without a new process, which would spend its time on imports."""
    printed, code = "", 0
    for line in block.text.splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] == ["slidepipe"]:
            result = CliRunner().invoke(cli, words[1:])
            said, code = result.output, result.exit_code
        else:
            done = subprocess.run(["bash", "-c", line], check=False, capture_output=True, text=True)  # noqa: S603, S607
            said, code = done.stdout + done.stderr, done.returncode
        printed += said
        if code:
            break
    assert code == int(block.options.get("exit", "0")), f"{block.place}\n{printed}"
    return printed


def check_output(block: Block, printed: str) -> None:
    """Each line shown was printed, in order; numbers of a simulation may differ a little from machine to machine."""
    lines = iter(printed.splitlines())
    for shown in filter(None, block.text.splitlines()):
        assert any(alike(shown, line) for line in lines), f"{block.place}: {shown}\nis not in\n{printed}"


def alike(shown: str, line: str) -> bool:
    if _NUMBER.sub("#", " ".join(shown.split())) != _NUMBER.sub("#", " ".join(line.split())):
        return False
    pairs = zip(_NUMBER.findall(shown), _NUMBER.findall(line), strict=True)
    return all(abs(float(ours) - float(theirs)) <= 0.05 * abs(float(ours)) + 0.2 for ours, theirs in pairs)


def check_part(block: Block) -> None:
    """Part of a lab file that a page shows is right where it is put into the whole."""
    whole = yaml.safe_load(Path(block.options["merge"]).read_text(encoding="utf-8"))
    put_into(whole, yaml.safe_load(block.text))
    parse(LabDocument, loads(dump(whole), block.place))


def put_into(whole: dict[str, object], part: dict[str, object]) -> None:
    for key, value in part.items():
        below = whole.get(key)
        if isinstance(value, dict) and isinstance(below, dict):
            put_into(below, value)
        else:
            whole[key] = value


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_every_command_in_the_text_exists(path: Path) -> None:
    for text in inline_code(path):
        check_words(text, path.name)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_nothing_escapes(path: Path) -> None:
    """A block says what it is, and a page that has something to run is run."""
    for block in blocks(path):
        assert block.language in ("sh", "python", "yaml", "text"), block.place
        if block.language != "text":
            assert path in RUN or "dry" in block.options, block.place
            check_words(block.text, block.place)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_every_path_in_the_text_exists(path: Path) -> None:
    for text in inline_code(path):
        if re.fullmatch(r"(docs|experiments|slidepipe|benchmarks|tests|data/recorded)/[\w./-]*", text):
            assert (ROOT / text).exists() or (path.name == "hardware.md" and "NAME" in text), f"{path.name}: {text}"


def check_words(text: str, place: str) -> None:
    """Every make target, verb and option is there, without doing anything."""
    for target in re.findall(r"(?m)(?:^|`)make ([a-z-]+)", text):
        assert re.search(rf"(?m)^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8")), f"{place}: make {target}"
    for line in re.findall(r"(?m)(?:^|\$\(|`)slidepipe ([^`\n)]*)", text):
        for command, options in spoken(line):
            known = {name for option in command.params for name in option.opts} | {"--help", "-h", "--version"}
            assert not options - known, f"{place}: {command.name} has no {options - known}"


def spoken(line: str) -> Iterator[tuple[click.Command, set[str]]]:
    """Commands that a line means, ``plan|execute`` being two, each with the options it is given."""
    words = re.sub(r"#.*|'[^']*'|\"[^\"]*\"", "", line).replace("\\|", "|").split()
    options = {word.partition("=")[0] for word in words if word.startswith("-")}
    context = click.Context(cli)
    for verb in re.split(r"[|,]", words[0]) if words and not words[0].startswith("-") else []:
        command = cli.get_command(context, verb)
        assert command is not None, f"there is no slidepipe {verb}"
        below = command.get_command(context, words[1]) if isinstance(command, click.Group) and len(words) > 1 else None
        yield below or command, options
