"""The command line: words around the stages, and nothing else."""
