"""Runs: scenes in, results as arrays out."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from . import _covact
from .geometry import Surface
from .mesh import Mesh
from .progress import Progress
from .results import Body, History, Result

# What stands in the text of a scene where Python has given arrays.
_GIVEN = "given as arrays"


def _plain(value: Any) -> Any:
    """What JSON has no word for, in its words."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene cannot hold {type(value).__name__}")


def _source(scene: Any, folder: str | os.PathLike | None = None) -> dict[str, Any]:
    """A scene as the compiled half takes it."""
    source: dict[str, Any] = {"path": None, "text": "", "folder": os.fspath(folder or "."), "meshes": {}, "surfaces": {}}
    if isinstance(scene, (str, os.PathLike)):
        if isinstance(scene, str) and scene.lstrip().startswith("{"):
            return source | {"text": scene}
        return source | {"path": os.fspath(scene)}
    if not isinstance(scene, Mapping):
        raise TypeError(f"a scene is a dict, a path or a text, not {type(scene).__name__}")
    scene = dict(scene)
    scene.setdefault("covact", 1)
    for section, stands_for in (("bodies", _mesh), ("surfaces", _surface)):
        if isinstance(scene.get(section), Mapping):
            scene[section] = {name: stands_for(name, part, source) for name, part in scene[section].items()}
    return source | {"text": json.dumps(scene, default=_plain, indent=1)}


def _mesh(name: str, body: Any, source: dict[str, Any]) -> Any:
    if isinstance(body, Mapping) and isinstance(body.get("mesh"), Mesh):
        mesh = body["mesh"]
        source["meshes"][name] = mesh.arrays()
        return dict(body) | {"mesh": {"file": {"path": _GIVEN, **mesh.options()}}}
    return body


def _surface(name: str, surface: Any, source: dict[str, Any]) -> Any:
    if isinstance(surface, Surface):
        surface = {"patches": surface}
    if isinstance(surface, Mapping) and isinstance(surface.get("patches"), Surface):
        source["surfaces"][name] = surface["patches"]._surface
        rest = {key: value for key, value in surface.items() if key != "patches"}
        return rest | {"cad": {"file": _GIVEN}}
    return surface


def check(scene: Any, folder: str | os.PathLike | None = None) -> dict[str, Any]:
    """What would be computed, without solving it: bodies, surfaces, pairs with their sizes.

    Raises
    ------
    SceneError
        With all that is wrong with the scene.
    """
    return json.loads(_covact.check(_source(scene, folder)))


def _told(observers: list[Callable[[dict[str, Any]], Any]]) -> Callable[[str], Any] | None:
    """What hands events, which come as JSON texts, to observers."""
    if not observers:
        return None

    def tell(text: str) -> None:
        event = json.loads(text)
        for observer in observers:
            observer(event)

    return tell


