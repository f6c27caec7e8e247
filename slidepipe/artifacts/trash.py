"""Where things go that are moved out of the way: ``trash/DAY/``, from where they can be moved back."""

import secrets
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from slidepipe.errors import StoreError


@dataclass(frozen=True, slots=True)
class Trash:
    """The trash of the store below ``root``."""

    root: Path

    def take(self, path: Path) -> Path:
        """Move a file or directory of the store into the trash by one rename; returns where it is now.

        Raises
        ------
        StoreError
            It cannot be moved.
        """
        day = self.root / "trash" / f"{datetime.now(UTC):%Y-%m-%d}"
        target = day / path.name
        while target.exists():
            target = day / f"{path.name}.{secrets.token_hex(4)}"
        try:
            day.mkdir(parents=True, exist_ok=True)
            path.rename(target)
        except OSError as error:
            raise StoreError(f"{path}: cannot be moved to {day}: {error.strerror}") from None
        return target
