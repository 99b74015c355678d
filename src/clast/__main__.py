"""``python -m clast`` is the same as ``clast``."""

from clast.cli.commands import main

if __name__ == "__main__":
    main()
