"""Kernels that other kernels call become part of them, and machine code only there.

numba makes machine code of every function that it compiles, with an entry for Python, keeps it on
disk, and then optimises it once more within each function that calls it.  Two thirds of our kernels
are never called from Python: the time to compile all of them falls by half where that is left out.

What is on disk is loaded without what only compilation needs: numba's tables of functions, and the
BLAS that it asks scipy for, whose import takes a quarter of a second.  None of our kernels needs
that; one that does (np.dot) asks again when it is compiled.
"""

from __future__ import annotations

import importlib
from functools import cached_property
from typing import Any

from llvmlite import ir
from llvmlite.binding import Linkage
from numba.core import boxing, cgutils, pythonapi, runtime, types
from numba.core import config as numba_config
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.registry import CPUDispatcher, cpu_target
from numba.np.numpy_support import as_dtype

SETTINGS: Any = numba_config
"""numba's settings of this process."""


class Linked(JITCodeLibrary):
    """The code of a function, made ready to run only if it has an entry for Python."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Leave it to when all that is called has been linked in."""
        ll_module.data_layout = self._codegen._data_layout

    def add_linking_library(self, library: Any) -> None:
        """Note code that is called, which need not be ready to run."""
        self._linking_libraries.append(library)

    def _all_called(self) -> list[Any]:
        """Return the code that is called, and all that it calls, each after its callers.

        LLVM leaves out code that nothing of the present code calls.
        """
        libraries: dict[Any, None] = {}

        def visit(library: Any) -> None:
            if not library._finalized:
                for called in library._linking_libraries:
                    if called not in libraries:
                        visit(called)
            libraries[library] = None

        visit(self)
        return list(libraries)[-2::-1]

    def _get_module_for_linking(self) -> Any:
        """Return the code for others to take in; until it is finalised, without its callees."""
        if self._finalized:
            return super()._get_module_for_linking()
        module = self._final_module.clone()
        for function in module.functions:
            if not function.is_declaration and function.linkage == Linkage.external:
                function.linkage = "linkonce_odr"
        return module

    def finalize(self) -> None:
        """Make the code ready to run, with all that it calls."""
        for library in self._all_called():
            self._reload_init.update(library._reload_init)
            module = library._get_module_for_linking()
            self._final_module.link_in(module, preserve=library._finalized)
        self._linking_libraries = []
        # by what is tidied up before it is inlined, impacts take a sixth less time
        super()._optimize_functions(self._final_module)
        super().finalize()

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function, 0 if there is none of this name."""
        if not self._finalized and not self._defines(name):
            return 0
        address: int = super().get_pointer_to_function(name)
        return address

    def _defines(self, name: str) -> bool:
        try:
            return not self._final_module.get_function(name).is_declaration
        except NameError:
            return False


class Linking(JITCPUCodegen):
    """Makes such code of all that numba compiles in this process."""

    _library_class = Linked

    def set_env(self, env_name: str, env: Any) -> None:
        """Tell the code of a function, where it is ready to run, where its Python objects are."""
        if self._engine.is_symbol_defined(env_name):
            super().set_env(env_name, env)


cpu_target.target_context.codegen().__class__ = Linking


def returned(kind: Any, value: Any, code: Any) -> Any:
    """Return an array as Python gets it.

    numba has Python unpickle numpy's class for each array that a kernel returns, which
    costs as much as to make the array: here it is kept beside the code, as its type of numbers is.
    """

    def kept(thing: Any) -> Any:
        return code.env_manager.read_const(code.env_manager.add_const(thing))

    api, builder, number = code.pyapi, code.builder, ir.IntType(32)
    given = [api.voidptr, api.pyobj, number, number, api.pyobj]
    form = ir.FunctionType(api.pyobj, given)
    function = cgutils.get_or_insert_function(
        builder.module, form, "NRT_adapt_ndarray_to_python_acqref"
    )
    place = builder.bitcast(cgutils.alloca_once_value(builder, value), api.voidptr)
    shape = number(kind.ndim), number(int(kind.mutable))
    array = builder.call(function, [place, kept(kind.box_type), *shape, kept(as_dtype(kind.dtype))])
    code.context.nrt.decref(builder, kind, value)
    return array


boxing.box_array = pythonapi._boxers.functions[types.Array] = returned
OWNING = pythonapi._unboxers.functions[types.Array]
"""How numba takes an array from Python: with a share in its memory, which is counted."""


def lent(kind: Any, thing: Any, code: Any) -> Any:
    """Return an array as a kernel gets it from Python, which keeps it while the kernel runs.

    numba counts who uses it, by an atomic operation each time that it is taken out of a tuple or
    handed on.  An array that is not counted may be returned as it is, but no part of it.
    """
    code.context.enable_nrt = False
    try:
        return OWNING(kind, thing, code)
    finally:
        code.context.enable_nrt = True


boxing.unbox_array = pythonapi._unboxers.functions[types.Array] = lent


def load_arrays() -> None:
    """Load numba's array functions without asking scipy, which clast requires, for a BLAS."""
    asked = importlib.import_module("numba.np.linalg")
    usual = getattr(asked, "ensure_blas", None)
    if usual is None:
        return
    try:
        vars(asked)["ensure_blas"] = lambda: None
        importlib.import_module("numba.np.arraymath")
    finally:
        vars(asked)["ensure_blas"] = usual


