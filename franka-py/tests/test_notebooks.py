"""The notebooks run from top to bottom."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat: Any = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

DIRECTORY = Path(__file__).parents[1] / "notebooks"


@pytest.mark.parametrize("path", sorted(DIRECTORY.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "notebooks are kept without outputs"
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = sum("image/png" in output.get("data", {}) for output in outputs)
    text = "".join(output.get("text", "") for output in outputs)
    assert not any(output.get("name") == "stderr" for output in outputs), text
    if path.stem == "quickstart":
        assert pictures == 4
        assert "cancelled: the arm brakes" in text and "(cartesian_reflex)" in text and "home after" in text


def test_there_is_a_notebook() -> None:
    assert (DIRECTORY / "quickstart.ipynb").is_file()
