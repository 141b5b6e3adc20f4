"""Writes the stub of ``franka_async.sync``, whose methods are those of the native classes, from that of the native module.

``python franka-py/tests/sync_stub.py`` after a change there; a test compares them.
"""

from __future__ import annotations

import ast
from pathlib import Path

import franka_async

PACKAGE = Path(franka_async.__file__).parent
STUB = PACKAGE / "sync" / "__init__.pyi"

WAITED = {"Motion": "MotionReport", "Follow": "MotionReport", "Engagement": "Arm"}
"""What awaiting these gives."""

ARGUMENTS = {("Team", "run"): "Sequence[Callable[[_native.Arm], Motion | Follow]]"}
"""What methods take in the place of their argument."""

CONTEXT = {"__aenter__": "__enter__", "__aexit__": "__exit__"}


def stub() -> str:
    """The text of the stub."""
    from franka_async import sync

    tree = ast.parse((PACKAGE / "_native.pyi").read_text())
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
    lines = ['"""Made by ``tests/sync_stub.py`` from the stub of the native module."""', ""]
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
    """What the method that is annotated so returns once it has waited."""
    if isinstance(returns, ast.Subscript) and ast.unparse(returns.value) == "Operation":
        return returns.slice
    if isinstance(returns, ast.Name) and returns.id in WAITED:
        return ast.Name(WAITED[returns.id])
    return returns


if __name__ == "__main__":
    STUB.write_text(stub())
