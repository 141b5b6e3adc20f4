"""Control laws that need no interpreter in the control cycle. Numba compiles them from Python, or any compiler from another
language.

A law is a C function, described in ``franka_async_law.h`` (:func:`header`), that the real-time thread calls with every
state. It runs through the filter, the limiter and the checks of every control function. With the extra ``numba``::

    @laws.compiled
    def spring(cycle, parameters, memory, output):
        for i in range(7):
            output[i] = parameters[i] * (parameters[7 + i] - cycle.q[i]) - parameters[14 + i] * cycle.dq[i] + cycle.coriolis[i]
        return laws.FINISH if cycle.time > 2.0 else laws.GO_ON

    law = franka_async.Law(spring, parameters=numpy.concatenate([stiffness, robot.state().q, damping]))
    await robot.run_law(law)
"""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ._native import _law_layout

if TYPE_CHECKING:
    import numpy.typing as npt

__all__ = ["CYCLE", "FINISH", "GO_ON", "RAISED", "address_of", "compiled", "header", "make_cycle"]

GO_ON = 0
"""Return value of a law that continues: it expects the next state."""

FINISH = 1
"""Return value of a law that ends the motion with its current output."""

RAISED = -(2**31)
"""Return value of a law made by :func:`compiled` after an exception in it."""

_OUTPUT = 18

_CTYPES_FUNCTION: Any = vars(ctypes)["_CFuncPtr"]

# Messages of numba about code that allocates where it must not.
_SIGNS_OF_ALLOCATION = ("NRT required", "Only accept returning of array passed into the function")


def _cycle_dtype() -> np.dtype[np.record]:
    fields, size = _law_layout()
    names, offsets, shapes, formats = zip(*fields, strict=True)
    made: Any = np.dtype(
        {
            "names": list(names),
            "formats": [(form, shape) if shape else form for form, shape in zip(formats, shapes, strict=True)],
            "offsets": list(offsets),
            "itemsize": size,
        },
        align=True,
    )
    return cast("np.dtype[np.record]", made)


CYCLE: np.dtype[np.record] = _cycle_dtype()
"""Input of a law in one cycle, as a structured type. Names, shapes and meanings match the header."""


def header() -> Path:
    """Returns the path of ``franka_async_law.h``. A law in C or C++ includes this file."""
    return Path(__file__).with_name("include") / "franka_async_law.h"


def compiled(function: Callable[[Any, Any, Any, Any], int]) -> Any:
    """Compiles ``function(cycle, parameters, memory, output) -> int`` with numba into code for :class:`franka_async.Law`.

    ``cycle`` has the fields of :data:`CYCLE` as attributes; the other arguments are arrays. ``output`` has 18 numbers, and
    the command comes first; a pose is given row by row. Divisions by zero give infinity. An exception in the function stops
    the robot, with :data:`RAISED` as the code.

    Raises ``ImportError`` without numba, and ``TypeError`` for a function that allocates (array expressions make new arrays:
    write loops over ``range`` instead) or that numba cannot compile.
    """
    try:
        numba: Any = importlib.import_module("numba")
    except ImportError as missing:
        raise ImportError("laws are compiled by numba: pip install 'franka-async[numba]'") from missing

    numbers = numba.types.CPointer(numba.types.float64)
    cycles = numba.types.CPointer(numba.from_dtype(CYCLE))
    signature = numba.types.int32(cycles, numbers, numbers, numbers)
    try:
        # Without numba's runtime, the function cannot allocate.
        law = numba.njit(error_model="numpy", _nrt=False)(function)

        def entry(cycle: Any, parameters: Any, memory: Any, output: Any) -> Any:
            now = numba.carray(cycle, 1)[0]
            given = numba.carray(parameters, now.parameters_len)
            kept = numba.carray(memory, now.memory_len)
            command = numba.carray(output, _OUTPUT)
            try:
                code = law(now, given, kept, command)
            except Exception:
                code = RAISED
            return code

        return numba.cfunc(signature, nopython=True, error_model="numpy")(entry)
    except numba.errors.NumbaError as error:
        text = str(error)
        if any(sign in text for sign in _SIGNS_OF_ALLOCATION):
            text = f"it allocates, which a law must not: write loops instead of array expressions ({text})"
        raise TypeError(f"{function.__name__} is not a law that numba can compile: {text}") from error


def make_cycle(**fields: npt.ArrayLike) -> np.record:
    """Returns the input of a law with these fields, and zeros in all others. Use it to try out a law before you compile it."""
    cycle = np.zeros((), dtype=CYCLE)
    for name, value in fields.items():
        cycle[name] = value
    record: Any = cycle.view(np.recarray)[()]
    return cast(np.record, record)


def address_of(code: object) -> int:
    """Returns the address of a C function. ``code`` is a ``numba.cfunc``, a function that ``ctypes`` or ``cffi`` has loaded, or
    an integer, which is returned as it is.

    Raises ``TypeError`` for anything else, callbacks into Python included: the control cycle does not wait for an interpreter.
    """
    if isinstance(code, int) and not isinstance(code, bool):
        return code
    address = getattr(code, "address", None)
    if isinstance(address, int):
        return address
    if isinstance(code, _CTYPES_FUNCTION):
        if any(type(kept).__name__ == "CThunkObject" for kept in (code._objects or {}).values()):
            raise TypeError("code is a callback into Python, expected a C function: compile it, see franka_async.laws.compiled")
        return ctypes.cast(code, ctypes.c_void_p).value or 0
    if type(code).__module__ == "_cffi_backend":
        cffi: Any = importlib.import_module("cffi")
        return int(cffi.FFI().cast("uintptr_t", code))
    if callable(code):
        raise TypeError("code is a Python function, expected a C function: compile it, see franka_async.laws.compiled")
    raise TypeError(f"code is {type(code).__name__}, expected a numba.cfunc, a ctypes or cffi function, or an address")
