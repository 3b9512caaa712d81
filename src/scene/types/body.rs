//! Deformable bodies: elements, where meshes come from, sets.
use super::boxes::Corners;
use super::dynamics::Spin;
use super::given::{Given, MeshArrays, MeshCells};
use super::mesh::*;
use super::mesh_file::MeshFile;
use super::nurbs::NurbsSurface;
use super::placement::Placement;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

/// A deformable body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "BodyForm", into = "BodyForm")]
pub struct Body {
    /// Where the mesh comes from.
    pub mesh: MeshSource,
    /// Name of the material.
    pub material: String,
    /// Element formulation.
    pub element: Element,
    /// Where the mesh is put: first scaled, then rotated about the origin, then moved.
    pub placement: Placement,
    /// Further node and face sets, selected by geometry, where the mesh is put.
    pub sets: BTreeMap<String, Selection>,
    /// Velocity at the start (length / time); only with `solution.dynamics`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<[f64; 3]>,
    /// Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spin: Option<Spin>,
}

/// A deformable body: elements of a `mesh`, or a CAD surface that bends (`nurbs`).
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Body", extend("oneOf" = [{"required": ["mesh"]}, {"required": ["nurbs"]}]))]
struct BodyForm {
    /// Where the mesh comes from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(deserialize_with = "given")]
    mesh: Option<MeshSource>,
    /// A CAD surface as a thin shell, in place of a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(deserialize_with = "given")]
    nurbs: Option<NurbsSurface>,
    /// Name of the material.
    material: String,
    /// Element formulation, by default `h8`, and `h8_mean_dilatation` for a `block` that is as thick as four of its elements are long; not
    /// of a body of kind `nurbs`, which has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    element: Option<Element>,
    /// Where the mesh is put: first scaled, then rotated about the origin, then moved.
    #[serde(default)]
    placement: Placement,
    /// Further node and face sets, selected by geometry, where the mesh is put.
    #[serde(default)]
    sets: BTreeMap<String, Selection>,
    /// Velocity at the start (length / time); only with `solution.dynamics`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    velocity: Option<[f64; 3]>,
    /// Rotation at the start, on top of `velocity`; only with `solution.dynamics`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spin: Option<Spin>,
}

/// A value that is there, be it a faulty one that is told of by itself: not none.
fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(from: D) -> Result<Option<T>, D::Error> {
    T::deserialize(from).map(Some)
}

impl TryFrom<BodyForm> for Body {
    type Error = &'static str;
    fn try_from(form: BodyForm) -> Result<Body, &'static str> {
        let (mesh, element) = match (form.mesh, form.nurbs) {
            (Some(mesh), None) => {
                let element = (form.element).unwrap_or_else(|| Element::by_default(&mesh));
                (mesh, element)
            }
            (None, Some(_)) if form.element.is_some() => {
                return Err("a body of kind `nurbs` has elements of its own: leave `element` out");
            }
            (None, Some(nurbs)) => (MeshSource::Nurbs(nurbs), Element::Nurbs),
            (None, None) => return Err("a body needs a `mesh`, or a CAD surface `nurbs`"),
            (Some(_), Some(_)) => return Err("a body has a `mesh` or `nurbs`, not both"),
        };
        Ok(Body {
            mesh,
            material: form.material,
            element,
            placement: form.placement,
            sets: form.sets,
            velocity: form.velocity,
            spin: form.spin,
        })
    }
}

impl From<Body> for BodyForm {
    fn from(body: Body) -> BodyForm {
        let (mesh, nurbs, element) = match body.mesh {
            MeshSource::Nurbs(nurbs) => (None, Some(nurbs), None),
            mesh => (Some(mesh), None, Some(body.element)),
        };
        BodyForm {
            mesh,
            nurbs,
            material: body.material,
            element,
            placement: body.placement,
            sets: body.sets,
            velocity: body.velocity,
            spin: body.spin,
        }
    }
}

/// Element formulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// 8-node solid-shell: assumed transverse shear and thickness strains, seven enhanced strains.
    #[default]
    H8,
    /// 8-node brick without assumed or enhanced strains (locks when thin and in rubber; for solids and comparisons).
    H8Displacement,
    /// As `h8_displacement`, with the mean change of volume of each element: for solids of rubber, which it follows far into
    /// compression (stiff where it is thin and bends).
    H8MeanDilatation,
    /// As `h8`, with the three of the enhanced strains that act through the thickness: stiff where a sheet bends in its own
    /// plane, and for nu up to 0.45.
    H8Eas3,
    /// 18-node solid-shell, quadratic in its plane and linear through the thickness: assumed membrane, transverse shear and
    /// thickness strains, four enhanced strains. Curved meshes follow cylinders and spheres closely.
    Q18,
    /// Kirchhoff-Love shell on a NURBS patch, which a body of kind `nurbs` has.
    #[serde(skip)]
    #[schemars(skip)]
    Nurbs,
}

/// Elements, by their longest edge and mean lengths along each axis, that have to fit into a block for it to be a solid and no shell: bricks
/// then bend within a hundredth of solid-shells.
const SOLID: f64 = 4.0;

