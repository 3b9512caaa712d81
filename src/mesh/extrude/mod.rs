//! A surface mesh becomes a body: its elements get one sense of rotation, triangles become quadrilaterals, and the surface
//! goes along its normals by its thickness.
mod cells;
mod edges;
mod error;
mod normals;
mod refine;
mod seams;
mod sense;
mod sets;
mod surface;

pub use error::SurfaceError;

use super::raw::{NONE, RawMesh, report, with_tags};
use super::{ElementKind, Mesh, MeshError, MeshReport, ThicknessRule};
use crate::scene::{Offset, Thickness};
use cells::Cells;
use edges::Edges;
use normals::Normals;
use std::path::Path;
use surface::Surface;

/// How a surface becomes a body.
pub(super) struct Extrusion<'s> {
    pub thickness: &'s Thickness,
    pub offset: Offset,
    pub layers: u32,
    pub kind: ElementKind,
    /// Factor of all coordinates of the file.
    pub scale: f64,
    /// Borders of one part that touch are slits.
    pub slits: bool,
}

impl RawMesh {
    /// Makes a body of the quadrilaterals and triangles of a file; its solid elements are left out.
    pub(super) fn into_shell(
        mut self,
        path: &Path,
        how: &Extrusion,
    ) -> Result<(Mesh, MeshReport), MeshError> {
        if let Some(refused) = self.refused_facets.take() {
            return Err(refused);
        }
        if self.facets.is_empty() {
            let help = match self.hexahedra.is_empty() {
                true => "`thickness` makes a body of a surface mesh".to_string(),
                false => {
                    "hexahedra have a thickness of their own: leave `thickness` out".to_string()
                }
            };
            return Err(self.nothing(path, "quadrilaterals or triangles", help));
        }
        let mut notes = std::mem::take(&mut self.notes);
        if !self.hexahedra.is_empty() {
            notes.push(format!(
                "{} hexahedra were left out: `thickness` makes a body of the surface elements",
                self.hexahedra.len()
            ));
        }
        if let Some(MeshError::Unsupported { what, .. }) = &self.refused {
            notes.push(format!("solid elements were left out: {what}"));
        }
        let fail = |source| MeshError::Surface {
            path: path.to_path_buf(),
            source,
        };
        let mut surface = Surface::new(self, how.scale, how.kind == ElementKind::Q18, &mut notes);
        let mut edges = Edges::new(&surface.facets);
        surface.check().map_err(fail)?;
        edges.check(&surface).map_err(fail)?;
        seams::check(&surface, &edges, how.slits, &mut notes).map_err(fail)?;
        surface.set_thickness(how.thickness, path)?;
        let turned = sense::unify(&mut surface, &edges).map_err(fail)?;
        if turned > 0 {
            notes.push(format!(
                "{turned} of {} surface elements looked against their neighbours and were turned; `top` is where the others \
                 look",
                surface.facets.len()
            ));
            edges = Edges::new(&surface.facets);
        }
        sense::check_fans(&surface, &edges).map_err(fail)?;
        let triangles = surface.facets.iter().filter(|f| f[3] == NONE).count();
        if triangles > 0 {
            let before = surface.facets.len();
            refine::split(&mut surface, &edges);
            edges = Edges::new(&surface.facets);
            notes.push(format!(
                "{triangles} triangles were cut into three quadrilaterals each, and the {} quadrilaterals beside them into \
                 four, so that the {before} surface elements became {}",
                before - triangles,
                surface.facets.len()
            ));
        }
        if how.kind == ElementKind::Q18 {
            let straight = surface.middles.is_empty();
            let made = refine::complete(&mut surface, &edges);
            if straight {
                notes.push(format!(
                    "the surface elements have no nodes between their corners: `q18` got {made}, on straight edges"
                ));
            }
        }
        surface.add_nodes_of_sets();
        let mut cells = Cells::new(&surface, how.kind);
        cells.at_nodes = surface::at_nodes(&surface, how.thickness).map_err(fail)?;
        let normals = Normals::new(&surface.nodes, &cells).map_err(fail)?;
        if let (count @ 1.., off) = normals.uneven {
            notes.push(format!(
                "at {count} node(s) more than three planes meet, which cannot all keep the thickness: it is up to {:.1} % off \
                 there",
                100.0 * off
            ));
        }
        let mut mesh = cells.extrude(&surface, &normals, how.offset, how.layers)?;
        sets::name(&mut mesh, &surface, &cells, &edges, how.layers, &mut notes);
        let layers = how.layers as usize;
        let element_tags = cells.tags.repeat(layers);
        let node_tags = surface.node_tags.repeat(layers + 1);
        mesh.check_with(how.slits)
            .map_err(|e| with_tags(e, &element_tags, &node_tags))?;
        let mut report = report(&mesh, notes, ThicknessRule::Extruded)?;
        report.element_tags = element_tags;
        report.node_tags = node_tags;
        Ok((mesh, report))
    }
}
