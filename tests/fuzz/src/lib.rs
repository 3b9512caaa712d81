//! What all targets share: the bounds of a reader, and what must hold of a mesh that was read.

#[path = "../../../geometry/fuzz/src/bounds.rs"]
mod bounds;

pub use bounds::{Budget, bounded};

use covact::mesh::{Mesh, MeshError, MeshReport};
use std::path::Path;

/// Reads bytes with a mesh reader within the bounds of a reader; what is read passes all checks of a mesh.
pub fn mesh(
    bytes: &[u8],
    name: &str,
    read: fn(&[u8], &Path, f64) -> Result<(Mesh, MeshReport), MeshError>,
) {
    let found = bounded(Budget::reader(bytes.len()), || {
        let found = read(bytes, Path::new(name), 1.0);
        // The message belongs to the work: it may be long.
        found.map_err(|e| e.to_string())
    });
    match found {
        Ok((mesh, report)) => {
            mesh.check().expect("a mesh that was read is sound");
            assert_eq!(report.element_tags.len(), mesh.elements());
            assert_eq!(report.node_tags.len(), mesh.nodes.len());
        }
        Err(message) => assert!(message.len() < 2000, "a message of {} bytes", message.len()),
    }
}
