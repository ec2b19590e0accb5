# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Type stubs of the module as it is: `PYTHONPATH=build/python python3 tools/make_stubs.py FOLDER`.

Writes one .pyi a public module into FOLDER.  The build does so.
"""

import inspect
import pathlib
import re
import sys

import explica
from explica import _explica
from explica._signature import annotation, signature_of

HEAD = '''# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Written by make_stubs.py from the module; do not edit.
'''
NAMES = {
    "typing": "Any Dict Iterable List Literal Optional Sequence Tuple Union".split(),
    "types": "Image Path Progress Surface Target".split(),
}
SUBMODULES = ("provenance",)


def written(value):
    """A default as the stub says it."""
    plain = value is None or isinstance(value, (bool, int, str))
    return repr(value) if plain or (isinstance(value, float) and abs(value) < 1e300) else "..."


def parameter(p):
    kind = {p.VAR_POSITIONAL: "*", p.VAR_KEYWORD: "**"}.get(p.kind, "")
    text = kind + p.name
    if p.annotation is not p.empty:
        note = p.annotation if isinstance(p.annotation, str) else p.annotation.__name__
        text += f": {note}"
    return text if p.default is p.empty else f"{text} = {written(p.default)}"


def definition(name, signature, indent=""):
    parts, keyword_only = [], False
    for p in signature.parameters.values():
        if p.kind is p.VAR_POSITIONAL:
            keyword_only = True
        if p.kind is p.KEYWORD_ONLY and not keyword_only:
            parts.append("*")
            keyword_only = True
        parts.append(parameter(p))
    result = signature.return_annotation
    result = result if isinstance(result, str) else getattr(result, "__name__", "None")
    line = f"{indent}def {name}({', '.join(parts)}) -> {result}: ..."
    if len(line) <= 100:
        return line + "\n"
    inner = "".join(f"{indent}    {part},\n" for part in parts)
    return f"{indent}def {name}(\n{inner}{indent}) -> {result}: ...\n"


def signature(function, keywords):
    """The signature of a Python function, or of a compiled one from its docstring."""
    try:
        return inspect.signature(function)
    except ValueError:
        name = function.__name__
        return signature_of(function.__doc__, keywords.get(name, []))


def class_stub(name, kind, keywords):
    if issubclass(kind, BaseException):
        return f"class {name}({kind.__base__.__name__}): ...\n"
    text = f"class {name}:\n"
    members = {}
    for base in reversed(kind.__mro__):
        if base.__name__ not in ("object", "pybind11_object"):
            members.update(vars(base))
    for member, value in members.items():
        if isinstance(value, property):
            result = value.fget.__doc__.split("\n")[0].rpartition(" -> ")[2]
            text += f"    @property\n    def {member}(self) -> {annotation(result, False)}: ...\n"
        elif callable(value) and member in ("__init__", "__len__") or not member.startswith("_"):
            found = signature(getattr(kind, member), keywords)
            first, *rest = found.parameters.values()
            found = found.replace(parameters=[inspect.Parameter("self", first.kind), *rest])
            text += definition(member, found, "    ")
    return text


def stub(module, keywords, is_package=False):
    """The stub of a module: its public names."""
    body = ""
    for name in sorted(module.__all__, key=str.lower):
        value = getattr(module, name)
        if inspect.ismodule(value):
            continue
        if inspect.isclass(value):
            body += class_stub(name, value, keywords)
        else:
            body += definition(name, signature(value, keywords))
    used = set(re.findall(r"\w+", body))
    head = HEAD
    if "pathlib" in used:
        head += "import pathlib\n"
    typing = [name for name in NAMES["typing"] if name in used]
    if typing:
        head += f"from typing import {', '.join(typing)}\n"
    if "np" in used:
        head += "\nimport numpy as np\n"
    arrays = [name for name in ("ArrayLike", "NDArray") if name in used]
    if arrays:
        head += ("" if "np" in used else "\n") + f"from numpy.typing import {', '.join(arrays)}\n"
    if is_package:
        head += "\n" + "".join(f"from . import {name} as {name}\n" for name in SUBMODULES + ("types",))
    types = [name for name in NAMES["types"] if name in used]
    if types:
        head += ("" if is_package else "\n") + f"from .types import {', '.join(types)}\n"
    if is_package:
        head += "\n__version__: str\n"
    return f"{head}\n{body}"


def main():
    folder = pathlib.Path(sys.argv[1])
    (folder / "__init__.pyi").write_text(stub(explica, _explica.keywords, is_package=True))
    for name in SUBMODULES:
        keywords = getattr(getattr(_explica, name), "keywords", {})
        (folder / f"{name}.pyi").write_text(stub(getattr(explica, name), keywords))


if __name__ == "__main__":
    main()
