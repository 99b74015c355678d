"""Write the stub of scripts, src/clast/case/script.pyi, from the declarations of inputs.

    python tools/script_stub.py

Editors and mypy read it for the arguments of ``ModelBuilder``, ``simulate`` and ``Stage``, with
types, units and sentences.  A test compares it with what this writes.
"""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from clast.case.api import ModelBuilder
from clast.case.script import Stage, simulate
from clast.inputs.builder import InputBuilder
from clast.inputs.declaring.arguments import arguments_of, meanings_of
from clast.inputs.declaring.builder_methods import singles
from clast.inputs.stages import StageTable

STUB = Path(__file__).parents[1] / "src" / "clast" / "case" / "script.pyi"
HEAD = '''\
"""The names of scripts, written by tools/script_stub.py from the declarations of inputs."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from numpy.typing import NDArray

from clast.actions.action import Action
from clast.block.rotation import RotationRule
from clast.case.case_file import Case
from clast.contact.corner_rules import CornerRule
from clast.contact.laws import ContactLaw
from clast.inputs.placing.place_blocks import Vector
from clast.linear.solvers import LinearSolver
from clast.model.model import Bools, Floats, Ints, Model, Plane
from clast.model.stages import Stage as _Stage
from clast.results import Run, RunRecorder
from clast.run.schedule import Progress, Schedule
from clast.step.integration import Integrator
from clast.step.method import Method, StepProcess

Pair = tuple[float, float] | list[float] | NDArray[Any]
"""Two numbers."""
Triple = tuple[float, float, float] | list[float] | NDArray[Any]
"""Three numbers."""
Numbers = Sequence[float] | NDArray[Any]
"""Any number of numbers."""
Points = Sequence[Pair] | NDArray[Any]
"""Points [x, y], shape (n, 2)."""
Names = tuple[str, ...] | list[str]
"""Names, not one name."""
Strengths = Mapping[str, Mapping[str, float]]

'''
WIDER = {
    "tuple[float, float]": "Pair",
    "tuple[float, float, float]": "Triple",
    "tuple[Pair, Pair]": "Points",
    "list[Pair]": "Points",
    "list[float]": "Numbers",
    "list[str]": "Names",
    "tuple[str, ...]": "Names",
    "tuple[str, str]": "Names",
    "model_builder.InputBuilder": "ModelBuilder",
}
"""Type of a case file, or of the package -> what a script may give."""
ATTRIBUTES = {
    "plane": 'Literal["stress", "strain"] | Plane',
    "gravity_amplitude": "str | None",
    "title": "str",
    "actions": "list[Any]",
    "line_joints": "list[str]",
}
"""Attribute of a builder -> its type; others are two numbers, or tables or objects."""


def wider(text: str) -> str:
    """Return an annotation with the types that a script may give."""
    for narrow, wide in WIDER.items():
        text = text.replace(narrow, wide)
    return re.sub(r"\blist\[", "Sequence[", text)


def argument(one: inspect.Parameter) -> str:
    """Return an argument as a stub writes it."""
    star = "**" if one.kind is one.VAR_KEYWORD else ""
    typed = "" if one.annotation is one.empty else f": {wider(str(one.annotation))}"
    if one.default is one.empty:
        return f"{star}{one.name}{typed}"
    simple = isinstance(one.default, str | bool | int | float | None)
    return f"{star}{one.name}{typed} = {one.default!r}" if simple else f"{one.name}{typed} = ..."


def function(name: str, taker: Any, indent: str = "") -> str:
    """Return a function or method with its arguments and docstring."""
    signature = inspect.signature(taker)
    arguments, is_named = [], False
    for one in signature.parameters.values():
        if one.kind is one.KEYWORD_ONLY and not is_named:
            arguments.append("*")
            is_named = True
        arguments.append(argument(one))
    head = f"{indent}def {name}({', '.join(arguments)}) -> {wider(signature.return_annotation)}:\n"
    return head + docstring(taker.__doc__, indent + "    ") + f"{indent}    ...\n\n"


def docstring(text: str | None, indent: str) -> str:
    """Return a docstring as source."""
    lines = inspect.cleandoc(text or "").replace("\\", "\\\\").splitlines()
    body = "\n".join(f"{indent}{line}" if line else "" for line in lines).strip()
    end = f"\n{indent}" if "\n" in body else ""
    return f'{indent}"""{body}{end}"""\n'


def builder() -> str:
    """Return the class of builders."""
    meanings, tables = meanings_of(InputBuilder), dict(singles(InputBuilder))
    text = "class ModelBuilder:\n" + docstring(ModelBuilder.__doc__, "    ")
    arguments = []
    for name in inspect.signature(InputBuilder).parameters:
        if name not in meanings or name == "notes":
            continue
        table = tables.get(name)
        kind = ATTRIBUTES.get(name, "Any" if table else "Pair")
        meaning = meanings[name]
        if table is not None:
            keys = [f"    {key}: {said}" for key, said in meanings_of(table.kind).items()]
            meaning = "\n".join([meaning, "", "Keys:", *keys])
        text += f"    {name}: {kind}\n{docstring(meaning, '    ')}"
        arguments.append(f"{name}: {kind} = ...")
    text += f"    def __init__(self, {', '.join(arguments)}) -> None: ...\n\n"
    methods = (name for name in dir(ModelBuilder) if not name.startswith("_"))
    takers = ((name, getattr(ModelBuilder, name)) for name in methods if name not in meanings)
    return text + "".join(function(name, taker, "    ") for name, taker in takers)


def stage() -> str:
    """Return the class of stages: its own fields, with the types of the table where it has them."""
    table = arguments_of(StageTable)
    arguments = []
    for name, one in inspect.signature(Stage).parameters.items():
        kind = table[name].annotation if name in table else "Strengths"
        if name == "release":
            kind = "Mapping[str, float]"
        usual = "" if one.default is one.empty else " = ..."
        arguments.append(f"{name}: {wider(kind)}{usual}")
    head = "class Stage(_Stage):\n" + docstring(Stage.__doc__, "    ")
    return head + f"    def __init__(self, *, {', '.join(arguments)}) -> None: ...\n\n"


def stub() -> str:
    """Return the stub, formatted."""
    text = HEAD + builder() + function("simulate", simulate) + stage()
    return subprocess.run(
        [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(STUB), "-"],
        input=text,
        capture_output=True,
        text=True,
        check=True,
    ).stdout


if __name__ == "__main__":
    STUB.write_text(stub(), "utf-8")
