"""Prints the public names of an installed package, one a line: `python of_module.py franky`.

A class is followed by its members, including members of bases that the package does not export. A name that several modules
export is printed with its shortest path. `name` and `value` of enumerations, names of other packages and submodules are left
out.
"""

import contextlib
import importlib
import pkgutil
import sys
import types
from collections.abc import Iterator
from typing import Any


def is_public(name: str) -> bool:
    return not name.startswith("_")


def modules(root: types.ModuleType) -> Iterator[tuple[str, types.ModuleType]]:
    """Returns the package and its public submodules, with the prefix of their names."""
    yield "", root
    for module in pkgutil.iter_modules(root.__path__):
        if is_public(module.name) and module.name not in SKIPPED:
            # A shared library next to the modules is taken for a module, and cannot be imported.
            with contextlib.suppress(ImportError):
                yield f"{module.name}.", importlib.import_module(f"{root.__name__}.{module.name}")


def members(of: type, exported: set[int], prefix: str) -> Iterator[str]:
    bases = [of, *(base for base in of.__mro__[1:] if is_own(base) and id(base) not in exported)]
    names = {name for base in bases for name in vars(base) if is_public(name)}
    if any(base.__name__ in ("Enum", "pybind11_object") for base in of.__mro__) and {"name", "value"} <= names:
        names -= {"name", "value"}
    for name in sorted(names):
        path = f"{prefix}.{name}"
        yield path
        member = getattr(of, name)
        if isinstance(member, type) and is_own(member):
            yield from members(member, exported, path)


def is_own(item: Any) -> bool:
    return (getattr(item, "__module__", None) or "").split(".")[0] == ROOT


def main() -> None:
    found: dict[tuple[int, str], tuple[str, Any]] = {}
    for prefix, module in modules(importlib.import_module(ROOT)):
        for name in filter(is_public, dir(module)):
            item = getattr(module, name)
            is_value = not isinstance(item, (type, types.ModuleType)) and not callable(item)
            # Constants belong to the module that assigns them.
            is_constant = is_value and name.isupper()
            if is_own(item) and not isinstance(item, types.ModuleType) or is_constant:
                known = found.get((id(item), name))
                if known is None or len(prefix + name) < len(known[0]):
                    found[id(item), name] = (prefix + name, item)
    exported = {key[0] for key in found}
    for name, item in sorted(found.values(), key=lambda it: it[0]):
        print(name)
        if isinstance(item, type):
            for member in members(item, exported, name):
                print(member)


# Programs rather than parts of the package.
SKIPPED = ("cli",)
ROOT = sys.argv[1]
main()
