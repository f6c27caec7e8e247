"""Dynamic in-hand sliding: plan, execute, estimate, iterate."""

__version__ = "0.1.0"
