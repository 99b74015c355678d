"""The structure of the package: what CONTRIBUTING.md asks of files, functions, imports and state.

What does not hold yet is listed in EXCEPTIONS, by rule and file, with how much of it there is.  The
list may only shrink: more than is listed fails, and so does a line that is no longer needed.
"""

import ast
import re
import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

import clast

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "clast"
TESTS = ROOT / "tests"

MOST_ARGUMENTS = 8
"""Arguments of a function, self and cls not counted."""

COMMANDS = {"film", "fit", "fos", "import_", "montecarlo", "plot", "resume", "run", "sweep"}
COMMANDS |= {"target"}
"""Commands of cli/: every option on the command line is an argument of the function."""
STARTING_UP = {
    "compute/jit.py": "what is read of the kernels' files does not change while a process runs",
    "inputs/declaring/alternatives.py": "types of the parts of a method, and keys of their tables",
    "inputs/declaring/field_docs.py": "docstrings of a class are those of its file",
    "case/case_file.py": "the JSON Schema of a case",
}
"""Files whose functions may be remembered by functools.cache, and why nothing can go stale."""
OF_THE_PROCESS = {
    "compute/compilation.py": "what numba compiles is the process' own, and no digit depends on it",
}
"""Files with an object that counts what the whole process does, and why no run depends on it."""
ONLY_HOME = {"numba": "compute", "llvmlite": "compute", "matplotlib": "pictures", "h5py": "results"}
"""Libraries that one folder imports."""
COMPILED = {"kernel", "shared", "summed", "operation", "intrinsic", "overload", "register_model"}
COMPILED |= {"lower_builtin"}
"""Decorators of what numba compiles: it infers the types of the arguments."""
CHANGING = {"add", "append", "clear", "extend", "insert", "pop", "popitem", "setdefault", "update"}
"""Methods that change a dictionary, a list or a set."""

Offences = dict[str, list[str]]
"""File or folder of the package -> what offends the rule there."""

EXCEPTIONS: dict[str, dict[str, int]] = {
    "functions have at most 8 arguments": {"contact/jacobian.py": 1},
    "plain functions are annotated": {},
}
"""Rule -> file -> how many offences it has."""


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def files() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def functions(path: Path) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree(path)) if isinstance(node, ast.FunctionDef)]


def arguments(function: ast.FunctionDef) -> list[ast.arg]:
    """Return the arguments of a function without self or cls."""
    given = function.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    named = named[1:] if named and named[0].arg in ("self", "cls") else named
    return [*named, *(one for one in (given.vararg, given.kwarg) if one is not None)]


def called(node: ast.expr) -> str:
    """Return the last part of the name of a decorator or of what is called: b of @a.b(c)."""
    node = node.func if isinstance(node, ast.Call) else node
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def decorators(node: ast.FunctionDef | ast.ClassDef) -> set[str]:
    return {called(one) for one in node.decorator_list}


# Rules -------------------------------------------------------------------------------------------


def many_arguments() -> Offences:
    """Functions of more than 8 arguments."""
    found = defaultdict(list)
    for path in files():
        for function in functions(path):
            count = len(arguments(function))
            command = name_of(path).startswith("cli/") and function.name in COMMANDS
            if count > MOST_ARGUMENTS and not command:
                found[name_of(path)].append(f"{function.name} has {count} arguments")
    return found


def remembering_functions() -> Offences:
    """Functions that remember answers (functools.cache), and so outlive a run."""
    found = defaultdict(list)
    for path in files():
        for function in functions(path):
            kept = decorators(function) & {"cache", "lru_cache"}
            if kept and name_of(path) not in STARTING_UP:
                found[name_of(path)].append(f"{function.name} remembers its answers")
    return found


def changing_state() -> Offences:
    """Names of modules that hold what changes: collections that are filled, objects, ``global``."""
    found = defaultdict(list)
    for path in files():
        objects = () if name_of(path) in OF_THE_PROCESS else _module_objects(path)
        found[name_of(path)] = [*_changed_names(path), *objects]
    return found


