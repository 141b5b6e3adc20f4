"""What the driver has in Rust, Python has too, or says why not."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from types import ModuleType

import pytest

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


BOOK = Path(__file__).parents[2] / "docs" / "src"


def rows(page: str) -> Iterator[tuple[list[str], str]]:
    """Of each row of a table with a column ``Python``: the names in the first cell, and the cell of that column."""
    header: list[str] | None = None
    for line in page.splitlines():
        if not line.startswith("|"):
            header = None
            continue
        cells = [cell.strip() for cell in line.replace("\\|", "/").strip("|").split("|")]
        if header is None:
            header = cells
        elif "Python" in header and not line.startswith("|--"):
            column = header.index("Python")
            yield re.findall("`(.*?)`", cells[0]), cells[column] if column < len(cells) else ""


def found(name: str) -> object:
    """What a name of the package stands for; ``Robot(realtime=)`` is the keyword of that name."""
    name, _, keyword = name.partition("(")
    path = name.removeprefix("franka_async.").split(".")
    item: object = franka_async
    for part in path:
        item = of(item, part)
    if keyword:
        keyword = keyword.rstrip("=)")
        assert re.search(rf"^\s+(self, )?.*\b{keyword}: ", STUBS, re.MULTILINE), f"{name} has no keyword {keyword}"
    return item


def of(owner: object, name: str) -> object:
    """An attribute, a field of a dataclass without a default, or a submodule."""
    if hasattr(owner, name):
        return getattr(owner, name)
    if name in getattr(owner, "__annotations__", {}):
        return None
    assert isinstance(owner, ModuleType), f"{owner} has no {name}"
    return importlib.import_module(f"{owner.__name__}.{name}")


STUBS = "\n".join(path.read_text() for path in Path(franka_async.__file__).parent.glob("*.py*"))


@pytest.mark.parametrize("page", sorted(path.name for path in BOOK.glob("*.md")))
def test_what_the_book_names_is_there(page: str) -> None:
    """A cell that begins with ``same: `` names what has attributes of the names of its row."""
    for names, cell in rows((BOOK / page).read_text()):
        for ours in re.findall("`(.*?)`", cell):
            item = found(ours)
            if cell.startswith("same: "):
                for name in names:
                    of(item, name)
