from pathlib import Path

import pytest

from slidepipe.figures.sheet import Sheet


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Sheet]:
    """Sheets that were drawn, each after it was written to its file."""
    sheets: list[Sheet] = []
    save = Sheet.save

    def keep(self: Sheet, path: Path) -> None:
        save(self, path)
        sheets.append(self)

    monkeypatch.setattr(Sheet, "save", keep)
    return sheets
