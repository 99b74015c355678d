"""The command line, called from a test."""

from __future__ import annotations

from click.testing import Result
from typer.testing import CliRunner

from clast.cli.commands import app


def clast_command(*arguments: object) -> Result:
    """Return what a command leaves: exit code, stdout, stderr."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def good(*arguments: object) -> str:
    """Return what a command prints that must not fail."""
    result = clast_command(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


def without_compilation(stderr: str) -> str:
    """Return what a command says but for what it compiles, which depends on what ran before."""
    lines = stderr.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(("compiling ", "compiled ")))