class OnDisk(FunctionCache):
    """Compiled code that is kept on disk.

    numba fills its tables of functions before it loads any, which takes as long as to load thirty
    kernels.  One that is ready calls none of them, only what keeps its memory.
    """

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code for the types of a call, None where it is not there."""
        allocator: Any = runtime
        allocator.rtsys.initialize(target_context)
        load_arrays()  # code that takes a sum or a maximum names their file
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)
        return None


class Kernel(CPUDispatcher):
    """A compiled function, which Python may call, and which other kernels take in."""

    kept_in: str | None = None
    """Folder where compiled code is kept and looked for, "" where numba chooses it, None where it
    is not, or is open already.  It is opened at the first call: most kernels of a file are never
    called, and opening takes half a millisecond for each."""

    def __init__(self, py_func: Any, locals: Any = None, targetoptions: Any = None) -> None:
        super().__init__(py_func, locals, targetoptions)
        self._given = py_func, locals, {**(targetoptions or {}), "no_cpython_wrapper": True}

    @cached_property
    def taken_in(self) -> Any:
        """Code for other kernels, made when the first of them is compiled.

        Of a kernel that is found on disk nobody needs it.
        """
        return CPUDispatcher(*self._given)

    def compile(self, sig: Any) -> Any:
        """Return the code for the types of a call, from disk or compiled now."""
        self.open()
        return super().compile(sig)

    def open(self) -> None:
        """Open the folder where it is kept, unless that has been done."""
        if self.kept_in is None:
            return
        kept, self.kept_in = self.kept_in, None
        usual = SETTINGS.CACHE_DIR
        SETTINGS.CACHE_DIR = kept or usual
        try:
            self._cache = OnDisk(self.py_func)
        finally:
            SETTINGS.CACHE_DIR = usual

    def typeof_pyval(self, val: Any) -> Any:
        """Return the type of a value from Python.

        Arrays of models and states are read-only to Python, others are not: to numba these would
        be two types, and every kernel would be compiled for both.  Kernels write into none that
        they are not made to fill.
        """
        return _writable(super().typeof_pyval(val))

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return the type of a call by another kernel."""
        return self.taken_in.get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        """Return the entry for the code that another kernel calls."""
        return self.taken_in.get_overload(sig)


def _writable(kind: Any) -> Any:
    """Return the type of an array that may be written to for that of one that may not be."""
    if isinstance(kind, types.Array) and not kind.mutable:
        return kind.copy(readonly=False)
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        own = getattr(kind, "instance_class", None)
        return types.BaseTuple.from_types([_writable(one) for one in parts.types], own)
    return kind
