# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Signatures of compiled functions, with the keywords that their option structs list.

A compiled function says in the first line of its docstring what it takes and gives, but for its
options it says `**kwargs`; their names, types and defaults are in the table `keywords` of the
module that defines it.  Both together make the signature that help(), editors and the stubs show.
"""

import inspect
import math
import re

_ARRAY = re.compile(r"numpy\.ndarray(?:\[numpy\.(\w+)(?:\[.*?\])?(?:, flags\.\w+)*\])?$")
_PLAIN = {"int": "int", "float": "float", "bool": "bool", "str": "str", "bytes": "bytes", "None": "None"}
_OPTION = {"flag": "bool", "integer": "int", "number": "float", "text": "str"}


def split(text):
    """Parts of a list of arguments or type parameters, at the commas outside of brackets."""
    parts, depth, quoted, start = [], 0, "", 0
    for at, c in enumerate(text):
        if quoted:
            quoted = "" if c == quoted else quoted
        elif c in "'\"":
            quoted = c
        elif c in "[(":
            depth += 1
        elif c in "])":
            depth -= 1
        elif c == "," and depth == 0:
            parts.append(text[start:at].strip())
            start = at + 1
    return [part for part in [*parts, text[start:].strip()] if part]


def annotation(text, given):
    """A type of pybind11's docstrings as the stubs name it; `given` for what a caller passes."""
    text = text.strip()
    array = _ARRAY.match(text)
    if array:
        if given:
            return "ArrayLike"
        return f"NDArray[np.{array[1]}]" if array[1] else "NDArray[Any]"
    if text in _PLAIN:
        return _PLAIN[text]
    if text == "os.PathLike":
        return "Path" if given else "pathlib.Path"
    if text in ("dict", "object", "list"):
        return {"dict": "Dict[str, Any]", "object": "Any", "list": "List[Dict[str, Any]]"}[text]
    outer, _, inner = text.partition("[")
    parts = [annotation(part, given) for part in split(inner[:-1])] if inner else []
    if outer == "List":
        if not given:
            return f"List[{parts[0]}]"
        return "ArrayLike" if parts[0] in ("int", "float", "bool") else f"Sequence[{parts[0]}]"
    if outer in ("Optional", "Tuple", "Dict"):
        return f"{outer}[{', '.join(parts)}]"
    name = text.rpartition(".")[2]
    return "Union[Viewpoints, ArrayLike]" if given and name == "Viewpoints" else name


def default(text):
    """A default as the docstring prints it, as a value."""
    numbers = re.match(r"array\((\[.*\])\)$", text)
    value = numbers[1] if numbers else text
    return eval(value, {"__builtins__": {}}, {"inf": math.inf})  # our own compiled module wrote it


def option_parameter(option):
    """The keyword parameter of one option of a struct."""
    kind = option["type"]
    if kind == "choice":
        name = "Literal[" + ", ".join(f'"{word}"' for word in option["choices"]) + "]"
    else:
        name = _OPTION.get(kind, "ArrayLike")
    if option["list"]:
        name = f"Sequence[{name}]"
    if option["optional"]:
        name = f"Optional[{name}]"
    value = option["default"]
    return inspect.Parameter(
        option["name"], inspect.Parameter.KEYWORD_ONLY,
        default=tuple(value) if isinstance(value, list) else value, annotation=name,
    )  # fmt: skip


def signature_of(document, keywords):
    """The signature in a compiled function's docstring, `**kwargs` replaced by its options."""
    taken, _, result = document.split("\n", 1)[0].partition(" -> ")
    parameters = []
    for part in split(taken[taken.index("(") + 1 : taken.rindex(")")]):
        if part == "**kwargs":
            parameters += [option_parameter(option) for option in keywords]
            continue
        name, _, rest = part.partition(": ")
        kind, has_default, value = rest.partition(" = ")
        given = "Optional[Progress]" if name == "progress" else annotation(kind, True)
        parameters.append(
            inspect.Parameter(
                name, inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=given,
                default=default(value) if has_default else inspect.Parameter.empty,
            )  # fmt: skip
        )
    return inspect.Signature(parameters, return_annotation=annotation(result or "None", False))


def replace_first(signature, place, count, name, kind):
    """A signature whose `count` parameters from `place` on are one of another name and type."""
    parameters = list(signature.parameters.values())
    one = inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=kind)
    parameters[place : place + count] = [one]
    return signature.replace(parameters=parameters)


def prose(document):
    """A docstring without the line that says the signature."""
    return document.split("\n\n", 1)[-1]
