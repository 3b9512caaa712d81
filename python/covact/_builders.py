"""Methods of `covact.Scene`, a method for every part of a scene: written by assets/make_builders.py from the schema of scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .geometry import Surface
from .mesh import Mesh

if TYPE_CHECKING:
    from typing_extensions import Self


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

    def st_venant_kirchhoff(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        density: float | None = None,
    ) -> Self:
        """A material. Linear law between Green-Lagrange strain and second Piola-Kirchhoff stress: large rotations,
        small strains.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, below 0.5.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"st_venant_kirchhoff": _given(E=E, nu=nu, density=density)})

    def neo_hooke(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        density: float | None = None,
    ) -> Self:
        """A material. Compressible neo-Hooke: large strains.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, below 0.5.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"neo_hooke": _given(E=E, nu=nu, density=density)})

    def hencky(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        density: float | None = None,
    ) -> Self:
        """A material. Hencky: linear law between logarithmic strain and its conjugate stress. Moderately large strains,
        stretches of 1/2 to 2.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, below 0.5.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"hencky": _given(E=E, nu=nu, density=density)})

    def j2(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        hardening: Mapping[str, Any],
        density: float | None = None,
    ) -> Self:
        """A material. Metal plasticity after von Mises (J2) with isotropic hardening, in logarithmic strains: sheets
        that are formed.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, at most 0.49.
        hardening: dict
            Yield stress over equivalent plastic strain, as Kirchhoff stress: true stress times the change of volume,
            which is below 0.3 % in metals.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"j2": _given(E=E, nu=nu, hardening=hardening, density=density)})

    def hill48(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        hardening: Mapping[str, Any],
        r: Sequence[float] | np.ndarray,
        rolling: Sequence[float] | np.ndarray,
        density: float | None = None,
    ) -> Self:
        """A material. Metal plasticity after Hill (1948) with isotropic hardening, in logarithmic strains: rolled
        sheets, which narrow and thin by their direction.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, at most 0.49.
        hardening: dict
            Yield stress of a strip along the rolling direction over its plastic strain, as Kirchhoff stress: true
            stress times the change of volume, which is below 0.3 % in metals.
        r: array of float
            r-values `[r0, r45, r90]` of strips along the rolling direction, at 45 degrees to it and across it: plastic
            strain across the strip over that through its thickness. `[1, 1, 1]` is `j2`.
        rolling: array of float
            The rolling direction in space, of any length; in a curved sheet what of it lies in the sheet.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"hill48": _given(E=E, nu=nu, hardening=hardening, r=r, rolling=rolling, density=density)})

    def armstrong_frederick(
        self,
        name: str,
        *,
        E: float,
        nu: float,
        hardening: Mapping[str, Any],
        back_stress: Mapping[str, Any],
        density: float | None = None,
    ) -> Self:
        """A material. Metal plasticity after von Mises with kinematic hardening after Armstrong and Frederick beside
        the isotropic one, in logarithmic strains: metal that is bent and straightened, or loaded back and forth.

        Parameters
        ----------
        name: str
            Name of the material.
        E: float
            Young's modulus (force / length^2).
        nu: float
            Poisson's ratio, at most 0.49.
        hardening: dict
            Yield stress over equivalent plastic strain, as Kirchhoff stress: half of the width of the elastic range.
        back_stress: dict
            Kinematic hardening: by how much the elastic range moves with the flow.
        density: float, optional
            Mass per undeformed volume (force time^2 / length^4: t/mm^3 for N, mm and s). Loads by gravity ask for it.
        """
        return self._put("materials", name, {"armstrong_frederick": _given(E=E, nu=nu, hardening=hardening, back_stress=back_stress, density=density)})

    def plate(
        self,
        name: str,
        material: str,
        *,
        size: Sequence[float] | np.ndarray,
        thickness: float,
        elements: Sequence[int] | np.ndarray,
        center: Sequence[float] | np.ndarray | None = None,
        layers: int | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        spacing: Sequence[Literal["uniform"] | Mapping[str, Any]] | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. Flat plate; the thickness is along z.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        size: array of float
            Lengths along x and y.
        thickness: float
            Thickness.
        elements: array of int
            Elements along x and y.
        center: array of float, optional
            Middle of the mid-surface; in place of `origin`.
        layers: int, optional
            Elements through the thickness.
        origin: array of float, optional
            Corner (x0, y0) and height z0 of the mid-surface; default: the origin.
        spacing: list of ("uniform" or dict), optional
            Spacing of the nodes along x and y.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"mesh": {"plate": _given(size=size, thickness=thickness, elements=elements, center=center, layers=layers, origin=origin, spacing=spacing)}, **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def cylinder_panel(
        self,
        name: str,
        material: str,
        *,
        radius: float,
        thickness: float,
        angles: Sequence[float] | np.ndarray,
        y: Sequence[float] | np.ndarray,
        elements: Sequence[int] | np.ndarray,
        center: Sequence[float] | np.ndarray | None = None,
        layers: int | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. Part of a cylinder about the y axis; the thickness is radial.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        radius: float
            Radius of the mid-surface.
        thickness: float
            Thickness.
        angles: array of float
            First and last angle phi (degrees).
        y: array of float
            First and last y.
        elements: array of int
            Elements along phi and y.
        center: array of float, optional
            The same as `origin`.
        layers: int, optional
            Elements through the thickness.
        origin: array of float, optional
            Position of the cylinder's centre; also written `center`.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"mesh": {"cylinder_panel": _given(radius=radius, thickness=thickness, angles=angles, y=y, elements=elements, center=center, layers=layers, origin=origin)}, **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def sphere_panel(
        self,
        name: str,
        material: str,
        *,
        radius: float,
        thickness: float,
        longitude: Sequence[float] | np.ndarray,
        latitude: Sequence[float] | np.ndarray,
        elements: Sequence[int] | np.ndarray,
        center: Sequence[float] | np.ndarray | None = None,
        layers: int | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. Part of a sphere about the origin; the thickness is radial.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        radius: float
            Radius of the mid-surface.
        thickness: float
            Thickness.
        longitude: array of float
            First and last longitude (degrees).
        latitude: array of float
            First and last latitude (degrees).
        elements: array of int
            Elements along longitude and latitude.
        center: array of float, optional
            The same as `origin`.
        layers: int, optional
            Elements through the thickness.
        origin: array of float, optional
            Position of the sphere's centre; also written `center`.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"mesh": {"sphere_panel": _given(radius=radius, thickness=thickness, longitude=longitude, latitude=latitude, elements=elements, center=center, layers=layers, origin=origin)}, **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def block(
        self,
        name: str,
        material: str,
        *,
        elements: Sequence[int] | np.ndarray,
        center: Sequence[float] | np.ndarray | None = None,
        max: Sequence[float] | np.ndarray | None = None,
        min: Sequence[float] | np.ndarray | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        size: Sequence[float] | np.ndarray | None = None,
        spacing: Sequence[Literal["uniform"] | Mapping[str, Any]] | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. Box of elements with grading along each axis; layers along z.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        elements: array of int
            Elements along x, y and z.
        center: array of float, optional
            Middle of a block of `size`; in place of `origin`.
        max: array of float, optional
            Highest corner; with `min`.
        min: array of float, optional
            Lowest corner; with `max`.
        origin: array of float, optional
            Lowest corner of a block of `size`; default: the origin.
        size: array of float, optional
            Lengths along x, y and z; in place of `min` and `max`.
        spacing: list of ("uniform" or dict), optional
            Spacing of the nodes along each axis.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"mesh": {"block": _given(elements=elements, center=center, max=max, min=min, origin=origin, size=size, spacing=spacing)}, **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def mesh_file(
        self,
        name: str,
        material: str,
        path: str,
        *,
        layers: int | None = None,
        offset: Literal["mid", "top", "bottom"] | None = None,
        only: str | None = None,
        scale: float | None = None,
        slits: bool | None = None,
        thickness: float | Mapping[str, Any] | str | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. Mesh file of hexahedra, or of a surface that `thickness` makes a body of: gmsh, Abaqus and
        CalculiX, Nastran, VTK, STL.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        path: str
            Path relative to the scene file.
        layers: int, optional
            Elements through the thickness of a surface, 1 by default.
        offset: "mid", "top", "bottom", optional
            Where the file's surface lies in the thickness: `mid` (default), `top` or `bottom`.
        only: str, optional
            Takes only the elements of this set, part or instance of the file, so that two bodies can come from one
            file.
        scale: float, optional
            Multiplies every coordinate of the file. `thickness` is not multiplied.
        slits: bool, optional
            Nodes of one part of the file that lie at the same place are the two sides of a slit, and are kept apart.
            Without it such a mesh is refused, since most of them are borders that were not joined.
        thickness: float or dict or str, optional
            Thickness of a surface, in the scene's unit of length: a number, one for each of some element sets of the
            file, or an expression of the place.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"mesh": {"file": _given(path=path, layers=layers, offset=offset, only=only, scale=scale, slits=slits, thickness=thickness)}, **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def nurbs(
        self,
        name: str,
        material: str,
        file: str,
        *,
        thickness: float,
        assumed_membrane: bool | None = None,
        elements: Sequence[int] | np.ndarray | None = None,
        faces: Sequence[int] | np.ndarray | None = None,
        hidden: bool | None = None,
        size: float | None = None,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body. A CAD surface as a thin shell, in place of a mesh.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        file: str
            CAD file: STEP (`.step`, `.stp`), IGES (`.igs`, `.iges`) or JSON; relative to the scene file.
        thickness: float
            Thickness (length); the face is the mid-surface.
        assumed_membrane: bool, optional
            Membrane strains are assumed, which keeps thin curved shells from locking; `false` for the plain cubic
            element.
        elements: array of int, optional
            Elements along both directions of every face, in place of `size`; one for each knot span of the file at
            least.
        faces: array of int, optional
            The face (STEP: instance name without `#`; IGES: directory sequence number; JSON: face id; as `covact
            inspect` prints them). Default: all of the file.
        hidden: bool, optional
            Use what the CAD system hides as well.
        size: float, optional
            Longest side of an element (length).
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, {"nurbs": _given(file=file, thickness=thickness, assumed_membrane=assumed_membrane, elements=elements, faces=faces, hidden=hidden, size=size), **_given(material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity)})

    def mesh(
        self,
        name: str,
        material: str,
        mesh: Mesh,
        *,
        element: Literal["h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18"] | None = None,
        placement: Mapping[str, Any] | None = None,
        sets: Mapping[str, Any] | None = None,
        spin: Mapping[str, Any] | None = None,
        velocity: Sequence[float] | np.ndarray | None = None,
    ) -> Self:
        """A deformable body with a mesh of arrays.

        Parameters
        ----------
        name: str
            Name of the body.
        material: str
            Name of the material.
        mesh: Mesh
            The mesh.
        element: "h8", "h8_displacement", "h8_mean_dilatation", "h8_eas3", "q18", optional
            Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its
            elements are long; not of a body of kind `nurbs`, which has its own.
        placement: dict, optional
            Where the mesh is put: first scaled, then rotated about the origin, then moved.
        sets: dict, optional
            Further node and face sets, selected by geometry, where the mesh is put.
        spin: dict, optional
            Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
        velocity: array of float, optional
            Velocity at the start (length / time); only with `solution.dynamics`.
        """
        return self._put("bodies", name, _given(mesh=mesh, material=material, element=element, placement=placement, sets=sets, spin=spin, velocity=velocity))

    def cad(
        self,
        name: str,
        file: str,
        *,
        allow_skipped: bool | None = None,
        bodies: Sequence[str] | None = None,
        entities: Sequence[int] | np.ndarray | None = None,
        hidden: bool | None = None,
        tolerance: float | None = None,
        depth: float | None = None,
        facets: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        placement: Mapping[str, Any] | None = None,
        side: Literal["auto", "as_given", "reversed", "outward", "inward"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A rigid surface. NURBS patches from a CAD file, or triangles from an STL file.

        Parameters
        ----------
        name: str
            Name of the surface.
        file: str
            Path relative to the scene file.
        allow_skipped: bool, optional
            Go on although the file holds surfaces that cannot be read (they are reported).
        bodies: list of str, optional
            Use only the bodies of these names, or all of the products and assemblies of these names (STEP; `covact
            inspect` lists them). Default: all.
        entities: array of int, optional
            Use only these entities (STEP: instance names without `#`; IGES: directory sequence numbers; JSON: face ids;
            as `covact inspect` prints them). Default: all.
        hidden: bool, optional
            Use what the CAD system hides (blanked entities of IGES, invisible items and layers of STEP) as well;
            otherwise it counts as not read.
        tolerance: float, optional
            Edges of patches closer than this are the same edge (length), in an STL file vertices; default from the
            file's own resolution.
        depth: float, optional
            A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's
            size.
        facets: dict, optional
            Facets in place of the exact surface; default: none, the surface is used as it is.
        motion: dict, optional
            Rigid motion over time.
        placement: dict, optional
            Placement: first rotated, then moved.
        side: "auto", "as_given", "reversed", "outward", "inward" or dict, optional
            Which side is outside.
        """
        return self._put("surfaces", name, {"cad": _given(file=file, allow_skipped=allow_skipped, bodies=bodies, entities=entities, hidden=hidden, tolerance=tolerance), **_given(depth=depth, facets=facets, motion=motion, placement=placement, side=side)})

    def sphere(
        self,
        name: str,
        *,
        radius: float,
        axis: Sequence[float] | np.ndarray | None = None,
        center: Sequence[float] | np.ndarray | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        depth: float | None = None,
        facets: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        placement: Mapping[str, Any] | None = None,
        side: Literal["auto", "as_given", "reversed", "outward", "inward"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A rigid surface. Exact sphere.

        Parameters
        ----------
        name: str
            Name of the surface.
        radius: float
            Radius.
        axis: array of float, optional
            Axis through the poles of the parametrisation; default y.
        center: array of float, optional
            Centre of the sphere; also written `origin`.
        origin: array of float, optional
            The same as `center`.
        depth: float, optional
            A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's
            size.
        facets: dict, optional
            Facets in place of the exact surface; default: none, the surface is used as it is.
        motion: dict, optional
            Rigid motion over time.
        placement: dict, optional
            Placement: first rotated, then moved.
        side: "auto", "as_given", "reversed", "outward", "inward" or dict, optional
            Which side is outside.
        """
        return self._put("surfaces", name, {"sphere": _given(radius=radius, axis=axis, center=center, origin=origin), **_given(depth=depth, facets=facets, motion=motion, placement=placement, side=side)})

    def cylinder(
        self,
        name: str,
        *,
        radius: float,
        length: float,
        axis: Sequence[float] | np.ndarray | None = None,
        center: Sequence[float] | np.ndarray | None = None,
        origin: Sequence[float] | np.ndarray | None = None,
        depth: float | None = None,
        facets: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        placement: Mapping[str, Any] | None = None,
        side: Literal["auto", "as_given", "reversed", "outward", "inward"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A rigid surface. Exact circular cylinder.

        Parameters
        ----------
        name: str
            Name of the surface.
        radius: float
            Radius.
        length: float
            Length along the axis.
        axis: array of float, optional
            Direction of the axis, of any length; default y.
        center: array of float, optional
            Centre of the cylinder, in the middle of its length; also written `origin`.
        origin: array of float, optional
            The same as `center`.
        depth: float, optional
            A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's
            size.
        facets: dict, optional
            Facets in place of the exact surface; default: none, the surface is used as it is.
        motion: dict, optional
            Rigid motion over time.
        placement: dict, optional
            Placement: first rotated, then moved.
        side: "auto", "as_given", "reversed", "outward", "inward" or dict, optional
            Which side is outside.
        """
        return self._put("surfaces", name, {"cylinder": _given(radius=radius, length=length, axis=axis, center=center, origin=origin), **_given(depth=depth, facets=facets, motion=motion, placement=placement, side=side)})

    def plane(
        self,
        name: str,
        *,
        size: Sequence[float] | np.ndarray,
        center: Sequence[float] | np.ndarray | None = None,
        normal: Sequence[float] | np.ndarray | None = None,
        depth: float | None = None,
        facets: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        placement: Mapping[str, Any] | None = None,
        side: Literal["auto", "as_given", "reversed", "outward", "inward"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A rigid surface. Flat rectangle.

        Parameters
        ----------
        name: str
            Name of the surface.
        size: array of float
            Edge lengths of the rectangle.
        center: array of float, optional
            Middle of the rectangle.
        normal: array of float, optional
            Normal, of any length; default z.
        depth: float, optional
            A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's
            size.
        facets: dict, optional
            Facets in place of the exact surface; default: none, the surface is used as it is.
        motion: dict, optional
            Rigid motion over time.
        placement: dict, optional
            Placement: first rotated, then moved.
        side: "auto", "as_given", "reversed", "outward", "inward" or dict, optional
            Which side is outside.
        """
        return self._put("surfaces", name, {"plane": _given(size=size, center=center, normal=normal), **_given(depth=depth, facets=facets, motion=motion, placement=placement, side=side)})

    def patches(
        self,
        name: str,
        patches: Surface,
        *,
        depth: float | None = None,
        facets: Mapping[str, Any] | None = None,
        motion: Mapping[str, Any] | None = None,
        placement: Mapping[str, Any] | None = None,
        side: Literal["auto", "as_given", "reversed", "outward", "inward"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A rigid surface of patches that were loaded or made of arrays.

        Parameters
        ----------
        name: str
            Name of the surface.
        patches: Surface
            The patches.
        depth: float, optional
            A point deeper than this below the surface is not in contact (length); default: a tenth of the surface's
            size.
        facets: dict, optional
            Facets in place of the exact surface; default: none, the surface is used as it is.
        motion: dict, optional
            Rigid motion over time.
        placement: dict, optional
            Placement: first rotated, then moved.
        side: "auto", "as_given", "reversed", "outward", "inward" or dict, optional
            Which side is outside.
        """
        return self._put("surfaces", name, _given(patches=patches, depth=depth, facets=facets, motion=motion, placement=placement, side=side))

    def move(
        self,
        surface: str,
        *,
        free: Mapping[str, Any] | None = None,
        rotation: Mapping[str, Any] | None = None,
        translation: Sequence[float | Mapping[str, Any] | str] | None = None,
    ) -> Self:
        """Moves a rigid surface of the scene over time.

        Parameters
        ----------
        surface: str
            Name of the surface.
        free: dict, optional
            Components that are unknown and driven by a given force or moment; all others follow what is prescribed.
        rotation: dict, optional
            Rotation about an axis.
        translation: list of (float or dict or str), optional
            Displacement as numbers, tables or expressions in `t`.
        """
        return self._join("surfaces", surface, "motion", _given(free=free, rotation=rotation, translation=translation))

    def contact(
        self,
        name: str,
        slave: str | Sequence[str],
        master: str | Sequence[str],
        *,
        accuracy: float | None = None,
        augmentation: Mapping[str, Any] | None = None,
        depth: float | None = None,
        friction: Mapping[str, Any] | float | str | None = None,
        gap: Literal["pointwise", "averaged"] | None = None,
        initial_overclosure: Literal["strain", "stress_free", "refuse"] | Mapping[str, Any] | None = None,
        master_surface: Literal["faces", "smooth"] | None = None,
        offset: float | None = None,
        passes: Literal["auto", "one", "two_half", "edges"] | None = None,
        penalty: Literal["auto"] | Mapping[str, Any] | None = None,
        points: Literal["auto", "nodes"] | Mapping[str, Any] | None = None,
        tangent: Literal["exact"] | Mapping[str, Any] | None = None,
        tangential_penalty: Literal["auto"] | Mapping[str, Any] | None = None,
    ) -> Self:
        """A contact pair.

        Parameters
        ----------
        name: str
            Name of the contact.
        slave: str or list of str
            Face set of a body, `body.set`, a list of face sets of one body, or a body, `body`: all its outer faces.
        master: str or list of str
            Name of a rigid surface, or faces of a deformable body: `body.set`, a list of face sets, or `body`.
        accuracy: float, optional
            Relative error of forces that the automatic penalty aims at; default: 4e-3, and 1e-4 where a stage releases
            the contact, until its penalty is rigid beside the thickness of the body. Only where no penalty is given.
        augmentation: dict, optional
            Multipliers beside the penalties; default: none.
        depth: float, optional
            A point deeper than this below the faces of a body is not in contact (length); only for masters that are
            bodies (a rigid surface has a depth of its own). Default: the depth of the elements below the faces.
        friction: dict or float or str, optional
            Law of friction; default: none.
        gap: "pointwise", "averaged", optional
            Whether every slave point has a gap of its own, or every slave node the mean of those around it.
        initial_overclosure: "strain", "stress_free", "refuse" or dict, optional
            What becomes of slave points that start below the master.
        master_surface: "faces", "smooth", optional
            What surface the faces of a body make; only for masters that are bodies. Default: `faces`.
        offset: float, optional
            Contact begins at this distance in front of the master (length), for a thickness that is not modelled.
        passes: "auto", "one", "two_half", "edges", optional
            Which side of a contact is the slave; `two_half` only for masters that are bodies.
        penalty: "auto" or dict, optional
            Normal penalty: traction per penetration (force / length^3).
        points: "auto", "nodes" or dict, optional
            Where contact is sampled on the slave faces.
        tangent: "exact" or dict, optional
            Tangent matrix of contact.
        tangential_penalty: "auto" or dict, optional
            Tangential penalty: traction per elastic slip (force / length^3); only with friction.
        """
        return self._put("contacts", name, _given(slave=slave, master=master, accuracy=accuracy, augmentation=augmentation, depth=depth, friction=friction, gap=gap, initial_overclosure=initial_overclosure, master_surface=master_surface, offset=offset, passes=passes, penalty=penalty, points=points, tangent=tangent, tangential_penalty=tangential_penalty))

    def support(
        self,
        name: str,
        on: str | Sequence[str],
        *,
        clamped: bool | None = None,
        displacement: Mapping[str, Any] | Sequence[float | Mapping[str, Any] | str] | None = None,
        fixed: bool | None = None,
        mid_surface: bool | None = None,
        plane_strain: Literal["x", "y", "z"] | None = None,
        symmetry: Literal["x", "y", "z"] | None = None,
    ) -> Self:
        """A support: exactly one of `fixed`, `clamped`, `symmetry`, `plane_strain`, `displacement`; the last may also
        stand beside `clamped`.

        Parameters
        ----------
        name: str
            Name of the support.
        on: str or list of str
            Node or face set, `body.set`, a whole body, `body`, or a list of them.
        clamped: bool, optional
            All three components are zero, and the sheet does not turn about the edge; only for edges and curves of
            trims of a body of kind `nurbs`, which `fixed` leaves hinged. With `displacement` beside it the clamp moves
            as that says, without turning.
        displacement: dict or list of (float or dict or str), optional
            Prescribed components.
        fixed: bool, optional
            All three components are zero.
        mid_surface: bool, optional
            Acts on the mean of both faces of the shell (the mid-surface), which leaves rotation and thickness free:
            with all three components a hinge that holds its place, with one a soft support.
        plane_strain: "x", "y", "z", optional
            The displacement along this axis is zero. Of whole bodies: what they do is the same at all places along it.
            A body of kind `nurbs` is extruded along the axis, and its other displacements do not change along it.
        symmetry: "x", "y", "z", optional
            The displacement along this axis is zero; at an edge of a body of kind `nurbs` the sheet also stays at right
            angles to the plane.
        """
        return self._put("supports", name, _given(on=on, clamped=clamped, displacement=displacement, fixed=fixed, mid_surface=mid_surface, plane_strain=plane_strain, symmetry=symmetry))

    def load(
        self,
        name: str,
        on: str | Sequence[str],
        *,
        couple: float | Mapping[str, Any] | str | None = None,
        follower: bool | None = None,
        force: Sequence[float | Mapping[str, Any] | str] | None = None,
        gravity: Sequence[float | Mapping[str, Any] | str] | None = None,
        pressure: float | Mapping[str, Any] | str | None = None,
        traction: Sequence[float | Mapping[str, Any] | str] | None = None,
    ) -> Self:
        """A load: exactly one of `force`, `traction`, `pressure`, `couple`, `gravity`.

        Parameters
        ----------
        name: str
            Name of the load.
        on: str or list of str
            Node or face set, `body.set`, or a list of them (traction and pressure need faces); for gravity a body, or a
            list.
        couple: float or dict or str, optional
            Couple per undeformed length along edges or curves of trims of a body of kind `nurbs`, which turns with them
            (force); positive where it lifts what would lie beyond the edge towards the top. Expressions may use t.
        follower: bool, optional
            The pressure follows the deformed faces (their area and normal).
        force: list of (float or dict or str), optional
            Total force, spread evenly over the nodes of a node set, over the area of a face set.
        gravity: list of (float or dict or str), optional
            Acceleration that acts on the mass of whole bodies (length / time^2): `[0, 0, -9810]` in mm and s. Their
            materials need a `density`.
        pressure: float or dict or str, optional
            Pressure against the outward normal (force / area). Expressions may use x, y, z and t; those of a follower
            t.
        traction: list of (float or dict or str), optional
            Force per undeformed area, of constant direction. Expressions may use x, y, z and t.
        """
        return self._put("loads", name, _given(on=on, couple=couple, follower=follower, force=force, gravity=gravity, pressure=pressure, traction=traction))

    def probe(
        self,
        name: str,
        *,
        body: str | None = None,
        near: Sequence[float] | np.ndarray | None = None,
        on: str | Sequence[str] | None = None,
        quantity: Literal["displacement", "reaction", "von_mises"] | None = None,
        take: Literal["mean", "max", "sum"] | None = None,
    ) -> Self:
        """A curve in `history.csv`, for the nodes of sets (`on`), the node nearest a point (`near`), or a whole body
        (`body`).

        Parameters
        ----------
        name: str
            Name of the probe.
        body: str, optional
            All nodes of this body; with `near` the body whose node is meant.
        near: array of float, optional
            The node that is nearest to this point of the undeformed bodies.
        on: str or list of str, optional
            Node or face set, `body.set`, or a list of them.
        quantity: "displacement", "reaction", "von_mises", optional
            What is recorded.
        take: "mean", "max", "sum", optional
            What is taken of several nodes. Default: the mean of displacements, the sum of reactions, the largest
            stress.
        """
        return self._put("probes", name, _given(body=body, near=near, on=on, quantity=quantity, take=take))

    def stage(
        self,
        name: str,
        *,
        contacts: str | Sequence[str] | None = None,
        loads: Mapping[str, Any] | None = None,
        release: Literal["forces", "tools"] | None = None,
        supports: str | Sequence[str] | None = None,
        tools: Mapping[str, Any] | None = None,
        until: float | None = None,
    ) -> Self:
        """A part of the run. Stages follow each other without a break: each goes on from the state in which the one
        before ended, plastic strains included.

        Parameters
        ----------
        name: str
            Name of the stage, for messages and the summary.
        contacts: str or list of str, optional
            The active contacts, by their names; default: those of the stage before, all in the first stage, and none in
            a stage with `release`.
        loads: dict, optional
            Factors of loads at the end of the stage, to which they grow evenly from what they were (0 before the first
            stage that names them). Only for loads that are given by numbers.
        release: "forces", "tools", optional
            How contacts end that were active before and are not listed in `contacts` (all of them where there is no
            list); default: `forces`. Not for the first stage.
        supports: str or list of str, optional
            The active supports: a list of their names, in which `automatic` stands for those that the program finds
            where the others leave a body free, or `"automatic"` for all supports and these. Default: all supports, with
            `automatic` where `release` is `forces`.
        tools: dict, optional
            Translations of rigid surfaces at the end of the stage (length); they go there evenly from where they were.
            Only for surfaces without a `motion.translation` of their own.
        until: float, optional
            Time at which it ends; left out in the last stage, which ends with the run.
        """
        return self._add_stage(_given(name=name, contacts=contacts, loads=loads, release=release, supports=supports, tools=tools, until=until))

    def units(
        self,
        *,
        force: Literal["uN", "mN", "N", "kN", "MN", "kgf", "lbf"] | None = None,
        length: Literal["nm", "um", "mm", "cm", "m", "km", "in", "ft"] | None = None,
    ) -> Self:
        """Units of the scene. CAD files state their own length unit and are converted to the scene's. Keys that are not
        given stay as they are.

        Parameters
        ----------
        force: "uN", "mN", "N", "kN", "MN", "kgf", "lbf", optional
            Force unit of the scene. Only materials that are taken by name ask for it.
        length: "nm", "um", "mm", "cm", "m", "km", "in", "ft", optional
            Length unit of the scene.
        """
        return self._set("units", _given(force=force, length=length))

    def solution(
        self,
        *,
        dynamics: Mapping[str, Any] | None = None,
        end_time: float | None = None,
        kinematics: Literal["large", "small"] | None = None,
        linear_solver: Literal["auto", "llt", "ldlt", "lu", "cudss", "mumps"] | Mapping[str, Any] | None = None,
        newton: Mapping[str, Any] | None = None,
        stabilization: Literal["auto", "none"] | Mapping[str, Any] | None = None,
        step: Mapping[str, Any] | None = None,
        stops: Sequence[float] | np.ndarray | None = None,
        threads: int | None = None,
    ) -> Self:
        """How the problem is solved. Keys that are not given stay as they are.

        Parameters
        ----------
        dynamics: dict, optional
            Motion with inertia; without it a run is a sequence of equilibria.
        end_time: float, optional
            The run goes from time 0 to this time.
        kinematics: "large", "small", optional
            How far displacements may go.
        linear_solver: "auto", "llt", "ldlt", "lu", "cudss", "mumps" or dict, optional
            Factorization.
        newton: dict, optional
            Newton's method.
        stabilization: "auto", "none" or dict, optional
            Stabilisation, written `"auto"`, `"none"` or `{"viscous": {"factor": 1e-3, "until": 0.5}}`.
        step: dict, optional
            Step sizes, in time.
        stops: array of float, optional
            Times at which a step must end, ascending; steps end at the rows of tables in any case.
        threads: int, optional
            Threads; 0 takes what the machine has.
        """
        return self._set("solution", _given(dynamics=dynamics, end_time=end_time, kinematics=kinematics, linear_solver=linear_solver, newton=newton, stabilization=stabilization, step=step, stops=stops, threads=threads))

    def output(
        self,
        *,
        contact_points: bool | None = None,
        every: int | None = None,
        full_precision: bool | None = None,
        shell_stresses: bool | None = None,
        tessellation: int | None = None,
    ) -> Self:
        """What is written. Keys that are not given stay as they are.

        Parameters
        ----------
        contact_points: bool, optional
            Write the slave points of contacts with friction too, with their values.
        every: int, optional
            Write fields at every n-th accepted step (the last is always written); 0 writes none.
        full_precision: bool, optional
            Write the fields of bodies with all digits of double precision; else displacements have nearly ten of them
            and all other fields nearly five, which takes half the room.
        shell_stresses: bool, optional
            Write the stresses of shells at the bottom, in the middle and at the top of the thickness too, in the
            directions of the mid-surface.
        tessellation: int, optional
            Most subdivisions of a Bezier piece, in either direction, in the tessellated copy of rigid surfaces; fewer
            where the copy is within 2e-4 of the size of the surface, or of the bodies.
        """
        return self._set("output", _given(contact_points=contact_points, every=every, full_precision=full_precision, shell_stresses=shell_stresses, tessellation=tessellation))
