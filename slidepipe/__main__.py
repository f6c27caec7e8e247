"""Run the command line with ``python -m slidepipe``."""

from slidepipe.cli.main import main

if __name__ == "__main__":
    main()
