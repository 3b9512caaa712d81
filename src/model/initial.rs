//! How the contact pairs stand before anything moves.
use super::error::{number, text};
use super::{Model, ModelError};
use crate::contact::rigid::presses;

/// Initial gaps of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InitialGap {
    /// Smallest signed distance of a slave point; negative where the tool starts inside the body.
    pub smallest: f64,
    /// Largest signed distance.
    pub largest: f64,
    /// Points that start in contact.
    pub touching: usize,
    /// Points that start behind the surface, deeper than its search depth: they are not in contact.
    pub behind: usize,
}

/// Distances of all points of pair `index` at time 0, wherever they are.
pub fn initial_gap(model: &Model, index: usize) -> Result<InitialGap, ModelError> {
    let pair = &model.pairs[index];
    let master = (model.surfaces[pair.surface].at(0.0))
        .map_err(|e| text(format!("/contacts/{}/master", pair.name), e.to_string()))?;
    let zero = vec![0.0; 3 * model.nodes.len()];
    let mut gap = InitialGap {
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        touching: 0,
        behind: 0,
    };
    let mut hint = None;
    for p in &pair.points {
        let x = model.point_position(p, &zero);
        let Some(foot) = master.foot(&x, hint, f64::INFINITY) else {
            continue;
        };
        hint = Some(covact_geometry::Hint {
            patch: foot.patch,
            xi: foot.xi,
        });
        let behind = presses(&foot) && foot.distance > master.depth;
        let counts = presses(&foot) && !behind;
        let distance = if foot.signed_distance < 0.0 && !counts {
            foot.distance
        } else {
            foot.signed_distance
        };
        gap.smallest = gap.smallest.min(distance);
        gap.largest = gap.largest.max(distance);
        gap.touching += usize::from(counts);
        gap.behind += usize::from(behind);
    }
    Ok(gap)
}

/// Refuses tools that start deep inside a body, and warns of small overclosures and of slave points too coarse for the
/// tool.
pub(super) fn check(model: &mut Model) -> Result<(), ModelError> {
    let mut warnings = Vec::new();
    let mut notes = Vec::new();
    for (index, pair) in model.pairs.iter().enumerate() {
        let surface = &model.surfaces[pair.surface];
        let gap = initial_gap(model, index)?;
        notes.push(format!(
            "contact `{}`: initial gaps from {} to {} at {} points, {} of them in contact",
            pair.name,
            number(gap.smallest),
            number(gap.largest),
            pair.points.len(),
            gap.touching
        ));
        let limit = 0.5 * pair.element_size;
        if gap.smallest < -limit {
            return Err(text(
                format!("/surfaces/{}", surface.name),
                format!(
                    "surface `{}` starts {} deep inside body `{}` (contact `{}`), more than half an element, {}",
                    surface.name,
                    number(-gap.smallest),
                    model.bodies[pair.body].name,
                    pair.name,
                    number(limit)
                ),
            )
            .help("move it back with `placement`, or choose the other `side`"));
        }
        if gap.smallest < -1e-9 * pair.element_size {
            warnings.push(format!(
                "contact `{}` starts with an overclosure of {} at {} point(s); the first step resolves it with strain",
                pair.name,
                number(-gap.smallest),
                gap.touching
            ));
        }
        if gap.behind > 0 {
            warnings.push(format!(
                "contact `{}`: {} point(s) start behind surface `{}`, deeper than its `depth` {}, and are not in \
                 contact: move the surface with `placement`, or choose the other `side`",
                pair.name,
                gap.behind,
                surface.name,
                number(surface.depth)
            ));
        }
        let spacing = point_spacing(model, index);
        if let Some(radius) = (surface.set.curvature_range().convex).map(|c| c.radius())
            && spacing > 0.5 * radius
        {
            warnings.push(format!(
                "contact `{}`: its slave points are {} apart, too coarse for the smallest convex radius {} of surface \
                 `{}`, which will sink in between them: refine the mesh or take more `points` a face (at most {} \
                 apart)",
                pair.name,
                number(spacing),
                number(radius),
                surface.name,
                number(0.5 * radius)
            ));
        }
    }
    model.warnings.extend(warnings);
    model.notes.extend(notes);
    Ok(())
}

/// Mean distance of neighbouring slave points: the square root of the mean tributary area.
pub fn point_spacing(model: &Model, index: usize) -> f64 {
    let points = &model.pairs[index].points;
    let area: f64 = points.iter().map(|p| p.area).sum();
    (area / points.len().max(1) as f64).sqrt()
}
