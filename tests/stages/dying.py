"""Work that ends its own process the first time it is done, as a machine that fails would."""

import os
import signal
from pathlib import Path


def square_and_die_once(task: tuple[int, str]) -> int:
    """Square of a number; the process that first meets number 3 is killed."""
    number, marker = task
    if number == 3 and not Path(marker).exists():
        Path(marker).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def always_die(_: int) -> int:
    """Kill the process that works on it."""
    os.kill(os.getpid(), signal.SIGKILL)
    return 0
