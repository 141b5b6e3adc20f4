"""Writes the generated parts of the stubs: the docstrings in the stub of the native module, copied from the module, and the
stub of ``franka_async.sync``, whose methods are copied from the native classes.

``python franka-py/tests/stubs.py`` with the package installed, after a change of either; a test compares them.
"""

from __future__ import annotations

import ast
import inspect
from pathlib import Path
from typing import Any

from franka_async import _native

PACKAGE = Path(__file__).parents[1] / "python" / "franka_async"
NATIVE = PACKAGE / "_native.pyi"
SYNC = PACKAGE / "sync" / "__init__.pyi"

WAITED = {"Motion": "MotionReport", "Follow": "MotionReport", "Engagement": "Arm"}
"""Types of the results of awaiting these."""

ARGUMENTS = {("Team", "run"): "Sequence[Callable[[_native.Arm], Motion | Follow]]"}
"""Types of arguments of methods in the stub of ``franka_async.sync`` that differ."""

CONTEXT = {"__aenter__": "__enter__", "__aexit__": "__exit__"}


def native(text: str) -> str:
    """Returns the stub of the native module, with the module's docstrings instead of the docstrings in ``text``."""
    lines = text.splitlines()
    # From the last to the first: those above keep their lines.
    for node, docs in sorted(documented(ast.parse(text)), key=lambda found: -found[0].lineno):
        first, last = node.body[0], node.body[-1]
        if isinstance(node, ast.ClassDef):
            has_docs = ast.get_docstring(node) is not None
            end = first.end_lineno if has_docs else node.lineno
            lines[node.lineno : end] = docstring(docs, 4)
            continue
        begin = first.lineno - 1
        head = lines[begin][: first.col_offset].rstrip()
        if not head:
            begin -= 1
            head = lines[begin]
        lines[begin : last.end_lineno] = [head, *docstring(docs, node.col_offset + 4)] if docs else [f"{head} ..."]
    return "\n".join(lines) + "\n"


def documented(tree: ast.Module) -> list[tuple[ast.ClassDef | ast.FunctionDef, str]]:
    """Classes and functions of the stub, each with its docstring in the module."""
    found: list[tuple[ast.ClassDef | ast.FunctionDef, str]] = []
    for node in tree.body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef):
            continue
        owner = getattr(_native, node.name)
        found.append((node, inspect.cleandoc(owner.__doc__ or "")))
        for member in node.body if isinstance(node, ast.ClassDef) else ():
            if not isinstance(member, ast.FunctionDef) or member.name.startswith("__"):
                continue
            if any(ast.unparse(decorator).endswith(".setter") for decorator in member.decorator_list):
                continue
            of: Any = vars(owner)[member.name]
            found.append((member, inspect.cleandoc(getattr(of, "__func__", of).__doc__ or "")))
    return found


def docstring(text: str, indent: int) -> list[str]:
    """Returns the lines of a docstring; none for an empty text."""
    if not text:
        return []
    assert '"""' not in text and "\\" not in text, text
    first, *rest = text.splitlines()
    end = "" if rest else '"""'
    lines = [f'{" " * indent}"""{first}{end}', *(f"{' ' * indent}{line}".rstrip() for line in rest)]
    return [*lines, f'{" " * indent}"""'] if rest else lines


def sync() -> str:
    """Returns the stub of the classes that wait."""
    from franka_async import sync

    tree = ast.parse(NATIVE.read_text())
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom | ast.Import)]
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    private = [node for node in tree.body if isinstance(node, ast.AnnAssign) and ast.unparse(node.target).startswith("_")]
    body: list[ast.stmt] = []
    made = [name for name in sync.__all__ if name in classes]
    for name in made:
        for method in (member for member in classes[name].body if isinstance(member, ast.FunctionDef)):
            if method.name == "__new__":
                method.name, method.returns = "__init__", ast.Constant(None)
                method.args.args[0].arg = "self"
            method.name = CONTEXT.get(method.name, method.name)
            if (name, method.name) in ARGUMENTS:
                method.args.args[1].annotation = ast.parse(ARGUMENTS[name, method.name], mode="eval").body
            method.returns = waited(method.returns)
        body.append(classes[name])
    used = {node.id for part in body for node in ast.walk(part) if isinstance(node, ast.Name)}
    private = [node for node in private if ast.unparse(node.target) in used]
    used |= {node.id for part in private for node in ast.walk(part) if isinstance(node, ast.Name)}
    lines = ['"""Made by ``tests/stubs.py`` from the stub of the native module."""', ""]
    for node in imports:
        names = [alias.name for alias in node.names if (alias.asname or alias.name) in used]
        if isinstance(node, ast.Import):
            lines += [ast.unparse(node)] if any((alias.asname or alias.name) in used for alias in node.names) else []
        elif names:
            level = node.level + 1 if node.level else 0
            lines.append(f"from {'.' * level}{node.module or ''} import {', '.join(names)}")
    native = sorted((used & classes.keys()) - set(made))
    lines += [f"from .._native import {', '.join(native)}", "from .. import _native", "from . import tools as tools"]
    lines += ["", f"__all__ = {sync.__all__!r}", ""]
    return "\n".join(lines + [ast.unparse(node) + "\n" for node in private + body])


def waited(returns: ast.expr | None) -> ast.expr | None:
    """Returns the type of the result of a method with this annotation once it has waited."""
    if isinstance(returns, ast.Subscript) and ast.unparse(returns.value) == "Operation":
        return returns.slice
    if isinstance(returns, ast.Name) and returns.id in WAITED:
        return ast.Name(WAITED[returns.id])
    return returns


if __name__ == "__main__":
    NATIVE.write_text(native(NATIVE.read_text()))
    SYNC.write_text(sync())
