"""The stages: each reads artifacts, calls the rooms below, and writes one run; ``run(request) -> result``."""
