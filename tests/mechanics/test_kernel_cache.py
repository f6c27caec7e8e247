"""Compiled code without a place to keep it."""

from pathlib import Path

import numba
import pytest
from numba.core import event

from slidepipe.mechanics import kernel_cache


def test_without_a_place_for_compiled_code_a_run_has_its_own_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere() -> None:
        raise RuntimeError("cannot cache function: no locator available")

    monkeypatch.setattr(kernel_cache, "_probe", nowhere)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    with pytest.warns(RuntimeWarning, match=r"^compiled code cannot be kept in .*mechanics or .* set NUMBA_CACHE_DIR"):
        kernel_cache.keep_compiled_code()
    assert Path(numba.config.CACHE_DIR).is_dir()


def test_with_a_place_nothing_is_said_or_changed() -> None:
    before = numba.config.CACHE_DIR
    kernel_cache.keep_compiled_code()
    assert before == numba.config.CACHE_DIR


def test_compiling_is_told_once(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO", logger="slidepipe.kernels")
    assert numba.njit(lambda x: x + 1)(1) == 2
    caplog.clear()  # of what this process may not have said before
    with event.install_listener("numba:compile", kernel_cache.Compiling()):
        for _ in range(2):
            assert numba.njit(lambda x: x + 1)(1) == 2
    assert [one.getMessage() for one in caplog.records] == [
        "compiling what is compiled once, at the first use: this may take two minutes"
    ]
