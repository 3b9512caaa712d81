//! From the boundary curves of a JSON file to a trimmed patch.

use super::GAP;
use crate::NurbsPatch;
use crate::curve::NurbsCurve;
use crate::io::report::FaceBorder;
use crate::trim::{TrimCurve, TrimLoop, TrimNoteKind};

/// A boundary curve and whether its loop runs through it backwards.
pub struct Part {
    pub curve: NurbsCurve<2>,
    pub backwards: bool,
    pub entity: u32,
}

/// A patch with its loops (the first the outer one, where `has_outer`), what bounds it, and what was noticed. The message
/// says why there is no such patch.
pub fn trimmed(
    patch: &NurbsPatch,
    loops: Vec<Vec<Part>>,
    has_outer: bool,
) -> Result<(NurbsPatch, FaceBorder, Vec<String>), String> {
    let mut notes = Vec::new();
    let mut list = Vec::with_capacity(loops.len());
    for (number, parts) in loops.into_iter().enumerate() {
        let extent = patch.domain().map(|[a, b]| b - a);
        let stated = gap(&parts, extent, |part| part.backwards);
        // Writers disagree about what the direction of a curve refers to.
        let as_drawn = gap(&parts, extent, |_| false);
        let turned = parts.iter().any(|p| p.backwards);
        let ignore = turned && stated > GAP && as_drawn <= GAP;
        if ignore {
            notes.push(format!(
                "trim loop {number}: the curves follow each other as they are, not in the directions stated"
            ));
        }
        let mut curves = Vec::with_capacity(parts.len());
        for part in parts {
            let parameter = match part.backwards && !ignore {
                true => part.curve.reversed().map_err(|e| e.to_string())?,
                false => part.curve,
            };
            curves.push(TrimCurve {
                parameter,
                space: None,
                entity: part.entity,
            });
        }
        list.push(TrimLoop { curves });
    }
    let trimmed = patch
        .trimmed_by(list, has_outer, GAP)
        .map_err(|e| e.to_string())?;
    let mut rectangle = false;
    for note in &trimmed.notes {
        let n = note.loop_number;
        let text = match note.kind {
            TrimNoteKind::Gap(curve, gap) => {
                format!("a gap of {gap:.1e} of the domain after curve {curve} was closed")
            }
            TrimNoteKind::ZeroArea => "it has no area and was left out".to_owned(),
            TrimNoteKind::SelfIntersecting => {
                "it crosses itself; inside is where a ray crosses it an odd number of times"
                    .to_owned()
            }
            TrimNoteKind::Outside => "it lies outside of the domain and was left out".to_owned(),
            TrimNoteKind::Rectangle(_) => {
                rectangle = true;
                continue;
            }
            TrimNoteKind::Shifted(_) => "it was moved by a period of the surface".to_owned(),
            TrimNoteKind::Seam(dir, at) => {
                format!(
                    "the seam of the surface in direction {} was moved to {at}",
                    dir + 1
                )
            }
        };
        notes.push(format!("trim loop {n}: {text}"));
    }
    let border = match (trimmed.patch.trim().is_some(), rectangle || has_outer) {
        (true, _) => FaceBorder::Trimmed,
        (false, true) => FaceBorder::Rectangle,
        (false, false) => FaceBorder::Natural,
    };
    Ok((trimmed.patch, border, notes))
}

/// Largest gap between parts that follow each other, as a share of the domain.
fn gap(parts: &[Part], extent: [f64; 2], backwards: impl Fn(&Part) -> bool) -> f64 {
    let ends: Vec<_> = parts
        .iter()
        .map(|part| {
            let [a, b] = part.curve.ends();
            if backwards(part) { [b, a] } else { [a, b] }
        })
        .collect();
    let gaps = (0..ends.len()).map(|k| {
        let d = ends[k][1] - ends[(k + 1) % ends.len()][0];
        (d.x / extent[0]).abs().max((d.y / extent[1]).abs())
    });
    gaps.fold(0.0, f64::max)
}
