//! The slave points of a contact as a cloud of vertices.
use super::OutputError;
use super::vtu::{Array, Grid};
use covact_geometry::Vec3;
use vtkio::model::CellType;

/// Slave points of a contact with friction at one time, a value of each field per point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    /// Name of the part, on which those of its files are built.
    pub name: String,
    /// Where the points are (length).
    pub positions: Vec<Vec3>,
    /// Tributary area on the undeformed surface (length^2).
    pub area: Vec<f64>,
    /// [`super::OPEN`], [`super::CLOSED`] or [`super::SLIP`].
    pub status: Vec<u8>,
    /// Contact pressure, positive in compression (force / length^2).
    pub pressure: Vec<f64>,
    /// Normal distance, negative in penetration (length). NaN where a point finds no master.
    pub gap: Vec<f64>,
    /// Traction that the master exerts on the slave along the surface (force / length^2).
    pub friction_traction: Vec<Vec3>,
    /// Length of the path slid so far.
    pub slip: Vec<f64>,
    /// Energy dissipated so far (force / length).
    pub dissipated: Vec<f64>,
}

impl PointCloud {
    /// The cloud as the bytes of a `.vtu` file of vertices. Point data are the fields, under the names that bodies have
    /// them by; `area` too.
    ///
    /// # Errors
    /// [`OutputError::FieldLength`] where a field has not one value per point.
    pub fn to_vtu(&self) -> Result<Vec<u8>, OutputError> {
        let n = self.positions.len();
        for (field, found) in [
            ("area", self.area.len()),
            ("contact_status", self.status.len()),
            ("contact_pressure", self.pressure.len()),
            ("contact_gap", self.gap.len()),
            ("friction_traction", self.friction_traction.len()),
            ("slip", self.slip.len()),
            ("dissipated", self.dissipated.len()),
        ] {
            if found != n {
                return Err(OutputError::FieldLength {
                    part: self.name.clone(),
                    field: field.to_owned(),
                    expected: n,
                    found,
                });
            }
        }
        let flat = |vectors: &[Vec3]| -> Vec<f64> {
            vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
        };
        Grid {
            part: self.name.clone(),
            points: flat(&self.positions),
            connectivity: (0..n as u64).collect(),
            offsets: (1..=n as u64).collect(),
            types: vec![CellType::Vertex; n],
            point_data: vec![
                Array::new("contact_pressure", 1, self.pressure.clone()),
                Array::new("contact_gap", 1, self.gap.clone()),
                Array::new("contact_status", 1, self.status.clone()),
                Array::new("friction_traction", 3, flat(&self.friction_traction)),
                Array::new("slip", 1, self.slip.clone()),
                Array::new("dissipated", 1, self.dissipated.clone()),
                Array::new("area", 1, self.area.clone()),
            ],
            cell_data: Vec::new(),
            vectors: None,
            normals: None,
            rational: false,
        }
        .into_bytes()
    }
}
