//! Fields of a deformable body.
use super::OutputError;
use super::vtu::{Array, DEGREES, Field, Grid, Place, Precision};
use crate::mesh::{ElementKind, Mesh};
use covact_geometry::Vec3;
use vtkio::model::CellType;

/// Order of the six components of a symmetric tensor, here and in the files; it is VTK's own.
pub const STRESS_COMPONENTS: [&str; 6] = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"];

/// `contact_status` of a node that is on no slave surface.
pub const NOT_A_SLAVE: u8 = 0;
/// `contact_status` of a slave node that touches nothing.
pub const OPEN: u8 = 1;
/// `contact_status` of a slave node in contact, with friction of one that does not slide.
pub const CLOSED: u8 = 2;
/// `contact_status` of a slave node in contact that slides under friction.
pub const SLIP: u8 = 3;

/// Tensor-product number of each node of VTK's hexahedron, which counts around the bottom, then around the top.
const H8_TO_VTK: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Tensor-product number of each node of VTK's Lagrange hexahedron of degrees 2, 2, 1: corners around the bottom and the
/// top, then the middles of the bottom and of the top edges, then the middles of bottom and top.
const Q18_TO_VTK: [usize; 18] = [0, 2, 8, 6, 9, 11, 17, 15, 1, 5, 7, 3, 10, 14, 16, 12, 4, 13];

/// Node order and type of the cell that an element is written as.
pub(crate) fn vtk_cell(kind: ElementKind) -> (&'static [usize], CellType) {
    match kind {
        // A sheet is written on a mesh of quadratic bricks.
        ElementKind::Nurbs => (&[], CellType::LagrangeHexahedron),
        ElementKind::H8 => (&H8_TO_VTK, CellType::Hexahedron),
        ElementKind::Q18 => (&Q18_TO_VTK, CellType::LagrangeHexahedron),
    }
}

/// Contact fields on the nodes of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactFields<'a> {
    /// Contact pressure, positive in compression (force / area); 0 where there is none.
    pub pressure: &'a [f64],
    /// Normal distance, negative in penetration (length). NaN where a node is no slave or finds no master.
    pub gap: &'a [f64],
    /// [`NOT_A_SLAVE`], [`OPEN`], [`CLOSED`] or [`SLIP`]; of several slave points around a node the largest.
    pub status: &'a [u8],
}

/// A body at one time. All fields but those of place [`Place::Cell`] are per node of the mesh.
#[derive(Debug, Clone)]
pub struct BodyFields<'a> {
    /// Name of the body in the scene.
    pub name: &'a str,
    /// The undeformed mesh.
    pub mesh: &'a Mesh,
    /// Displacement (length).
    pub displacement: &'a [Vec3],
    /// Cauchy stress (force / area) in the order of [`STRESS_COMPONENTS`]; none where it was not computed.
    pub stress: Option<&'a [[f64; 6]]>,
    /// None for a body without slave surface.
    pub contact: Option<ContactFields<'a>>,
    /// Further fields.
    pub fields: Vec<Field<'a>>,
    /// How exactly the numbers are written.
    pub precision: Precision,
}

/// Equivalent stress of von Mises of a stress in the order of [`STRESS_COMPONENTS`].
pub fn von_mises(s: &[f64; 6]) -> f64 {
    let d = [s[0] - s[1], s[1] - s[2], s[2] - s[0]];
    let normal = 0.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    (normal + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])).sqrt()
}