impl Element {
    /// The element of a mesh for which none is named: solid-shells, and for a block that is no shell bricks, which hold where these
    /// give way under compression.
    pub fn by_default(mesh: &MeshSource) -> Element {
        let MeshSource::Block(block) = mesh else {
            return Element::H8;
        };
        let sizes = [0, 1, 2].map(|i| block.max[i] - block.min[i]);
        let lengths = [0, 1, 2].map(|i| sizes[i] / f64::from(block.elements[i]));
        let thickness = sizes.into_iter().fold(f64::INFINITY, f64::min);
        // Rounding: 0.8 is four times 0.2.
        match thickness >= (SOLID - 1e-9) * lengths.into_iter().fold(0.0, f64::max) {
            true => Element::H8MeanDilatation,
            false => Element::H8,
        }
    }

    /// Those of meshes, in the order in which they are told.
    pub const OF_MESHES: [Element; 5] = [
        Element::H8,
        Element::H8Displacement,
        Element::H8MeanDilatation,
        Element::H8Eas3,
        Element::Q18,
    ];

    /// How a scene writes it.
    pub const fn word(self) -> &'static str {
        match self {
            Element::H8 => "h8",
            Element::H8Displacement => "h8_displacement",
            Element::H8MeanDilatation => "h8_mean_dilatation",
            Element::H8Eas3 => "h8_eas3",
            Element::Q18 => "q18",
            Element::Nurbs => "nurbs",
        }
    }

    /// Whether its strains are other than those of its displacements.
    pub const fn assumes_strains(self) -> bool {
        !matches!(self, Element::H8Displacement | Element::H8MeanDilatation)
    }
}

/// Where a body's mesh comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshSource {
    /// Flat plate; the thickness is along z.
    Plate(Plate),
    /// Part of a cylinder about the y axis; the thickness is radial.
    CylinderPanel(CylinderPanel),
    /// Part of a sphere about the origin; the thickness is radial.
    SpherePanel(SpherePanel),
    /// Box of elements with grading along each axis; layers along z.
    Block(Block),
    /// Mesh file of hexahedra, or of a surface that `thickness` makes a body of: gmsh, Abaqus and CalculiX, Nastran, VTK,
    /// STL.
    File(MeshFile),
    /// Arrays that a program gives; a scene file names a file in their place.
    #[serde(skip_deserializing)]
    #[schemars(skip)]
    Arrays(Given<MeshArrays>),
    /// Points and cells that a program gives; a scene file names a file in their place.
    #[serde(skip_deserializing)]
    #[schemars(skip)]
    Cells(Given<MeshCells>),
    /// A CAD surface that bends; a scene file writes `nurbs` in the place of `mesh`.
    #[serde(skip_deserializing)]
    #[schemars(skip)]
    Nurbs(NurbsSurface),
}

/// Set selected by geometry, on the undeformed mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Selection {
    /// Nodes inside a box (its borders included).
    NodesInBox(Corners),
    /// Nodes within `tolerance` of a plane.
    NodesNearPlane {
        /// A point of the plane.
        point: [f64; 3],
        /// Normal of the plane, of any length.
        normal: [f64; 3],
        /// Largest distance (length).
        tolerance: f64,
    },
    /// Nodes within `tolerance` of a point.
    NodesNearPoint {
        /// The point.
        point: [f64; 3],
        /// Largest distance (length).
        tolerance: f64,
    },
    /// Outer faces whose nodes all lie inside a box.
    FacesInBox(Corners),
    /// Outer faces whose outward normal is within `angle` degrees of `normal`.
    FacesFacing {
        /// Direction, of any length.
        normal: [f64; 3],
        /// Largest angle (degrees).
        angle: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The element of a block of these sizes and numbers of elements.
    fn of(size: [f64; 3], elements: [u32; 3]) -> Element {
        let block = json!({ "block": { "size": size, "elements": elements } });
        let body = json!({ "mesh": block, "material": "rubber" });
        serde_json::from_value::<Body>(body).unwrap().element
    }

    /// Four elements as long as they are high fit into a solid; three do not, nor do long ones, nor does one layer of a sheet.
    #[test]
    fn a_block_that_is_no_shell_has_bricks() {
        assert_eq!(of([2.0, 1.0, 0.8], [10, 5, 4]), Element::H8MeanDilatation);
        for (size, elements) in [
            ([2.0, 1.0, 0.6], [10, 5, 3]),
            ([2.0, 1.0, 0.8], [9, 5, 4]),
            ([2.0, 1.0, 0.8], [10, 1, 4]),
            ([20.0, 10.0, 1.0], [20, 10, 1]),
        ] {
            assert_eq!(of(size, elements), Element::H8, "{size:?} {elements:?}");
        }
        let plate =
            json!({ "plate": { "size": [1, 1], "thickness": 1, "elements": [4, 4], "layers": 4 } });
        let body = |element: serde_json::Value| {
            let mut body = json!({ "mesh": plate, "material": "rubber" });
            if !element.is_null() {
                body["element"] = element;
            }
            serde_json::from_value::<Body>(body).unwrap().element
        };
        assert_eq!(body(serde_json::Value::Null), Element::H8);
        assert_eq!(body(json!("q18")), Element::Q18);
    }
}
