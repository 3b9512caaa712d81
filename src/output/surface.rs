//! Rigid surfaces as exact rational Bezier cells, bilinear ones as plain quadrilaterals, and as flat quadrilaterals.
use super::OutputError;
use super::bezier::{MAX_DEGREE, SurfacePiece, vtk_order};
use super::template::LastFile;
use super::vtu::{Array, DEGREES, Grid, WEIGHTS, single};
use crate::machine::memory::times;
use nalgebra::{Isometry3, Point3, Vector3};
use vtkio::model::CellType;

/// Bytes of a quadrilateral of the flat copy of a surface: four indices, patch, entity, and a corner with its normal.
const FLAT: u64 = 4 * 8 + 2 * 4 + 2 * 24;
/// The flat copy is held once, with the file written last, and moved and as the bytes of a file while it is written.
const COPIES: u64 = 4;

/// Bytes of the flat copies of a surface, `each` quadrilaterals for every one of so many polynomial pieces.
pub fn flat_bytes(pieces: u64, each: u64) -> u64 {
    times(times(pieces, each), COPIES * FLAT)
}

/// A rigid surface ready to be written at any position: control points in VTK's order and the tessellation are worked
/// out once.
#[derive(Debug, Clone)]
pub struct SurfaceOutput {
    name: String,
    exact: Exact,
    flat: Flat,
    left_out: Vec<usize>,
    /// What was written last of the exact surface and of the flat copy.
    last: [LastFile; 2],
}

/// Bezier cells, and quadrilaterals where the degree is one.
#[derive(Debug, Clone, Default)]
struct Exact {
    points: Vec<Point3<f64>>,
    weights: Vec<f64>,
    offsets: Vec<u64>,
    types: Vec<CellType>,
    degrees: Vec<f64>,
    patch: Vec<u32>,
    entity: Vec<u32>,
}

/// The quadrilaterals of a surface, for who draws it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tessellation {
    /// Corners, those of each quadrilateral in steps around it; pieces share none.
    pub points: Vec<Point3<f64>>,
    /// Outward unit normals at the corners.
    pub normals: Vec<Vector3<f64>>,
    /// Numbers of the corners, four a quadrilateral.
    pub corners: Vec<u64>,
    /// Patch of each quadrilateral.
    pub patch: Vec<u32>,
}

/// Flat quadrilaterals.
#[derive(Debug, Clone, Default)]
struct Flat {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    connectivity: Vec<u64>,
    patch: Vec<u32>,
    entity: Vec<u32>,
}

impl SurfaceOutput {
    /// Prepares the surface `name` in its reference position; every piece is divided into `tessellation` x
    /// `tessellation` quadrilaterals (at least 1 x 1) for the flat copy, unless it says how many it needs.
    ///
    /// # Errors
    /// [`OutputError::Piece`] when a piece has the wrong number of points or a weight that is not positive.
    pub fn new(
        name: &str,
        pieces: Vec<SurfacePiece>,
        tessellation: u32,
    ) -> Result<Self, OutputError> {
        let mut exact = Exact::default();
        let mut flat = Flat::default();
        let mut left_out = Vec::new();
        let most = [tessellation.max(1); 2];
        for (number, piece) in pieces.into_iter().enumerate() {
            piece.check().map_err(|reason| OutputError::Piece {
                surface: name.to_string(),
                piece: number,
                reason,
            })?;
            let piece = piece.oriented();
            if piece.degree.iter().any(|&d| d > MAX_DEGREE) {
                left_out.push(number);
            } else {
                exact.push(&piece);
            }
            let divisions = piece.divisions.unwrap_or(most);
            flat.push(&piece, divisions.map(|n| n.max(1) as usize));
        }
        Ok(SurfaceOutput {
            name: name.to_string(),
            exact,
            flat,
            left_out,
            last: Default::default(),
        })
    }

    /// Name of the surface in the scene.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The flat copy.
    pub fn into_tessellation(self) -> Tessellation {
        let Flat {
            points,
            normals,
            connectivity,
            patch,
            ..
        } = self.flat;
        Tessellation {
            points,
            normals,
            corners: connectivity,
            patch,
        }
    }

    /// Numbers of the pieces whose degree is above [`MAX_DEGREE`]: VTK has no cell for them, so they are in the
    /// tessellated copy only.
    pub fn left_out(&self) -> &[usize] {
        &self.left_out
    }

