//! STL surfaces made of exact ones.
use super::file::StlSource;
use crate::model::build::exact_surface;
use crate::model::error::number;
use crate::scene;
use covact_geometry::facet::{Bilinear, FacetError, Refinement, bilinear_facets, distance_from};
use covact_geometry::io::write_stl;
use covact_geometry::{PatchSet, Vec3};
use serde_json::Value as Json;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Times that facets are cut anew, finer, where their triangles are farther from the surface than they are.
const TRIES: usize = 8;

/// Why there are no triangles.
#[derive(Debug, thiserror::Error)]
pub enum TriangleError {
    /// The surface could not be cut into facets.
    #[error(transparent)]
    Facets(#[from] FacetError),
    /// The triangles do not get as near to the surface as asked for: their distance, and the one asked for.
    #[error("triangles are still {0} away from the surface where {1} is asked for")]
    Chord(String, String),
}

/// Flat triangles with nodes on a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Triangles {
    /// Positions of the nodes.
    pub nodes: Vec<Vec3>,
    /// Counter-clockwise seen from the side of rho_1 x rho_2.
    pub triangles: Vec<[u32; 3]>,
}

impl Triangles {
    /// Cuts an exact surface into quadrilaterals, and each of these in two along the diagonal that is nearer to it. A chord
    /// error is kept by the triangles.
    ///
    /// # Errors
    /// [`TriangleError`]: trimmed patches, useless numbers, too many facets.
    pub fn of(exact: &PatchSet, refinement: Refinement) -> Result<Self, TriangleError> {
        let Refinement::Chord(wanted) = refinement else {
            return Ok(cut(exact, refinement)?);
        };
        let (mut chord, mut distance) = (wanted, f64::INFINITY);
        for _ in 0..TRIES {
            let made = cut(exact, Refinement::Chord(chord))?;
            distance = made.distance(exact)?;
            if distance <= wanted {
                return Ok(made);
            }
            chord *= 0.95 * wanted / distance;
        }
        Err(TriangleError::Chord(number(distance), number(wanted)))
    }

    /// Largest distance of a triangle from the surface.
    ///
    /// # Errors
    /// Nodes that are not finite.
    pub fn distance(&self, exact: &PatchSet) -> Result<f64, FacetError> {
        let flat = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|n| self.nodes[n as usize]);
            Bilinear::new([a, b, c, c])
        };
        let flat = self
            .triangles
            .iter()
            .map(flat)
            .collect::<Result<Vec<_>, _>>()?;
        Ok(distance_from(exact, &flat))
    }
}

fn cut(exact: &PatchSet, refinement: Refinement) -> Result<Triangles, FacetError> {
    let mesh = bilinear_facets(exact, refinement)?.mesh;
    let away = |a: u32, b: u32| {
        let middle = (mesh.nodes[a as usize] + mesh.nodes[b as usize]) * 0.5;
        (exact.project(&middle, None, f64::INFINITY)).map_or(0.0, |foot| foot.distance)
    };
    let mut triangles = Vec::with_capacity(2 * mesh.facets.len());
    for &[a, b, c, d] in &mesh.facets {
        let both = match away(b, c) < away(a, d) {
            true => [[a, b, c], [b, d, c]],
            false => [[a, b, d], [a, d, c]],
        };
        // A facet at a pole is a triangle already.
        let whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        triangles.extend(both.into_iter().filter(whole));
    }
    Ok(Triangles {
        nodes: mesh.nodes,
        triangles,
    })
}

/// Makes STL files of the surfaces of scenes, each once.
pub(super) struct Maker {
    /// Where paths in the scene are relative to.
    dir: PathBuf,
    folder: TempDir,
    made: HashMap<String, PathBuf>,
}

impl Maker {
    pub fn new(dir: &Path) -> std::io::Result<Self> {
        Ok(Maker {
            dir: dir.to_path_buf(),
            folder: tempfile::tempdir()?,
            made: HashMap::new(),
        })
    }

    /// The file with the triangles of the surface `name` of a scene; errors in words.
    pub fn make(
        &mut self,
        scene: &Json,
        name: &str,
        source: &StlSource,
    ) -> Result<PathBuf, String> {
        let (refinement, label) = match source {
            StlSource::File(path) => return Ok(path.clone()),
            StlSource::Chord(c) => (Refinement::Chord(*c), format!("chord_{c}")),
            StlSource::Size(s) => (Refinement::Size(*s), format!("size_{s}")),
            StlSource::Count(n) => {
                let label = format!("count_{}_{}", n[0], n[1]);
                (Refinement::PerPatch(*n), label)
            }
        };
        let surface = scene.pointer(&scene::pointer(&["surfaces", name]));
        let key = format!(
            "{name} {label} {} {}",
            surface.unwrap_or(&Json::Null),
            scene["units"]
        );
        if let Some(path) = self.made.get(&key) {
            return Ok(path.clone());
        }
        let mut loaded =
            scene::parse(&scene.to_string(), "the scene").map_err(|e| e.to_string())?;
        loaded.dir.clone_from(&self.dir);
        let exact = exact_surface(&loaded, name).map_err(|e| e.to_string())?;
        let made = Triangles::of(&exact, refinement).map_err(|e| e.to_string())?;
        let stem = crate::output::file_stem(&format!("{name}_{label}"));
        // Surfaces that are not the same may be called the same.
        let folder = self.folder.path().join(self.made.len().to_string());
        let path = folder.join(format!("{stem}.stl"));
        std::fs::create_dir(&folder)
            .and_then(|()| std::fs::write(&path, write_stl(&made.nodes, &made.triangles)))
            .map_err(|e| format!("cannot write `{}`: {e}", path.display()))?;
        self.made.insert(key, path.clone());
        Ok(path)
    }
}
