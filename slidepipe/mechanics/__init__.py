"""The paper's physics: pure functions and frozen dataclasses on SI arrays, in the paper's own symbols."""

from slidepipe.mechanics.kernel_cache import keep_compiled_code, tell_compiling

keep_compiled_code()
tell_compiling()
