"""Writes covact/_builders.py, the methods of `covact.Scene`, from the JSON schema of scenes.

    python3 assets/make_builders.py

A test compares the file with what this program would write.
"""

from __future__ import annotations

import json
import re
import textwrap
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SCHEMA = ROOT / "examples" / "scenes" / "schema.json"
TARGET = ROOT / "python" / "covact" / "_builders.py"

HEAD = '''"""Methods of `covact.Scene`, a method for every part of a scene: written by assets/make_builders.py from the schema of scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .geometry import Surface
from .mesh import Mesh

if TYPE_CHECKING:
    from typing_extensions import Self
'''


class Schema:
    """The schema, its references followed."""

    def __init__(self) -> None:
        self.root = json.loads(SCHEMA.read_text(encoding="utf-8"))

    def of(self, name: str) -> dict[str, Any]:
        return self.root["$defs"][name]

    def follow(self, part: dict[str, Any]) -> dict[str, Any]:
        while "$ref" in part:
            part = self.of(part["$ref"].rsplit("/", 1)[1])
        return part

    def object(self, part: dict[str, Any]) -> dict[str, Any]:
        """The form of a part that is written with all its keys."""
        part = self.follow(part)
        if "properties" in part:
            return part
        forms = [self.follow(form) for form in part.get("anyOf", []) + part.get("oneOf", [])]
        return next(self.object(form) for form in forms if form.get("type") != "null")

    def kinds(self, name: str) -> list[tuple[str, dict[str, Any]]]:
        """Kinds of a part that is written `{"kind": {...}}`."""
        found = []
        for form in self.of(name).get("oneOf", []) + self.of(name).get("anyOf", []):
            for kind in form.get("oneOf", [form]):
                found += [(key, value) for key, value in kind.get("properties", {}).items()]
        return found

    def type(self, part: dict[str, Any]) -> str:
        """The type of a value, for whoever reads signatures."""
        part = {key: value for key, value in part.items() if key not in ("description", "default")}
        if "$ref" in part:
            return self.type(self.follow(part))
        if "const" in part:
            return f'Literal["{part["const"]}"]'
        if "enum" in part:
            return "Literal[" + ", ".join(json.dumps(word) for word in part["enum"]) + "]"
        forms = part.get("anyOf") or (part.get("oneOf") if "properties" not in part else None)
        if forms:
            return union([self.type(form) for form in forms])
        kinds = part.get("type", "any")
        return union([self.plain(kind, part) for kind in ([kinds] if isinstance(kinds, str) else kinds)])

    def plain(self, kind: str, part: dict[str, Any]) -> str:
        if kind == "array":
            inside = self.type(part.get("items", {}))
            return f"Sequence[{inside}]" + (" | np.ndarray" if inside in ("float", "int") else "")
        names = {"number": "float", "integer": "int", "boolean": "bool", "string": "str", "object": "Mapping[str, Any]", "null": "None"}
        return names.get(kind, "Any")


def union(types: list[str]) -> str:
    """One type of several, each once; words of one `Literal` together."""
    parts = [part for kind in types for part in split(kind)]
    words = [part[len("Literal[") : -1] for part in parts if part.startswith("Literal[")]
    rest = list(dict.fromkeys(part for part in parts if not part.startswith("Literal[") and part != "None"))
    if words and "str" not in rest:
        rest.insert(0, f"Literal[{', '.join(dict.fromkeys(words))}]")
    return " | ".join(rest) or "None"


def split(kind: str) -> list[str]:
    """The members of a union, which stand outside of brackets."""
    parts, depth, start = [], 0, 0
    for at, letter in enumerate(kind):
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "|" and depth == 0:
            parts.append(kind[start:at].strip())
            start = at + 1
    return [*parts, kind[start:].strip()]


def sentence(text: str) -> str:
    """Text of the schema as the words of a docstring."""
    text = " ".join(text.replace("\\", "\\\\").split())
    return text if text.endswith(".") else text + "."


