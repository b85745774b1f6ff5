"""Names that were nearly right."""

from __future__ import annotations

from collections.abc import Iterable

from . import _core


def nearest(name: object, known: Iterable[str], what: str) -> KeyError:
    """The error for a name that is none of those known, with the nearest one."""
    names = list(known)
    near = _core.closest(str(name), names)
    hint = f"; did you mean {near!r}?" if near else f"; there are {', '.join(names)}"
    return _NoSuchName(f"{what} {name!r}{hint}")


class _NoSuchName(KeyError):
    def __str__(self) -> str:  # KeyError would show the text in quotes
        return str(self.args[0])
