//! The mid-surface of a sheet as exact rational Bezier cells, deformed.
use super::OutputError;
use super::bezier::{SurfacePiece, vtk_order};
use super::vtu::{Array, DEGREES, Grid, Precision, WEIGHTS};
use covact_geometry::NurbsPatch;
use vtkio::model::CellType;

/// Cell data by which such a file is known: the number of the element.
pub(crate) const SHEET: &str = "sheet_element";

/// The mid-surface of a body of kind `nurbs` at one time.
#[derive(Debug, Clone)]
pub struct MidSurface {
    /// Name of the part, on which those of its files are built.
    pub name: String,
    /// Undeformed patches.
    pub rest: Vec<NurbsPatch>,
    /// The same deformed, on the same knots with the same weights.
    pub now: Vec<NurbsPatch>,
    /// Contact pressure at the control points, on either face; none of a body without slave faces.
    pub pressure: Option<Vec<f64>>,
    /// Thickness of the undeformed sheet (length).
    pub thickness: f64,
    /// Elements that are shown; none where all of them are.
    pub kept: Option<Vec<bool>>,
    /// How exactly displacements and pressures are written.
    pub precision: Precision,
}

impl MidSurface {
    /// The surface as the bytes of a `.vtu` file: a Bezier cell for every element, patch after patch; elements that a trim cuts are whole. Point data, at the control points of the
    /// cells: `displacement`, the weights, `contact_pressure`; cell data: `sheet_element` (counted from 0), `thickness` and the
    /// degrees.
    ///
    /// # Errors
    /// [`OutputError::FieldLength`] where the pressure has not one value per control point.
    pub fn to_vtu(&self) -> Result<Vec<u8>, OutputError> {
        let pieces = |patches: &[NurbsPatch]| -> Vec<SurfacePiece> {
            let all = patches.iter();
            all.flat_map(|patch| SurfacePiece::of_patch(patch, 0, 0, false))
                .collect()
        };
        let (rest, now) = (pieces(&self.rest), pieces(&self.now));
        let pressure = match &self.pressure {
            None => None,
            Some(values) => Some(pieces(&self.scalar(values)?)),
        };
        let (mut points, mut way, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        let (mut offsets, mut degrees, mut pressures) = (Vec::new(), Vec::new(), Vec::new());
        let mut numbers = Vec::new();
        for (k, (rest, now)) in rest.iter().zip(&now).enumerate() {
            if self.kept.as_ref().is_some_and(|kept| !kept[k]) {
                continue;
            }
            numbers.push(k as u32);
            for at in vtk_order(rest.degree) {
                let [a, b] = [rest, now].map(|piece| {
                    let [x, y, z, w] = piece.points[at];
                    [x / w, y / w, z / w]
                });
                points.extend(a);
                way.extend((0..3).map(|c| b[c] - a[c]));
                weights.push(rest.points[at][3]);
                if let Some(pressure) = &pressure {
                    let [p, _, _, w] = pressure[k].points[at];
                    pressures.push(p / w);
                }
            }
            offsets.push(weights.len() as u64);
            let [p, q] = rest.degree;
            degrees.extend([p as f64, q as f64, 0.0]);
        }
        let cells = offsets.len();
        let mut point_data = vec![
            Array::new("displacement", 3, self.precision.displacement(way)),
            Array::new(WEIGHTS, 1, weights),
        ];
        if pressure.is_some() {
            point_data.push(Array::new(
                "contact_pressure",
                1,
                self.precision.field(&pressures),
            ));
        }
        Grid {
            part: self.name.clone(),
            connectivity: (0..offsets.last().copied().unwrap_or(0)).collect(),
            offsets,
            types: vec![CellType::BezierQuadrilateral; cells],
            points,
            point_data,
            cell_data: vec![
                Array::new(DEGREES, 3, degrees),
                Array::new(SHEET, 1, numbers),
                Array::new("thickness", 1, vec![self.thickness; cells]),
            ],
            vectors: Some("displacement"),
            normals: None,
            rational: true,
        }
        .into_bytes()
    }

    /// Values of the control points as the first coordinate of patches on the same knots.
    fn scalar(&self, values: &[f64]) -> Result<Vec<NurbsPatch>, OutputError> {
        let expected = self.rest.iter().map(|p| p.homogeneous().len()).sum();
        let wrong = || OutputError::FieldLength {
            part: self.name.clone(),
            field: "contact_pressure".to_owned(),
            expected,
            found: values.len(),
        };
        if values.len() != expected {
            return Err(wrong());
        }
        let mut values = values.iter();
        (self.rest.iter())
            .map(|patch| {
                let basis = [patch.basis(0).clone(), patch.basis(1).clone()];
                // Weights first: where they end no value is taken.
                let points = patch.weights().into_iter().zip(values.by_ref());
                let points: Vec<[f64; 4]> = points.map(|(w, p)| [p * w, 0.0, 0.0, w]).collect();
                NurbsPatch::from_homogeneous(basis, points).map_err(|_| wrong())
            })
            .collect()
    }
}
