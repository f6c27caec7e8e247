"""How documents are shown to a person: tables and lines for :mod:`slidepipe.cli.render` to print."""
