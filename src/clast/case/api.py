"""The interface for scripts: a builder that makes cases, and a run of any model in one line.

    import clast

    builder = clast.ModelBuilder(title="A block that falls")
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="falling", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    run = clast.simulate(builder.build(), end=0.5)
    run.block("falling").displacement[-1]
    builder.case(end=0.5, process="modified").run()

Defaults of a script: the methods of a case file without [method]; a step of a 300th of the time in
which the smallest block falls by half its own size, rounded to 1, 2 or 5 times a power of ten (1 ms
for blocks of 1 m); an end at 1 s; a hundred frames.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast import spelling
from clast.case.case_file import Case
from clast.errors import CaseError, ModelError, shortened
from clast.inputs import builder as model_builder
from clast.inputs.blocks import BlockTable
from clast.inputs.bolts import BoltPattern
from clast.inputs.declaring.builder_methods import singles, with_keys
from clast.inputs.declaring.table import Inputs, Table, as_plain, table_of, unwritable
from clast.inputs.declaring.validation_messages import table_in
from clast.inputs.linings.linings import Lining
from clast.inputs.materials import Joint
from clast.inputs.method import Damping, MethodTable, OutputTable, TimeTable
from clast.inputs.stages import given_stages, stage_keys
from clast.model.model import PLANES, Model
from clast.model.stages import Stage
from clast.results import Run, RunRecorder

if TYPE_CHECKING:
    from clast.inputs.placing.place_blocks import BlockArrays
    from clast.run.schedule import Progress, Schedule
    from clast.step.method import Method


RUN_MODEL = "run the model itself: clast.simulate(builder.build())"
TABLES: dict[str, type[Table]] = {"time": TimeTable, "method": MethodTable, "output": OutputTable}
"""Tables whose keys a script gives without saying where they belong."""
WHOLE = {"damping": Damping}
"""Tables that a script gives as a whole, with their types."""
takes_keys = with_keys(*TABLES.values(), whole=WHOLE)
"""Decorator of functions that take these keys:  ``help`` shows them."""


class ShowsOwnNames(type):
    """Class of a class that lists the names users call: neither machinery nor private names."""

    def __dir__(cls) -> list[str]:
        hidden = {*vars(Inputs), "add_block", "opening_outlines"} - {*vars(object)}
        return sorted(name for name in super().__dir__() if name not in hidden)


class ModelBuilder(model_builder.InputBuilder, metaclass=ShowsOwnNames):
    """Collects the parts of a system of blocks, and makes the Model or a case of it.

    Lengths in m, forces in N per metre of thickness, stresses in Pa (tension positive, order xx,
    yy, xy), angles in degrees, velocities in m/s and rad/s.  Polygons are counter-clockwise.
    Its methods take the keys of a case file's tables; how things fit together is judged by
    ``build``, ``case`` and ``to_toml``.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an attribute; refuse names that builders do not have."""
        known = model_builder.InputBuilder.__dataclass_fields__
        if type(self) is ModelBuilder and name not in known:
            if callable(getattr(type(self), name, None)):
                remedy = f"call it: builder.{name}(...)"
                raise ModelError(f"'{name}' is a method of the builder", remedy=remedy)
            shown = [one for one in known if not one.startswith("_")]
            what = f"a builder has no attribute '{shortened(name)}'"
            raise ModelError(what, remedy=spelling.advice(name, shown, kind="attribute"))
        super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return dir(type(self))

    def __repr__(self) -> str:
        parts = []
        for key, entry in Case.model_fields.items():
            kind: Any = table_in(entry.annotation)
            if kind is BlockTable:
                count = self.count(kind)
            else:
                count = len({**self._named, **self._listed}.get(kind, ()))
            if count or kind is BlockTable:
                parts.append(f"{count} {key.replace('_', ' ')}{'s' if count != 1 else ''}")
        return f"ModelBuilder('{self.title}': {', '.join(parts)}; plane {self.plane.name})"

    def build(self) -> Model:
        """Check everything and return the Model; raise ModelError with the remedy otherwise."""
        model = super().build()
        made_by = copy(self)
        made_by._entries, made_by.actions = [*self._entries], [*self.actions]
        made_by._listed = {kind: [*listed] for kind, listed in self._listed.items()}
        made_by._named = {kind: {**named} for kind, named in self._named.items()}
        vars(model)["made_by"] = made_by
        return model

    @takes_keys
    def case(self, *, stages: Sequence[Stage] = (), **keys: Any) -> Case:
        """Return the case of these blocks; ``keys`` are those of [time], [method] and [output].

        ``builder.case(end=2.0, process="modified").run()``.  A step that is not given follows from
        the blocks, the end is 1 s; ``stages`` are the parts of the run.  Raises CaseError and
        ModelError, naming place and remedy.
        """
        # what cannot be built is not a case either, be it two rocks of one name
        tables = _with_time(_tables(keys), self.build())
        content = {**self._content(), **tables, **_stages_of_case(stages)}
        return Case.validated(content, "script")

    @takes_keys
    def to_toml(self, *, stages: Sequence[Stage] = (), **keys: Any) -> str:
        """Return these blocks as the text of a case file, which gives the same Model to the bit.

        ``stages`` and ``keys`` as in ``case``.  Raises CaseError for objects of a script, which no
        file can hold.
        """
        return self.case(stages=stages, **keys).to_toml()

    def _content(self) -> dict[str, Any]:
        """Return the tables of a case file that hold the system of blocks."""
        plane = next((name for name, known in PLANES.items() if self.plane == known), None)
        if plane is None:
            raise unwritable(self.plane, "plane", RUN_MODEL)
        for action in self.actions[:1]:
            raise unwritable(action, "actions", RUN_MODEL)
        push = as_plain(np.asarray(self.seismic_coefficient, np.float64))
        content = {
            "title": self.title,
            "plane": plane,
            "gravity": as_plain(np.asarray(self.gravity, np.float64)),
            **({"gravity_amplitude": self.gravity_amplitude} if self.gravity_amplitude else {}),
            **({"seismic_coefficient": push} if any(push) else {}),
            "block": list(self._blocks()),
            **self._tables_given(),
            "joint": self._placed_joints(),
            **self._singles(),
        }
        return {key: value for key, value in content.items() if value}

    def _singles(self) -> dict[str, Any]:
        """Return the tables of which there is one each."""
        tables = {}
        for name, one in singles(type(self)):
            value = getattr(self, name)
            keys = one.written(value)
            if keys is None:
                raise unwritable(value, one.key, RUN_MODEL)
            tables[one.key] = keys
        return {key: tables[key] for key in Case.model_fields if key in tables}

    def _tables_given(self) -> dict[str, Any]:
        """Return the tables of all inputs, by their keys in a case file."""
        tables: dict[str, Any] = {}
        for key, entry in Case.model_fields.items():
            kind: Any = table_in(entry.annotation)
            if self.has(kind) and kind.NAMED:
                tables[key] = {name: as_plain(one) for name, one in self.named(kind).items()}
            elif self.has(kind):
                tables[key] = [as_plain(self._with_outline(one)) for one in self.all(kind)]
        return tables

    def _with_outline(self, table: Table) -> Table:
        """Return a table; a pattern of bolts has the outline of its opening in place of a name."""
        if not isinstance(table, BoltPattern) or not isinstance(table.opening, str):
            return table
        outline = self.opening_outlines.get(table.opening)
        if outline is None:
            return table
        return table.model_copy(update={"opening": outline, "name": table.group(1)})

    def _placed_joints(self) -> dict[str, Any]:
        """Return the joints without those of lines that became no edges, which a file refuses."""
        along = {"default", *np.unique(self._edge_joint_names()).tolist()}
        along |= {one.joint for one in self.all(Lining) if one.joint is not None}
        return {
            name: as_plain(one)
            for name, one in self.named(Joint).items()
            if one.between or one.between_rocks or name in along
        }

    def _blocks(self) -> Iterator[dict[str, Any]]:
        """Give the table of every block, in their order."""
        number = 0
        for entry in self._entries:
            for name, values in zip(entry.names, _values(entry), strict=True):
                number += 1
                named = {} if name == str(number) else {"name": name}
                yield {**named, **table_of(BlockTable, values)}


def _values(entry: BlockArrays) -> Iterator[dict[str, Any]]:
    """Yield the properties of each block of an entry, but for its name."""
    counts, vertices = entry.loops
    past = np.cumsum(counts)
    velocity, stress = entry.velocities(), entry.stresses()
    joints = entry.edge_joints()
    alike = entry.rock is None or isinstance(entry.rock, str)
    rocks = [entry.rock] * len(counts) if alike else list(entry.rock or ())
    for k, fixed in enumerate(entry.held()):
        own = slice(past[k] - counts[k], past[k])
        yield {
            "vertices": vertices[own],
            "rock": rocks[k],
            "fixed": bool(fixed),
            "velocity": velocity[k],
            "initial_stress": None if stress is None else stress[k],
            "edge_joint": joints[own].tolist() if joints[own].any() else None,
        }


@takes_keys
def simulate(
    model: str | Path | Case | model_builder.InputBuilder | Model,
    method: Method | None = None,
    schedule: Schedule | None = None,
    *,
    output: Path | str | None = None,
    progress: bool | Callable[[Progress], None] = False,
    recorder: RunRecorder | None = None,
    stages: Sequence[Stage] = (),
    **keys: Any,
) -> Run:
    """Return the run of a model from rest, or its initial velocities, to the end.

    ``clast.simulate(model, end=2.0, process="modified", contact_law=MyLaw())``:  ``model`` is a
    builder or its model, a case or the name of its file.  ``keys`` are those of [time], [method]
    and [output] of a case file; they replace those of a case, and else defaults follow from the
    model (the step, 1 s for the end).  ``method`` and ``schedule`` are in the place of these keys
    where they are given.
    ``output`` is the result file to write (.vtkhdf); without it frames are kept in memory.
    ``progress`` is True for a line on the terminal, or a function to call after every step.
    ``stages`` are the parts of the run, one after the other.  Warnings of the run are Python
    warnings of the category ``clast.RunWarning``, each of them once.

    Raises CaseError and ModelError for input that cannot be simulated, RunStopped where the run
    cannot go on, with the partial results in its ``run``.
    """
    tables = _tables(keys)
    _check_given_once(tables, method, schedule)
    if isinstance(model, str | Path | Case):
        case = case_of(model).with_(**tables, **_stages_of_case(stages))
        if (method, schedule, recorder) == (None, None, None):
            return case.run(output=output, progress=progress)
        # the case gives what is not given as an object
        model, stages = case.model(), stages or case.schedule().stages
        method, schedule = method or case.method(model), schedule or case.schedule()
        tables = {}
    model = model.build() if isinstance(model, model_builder.InputBuilder) else model
    if not isinstance(model, Model):
        raise not_one(model)
    # a bad model is refused before anything slow is loaded
    from clast.results.checkpoints.checkpoint import OBJECTS, SETTINGS, Source
    from clast.results.checkpoints.fingerprints import fingerprints
    from clast.run.launch import Launch, Target, launch
    from clast.run.preflight import examine

    # a case that has everything but blocks
    settings = Case.validated({**_with_time(tables, model), "rock": {}}, "script")
    text = settings.text if method is None and schedule is None else ""
    method = method or settings.method(model)
    schedule = schedule or settings.schedule()
    schedule = replace(schedule, stages=given_stages(stages or schedule.stages))
    if stages:
        every = settings.output.interval(schedule.step, schedule.latest)
        schedule = replace(schedule, every=every) if "every" not in keys else schedule
    target = Target(output=None if output is None else Path(output), recorder=recorder)
    made, when = method, schedule
    return launch(
        Launch(
            model=model,
            method=made,
            schedule=when,
            foreseen=lambda: examine(model, made, when).warnings,
            source=lambda: Source(
                text=text,
                gives=SETTINGS if text and settings.is_whole() else OBJECTS,
                schedule=when,
                fingerprints=fingerprints(model=model, method=made),
            ),
            target=lambda say: target,
            case_text=text,
            contacts=settings.output.contacts,
            checkpoint_every=settings.output.checkpoint_every,
        ),
        progress,
    )


def _check_given_once(
    tables: dict[str, Any], method: Method | None, schedule: Schedule | None
) -> None:
    """Raise CaseError for keys beside the object that has them."""
    for name, given in {"method": method, "damping": method, "time": schedule}.items():
        if given is not None and tables.get(name):
            keys_given, kind = (
                name if name in WHOLE else ", ".join(tables[name]),
                type(given).__name__,
            )
            remedy = f"give the keys, or put them into the {kind}"
            raise CaseError(f"{keys_given} and a {kind} are both given", remedy=remedy)


def _stages_of_case(stages: Sequence[Stage]) -> dict[str, Any]:
    """Return the stages of a script as a table of a case, nothing where there are none."""
    return {"stage": [stage_keys(one) for one in given_stages(stages)]} if stages else {}


def case_of(given: Any) -> Case:
    """Return the case of a file, of a builder, or of the model that one has made.

    Raises CaseError for anything else.
    """
    if isinstance(given, str | Path):
        return Case.from_toml(Path(given))
    if isinstance(given, Model):
        if given.made_by is None:
            what = "no case is known of a model that a script has changed or made of arrays"
            raise CaseError(what, remedy="give the builder, or builder.case(...)")
        given = given.made_by
    if isinstance(given, ModelBuilder):
        return given.case()
    if isinstance(given, Case):
        return given
    raise not_one(given)


def not_one(given: Any) -> CaseError:
    """Return the error of an object that is neither a case nor a model."""
    remedy = "give the name of a case file, clast.load(file), a ModelBuilder or builder.build()"
    return CaseError(f"{shortened(repr(given))} is neither a case nor a model", remedy=remedy)


def usual_step(model: Model) -> float:
    """Return the step, s, of a run that names none: 1, 2 or 5 times a power of ten.

    At most a 300th of the time in which the smallest block falls by half its size.
    """
    gravity = float(np.hypot(*model.gravity)) or 9.8
    wanted = math.sqrt(math.sqrt(float(model.area.min())) / gravity) / 300.0
    power = 10.0 ** math.floor(math.log10(wanted))
    rounded = power * max(digit for digit in (1.0, 2.0, 5.0) if digit * power <= wanted)
    return float(f"{rounded:.1g}")


def _with_time(tables: dict[str, Any], model: Model) -> dict[str, Any]:
    """Return the tables of a script with the end and the step that it does not give."""
    # End of a run that does not say when, s
    time = {"end": 1.0, **tables.get("time", {})}
    if "step" not in time:
        step, end = usual_step(model), time["end"]
        time["step"] = min(step, end) if isinstance(end, int | float) and end > 0.0 else step
    return {**tables, "time": time}


def _tables(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a script in the tables of a case file where they belong."""
    tables: dict[str, Any] = {key: as_plain(value) for key, value in keys.items() if key in WHOLE}
    for key, value in keys.items():
        if key in tables:
            continue
        home = next((name for name, kind in TABLES.items() if key in kind.model_fields), None)
        if home is None:
            known = [*WHOLE, *(name for kind in TABLES.values() for name in kind.model_fields)]
            what = f"there is no key '{key}'"
            raise CaseError(what, remedy=spelling.advice(key, known, kind="key"))
        tables.setdefault(home, {})[key] = as_plain(value)
    return tables
