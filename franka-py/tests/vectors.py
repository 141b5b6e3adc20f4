"""The project's golden vectors, made by other implementations; see ``tests/vectors/README.md``."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

DIRECTORY = Path(__file__).parents[2] / "tests" / "vectors"


@functools.cache
def load(name: str) -> Any:
    """Returns the file of this name, such as ``model/ik_vectors``, as Python objects."""
    return json.loads((DIRECTORY / f"{name}.json").read_text())
