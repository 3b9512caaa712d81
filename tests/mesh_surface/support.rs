//! Surfaces of quadrilaterals and triangles, and writers of small files.
use covact::mesh::{ElementKind, Format, Mesh, MeshError, MeshReport, read};
use covact::scene::{MeshFile, Thickness};
use std::fmt::Write;
use std::path::Path;

/// A surface: points, and elements around their border.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    pub points: Vec<[f64; 3]>,
    pub facets: Vec<Vec<usize>>,
}

/// `n` x `m` quadrilaterals over `[0, 1]^2`, mapped into space.
pub fn grid(n: usize, m: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Surface {
    let mut surface = Surface::default();
    for j in 0..=m {
        for i in 0..=n {
            surface
                .points
                .push(at(i as f64 / n as f64, j as f64 / m as f64));
        }
    }
    for j in 0..m {
        for i in 0..n {
            let a = i + (n + 1) * j;
            surface.facets.push(vec![a, a + 1, a + n + 2, a + n + 1]);
        }
    }
    surface
}

impl Surface {
    /// Every quadrilateral as two triangles.
    pub fn triangles(&self) -> Surface {
        let halves = |f: &Vec<usize>| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]];
        Surface {
            points: self.points.clone(),
            facets: self.facets.iter().flat_map(halves).collect(),
        }
    }

    /// The `*NODE` and `*ELEMENT` lines of an input file, all elements in the set `ALL`, numbered from 1.
    pub fn inp(&self) -> String {
        let mut text = "*NODE\n".to_string();
        for (k, [x, y, z]) in self.points.iter().enumerate() {
            writeln!(text, "{}, {x}, {y}, {z}", k + 1).unwrap();
        }
        for (kind, corners) in [("S4", 4), ("S3", 3)] {
            writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=ALL").unwrap();
            for (k, facet) in self.facets.iter().enumerate() {
                if facet.len() == corners {
                    let nodes: Vec<String> = facet.iter().map(|n| (n + 1).to_string()).collect();
                    writeln!(text, "{}, {}", k + 1, nodes.join(", ")).unwrap();
                }
            }
        }
        text
    }
}

/// A surface file with this thickness and everything else at its default.
pub fn file(thickness: f64) -> MeshFile {
    MeshFile {
        thickness: Some(Thickness::Uniform(thickness)),
        ..MeshFile::new("a")
    }
}

/// Reads bytes as `a.<extension>`.
pub fn load(
    bytes: &[u8],
    extension: &str,
    file: &MeshFile,
    kind: ElementKind,
) -> Result<(Mesh, MeshReport), MeshError> {
    let name = format!("a.{extension}");
    let path = Path::new(&name);
    read(bytes, path, Format::of(path).unwrap(), file, kind)
}

/// Reads an input file as linear elements.
pub fn h8(text: &str, file: &MeshFile) -> Result<(Mesh, MeshReport), MeshError> {
    load(text.as_bytes(), "inp", file, ElementKind::H8)
}

pub fn close(a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance * b.abs().max(1.0),
        "{a} is not {b}"
    );
}