def _changed_names(path: Path) -> Iterator[str]:
    names = set(_assigned(path))
    for function in functions(path):
        own = {one.arg for one in arguments(function)}
        for node in ast.walk(function):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                own.add(node.id)
        for node in ast.walk(function):
            if isinstance(node, ast.Global):
                yield f"{function.name} changes {', '.join(node.names)}"
            target = None
            if isinstance(node, ast.Subscript) and not isinstance(node.ctx, ast.Load):
                target = node.value
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                target = node.func.value if node.func.attr in CHANGING else None
            if isinstance(target, ast.Name) and target.id in names - own:
                yield f"{function.name} changes {target.id}"


def _assigned(path: Path) -> dict[str, ast.expr]:
    """Return the names that a module gives to values, outside of functions and classes."""
    found = {}
    for node in tree(path).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
        for target in targets:
            if isinstance(target, ast.Name) and node.value is not None:
                found[target.id] = node.value
    return found


def _module_objects(path: Path) -> Iterator[str]:
    """Say which names are objects of a class of the package that can change."""
    for name, value in _assigned(path).items():
        if isinstance(value, ast.Call) and called(value) in changing_classes():
            yield f"{name} is a {called(value)}, which can change"


@cache
def changing_classes() -> frozenset[str]:
    """Return the classes of the package whose objects keep what they are given, and change it."""
    found = set()
    for path in files():
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef) and _can_change(node):
                found.add(node.name)
    return frozenset(found)


def _can_change(node: ast.ClassDef) -> bool:
    for one in node.decorator_list:
        if called(one) == "dataclass":
            words = one.keywords if isinstance(one, ast.Call) else []
            return not any(word.arg == "frozen" for word in words)
    # A class of plain Python can change where its methods give attributes to self.
    return any(
        isinstance(target, ast.Attribute)
        and isinstance(target.ctx, ast.Store)
        and isinstance(target.value, ast.Name)
        and target.value.id == "self"
        for target in ast.walk(node)
    )


def untyped_functions() -> Offences:
    """Plain Python functions without types, in folders where mypy asks for none of kernels."""
    found = defaultdict(list)
    for path in filter(_is_relaxed, files()):
        for function in _plain(tree(path).body):
            untyped = [one.arg for one in arguments(function) if one.annotation is None]
            if untyped or function.returns is None:
                found[name_of(path)].append(f"{function.name} is not annotated")
    return found


def _is_relaxed(path: Path) -> bool:
    """Return whether mypy is told not to ask for types in a file."""
    module = ".".join(("clast", *path.relative_to(PACKAGE).with_suffix("").parts))
    return any(
        module == known or module.startswith(known.removesuffix("*")) for known in relaxed_modules()
    )


@cache
def relaxed_modules() -> tuple[str, ...]:
    """Return the modules that mypy is lenient with, as pyproject.toml names them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["mypy"]
    lenient = (one for one in settings["overrides"] if "disallow_untyped_defs" in one)
    return tuple(module for one in lenient for module in one["module"])


def _plain(body: list[ast.stmt]) -> Iterator[ast.FunctionDef]:
    """Yield the functions and methods that are not compiled, those inside them too."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not decorators(node) & COMPILED:
            yield from _plain(node.body)
        if isinstance(node, ast.FunctionDef) and not decorators(node) & COMPILED:
            yield node
            yield from _plain(node.body)


def foreign_imports() -> Offences:
    """Imports of numba, matplotlib or h5py outside of the folder that has them, wherever made."""
    found = defaultdict(list)
    for path in files():
        folder = path.relative_to(PACKAGE).parts[0]
        for module in _imported(path):
            home = ONLY_HOME.get(module.partition(".")[0])
            if home is not None and home != folder:
                found[name_of(path)].append(f"{module} is imported; only {home}/ may")
    return found


