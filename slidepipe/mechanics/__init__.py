"""The paper's physics: pure functions and frozen dataclasses on SI arrays, in the paper's own symbols."""
