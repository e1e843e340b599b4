"""The commands by name."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

import palpate
from palpate.cli.bundled import parts
from palpate.cli.console import PROGRAM
from palpate.cli.demo import demo
from palpate.cli.experiment import experiment
from palpate.cli.identify import identify, replay
from palpate.cli.models import models
from palpate.cli.plan import plan
from palpate.cli.recognize import recognize
from palpate.cli.tune import tune
from palpate.cli.view import view


class _HelpIsAFlag:
    """Lists `--help` as the flag that it is, without a type."""

    def get_help_option(self, ctx: Any) -> Any:
        option = super().get_help_option(ctx)  # type: ignore[misc]
        if option is not None:
            option.metavar = ""
        return option


class _Command(_HelpIsAFlag, TyperCommand):
    """A command; what it refuses is called by its flag where it has one of that name."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except ValueError as error:
            name, colon, rest = str(error).partition(":")
            flags = {str(one.name): one.opts[0] for one in self.params if one.opts[0].startswith("--")}
            if name not in flags:
                raise
            raise ValueError(flags[name] + colon + rest) from None


class _Group(_HelpIsAFlag, TyperGroup):
    """The commands by name."""


app = typer.Typer(
    name=PROGRAM,
    cls=_Group,
    help="Recognize and localize a known part by touch: every part and pose that explains a few contacts, "
    "and the next touch.",
    epilog="Example: palpate demo",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

app.command(cls=_Command, epilog="Example: palpate demo --part boot --seed 3 --out boot")(demo)
app.command(
    cls=_Command, epilog="Example: palpate recognize boot parts/ --contacts touches.csv --plot found.svg"
)(recognize)
app.command(cls=_Command, epilog="Example: palpate plan boot camera --contacts touches.csv --plot next.svg")(
    plan
)
app.command(
    cls=_Command,
    epilog="Example: palpate identify boot camera --probe sim --truth boot --pose 10,20,30 --plot run.svg",
)(identify)
app.command(cls=_Command, epilog="Example: palpate replay run.jsonl --plot pictures")(replay)
app.command(cls=_Command, epilog="Example: palpate view boot camera --contacts boot")(view)
app.command(cls=_Command, epilog="Example: palpate experiment all --cluster local --out thesis")(experiment)
app.command(cls=_Command, epilog="Example: palpate models boot bracket.dxf --plot models.svg")(models)
app.command(cls=_Command, epilog="Example: palpate parts --json")(parts)
app.command(cls=_Command, epilog="Example: palpate tune boot camera telephone --problems 100")(tune)


def _print_version(wanted: bool) -> None:
    if wanted:
        # Read from the compiled core: that it can be printed proves that the core loads.
        typer.echo(f"{PROGRAM} {palpate.__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def without_command(
    context: typer.Context,
    *,
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            metavar="",
            help="Print the version and exit.",
        ),
    ] = False,
) -> None:
    """Print the help if there is no command."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
