"""Contact between finite-element shells and CAD surfaces.

A scene says what is solved: bodies, rigid surfaces, contacts, supports, loads. It is a dict of the same form as a scene file
(``covact schema`` prints the form, the reference in docs/scene_format.md explains it), a path of such a file, or its text. Meshes
and surfaces may be arrays: :class:`Mesh` and :class:`covact.geometry.Surface` stand in a scene wherever a file may. :class:`Scene`
is such a dict with a method for every part.

>>> import covact
>>> result = covact.run("press.json")                        # doctest: +SKIP
>>> result.history["force.ball.z"][-1]                       # doctest: +SKIP
"""

from . import geometry
from ._covact import Error, NotConverged, SceneError, Step, __version__
from .mesh import Mesh
from .progress import Progress
from .results import Body, Result, read
from .scene import Scene
from .simulation import Simulation, check, run
from .study import Study, study

__all__ = [
    "Body",
    "Error",
    "Mesh",
    "NotConverged",
    "Progress",
    "Result",
    "Scene",
    "SceneError",
    "Simulation",
    "Step",
    "Study",
    "__version__",
    "check",
    "geometry",
    "read",
    "run",
    "study",
]
