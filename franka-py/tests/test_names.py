"""What the driver has in Rust, Python has too, or says why not."""

from __future__ import annotations

import importlib
from functools import reduce
from pathlib import Path

import franka_async

TABLE = Path(__file__).with_name("rust_names.txt")


def test_what_the_table_names_is_there() -> None:
    lines = [line for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    named = [line.split(" = ")[1] for line in lines if " = " in line]
    assert len(named) > 100
    for name in named:
        module, *path = name.split(".")
        assert module == "franka_async"
        for submodule in ("sync", "options", "goal", "supervision"):
            importlib.import_module(f"franka_async.{submodule}")
        reduce(getattr, path, franka_async)


def test_reasons_name_what_is_there() -> None:
    """A reason that begins with a class of the package and its attribute is held against it."""
    for line in TABLE.read_text().splitlines():
        _, _, reason = line.partition(": ")
        first = reason.split()[0].rstrip(",:") if reason else ""
        owner, _, attribute = first.partition(".")
        if attribute and hasattr(franka_async, owner):
            attribute = attribute.split("(")[0]
            known = getattr(franka_async, owner)
            assert hasattr(known, attribute) or attribute in getattr(known, "__annotations__", {}), line
