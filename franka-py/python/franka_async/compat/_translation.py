"""Exceptions of the original packages instead of the exceptions of this package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from .. import errors


def text_of(error: errors.FrankaError) -> str:
    """Returns the text of an error, without the parts that the original packages lack: the address and cause of a missing
    connection, the argument that was out of range, and the advice.
    """
    text = str(error).removesuffix(" (call `recover` first)")
    is_connecting = isinstance(error, errors.ConnectError)
    kinds = ("refused", "connection_closed", "realtime") if is_connecting else ("out_of_range", "invalid_argument")
    if error.kind in kinds:
        return text.split(" (")[0]
    return text


def translation(exception: Callable[[errors.FrankaError], Exception]) -> Callable[[], AbstractContextManager[None]]:
    """Returns a context that translates exceptions of this package to the exceptions that ``exception`` makes of them. The
    exception of this package is the cause.
    """

    @contextmanager
    def translated() -> Iterator[None]:
        try:
            yield
        except errors.FrankaError as error:
            raise exception(error) from error

    return translated