    /// The exact surface as the bytes of a `.vtu` file, where it starts (the first pose), with its displacement to where it
    /// is (the second). Cell data: `patch`, `entity` and the degrees; point data: the weights and `displacement`, as bodies
    /// have it.
    pub fn to_vtu(&self, [start, at]: [&Isometry3<f64>; 2]) -> Result<Vec<u8>, OutputError> {
        let e = &self.exact;
        let points = moved(&e.points, start);
        let way = displacement(&points, moved(&e.points, at));
        self.last[0].bytes(&points, way, |way| Grid {
            part: self.name.clone(),
            connectivity: (0..e.points.len() as u64).collect(),
            offsets: e.offsets.clone(),
            types: e.types.clone(),
            point_data: vec![way, Array::new(WEIGHTS, 1, e.weights.clone())],
            points: points.clone(),
            cell_data: vec![
                Array::new(DEGREES, 3, e.degrees.clone()),
                Array::new("patch", 1, e.patch.clone()),
                Array::new("entity", 1, e.entity.clone()),
            ],
            vectors: Some(DISPLACEMENT),
            normals: None,
            rational: true,
        })
    }

    /// The surface as flat quadrilaterals, as the bytes of a `.vtu` file; as [`SurfaceOutput::to_vtu`]. Point data: outward
    /// `normal` (before the displacement) and `displacement`; cell data: `patch`, `entity`.
    pub fn to_tessellated_vtu(
        &self,
        [start, at]: [&Isometry3<f64>; 2],
    ) -> Result<Vec<u8>, OutputError> {
        let f = &self.flat;
        let points = moved(&f.points, start);
        let way = displacement(&points, moved(&f.points, at));
        let cells = f.patch.len();
        let normals = || -> Vec<f64> {
            let turned = f.normals.iter().map(|n| start.rotation * n);
            turned.flat_map(|n| [n.x, n.y, n.z]).collect()
        };
        self.last[1].bytes(&points, way, |way| Grid {
            part: self.name.clone(),
            connectivity: f.connectivity.clone(),
            offsets: (1..=cells as u64).map(|c| 4 * c).collect(),
            types: vec![CellType::Quad; cells],
            point_data: vec![way, Array::new("normal", 3, single(&normals()))],
            points: points.clone(),
            cell_data: vec![
                Array::new("patch", 1, f.patch.clone()),
                Array::new("entity", 1, f.entity.clone()),
            ],
            vectors: Some(DISPLACEMENT),
            normals: Some("normal"),
            rational: false,
        })
    }
}

impl Exact {
    fn push(&mut self, piece: &SurfacePiece) {
        for k in vtk_order(piece.degree) {
            let [x, y, z, w] = piece.points[k];
            self.points.push(Point3::new(x / w, y / w, z / w));
            self.weights.push(w);
        }
        self.offsets.push(self.points.len() as u64);
        // Every program knows these; with equal weights they are the same.
        let equal = piece.points.iter().all(|c| c[3] == piece.points[0][3]);
        self.types.push(match piece.degree {
            [1, 1] if equal => CellType::Quad,
            _ => CellType::BezierQuadrilateral,
        });
        let [p, q] = piece.degree;
        self.degrees.extend([p as f64, q as f64, 0.0]);
        self.patch.push(piece.patch);
        self.entity.push(piece.entity);
    }
}

impl Flat {
    fn push(&mut self, piece: &SurfacePiece, [n, m]: [usize; 2]) {
        let first = self.points.len();
        for j in 0..=m {
            for i in 0..=n {
                let at = piece.evaluate(i as f64 / n as f64, j as f64 / m as f64);
                self.points.push(at.point.into());
                self.normals.push(at.normal.into());
            }
        }
        for j in 0..m {
            for i in 0..n {
                let corner = (first + i + (n + 1) * j) as u64;
                let up = corner + n as u64 + 1;
                self.connectivity.extend([corner, corner + 1, up + 1, up]);
                self.patch.push(piece.patch);
                self.entity.push(piece.entity);
            }
        }
    }
}

/// Name of the point data that bodies and surfaces are warped by.
const DISPLACEMENT: &str = "displacement";

/// What leads from the points to where they are now. In single precision, which the rounding of the difference is below: all
/// points of a surface that does not turn have the same, which is compressed to nothing.
fn displacement(points: &[f64], now: Vec<f64>) -> Array {
    let way: Vec<f64> = now.iter().zip(points).map(|(b, a)| b - a).collect();
    Array::new(DISPLACEMENT, 3, single(&way))
}

fn moved(points: &[Point3<f64>], at: &Isometry3<f64>) -> Vec<f64> {
    points
        .iter()
        .map(|x| at * x)
        .flat_map(|x| [x.x, x.y, x.z])
        .collect()
}
