"""Scenes put together by calls."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._builders import Builders
from .simulation import _plain, check, run

if TYPE_CHECKING:
    from typing_extensions import Self

    from .results import Result


class Scene(dict, Builders):
    """A scene: a dict of the form of a scene file, with a method for every part.

    Every method returns the scene, so that calls may follow each other. Whatever takes a scene takes this one, and its parts may
    be read and changed as those of any dict.

    Parameters
    ----------
    title: str, optional
        What the scene is about; it heads reports.
    scene: mapping, optional
        A scene to start from, e.g. one that was read from a file; it is not changed.

    >>> scene = Scene("A ball on rubber").neo_hooke("rubber", E=2, nu=0.45)
    >>> scene["materials"]
    {'rubber': {'neo_hooke': {'E': 2, 'nu': 0.45}}}
    """

    def __init__(self, title: str | None = None, scene: Mapping[str, Any] | None = None) -> None:
        super().__init__(_copied(scene or {}))
        self.setdefault("covact", 1)
        if title is not None:
            self["title"] = title

    def material(self, name: str, known: str) -> Self:
        """A well-known material by its name, `"steel"` or `"rubber_50"` for instance. Such a material asks for :meth:`units`.

        Parameters
        ----------
        name: str
            Name of the material in the scene.
        known: str
            What it is.
        """
        return self._put("materials", name, known)

    def check(self, folder: str | os.PathLike | None = None) -> dict[str, Any]:
        """What would be computed (:func:`covact.check`)."""
        return check(self, folder)

    def run(self, out: str | os.PathLike | None = None, **options: Any) -> Result:
        """Solves the scene (:func:`covact.run`)."""
        return run(self, out, **options)

    def save(self, path: str | os.PathLike) -> Path:
        """Writes the scene to a file, which ``covact run`` takes. Meshes and surfaces of arrays have no place in a file.

        Raises
        ------
        TypeError
            A mesh or surface of arrays.
        """
        text = json.dumps(self, default=_plain, indent=2)
        path = Path(path)
        path.write_text(text + "\n", encoding="utf-8")
        return path

    def _put(self, section: str, name: str, part: Any) -> Self:
        self.setdefault(section, {})[name] = part
        return self

    def _join(self, section: str, name: str, key: str, part: dict[str, Any]) -> Self:
        parts = self.get(section, {})
        if name not in parts:
            there = ", ".join(f"`{one}`" for one in parts) or "none"
            raise KeyError(f"the scene has no `{name}` among its {section}: {there}")
        parts[name].setdefault(key, {}).update(part)
        return self

    def _set(self, section: str, part: dict[str, Any]) -> Self:
        self.setdefault(section, {}).update(part)
        return self

    def _add_stage(self, stage: dict[str, Any]) -> Self:
        self.setdefault("stages", []).append(stage)
        return self


def _copied(part: Any) -> Any:
    """Dicts and lists of their own; what they hold at last is shared."""
    if isinstance(part, Mapping):
        return {key: _copied(value) for key, value in part.items()}
    return [_copied(value) for value in part] if isinstance(part, list) else part
