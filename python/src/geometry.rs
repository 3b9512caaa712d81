//! Surfaces of CAD files and of arrays: frames, closest points, tessellation.
use crate::error;
use crate::work::work;
use covact::geometry::io::{self, LengthUnit, ReadOptions};
use covact::geometry::project::Joining;
use covact::geometry::{EdgeKind, Foot, Frame, Location, NurbsPatch, PatchSet, Status, Vec3};
use covact::machine;
use covact::output::{SurfaceOutput, SurfacePiece};
use numpy::ndarray::{Array1, Array2, Array3};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, ToPyArray,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

/// Points that one thread takes at a time.
const CHUNK: usize = 64;

/// NURBS patches, joined over their common edges.
#[pyclass(frozen, module = "covact.geometry")]
pub struct Surface {
    set: PatchSet,
    /// Number in the file of each patch.
    entities: Vec<u32>,
    names: Vec<Option<String>>,
    unit: Option<String>,
    skipped: Vec<io::Skipped>,
    notes: Vec<String>,
    pool: OnceLock<rayon::ThreadPool>,
}

impl Surface {
    pub fn patches(&self) -> &[NurbsPatch] {
        self.set.patches()
    }

    /// Threads of this surface's queries, as many as the machine has.
    fn pool(&self) -> PyResult<&rayon::ThreadPool> {
        if self.pool.get().is_none() {
            let threads = machine::threads(0).0;
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let _ = self.pool.set(pool.map_err(error::plain)?);
        }
        self.pool
            .get()
            .ok_or_else(|| error::plain("internal error: no threads"))
    }

    fn patch(&self, number: i64) -> PyResult<&NurbsPatch> {
        let patches = self.set.patches();
        let found = usize::try_from(number).ok().and_then(|n| patches.get(n));
        found.ok_or_else(|| {
            let last = patches.len() - 1;
            PyValueError::new_err(format!(
                "there is no patch {number}: the numbers are 0 to {last}"
            ))
        })
    }
}

/// Which side of the patch is outside.
fn side(set: &PatchSet, patch: usize) -> f64 {
    set.sides().get(patch).copied().unwrap_or(1.0)
}

/// Numbers of [`Location`] and [`EdgeKind`] as Python has them.
fn location(at: &Location) -> u8 {
    match at {
        Location::Face => 0,
        Location::Edge {
            kind: EdgeKind::Smooth,
            ..
        }
        | Location::Corner {
            kind: EdgeKind::Smooth,
            ..
        } => 1,
        Location::Edge {
            kind: EdgeKind::Sharp,
            ..
        } => 2,
        Location::Edge {
            kind: EdgeKind::Free,
            ..
        } => 3,
        Location::Corner {
            kind: EdgeKind::Sharp,
            ..
        } => 4,
        Location::Corner {
            kind: EdgeKind::Free,
            ..
        } => 5,
        Location::Crease { .. } => 6,
        Location::Pole { .. } => 7,
    }
}

fn status(of: Status) -> u8 {
    match of {
        Status::Unique => 0,
        Status::NonUnique => 1,
        Status::NotConverged => 2,
    }
}

/// Answers of many queries, an array for each quantity.
struct Feet {
    patch: Vec<i32>,
    xi: Vec<f64>,
    point: Vec<f64>,
    normal: Vec<f64>,
    distance: Vec<f64>,
    location: Vec<u8>,
    status: Vec<u8>,
}

impl Feet {
    fn new(n: usize) -> Self {
        Feet {
            patch: vec![-1; n],
            xi: vec![f64::NAN; 2 * n],
            point: vec![f64::NAN; 3 * n],
            normal: vec![f64::NAN; 3 * n],
            distance: vec![f64::NAN; n],
            location: vec![255; n],
            status: vec![255; n],
        }
    }

    /// Fills in the answers for `points` (three numbers each), on the threads of the current pool.
    fn fill(&mut self, set: &PatchSet, points: &[f64], reach: f64) {
        (
            points.par_chunks(3 * CHUNK),
            self.patch.par_chunks_mut(CHUNK),
            self.xi.par_chunks_mut(2 * CHUNK),
            self.point.par_chunks_mut(3 * CHUNK),
            self.normal.par_chunks_mut(3 * CHUNK),
            self.distance.par_chunks_mut(CHUNK),
            self.location.par_chunks_mut(CHUNK),
            self.status.par_chunks_mut(CHUNK),
        )
            .into_par_iter()
            .for_each(|(points, patch, xi, point, normal, distance, at, sure)| {
                for (k, q) in points.chunks_exact(3).enumerate() {
                    let q = Vec3::new(q[0], q[1], q[2]);
                    let Some(foot) = set.project(&q, None, reach) else {
                        continue;
                    };
                    let Foot { jet, .. } = &foot;
                    patch[k] = foot.patch as i32;
                    xi[2 * k..][..2].copy_from_slice(&foot.xi);
                    point[3 * k..][..3].copy_from_slice(jet.rho.as_slice());
                    normal[3 * k..][..3].copy_from_slice(foot.normal.as_slice());
                    distance[k] = foot.signed_distance;
                    at[k] = location(&foot.location);
                    sure[k] = status(foot.status);
                }
            });
    }
}

