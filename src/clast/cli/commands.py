"""The command line: its commands, how their errors end, and the exit codes.

Only this folder prints.
"""

from __future__ import annotations

import atexit
import gc
import itertools
import re
import signal
import warnings
from collections.abc import Callable
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from clast.cli import (
    case_commands,
    comparison_commands,
    editing,
    importing,
    result_commands,
    rock_masses,
    study_commands,
)
from clast.cli.terminal import BAD_INPUT, SIGNALLED, STOPPED, say
from clast.errors import ClastError, RunStopped, RunWarning, shortened
from clast.spelling import visible

USAGE_ERROR: Any = typer.BadParameter.__base__
"""The error that the parser of the command line raises."""


class Commands(TyperGroup):
    """Commands whose errors end as one message on stderr and an exit code."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the commands in groups."""
        width = formatter.width - 16
        for group, commands in GROUPS.items():
            names = [one.__name__.rstrip("_") for one in commands]
            names += ["study"] if group == "Study" else []
            with formatter.section(group):
                listed = [(name, self.get_command(ctx, name)) for name in names]
                formatter.write_dl(
                    [(name, one.get_short_help_str(width)) for name, one in listed if one]
                )

    def invoke(self, ctx: Any) -> Any:
        """Run a command; say its errors."""
        try:
            with warnings.catch_warnings():
                # commands say themselves what a run warns of
                warnings.simplefilter("ignore", RunWarning)
                return super().invoke(ctx)
        except RunStopped as stopped:
            say(f"stopped: {stopped}")
            raise typer.Exit(STOPPED) from None
        except ClastError as error:
            say(f"error: {error}")
            raise typer.Exit(BAD_INPUT) from None
        except USAGE_ERROR as error:
            message = error.message.replace("Value error, ", "")
            message = re.sub(r"Input should be ([^,]+).*", r"it must be \1", message)
            error.message = visible(shortened(message, 200))
            raise
        except BrokenPipeError:
            raise
        except OSError as error:
            say(f"error: {shortened(str(error.filename or 'a file'), 200)}: {error.strerror}")
            raise typer.Exit(BAD_INPUT) from None
        except (KeyboardInterrupt, SystemError) as error:
            # Python makes a SystemError of the key where numba is loading a kernel
            key = error.__cause__ if isinstance(error, SystemError) else error
            if not isinstance(key, KeyboardInterrupt):
                raise
            say("interrupted")
            raise typer.Exit(SIGNALLED + int(getattr(key, "number", signal.SIGINT))) from None


app = typer.Typer(
    cls=Commands,
    help="Discontinuous deformation analysis of rock and masonry blocks in two dimensions.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich is loaded by commands that print tables, not by --help
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        import clast

        typer.echo(f"clast {clast.__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Discontinuous deformation analysis of rock and masonry blocks in two dimensions."""


GROUPS: dict[str, tuple[Callable[..., None], ...]] = {
    "Make": (
        *(case_commands.new, importing.import_, rock_masses.cut),
        *(editing.edit, case_commands.check, case_commands.schema),
    ),
    "Run": (case_commands.run, case_commands.resume),
    "Look": (
        *(result_commands.info, result_commands.plot, result_commands.film),
        *(result_commands.page, result_commands.report, result_commands.export),
    ),
    "Study": (case_commands.compare, study_commands.rockfall),
    "Maintain": (comparison_commands.verify, comparison_commands.warmup),
}
"""Commands as clast --help groups them; study is a group of its own commands."""
for command in itertools.chain(*GROUPS.values()):
    app.command(command.__name__.rstrip("_"))(command)  # import is a word of Python
app.add_typer(study_commands.app, name="study")


def main() -> None:
    """Run the command line."""
    # the collector would go through all that has been loaded, which is not garbage, again and
    # again: a tenth of the time until the first step, and as long as a fifth of it at the end
    gc.set_threshold(20_000, 50, 100)
    atexit.register(gc.freeze)
    app(prog_name="clast")
