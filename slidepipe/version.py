"""The version, where everything can read it without importing anything else."""

VERSION = "0.1.0"