impl BodyFields<'_> {
    /// The body as the bytes of a `.vtu` file; `id` is written as cell data `body`.
    ///
    /// Point data: `displacement` (3), `cauchy_stress` (6), `von_mises`, `contact_pressure`, `contact_gap`,
    /// `contact_status` and the further fields; cell data: `element` (counted from 0) and `body`. Numbers are as
    /// exact as [`Self::precision`] says.
    ///
    /// # Errors
    /// [`OutputError::FieldLength`], [`OutputError::DuplicateField`] or [`OutputError::NoSuchNode`] when the fields and
    /// the mesh do not fit together.
    pub fn to_vtu(&self, id: u32) -> Result<Vec<u8>, OutputError> {
        let nodes = self.mesh.nodes.len();
        let elements = self.mesh.elements();
        let mut point_data = Vec::new();

        self.check("displacement", nodes, self.displacement.len())?;
        let u: Vec<f64> = self
            .displacement
            .iter()
            .flat_map(|u| [u.x, u.y, u.z])
            .collect();
        let exactly = self.precision;
        point_data.push(Array::new("displacement", 3, exactly.displacement(u)));

        if let Some(stress) = self.stress {
            self.check("cauchy_stress", nodes, stress.len())?;
            let flat: Vec<f64> = stress.iter().flatten().copied().collect();
            let mut array = Array::new("cauchy_stress", 6, exactly.field(&flat));
            array.component_names = STRESS_COMPONENTS.iter().map(|s| s.to_string()).collect();
            point_data.push(array);
            let mises: Vec<f64> = stress.iter().map(von_mises).collect();
            point_data.push(Array::new("von_mises", 1, exactly.field(&mises)));
        }
        if let Some(contact) = &self.contact {
            self.check("contact_pressure", nodes, contact.pressure.len())?;
            self.check("contact_gap", nodes, contact.gap.len())?;
            self.check("contact_status", nodes, contact.status.len())?;
            point_data.push(Array::new(
                "contact_pressure",
                1,
                exactly.field(contact.pressure),
            ));
            point_data.push(Array::new("contact_gap", 1, exactly.field(contact.gap)));
            point_data.push(Array::new("contact_status", 1, contact.status.to_vec()));
        }

        let numbers: Vec<u32> = (0..elements as u32).collect();
        let mut cell_data = vec![
            Array::new("element", 1, numbers),
            Array::new("body", 1, vec![id; elements]),
        ];
        if self.mesh.kind == ElementKind::Q18 {
            cell_data.push(Array::new(DEGREES, 3, [2.0, 2.0, 1.0].repeat(elements)));
        }
        for field in &self.fields {
            let (into, count) = match field.place {
                Place::Point => (&mut point_data, nodes),
                Place::Cell => (&mut cell_data, elements),
            };
            self.check(field.name, count * field.components, field.data.len())?;
            if into.iter().any(|a| a.name == field.name) {
                return Err(OutputError::DuplicateField {
                    part: self.name.to_string(),
                    field: field.name.to_string(),
                });
            }
            let data = exactly.field(field.data);
            let mut array = Array::new(field.name, field.components as u32, data);
            array.component_names = field
                .component_names
                .iter()
                .map(|s| s.to_string())
                .collect();
            into.push(array);
        }

        let (order, cell) = vtk_cell(self.mesh.kind);
        let connectivity = self.connectivity(order)?;
        Grid {
            part: self.name.to_string(),
            points: self
                .mesh
                .nodes
                .iter()
                .flat_map(|x| [x.x, x.y, x.z])
                .collect(),
            connectivity,
            offsets: (1..=elements).map(|e| (e * order.len()) as u64).collect(),
            types: vec![cell; elements],
            point_data,
            cell_data,
            vectors: Some("displacement"),
            normals: None,
            rational: false,
        }
        .into_bytes()
    }

    /// Node numbers of all elements in VTK's order.
    fn connectivity(&self, order: &[usize]) -> Result<Vec<u64>, OutputError> {
        let nodes = self.mesh.nodes.len();
        let mut connectivity = Vec::with_capacity(self.mesh.elements() * order.len());
        for e in 0..self.mesh.elements() {
            let element = self.mesh.element(e);
            if let Some(&node) = element.iter().find(|&&n| n as usize >= nodes) {
                return Err(OutputError::NoSuchNode {
                    part: self.name.to_string(),
                    element: e,
                    node,
                    nodes,
                });
            }
            connectivity.extend(order.iter().map(|&k| u64::from(element[k])));
        }
        Ok(connectivity)
    }

    fn check(&self, field: &str, expected: usize, found: usize) -> Result<(), OutputError> {
        if expected == found {
            return Ok(());
        }
        Err(OutputError::FieldLength {
            part: self.name.to_string(),
            field: field.to_string(),
            expected,
            found,
        })
    }
}
