//! Scenes from texts, with meshes and surfaces that Python gives as arrays.
use crate::error;
use crate::geometry::Surface;
use covact::scene::{self, LoadedScene, MeshCells, MeshSource};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Points and cells of a mesh, as Python gives them.
#[derive(FromPyObject)]
pub struct Cells<'py> {
    #[pyo3(item)]
    points: PyReadonlyArray2<'py, f64>,
    #[pyo3(item)]
    connectivity: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    ends: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    types: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    cell_sets: BTreeMap<String, PyReadonlyArray1<'py, u32>>,
    #[pyo3(item)]
    point_sets: BTreeMap<String, PyReadonlyArray1<'py, u32>>,
}

/// A scene as Python gives it: a file, or a text with what stands in it for files as arrays.
#[derive(FromPyObject)]
pub struct Source<'py> {
    /// Path of a scene file; the rest is empty then.
    #[pyo3(item)]
    path: Option<PathBuf>,
    #[pyo3(item)]
    text: String,
    /// Folder that paths in the scene are relative to.
    #[pyo3(item)]
    folder: PathBuf,
    /// Meshes of bodies by name; in the text a mesh file stands in their place.
    #[pyo3(item)]
    meshes: BTreeMap<String, Cells<'py>>,
    /// Surfaces by name; in the text a CAD file stands in their place.
    #[pyo3(item)]
    surfaces: BTreeMap<String, PyRef<'py, Surface>>,
}

/// Rows of three numbers.
pub fn rows(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<[f64; 3]>> {
    let view = array.as_array();
    if view.ncols() != 3 {
        let found = view.ncols();
        let message = format!("{what}: expected an array of shape (n, 3), found (n, {found})");
        return Err(PyValueError::new_err(message));
    }
    Ok((view.rows().into_iter())
        .map(|row| [row[0], row[1], row[2]])
        .collect())
}

impl Source<'_> {
    /// The scene, with all that is wrong with its form as an exception.
    pub fn load(&self, py: Python<'_>) -> PyResult<LoadedScene> {
        let wrong = |e| error::of_scene(py, &e);
        if let Some(path) = &self.path {
            return scene::load(path).map_err(wrong);
        }
        let mut loaded = scene::parse(&self.text, "scene").map_err(wrong)?;
        loaded.dir = self.folder.clone();
        for (name, cells) in &self.meshes {
            let Some(body) = loaded.scene.bodies.get_mut(name) else {
                continue;
            };
            let MeshSource::File(file) = &body.mesh else {
                continue;
            };
            let list = |array: &PyReadonlyArray1<'_, i64>| array.as_array().to_vec();
            let sets = |sets: &BTreeMap<String, PyReadonlyArray1<'_, u32>>| {
                let list = |(name, set): (&String, &PyReadonlyArray1<'_, u32>)| {
                    (name.clone(), set.as_array().to_vec())
                };
                sets.iter().map(list).collect()
            };
            body.mesh = MeshSource::from(MeshCells {
                points: rows(&cells.points, "points of a mesh")?,
                connectivity: list(&cells.connectivity),
                ends: list(&cells.ends),
                types: list(&cells.types),
                cell_sets: sets(&cells.cell_sets),
                point_sets: sets(&cells.point_sets),
                file: file.clone(),
            });
        }
        for (name, given) in &self.surfaces {
            if let Some(surface) = loaded.scene.surfaces.get_mut(name) {
                surface.cad = None;
                surface.patches = Some(given.patches().to_vec().into());
            }
        }
        Ok(loaded)
    }
}

/// All that is wrong with a scene, without solving it: raises an exception where there is anything.
#[pyfunction]
pub fn check(py: Python<'_>, source: Source<'_>) -> PyResult<String> {
    let loaded = source.load(py)?;
    let problems = scene::check(&loaded);
    if !problems.is_empty() {
        return Err(error::of_problems(py, &problems));
    }
    let report = covact::run::check(&loaded).map_err(|e| error::of_run(py, e))?;
    serde_json::to_string(&report).map_err(error::plain)
}
