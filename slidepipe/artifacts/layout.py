"""Which layout a store has: ``store.yaml``. Loads YAML and pydantic only where there is something to complain of."""

from pathlib import Path

from slidepipe.artifacts.durable import whole
from slidepipe.errors import InputError, StoreError

NAME = "store.yaml"
TEXT = "schema: slidepipe.store/1\n"


def check_layout(root: Path) -> None:
    """Make sure that a directory may be used as a store.

    Raises
    ------
    InputError
        It is a file.
    NewerSchemaError
        A newer slidepipe made the store.
    StoreError
        ``store.yaml`` is damaged.
    """
    if root.exists() and not root.is_dir():
        raise InputError(f"{root}: is a file, the store is a directory")
    path = root / NAME
    if not path.exists() or path.read_bytes() == TEXT.encode():
        return
    from slidepipe.artifacts.documents import StoreDocument  # noqa: PLC0415
    from slidepipe.artifacts.schema import parse  # noqa: PLC0415
    from slidepipe.artifacts.strict_yaml import load  # noqa: PLC0415

    try:
        parse(StoreDocument, load(path))
    except InputError as error:
        raise StoreError(error.lines[0]) from None


def write_layout(root: Path) -> None:
    """Say which layout this is, where nobody has said so yet."""
    path = root / NAME
    if path.exists():
        return
    with whole(path, StoreError) as draft:
        draft.write_text(TEXT, encoding="utf-8")