class Method:
    """A method that adds a part to a section of the scene, or replaces one."""

    def __init__(self, schema: Schema, name: str, about: str) -> None:
        self.schema, self.name, self.about = schema, name, about
        #: Name, type, meaning, whether it must be given, whether it may be given by its place.
        self.arguments: list[tuple[str, str, str, bool, bool]] = []

    def take(self, form: dict[str, Any], leave: tuple[str, ...] = (), first: tuple[str, ...] = (), must: tuple[str, ...] = ()) -> list[str]:
        """Arguments for the keys of a form; those of `first` may be given by their place. Returns the keys."""
        required = [*form.get("required", []), *must]
        keys = [key for key in form["properties"] if key not in leave]
        order = list(first) + sorted(set(keys) - set(first), key=lambda key: (key not in required, required.index(key) if key in required else 0, key))
        for key in order:
            value = form["properties"][key]
            meaning = value.get("description") or self.schema.follow(value).get("description", "")
            self.arguments.append((key, self.schema.type(value), meaning, key in required, key in first))
        return order

    def argument(self, name: str, kind: str, meaning: str) -> None:
        self.arguments.append((name, kind, meaning, True, True))

    def text(self, body: str) -> str:
        by_place = [argument for argument in self.arguments if argument[4]]
        by_name = sorted((argument for argument in self.arguments if not argument[4]), key=lambda argument: not argument[3])
        lines = [f"    def {self.name}(", "        self,"]
        lines += [declared(argument) for argument in by_place]
        if by_name:
            lines += ["        *,", *[declared(argument) for argument in by_name]]
        lines += ["    ) -> Self:", *wrapped(f'"""{sentence(self.about)}', 8), "", "        Parameters", "        ----------"]
        for name, kind, meaning, must, _ in by_place + by_name:
            lines.append(f"        {name}: {spoken(kind)}{'' if must else ', optional'}")
            lines += wrapped(sentence(meaning), 12)
        return "\n".join([*lines, '        """', textwrap.indent(body, " " * 8)]) + "\n"


def spoken(kind: str) -> str:
    """A type in the words of a docstring."""
    kind = re.sub(r"Sequence\[(float|int)\] \| np\.ndarray", r"array of \1", kind)
    kind = kind.replace("Mapping[str, Any]", "dict")
    kind = re.sub(r"Literal\[([^]]*)\]", lambda words: ", ".join(words[1].split(", ")), kind)
    while "Sequence[" in kind:
        kind = re.sub(r"Sequence\[([^][]*)\]", r"list of (\1)", kind)
    return re.sub(r"\((\w+)\)", r"\1", kind).replace(" | ", " or ")


def declared(argument: tuple[str, str, str, bool, bool]) -> str:
    name, kind, _, must, _ = argument
    return f"        {name}: {kind}," if must else f"        {name}: {kind} | None = None,"


def wrapped(text: str, indent: int) -> list[str]:
    space = " " * indent
    return textwrap.wrap(text, 120, initial_indent=space, subsequent_indent=space, break_long_words=False, break_on_hyphens=False)


def given(keys: list[str]) -> str:
    return "_given(" + ", ".join(f"{key}={key}" for key in keys) + ")"


