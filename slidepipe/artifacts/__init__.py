"""What is kept: schemas and their versions, strict YAML, recordings, the run store and provenance."""
