"""Names of the driver in Rust exist in Python too, or have a stated reason why not."""

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
    """If a reason begins with a class of the package and its attribute, the attribute must exist."""
    for line in TABLE.read_text().splitlines():
        _, _, reason = line.partition(": ")
        first = reason.split()[0].rstrip(",:") if reason else ""
        owner, _, attribute = first.partition(".")
        if attribute and hasattr(franka_async, owner):
            attribute = attribute.split("(")[0]
            known = getattr(franka_async, owner)
            assert hasattr(known, attribute) or attribute in getattr(known, "__annotations__", {}), line


BOOK = Path(__file__).parents[2] / "docs" / "src"
PEERS = Path(__file__).parents[2] / "tests" / "peers" / "names"


def tables(page: str) -> Iterator[list[list[str]]]:
    """The cells of each table, with the header as its first row."""
    table: list[list[str]] = []
    for line in [*page.splitlines(), ""]:
        if line.startswith("|"):
            if not line.startswith("|--"):
                table.append([cell.strip() for cell in line.replace("\\|", "/").strip("|").split("|")])
        elif table:
            yield table
            table = []


def rows(page: Path) -> Iterator[tuple[list[str], str]]:
    """Yields, for each row of a table with a column ``Python``, the names in the first cell, and the cell of that column.

    ``*`` stands for the members of the types in the header that have no separate row.
    """
    known = names_of_peer(page)
    for header, *body in tables(page.read_text()):
        if "Python" not in header:
            continue
        column = header.index("Python")
        told = {name for cells in body for name in re.findall("`(.*?)`", cells[0])}
        for cells in body:
            names = re.findall("`(.*?)`", cells[0])
            if names == ["*"]:
                owners = "|".join(map(re.escape, re.findall("`(.*?)`", header[0])))
                members = (re.fullmatch(rf"(?:{owners})(?:\.|::)(\w+)", name) for name in known)
                names = [member[1] for member in members if member and member[1] not in told]
                assert names, cells
            yield names, cells[column] if column < len(cells) else ""


def names_of_peer(page: Path) -> list[str]:
    """The public names of the package that a chapter is about; none for other pages."""
    peer = PEERS / {"from-franka-rs-python.md": "franka.txt"}.get(
        page.name, page.stem.removeprefix("from-").replace("-", "_") + ".txt"
    )
    lines = peer.read_text().splitlines() if peer.exists() else []
    return [line for line in lines if line and not line.startswith("#")]


@pytest.mark.parametrize("page", sorted(path.name for path in BOOK.glob("from-*.md")))
def test_each_name_of_another_package_has_one_row(page: str) -> None:
    """``*``, or ``Type.*``, stands for the members that have no row."""
    known = set(names_of_peer(BOOK / page))
    separator = "::" if any("::" in name for name in known) else "."
    told: list[str] = []
    for header, *body in tables((BOOK / page).read_text()):
        if {"Rust", "Python"} & set(header):
            owners = [name + separator for name in re.findall("`(.*?)`", header[0])] or [""]
            for cells in body:
                names = re.findall("`(.*?)`", cells[0])
                assert names, cells
                told += [owner + name for owner in owners for name in names]
    spelled = [name for name in told if not name.endswith("*")]
    assert len(spelled) == len(set(spelled)), "a name has two rows"
    others: set[str] = set()
    for star in set(told) - set(spelled):
        owner = star.removesuffix("*")
        members = {name for name in known - set(spelled) if re.fullmatch(re.escape(owner) + r"\w+", name)}
        assert owner and members, f"{star} stands for nothing"
        others |= members
    assert set(spelled) | others == known


def found(name: str) -> object:
    """Returns the object that a name of the package stands for; ``Robot(realtime=)`` is the keyword of that name."""
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
    """A cell that begins with ``same: `` names an object that has attributes with the names of its row."""
    for names, cell in rows(BOOK / page):
        for ours in re.findall("`(.*?)`", cell):
            item = found(ours)
            if cell.startswith("same: "):
                for name in names:
                    of(item, name)