#[pymethods]
impl Surface {
    /// Reads a CAD file.
    #[staticmethod]
    #[pyo3(signature = (path, unit=None, hidden=false, tolerance=None))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        unit: Option<&str>,
        hidden: bool,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let unit = unit.map(|name| {
            LengthUnit::from_name(name).ok_or_else(|| {
                let known = LengthUnit::names().join(", ");
                PyValueError::new_err(format!("unknown unit `{name}`; known: {known}"))
            })
        });
        let unit = unit.transpose()?;
        let never = AtomicBool::new(false);
        work(py, &never, None, || {
            let options = ReadOptions { hidden };
            let mut file = io::read_path_with(&path, &options).map_err(|e| e.to_string())?;
            if let Some(unit) = &unit {
                file.convert_to(unit).map_err(|e| e.to_string())?;
            }
            if file.patches.is_empty() {
                let error = file.surface().map(drop);
                return Err(error.map_or_else(|e| e.to_string(), |()| String::new()));
            }
            let joining = Joining {
                tolerance,
                resolution: file.resolution,
            };
            let entities = file.patches.iter().map(|p| p.entity).collect();
            let names = file.patches.iter().map(|p| p.name.clone()).collect();
            let patches = file.patches.into_iter().map(|p| p.patch).collect();
            let set =
                PatchSet::join(patches, joining).map_err(|e| format!("{}: {e}", path.display()))?;
            Ok(Surface {
                set,
                entities,
                names,
                unit: Some(file.unit.name.clone()),
                skipped: file.skipped,
                notes: file.notes,
                pool: OnceLock::new(),
            })
        })?
        .map_err(error::plain)
    }

    /// A NURBS patch from arrays: control points of shape (n1, n2, 3), knot vectors with clamped ends.
    #[staticmethod]
    #[pyo3(signature = (degrees, knots, points, weights=None))]
    fn patch_of(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        points: numpy::PyReadonlyArray3<'_, f64>,
        weights: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let view = points.as_array();
        let (n1, n2, each) = view.dim();
        if each != 3 {
            let message = format!("points: expected shape (n1, n2, 3), found ({n1}, {n2}, {each})");
            return Err(PyValueError::new_err(message));
        }
        let weights = weights.map(|w| {
            let w = w.as_array();
            match w.dim() == (n1, n2) {
                true => Ok((0..n2)
                    .flat_map(|j| (0..n1).map(move |i| (i, j)))
                    .map(|at| w[at])
                    .collect::<Vec<f64>>()),
                false => Err(PyValueError::new_err(format!(
                    "weights: expected shape ({n1}, {n2}), found {:?}",
                    w.dim()
                ))),
            }
        });
        let weights = weights.transpose()?;
        let mut flat = Vec::with_capacity(n1 * n2);
        for j in 0..n2 {
            for i in 0..n1 {
                flat.push(Vec3::new(view[(i, j, 0)], view[(i, j, 1)], view[(i, j, 2)]));
            }
        }
        let patch = NurbsPatch::new(degrees, knots, [n1, n2], &flat, weights.as_deref())
            .map_err(error::plain)?;
        Ok(Surface {
            set: PatchSet::new(vec![patch], None).map_err(error::plain)?,
            entities: vec![0],
            names: vec![None],
            unit: None,
            skipped: Vec::new(),
            notes: Vec::new(),
            pool: OnceLock::new(),
        })
    }

    /// Number of patches.
    fn __len__(&self) -> usize {
        self.set.patches().len()
    }

    #[getter]
    fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Two corners of a box around the surface.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let [low, high] = self.set.bounds();
        let rows = [low, high].map(|x| [x.x, x.y, x.z]);
        numpy::ndarray::arr2(&rows).to_pyarray(py)
    }

    #[getter]
    fn skipped<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for s in &self.skipped {
            let one = PyDict::new(py);
            one.set_item("entity", s.entity)?;
            one.set_item("name", &s.name)?;
            one.set_item("reason", &s.reason)?;
            list.append(one)?;
        }
        Ok(list)
    }

    /// What there is to know of each patch.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for (k, patch) in self.set.patches().iter().enumerate() {
            let one = PyDict::new(py);
            one.set_item("entity", self.entities[k])?;
            one.set_item("name", self.names[k].as_ref())?;
            one.set_item("degrees", patch.degree())?;
            one.set_item("counts", patch.counts())?;
            one.set_item("domain", patch.domain())?;
            one.set_item("rational", patch.is_rational())?;
            one.set_item("trimmed", patch.trim().is_some())?;
            list.append(one)?;
        }
        Ok(list)
    }

    /// Closest points of `points`, an array of shape (n, 3).
    #[pyo3(signature = (points, reach=f64::INFINITY))]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        reach: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let flat = points.as_slice().map_err(|_| {
            PyValueError::new_err(
                "points: expected an array whose rows follow each other in memory",
            )
        })?;
        let n = points.as_array().nrows();
        let pool = self.pool()?;
        let never = AtomicBool::new(false);
        let feet = work(py, &never, None, || {
            let mut feet = Feet::new(n);
            pool.install(|| feet.fill(&self.set, flat, reach));
            feet
        })?;
        let out = PyDict::new(py);
        out.set_item("patch", PyArray1::from_vec(py, feet.patch))?;
        out.set_item("xi", PyArray1::from_vec(py, feet.xi).reshape([n, 2])?)?;
        out.set_item("point", PyArray1::from_vec(py, feet.point).reshape([n, 3])?)?;
        out.set_item(
            "normal",
            PyArray1::from_vec(py, feet.normal).reshape([n, 3])?,
        )?;
        out.set_item("distance", PyArray1::from_vec(py, feet.distance))?;
        out.set_item("location", PyArray1::from_vec(py, feet.location))?;
        out.set_item("status", PyArray1::from_vec(py, feet.status))?;
        Ok(out)
    }

    /// Points, first and second derivatives: arrays of shape (n, 6, 3).
    fn jets<'py>(
        &self,
        py: Python<'py>,
        patch: PyReadonlyArray1<'py, i64>,
        xi: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (patch, xi) = (patch.as_array(), xi.as_array());
        let mut out = Array3::zeros((patch.len(), 6, 3));
        for (k, mut rows) in out.outer_iter_mut().enumerate() {
            let jet = self.patch(patch[k])?.jet([xi[(k, 0)], xi[(k, 1)]]);
            let [a, b] = jet.rho_i;
            let [aa, ab, bb] = jet.rho_ij;
            for (mut row, x) in rows.outer_iter_mut().zip([jet.rho, a, b, aa, ab, bb]) {
                (0..3).for_each(|c| row[c] = x[c]);
            }
        }
        Ok(PyArray3::from_owned_array(py, out))
    }

    /// Normal, metric, curvature and principal curvatures.
    fn frames<'py>(
        &self,
        py: Python<'py>,
        patch: PyReadonlyArray1<'py, i64>,
        xi: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (patch, xi) = (patch.as_array(), xi.as_array());
        let n = patch.len();
        let mut arrays = [3, 3, 3, 2].map(|m| Array2::from_elem((n, m), f64::NAN));
        for k in 0..n {
            let of = self.patch(patch[k])?;
            let jet = of.jet([xi[(k, 0)], xi[(k, 1)]]);
            // A pole has no frame: its row stays as it is.
            let Some(frame) = Frame::new(&jet, side(&self.set, patch[k] as usize)) else {
                continue;
            };
            let [normal, metric, curvature, principal] = &mut arrays;
            for c in 0..3 {
                normal[(k, c)] = frame.n[c];
                metric[(k, c)] = frame.a[c];
                curvature[(k, c)] = frame.h[c];
            }
            let kappa = frame.principal_curvatures();
            (0..2).for_each(|c| principal[(k, c)] = kappa[c]);
        }
        let out = PyDict::new(py);
        let names = ["normal", "metric", "curvature", "principal"];
        for (name, array) in names.into_iter().zip(arrays) {
            out.set_item(name, PyArray2::from_owned_array(py, array))?;
        }
        Ok(out)
    }

    /// Quadrilaterals for drawing: corners, normals there, numbers of the corners, patch of each.
    #[pyo3(signature = (divisions=8))]
    fn tessellate<'py>(&self, py: Python<'py>, divisions: u32) -> PyResult<Bound<'py, PyDict>> {
        let pieces = (self.set.patches().iter().enumerate()).flat_map(|(k, patch)| {
            let reversed = side(&self.set, k) < 0.0;
            SurfacePiece::of_patch(patch, k as u32, self.entities[k], reversed)
        });
        let surface = SurfaceOutput::new("surface", pieces.collect(), divisions);
        let drawn = surface.map_err(error::plain)?.into_tessellation();
        let n = drawn.points.len();
        let points = Array2::from_shape_fn((n, 3), |(k, c)| drawn.points[k][c]);
        let normals = Array2::from_shape_fn((n, 3), |(k, c)| drawn.normals[k][c]);
        let corners = Array2::from_shape_fn((drawn.corners.len() / 4, 4), |(k, c)| {
            drawn.corners[4 * k + c] as i64
        });
        let patch = Array1::from_iter(drawn.patch.iter().map(|p| i64::from(*p)));
        let out = PyDict::new(py);
        out.set_item("points", PyArray2::from_owned_array(py, points))?;
        out.set_item("normals", PyArray2::from_owned_array(py, normals))?;
        out.set_item("corners", PyArray2::from_owned_array(py, corners))?;
        out.set_item("patch", PyArray1::from_owned_array(py, patch))?;
        Ok(out)
    }
}
