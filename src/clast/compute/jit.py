"""How kernels are compiled: once, kept on disk, and again when any kernel has changed.

numba keeps compiled code beside each file and looks at the age of that file alone; a kernel that
calls one of another file would go on with the old one after a change there.  So the compiled code
of a file lies in a folder named after its text and that of every kernel file it uses.

One thread works unless NUMBA_NUM_THREADS asks for more.  Threads come from OpenMP where numba has
it, and wait for each other by spinning for about a millisecond: one that sleeps takes 0.1 ms to
wake, as long as much of the work that is shared.  On a machine with something else to do spinning
costs more than threads gain, which is why they must be asked for.

Every iteration needs arrays as large as those that the one before has just given back.  Linux' C
library would hand them to the system and ask for them again, which costs as much as a third of the
work on them, and by one thread: it is told to keep them.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

from clast.compute.compilation import COMPILATION
from clast.compute.linking import SETTINGS, Kernel

BY_THREADS = os.environ.get("NUMBA_NUM_THREADS", "1") != "1"
"""Whether this process has more than one thread: loops that threads share are compiled for it."""
os.environ.setdefault("GOMP_SPINCOUNT", "30000")  # read when OpenMP is loaded, with the threads


def keep_memory() -> None:
    """Let the C library keep memory that is given back, where it is glibc and nothing else is said.

    It is said by the environment, MALLOC_TRIM_THRESHOLD_ or MALLOC_MMAP_THRESHOLD_.
    """
    said = any(name.startswith("MALLOC_") for name in os.environ)
    if not sys.platform.startswith("linux") or said:
        return
    adjust = getattr(ctypes.CDLL(None), "mallopt", None)
    if adjust is not None:
        for option, size in KEPT_MEMORY.items():
            adjust(option, size)


KEPT_MEMORY = {-1: 2**30, -3: 2**28}
"""glibc's M_TRIM_THRESHOLD and M_MMAP_THRESHOLD, bytes: free memory kept, and size of blocks that
are not kept at all."""


PACKAGE = Path(__file__).resolve().parents[1]
"""Where the package is."""
USES = re.compile(r"^from clast((?:\.\w+)*) import (\([^)]*\)|.*)$", re.MULTILINE)
"""An import of another module: `.folder.file import name`, or `.folder import file, file`."""
KERNELS = re.compile(r"^from clast\.compute\b", re.MULTILINE)
"""The import in files that have kernels."""


@cache
def text_of(file: Path) -> str:
    """Return the text of a file of the package, as it is when it is first asked for; "" if none."""
    try:
        return file.read_text(encoding="utf-8")
    except (FileNotFoundError, NotADirectoryError):
        return ""


@cache
def has_kernels(file: Path) -> bool:
    """Return whether a file has kernels of its own, or belongs to the tools that compile them."""
    return file.parent.name == "compute" or bool(KERNELS.search(text_of(file)))


@cache
def used_by(file: Path, package: Path = PACKAGE) -> frozenset[Path]:
    """Return the files with kernels of the ``package`` that ``file`` imports from."""
    files: set[Path] = set()
    for module, imported in USES.findall(text_of(file)):
        place = package.joinpath(*module.split(".")[1:])
        names = re.findall(r"\w+", re.sub(r"\bas \w+", "", imported))
        files.update([place.with_suffix(".py"), *(place / f"{name}.py" for name in names)])
    return frozenset(one for one in files if text_of(one) and has_kernels(one))


def all_used_by(file: Path, package: Path = PACKAGE) -> frozenset[Path]:
    """Return ``file`` and every file with kernels that it uses, directly or through others."""
    files: set[Path] = set()
    left = [file]
    while left:
        one = left.pop()
        if one not in files:
            files.add(one)
            left.extend(used_by(one, package))
    return frozenset(files)


@cache
def folder(file: Path, package: Path = PACKAGE) -> str:
    """Return where the compiled kernels of ``file`` are kept; "" leaves it to numba.

    It is left to numba where NUMBA_CACHE_DIR is set, or where the folder cannot be written.
    """
    if SETTINGS.CACHE_DIR:
        return ""
    text = hashlib.sha256(b"by threads" if BY_THREADS else b"alone")
    for one in sorted(all_used_by(file, package)):
        text.update(text_of(one).encode())
    kept = file.parent / "__pycache__" / f"{file.stem}-{text.hexdigest()[:16]}"
    try:
        kept.mkdir(parents=True, exist_ok=True)
    except OSError:
        return ""
    return str(kept) if os.access(kept, os.W_OK) else ""


keep_memory()


def kernel(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator of a kernel; ``options`` are those of ``numba.njit``."""

    def compiled(function: Callable[..., Any]) -> Any:
        COMPILATION.known += 1
        made = Kernel(function, targetoptions={"nopython": True, **options})
        made.kept_in = folder(Path(function.__code__.co_filename))
        return made

    return compiled


def start_threads() -> None:
    """Start the threads that parallel kernels share, if they do not run yet.

    numba does so itself when it compiles a parallel kernel, and when it loads one, but not when it
    loads a kernel that calls one.
    """
    if "NUMBA_NUM_THREADS" not in os.environ:
        numba.set_num_threads(1)
    numba.get_num_threads()
