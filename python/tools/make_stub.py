"""Writes repose/_core.pyi, the types of the compiled part, from what the module says of itself
(pybind11 puts a signature into every docstring); --check compares instead."""

import inspect
import re
import sys
from pathlib import Path

from repose import _core

STUB = Path(__file__).resolve().parent.parent / "repose" / "_core.pyi"
HEAD = '''"""The compiled part of repose. Written by python/tools/make_stub.py."""

from typing import Any

import numpy
import numpy.typing

'''


def typed(signature: str) -> str:
    """A signature of pybind11 as one of Python."""
    signature = re.sub(r"repose\._core\.(\w+)", r"\1", signature)
    signature = re.sub(r"numpy\.ndarray\[numpy\.(\w+)\]", r"numpy.typing.NDArray[numpy.\1]", signature)
    signature = re.sub(r"(Dict|List|Tuple|Set)\[", lambda m: m.group(1).lower() + "[", signature)
    signature = re.sub(r"Optional\[([^\[\]]*)\]", r"\1 | None", signature)
    signature = re.sub(r"\b(handle|object)\b", "Any", signature)
    return signature.replace("arg0", "_arg0")


def function(name: str, thing: object, indent: str, decorator: str = "") -> str:
    doc = (thing.__doc__ or "").strip()
    first, _, rest = doc.partition("\n")
    match = re.fullmatch(rf"{re.escape(name)}(\(.*\) -> .*)", first)
    if match is None:
        raise SystemExit(f"{name}: its docstring begins with no signature: {first}")
    about = inspect.cleandoc(rest).strip()
    body = f'\n{indent}    """{about}"""' if about else " ..."
    return f"{decorator}{indent}def {name}{typed(match.group(1))}:{body}\n"


def property_of(name: str, thing: property, indent: str) -> str:
    first = (thing.fget.__doc__ or "").strip().partition("\n")[0]
    match = re.search(r"-> (.*)$", first)
    kind = typed(match.group(1)) if match else "Any"
    return f"{indent}@property\n{indent}def {name}(self) -> {kind}: ...\n"


def class_of(name: str, thing: type) -> str:
    if issubclass(thing, Exception):
        field = "problems: list[str]" if name == "InputError" else "result: Any"
        return f'class {name}({thing.__base__.__name__}):\n    """{thing.__doc__}"""\n    {field}\n'
    text = f'class {name}:\n    """{thing.__doc__}"""\n'
    for member, value in sorted(vars(thing).items()):
        if isinstance(value, property):
            text += property_of(member, value, "    ")
        elif isinstance(value, staticmethod):
            text += function(member, value.__func__, "    ", "    @staticmethod\n")
        elif member == "__init__" and "__init__(self: " not in (value.__doc__ or ""):
            continue  # made by other calls alone
        elif callable(value) and (not member.startswith("_") or member == "__init__"):
            text += function(member, value, "    ")
    return text


def stub() -> str:
    text = HEAD
    for name, thing in sorted(vars(_core).items()):
        if name.startswith("_"):
            continue
        if inspect.isclass(thing):
            text += class_of(name, thing) + "\n"
        elif callable(thing):
            text += function(name, thing, "") + "\n"
        else:
            text += f"{name}: {type(thing).__name__}\n\n"
    return text.rstrip() + "\n"


def main() -> int:
    wanted = stub()
    if "--check" not in sys.argv:
        STUB.write_text(wanted, encoding="utf-8")
        return 0
    compile(wanted, str(STUB), "exec")
    if STUB.exists() and STUB.read_text(encoding="utf-8") == wanted:
        return 0
    print(f"{STUB} is not what the module has: python3 python/tools/make_stub.py writes it anew", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