class Simulation:
    """A run that is stepped, and read in memory.

    Parameters
    ----------
    scene: dict, path or text
        What is solved. Paths in a dict are relative to `folder`, by default the current one; those in a file to the file.
    out: path, optional
        Folder for results as ``covact run`` writes them. Without it no file is written.
    resume, replace: bool
        Go on with the run that is in `out`; or replace it.
    threads: int
        0 takes the scene's number, and where that is 0 too, what the machine has.
    observer: callable, optional
        Gets every event of the run as a dict, e.g. ``{"event": "iteration", "step": 1, ...}``. It may raise an exception,
        which ends the run; it cannot read the simulation, which is at work then.
    progress: bool
        Show how far the run has got: a bar in a notebook or a terminal, lines elsewhere (:class:`covact.Progress`).

    Raises
    ------
    SceneError
        With all that is wrong with the scene.
    """

    def __init__(
        self,
        scene: Any,
        out: str | os.PathLike | None = None,
        *,
        folder: str | os.PathLike | None = None,
        resume: bool = False,
        replace: bool = False,
        threads: int = 0,
        observer: Callable[[dict[str, Any]], Any] | None = None,
        progress: bool = False,
    ) -> None:
        self._progress = Progress() if progress else None
        told = _told([one for one in (self._progress, observer) if one is not None])
        where = None if out is None else Path(out)
        self._run = _covact.Simulation(_source(scene, folder), where, resume, replace, threads, told)
        self.out = where

    @contextmanager
    def _shown(self) -> Iterator[None]:
        """Shows progress while the run is at work."""
        if self._progress is None:
            yield
            return
        # A stage that was begun since may end later.
        self._progress.end = self.end_time
        try:
            yield
        except BaseException:
            self._progress.pause(keep=True)
            raise
        self._progress.pause()

    def step(self) -> _covact.Step | None:
        """Goes on to the next accepted step; None at the end of the run.

        A run that finds its defaults unfit, slave points that miss what lies between them for instance, begins again at time 0
        with others: what is returned then is its first step, of the next ``attempt``, and what was read before is of no use.

        Raises
        ------
        NotConverged
            No equilibrium was found, even with the smallest step; the simulation stays at the last accepted step.
        KeyboardInterrupt
            Ctrl-C; the next call goes on.
        """
        with self._shown():
            return self._run.step()

    def __iter__(self) -> Iterator[_covact.Step]:
        while (step := self.step()) is not None:
            yield step

    def run(self, callback: Callable[[Simulation, _covact.Step], Any] | None = None) -> Result:
        """Goes on to the end, or as far as it gets: `Result.status` says which.

        `callback` is called after every accepted step with the simulation and the step, and ends the run where it returns
        False. It sees the steps of a run that begins again (:meth:`step`) anew, with another ``step.attempt``.
        """
        if callback is None:
            with self._shown():
                self._run.run()
            return self.result()
        try:
            for step in self:
                go_on = callback(self, step)
                # False of numpy too, but not the None of a callback that says nothing.
                if go_on is not None and not go_on:
                    break
        except _covact.NotConverged:
            # As without a callback, the status tells.
            pass
        return self.result()

    def begin_stage(self, stage: Mapping[str, Any]) -> None:
        """Ends the present stage of the run at the last accepted step, and goes on in another one, which becomes the last.

        `stage` is a dict of the form of the scene's ``stages``: ``name``, ``until``, ``tools`` with the translations and ``loads``
        with the factors at its end, which tools and loads reach evenly from where they are, ``contacts``, ``supports``,
        ``release``. It may be called between steps and in the callback of :meth:`run`; the scene needs at least one stage.

        Raises
        ------
        SceneError
            What is wrong with the stage, or why none can begin; the run is as it was.
        """
        self._run.begin_stage(json.dumps(dict(stage), default=_plain))

    def result(self) -> Result:
        """All results so far, in arrays of their own."""
        bodies = {name: self.body(name) for name in self.names["bodies"]}
        return Result(json.loads(self._run.summary()), self.history, bodies)

    @property
    def time(self) -> float:
        """Time at the end of the last accepted step; 0 before the first."""
        return self._run.time

    @property
    def end_time(self) -> float:
        """Time at the end of the run, as the scene and the stages that were begun say."""
        return self._run.end_time

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return self._run.steps

    @property
    def done(self) -> bool:
        """Whether the end time has been reached."""
        return self._run.done

    @property
    def status(self) -> str | None:
        """How the run ended; None while it goes on."""
        return self._run.status

    @property
    def warnings(self) -> list[str]:
        """What the user should know, so far."""
        return self._run.warnings

    @property
    def names(self) -> dict[str, list[str]]:
        """Names of ``bodies``, ``surfaces``, ``supports`` and ``contacts``."""
        return self._run.names()

    @property
    def history(self) -> History:
        """Columns of ``history.csv`` by name, a number for every accepted step."""
        columns, rows = self._run.history()
        return History(columns, rows)

    def value(self, column: str) -> float:
        """The last number of a column of the history, e.g. ``pressure.max`` or ``probe.centre.z``."""
        return self._run.value(column)

    def force(self, name: str) -> np.ndarray:
        """Force (3,) of a rigid surface or support on the bodies at the last accepted step."""
        return np.array(self._run.force(name)[0])

    def moment(self, name: str) -> np.ndarray:
        """Moment (3,) about the origin of a rigid surface or support on the bodies."""
        return np.array(self._run.force(name)[1])

    def contact_force(self, contact: str) -> np.ndarray:
        """Forces (2, 3) of a contact between bodies on its slave and on its master."""
        return np.array([force for force, _ in self._run.contact_force(contact)])

    def displacements(self, body: str) -> np.ndarray:
        """Displacements (n, 3) of the nodes of a body."""
        return self._run.displacements(body)

    def body(self, name: str) -> Body:
        """Mesh and fields of a body at the last accepted step."""
        nodes, cells, sets = self._run.mesh(name)
        return Body(name, nodes, cells, self._run.fields(name), sets)


def run(
    scene: Any,
    out: str | os.PathLike | None = None,
    *,
    folder: str | os.PathLike | None = None,
    resume: bool = False,
    replace: bool = False,
    threads: int = 0,
    observer: Callable[[dict[str, Any]], Any] | None = None,
    progress: bool = False,
    callback: Callable[[Simulation, _covact.Step], Any] | None = None,
) -> Result:
    """Solves a scene; without `out` no file is written. Parameters as those of :class:`Simulation` and its ``run``.

    Returns
    -------
    Result
        History, fields and account. A run that does not reach its end returns what there is, with a status that says so.
    """
    simulation = Simulation(
        scene, out, folder=folder, resume=resume, replace=replace, threads=threads, observer=observer, progress=progress
    )
    return simulation.run(callback)