def methods(schema: Schema) -> list[str]:
    written = []
    # Materials, a method for each law.
    for kind, value in schema.kinds("MaterialChoice"):
        method = Method(schema, kind, f"A material. {sentence(value['description'])}")
        method.argument("name", "str", "Name of the material.")
        keys = method.take(schema.object(value))
        written.append(method.text(f'return self._put("materials", name, {{"{kind}": {given(keys)}}})'))
    # Bodies, a method for each generator.
    body = schema.object(schema.of("Body"))
    for kind, value in [*schema.kinds("MeshSource"), ("nurbs", body["properties"]["nurbs"])]:
        name = "mesh_file" if kind == "file" else kind
        method = Method(schema, name, f"A deformable body. {sentence(value['description'])}")
        method.argument("name", "str", "Name of the body.")
        method.argument("material", "str", "Name of the material.")
        form = schema.object(value)
        both = sorted(set(form["properties"]) & set(body["properties"]))
        assert not both, both
        mesh = method.take(form, first=tuple(key for key in ("path", "file") if key in form["properties"]))
        rest = method.take(body, leave=("mesh", "nurbs", "material"))
        inner = f'"mesh": {{"{kind}": {given(mesh)}}}' if kind != "nurbs" else f'"nurbs": {given(mesh)}'
        written.append(method.text(f'return self._put("bodies", name, {{{inner}, **{given(["material", *rest])}}})'))
    method = Method(schema, "mesh", "A deformable body with a mesh of arrays.")
    method.argument("name", "str", "Name of the body.")
    method.argument("material", "str", "Name of the material.")
    method.argument("mesh", "Mesh", "The mesh.")
    rest = method.take(body, leave=("mesh", "nurbs", "material"))
    written.append(method.text(f'return self._put("bodies", name, {given(["mesh", "material", *rest])})'))
    # Rigid surfaces, a method for each shape.
    surface = schema.of("Surface")
    shapes = [form["required"][0] for form in surface["oneOf"]]
    for kind in shapes:
        value = surface["properties"][kind]
        method = Method(schema, kind, f"A rigid surface. {sentence(value['description'])}")
        method.argument("name", "str", "Name of the surface.")
        form = schema.object(value)
        # Keys that the shape and the surface both have would be one argument.
        both = sorted(set(form["properties"]) & (set(surface["properties"]) - set(shapes)))
        assert not both, both
        shape = method.take(form, first=tuple(key for key in ("file",) if key in form["properties"]))
        rest = method.take(surface, leave=tuple(shapes))
        written.append(method.text(f'return self._put("surfaces", name, {{"{kind}": {given(shape)}, **{given(rest)}}})'))
    method = Method(schema, "patches", "A rigid surface of patches that were loaded or made of arrays.")
    method.argument("name", "str", "Name of the surface.")
    method.argument("patches", "Surface", "The patches.")
    rest = method.take(surface, leave=tuple(shapes))
    written.append(method.text(f'return self._put("surfaces", name, {given(["patches", *rest])})'))
    motion = Method(schema, "move", "Moves a rigid surface of the scene over time.")
    motion.argument("surface", "str", "Name of the surface.")
    keys = motion.take(schema.object(schema.of("Motion")))
    written.append(motion.text(f'return self._join("surfaces", surface, "motion", {given(keys)})'))
    # What has a name and one form.
    for name, section, form, first, about in (
        ("contact", "contacts", "Contact", ("slave", "master"), "A contact pair."),
        ("support", "supports", "Support", ("on",), None),
        ("load", "loads", "Load", ("on",), None),
        ("probe", "probes", "Probe", (), None),
    ):
        method = Method(schema, name, about or schema.of(form)["description"])
        method.argument("name", "str", f"Name of the {name}.")
        keys = method.take(schema.object(schema.of(form)), first=first)
        written.append(method.text(f'return self._put("{section}", name, {given(keys)})'))
    method = Method(schema, "stage", schema.of("Stage")["description"])
    keys = method.take(schema.of("Stage"), first=("name",))
    written.append(method.text(f"return self._add_stage({given(keys)})"))
    # What a scene has once.
    for name in ("units", "solution", "output"):
        value = schema.root["properties"][name]
        method = Method(schema, name, f"{sentence(value['description'])} Keys that are not given stay as they are.")
        keys = method.take(schema.object(value))
        written.append(method.text(f'return self._set("{name}", {given(keys)})'))
    return written


CLASS = '''

def _given(**keys: Any) -> dict[str, Any]:
    """The keys that were given."""
    return {key: value for key, value in keys.items() if value is not None}


class Builders:
    """A method for every part of a scene."""

    def _put(self, section: str, name: str, part: dict[str, Any]) -> Self:
        raise NotImplementedError

    def _join(self, section: str, name: str, key: str, part: dict[str, Any]) -> Self:
        raise NotImplementedError

    def _set(self, section: str, part: dict[str, Any]) -> Self:
        raise NotImplementedError

    def _add_stage(self, stage: dict[str, Any]) -> Self:
        raise NotImplementedError

'''


def text() -> str:
    """What the file should hold."""
    return HEAD + CLASS + "\n".join(methods(Schema()))


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
