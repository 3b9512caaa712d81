//! STL files as surface meshes: points in the same place are one node.
use super::raw::RawMesh;
use super::{MeshError, Position};
use covact_geometry::io::{StlError, read_stl};
use std::path::Path;

/// The triangles of a file, numbered from 1.
pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<RawMesh, MeshError> {
    let name = path.display().to_string();
    let stl = read_stl(bytes, &name, None).map_err(|e| told(e, path))?;
    let mut raw = RawMesh {
        node_tags: (1..=stl.nodes.len() as u64).collect(),
        nodes: stl.nodes,
        help: "an STL file holds a surface",
        ..RawMesh::default()
    };
    for (triangle, number) in stl.triangles.iter().zip(stl.numbers) {
        raw.facets.push(triangle, u64::from(number) + 1);
    }
    let left_out = stl.report.degenerate.len();
    if left_out > 0 {
        raw.notes.push(format!(
            "{left_out} triangles have no area and were left out"
        ));
    }
    raw.found = vec![format!("{} triangles", raw.facets.len())];
    Ok(raw)
}

fn told(error: StlError, path: &Path) -> MeshError {
    let path = path.to_path_buf();
    match error {
        StlError::Line {
            line,
            expected,
            found,
            ..
        } => MeshError::Syntax {
            path,
            at: Position::Text { line, column: 1 },
            expected: expected.to_string(),
            found,
        },
        StlError::Byte { byte, reason, .. } => MeshError::Syntax {
            path,
            at: Position::Byte(byte),
            expected: "an STL file".to_string(),
            found: reason,
        },
        other => MeshError::Syntax {
            path,
            at: Position::Byte(0),
            expected: "an STL file with triangles".to_string(),
            found: other.to_string(),
        },
    }
}
