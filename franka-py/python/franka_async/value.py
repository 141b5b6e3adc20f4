"""Values that hold arrays."""

from __future__ import annotations

import numpy as np

__all__ = ["Value"]


class Value:
    """Base of frozen dataclasses that contain arrays. Two values are equal if all fields are equal."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(np.array_equal(field, other.__dict__[name]) for name, field in self.__dict__.items())

    __hash__ = None  # type: ignore[assignment]
