"""Runs a program with a package in a separate process: ``run_program.py PROGRAMS PROGRAM PACKAGE ADDRESS``. Prints its outcome.

The originals hold the interpreter while they wait, and raise the thread that connects to real-time priority.
"""

from __future__ import annotations

import importlib
import json
import sys
from typing import Any

import numpy as np


class Outcome:
    """Notes of a program on its way."""

    def __init__(self) -> None:
        self.notes: list[tuple[str, Any]] = []

    def note(self, name: str, value: Any) -> None:
        """Notes a value: text, truth, or numbers."""
        self.notes.append((name, np.asarray(value).tolist()))

    def attempt(self, name: str, call: Any, *arguments: Any, **named: Any) -> Any:
        """Calls it, and notes the class, the base and the text of its exception, or that it raises none."""
        return self._call(True, name, call, *arguments, **named)

    def usage(self, name: str, call: Any, *arguments: Any, **named: Any) -> Any:
        """The same without the text."""
        return self._call(False, name, call, *arguments, **named)

    def _call(self, with_text: bool, name: str, call: Any, *arguments: Any, **named: Any) -> Any:
        try:
            result = call(*arguments, **named)
        except Exception as error:
            kind = getattr(error, "kind", None)
            described = [type(error).__name__, type(error).__mro__[1].__name__, kind]
            text = str(error) if with_text and not isinstance(error, TypeError) else ""
            self.notes.append((name, [*described, text]))
            return None
        self.notes.append((name, "returned"))
        return result


def main() -> None:
    programs, program, package, address = sys.argv[1:]
    outcome = Outcome()
    run = getattr(importlib.import_module(programs), program)
    run(importlib.import_module(package), address, outcome)
    print("outcome", json.dumps(outcome.notes), flush=True)


if __name__ == "__main__":
    main()