def _imported(path: Path) -> Iterator[str]:
    """Yield the modules that a file imports: at its top, in functions, for annotations."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def imports_within() -> dict[str, set[str]]:
    """Every module of the package -> modules of it that it imports, wherever and for whatever."""
    modules = {
        ".".join(("clast", *path.relative_to(PACKAGE).with_suffix("").parts)): path
        for path in files()
    }
    found: dict[str, set[str]] = {}
    for module, path in modules.items():
        named = set(_imported(path))
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ImportFrom) and node.module:
                named |= {f"{node.module}.{one.name}" for one in node.names}
        # a package hands on what its modules have: it belongs to none of its own circles
        found[module] = {one for one in named if one in modules} - {module}
    return found


def circles() -> Offences:
    """Modules that import each other, directly or through others, also those of one folder."""
    imports = imports_within()

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        left = list(imports[start])
        while left:
            one = left.pop()
            if one not in seen:
                seen.add(one)
                left.extend(imports[one])
        return seen

    behind = {module: reached(module) for module in imports}
    return {
        "/".join(module.split(".")[1:]) + ".py": [
            f"imports itself through {other}"
            for other in sorted(imports[module])
            if module in behind[other]
        ]
        for module in imports
        if module in behind[module]
    }


RULES: dict[str, Callable[[], Offences]] = {
    "functions have at most 8 arguments": many_arguments,
    "nothing is remembered between runs": remembering_functions,
    "no module holds what changes": changing_state,
    "plain functions are annotated": untyped_functions,
    "numba, matplotlib and h5py have one home": foreign_imports,
    "no module imports itself through others": circles,
}


@pytest.mark.slow  # reads the whole package
@pytest.mark.parametrize("rule", RULES)
def test_the_house(rule: str):
    found, known = RULES[rule](), EXCEPTIONS.get(rule, {})
    more = [
        f"{path}: {text}"
        for path, texts in found.items()
        if len(texts) > known.get(path, 0)
        for text in texts
    ]
    assert not more, "\n".join([rule, *more])
    over = [path for path in known if not found.get(path)]
    assert not over, f"remove from EXCEPTIONS[{rule!r}], where nothing is left: {over}"


def test_every_exception_belongs_to_a_rule():
    assert set(EXCEPTIONS) <= set(RULES)


@pytest.mark.parametrize("name", clast.__all__)
def test_every_public_name_is_where_it_is_said_to_be(name: str):
    assert getattr(clast, name) is not None


def test_no_test_imports_another_test():
    tests = {path.stem for path in TESTS.rglob("test_*.py")}
    found = [
        f"{path.relative_to(TESTS)} imports {module}"
        for path in TESTS.rglob("*.py")
        for module in re.findall(r"^\s*(?:from|import) ([\w.]+)", path.read_text("utf-8"), re.M)
        if module in tests or module.rpartition(".")[2] in tests
    ]
    assert not found


SAMPLE = {
    "run/one.py": """
if TYPE_CHECKING:
    from clast.run import two
""",
    "run/two.py": """
def late() -> None:
    from clast.run.one import something
""",
    "step/much.py": """
import numba
from functools import lru_cache

KEPT = {}
LAST = Last()


class Last:
    def look(self):
        self.found = 1


@lru_cache
def remembered(a: int) -> int:
    KEPT[a] = a
    return a


@kernel()
def fast(a, b, c, d, e, f, g, h, i):
    return a


def plain(a):
    return a
""",
    "step/sound.py": """
KNOWN = {"a": 1}
ORIGIN = Point(0.0)


@dataclass(frozen=True)
class Point:
    x: float

    def moved(self, dx: float) -> Point:
        known = {}
        known["a"] = dx
        return Point(self.x + dx)
""",
}


def test_the_rules_see_what_offends_them(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.PACKAGE", tmp_path)
    changing_classes.cache_clear()
    (tmp_path / "step").mkdir()
    (tmp_path / "run").mkdir()
    for name, text in SAMPLE.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    found = {
        rule: {where: texts for where, texts in check().items() if texts}
        for rule, check in RULES.items()
    }
    changing_classes.cache_clear()
    assert list(found.values()) == [
        {"step/much.py": ["fast has 9 arguments"]},
        {"step/much.py": ["remembered remembers its answers"]},
        {"step/much.py": ["remembered changes KEPT", "LAST is a Last, which can change"]},
        {"step/much.py": ["look is not annotated", "plain is not annotated"]},
        {"step/much.py": ["numba is imported; only compute/ may"]},
        {
            "run/one.py": ["imports itself through clast.run.two"],
            "run/two.py": ["imports itself through clast.run.one"],
        },
    ]


def test_no_two_files_of_tests_have_one_name():
    """Python would take one for the other."""
    counts = Counter(path.name for path in Path(__file__).parent.rglob("test_*.py"))
    assert [name for name, count in counts.items() if count > 1] == []
