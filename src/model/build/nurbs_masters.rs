//! Faces of sheets as masters.
use super::super::error::text;
use super::{Builder, ModelError};
use crate::mesh::nurbs::{Kept, side};
use crate::mesh::{Face, NurbsSheet};
use crate::scene::{Contact, Gap, Passes, Points, Tangent};
use covact_geometry::{MovingError, MovingFacets, PatchSpans};

/// Largest angle between neighbouring patches of a master (degrees): at a seam the side of a point is told by one of both normals.
const STEEPEST: f64 = 89.0;

/// Largest angle along a curve of a trim (degrees).
const FLAT: f64 = 1.0;

impl Builder<'_> {
    /// What a contact asks for that a face of a sheet as a master cannot do, or that nothing was tried of.
    pub(super) fn sheet_master(
        &self,
        contact: &Contact,
        at: &impl Fn(&str) -> String,
    ) -> Result<(), ModelError> {
        let refuse = |field: &str, what: &str, help: &str| {
            let message = format!(
                "{what} do not go with the master `{}`, a face of a body of kind `nurbs`, yet",
                contact.master
            );
            Err(text(at(field), message).help(help.to_owned()))
        };
        if matches!(contact.passes, Passes::TwoHalf | Passes::Edges) {
            return refuse("passes", "two passes", "leave `passes` out");
        }
        if matches!(contact.points, Points::Segments(_)) {
            return refuse("points", "integration segments", "take `{\"gauss\": 3}`");
        }
        if contact.gap == Gap::Averaged {
            return refuse("gap", "averaged gaps", "leave `gap` out");
        }
        if contact.master_surface.is_some() {
            return refuse(
                "master_surface",
                "kinds of surfaces",
                "leave it out: the face is the exact surface",
            );
        }
        if let Tangent::Published { .. } = contact.tangent {
            return refuse("tangent", "published tangents", "take `exact`");
        }
        let index = self.body_index.get(contact.master.body());
        let body = index.map(|i| &self.bodies[*i]);
        let sheet = body.and_then(|b| b.block.sheet());
        // Beyond a curve of a trim there are no feet, nor between the normals of both sides.
        let bent = sheet.and_then(|s| s.sharpest_fold(true));
        if let (Some(sheet), Some((seam, _))) = (sheet, bent.filter(|(_, angle)| *angle > FLAT)) {
            let [a, b] = seam.edges.map(|e| sheet.patches[e.patch()].face);
            let message = format!(
                "`{}` is folded along a curve of a trim between faces {a} and {b}, where a face of a body of kind `nurbs` that is a master \
                 has no fold yet",
                contact.master
            );
            let help = "exchange slave and master, or split the face in the CAD program so that the fold is an edge";
            return Err(text(at("master"), message).help(help));
        }
        let fold = sheet
            .and_then(|s| s.sharpest_fold(false))
            .filter(|(_, angle)| *angle > STEEPEST);
        if let (Some(sheet), Some((seam, angle))) = (sheet, fold) {
            let [a, b] = seam.edges.map(|e| sheet.patches[e.patch()].face);
            let message = format!(
                "`{}` is folded by {:.0} degrees between faces {a} and {b}: a face of a body of kind `nurbs` that is a master is folded by \
                 {STEEPEST} degrees at most",
                contact.master, angle
            );
            let help = "take the faces on one side of the fold as masters of contacts of their own";
            return Err(text(at("master"), message).help(help));
        }
        Ok(())
    }

    /// Faces of a sheet as a master: its mid-surface, from which contact begins half of the thickness away. The faces are of one
    /// side.
    pub(super) fn sheet_facets(
        &self,
        body: usize,
        faces: &[Face],
    ) -> Option<Result<(MovingFacets, f64), MovingError>> {
        let model = &self.bodies[body];
        let sheet = model.block.sheet()?;
        let spans: Vec<usize> = faces.iter().map(|f| f.element as usize).collect();
        let bottom = faces.first().and_then(|f| side(*f)) == Some(-1.0);
        let number = |n: u32| n + model.first_node;
        let facets = sheet_master_facets(sheet, &spans, bottom, number);
        Some(facets.map(|mut facets| {
            facets.update(|n| self.nodes[n as usize]);
            (facets, 0.5 * sheet.thickness)
        }))
    }
}

/// Spans of a sheet as a surface that others meet. Elements are of one side and ascend.
fn sheet_master_facets(
    sheet: &NurbsSheet,
    elements: &[usize],
    bottom: bool,
    number: impl Fn(u32) -> u32,
) -> Result<MovingFacets, MovingError> {
    let spans: Vec<Vec<usize>> = (sheet.patches.iter())
        .map(|part| {
            let first = part.first_element as usize;
            let own = first..first + part.elements();
            let of_part = elements.iter().filter(|e| own.contains(e));
            of_part.map(|e| e - first).collect()
        })
        .collect();
    let joined: Vec<_> = (0..spans.len()).map(|k| sheet.joined_sides(k)).collect();
    let cut: Vec<Vec<usize>> = (sheet.patches.iter())
        .map(|part| {
            let all = 0..part.elements();
            all.filter(|span| matches!(part.kept(*span), Kept::Part(_)))
                .collect()
        })
        .collect();
    let parts: Vec<PatchSpans> = (sheet
        .patches
        .iter()
        .zip(&spans)
        .zip(joined.iter().zip(&cut)))
    .map(|((part, spans), (joined, cut))| PatchSpans {
        patch: &part.patch,
        spans,
        joined,
        trim: part.trim(),
        cut,
    })
    .collect();
    MovingFacets::of_patches(&parts, bottom, |k, n| {
        number(n + sheet.patches[k].first_node)
    })
}
