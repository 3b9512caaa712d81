//! How the contact pairs stand before anything moves.
use super::error::{number, text};
use super::overclosure::{Deepest, treat};
use super::{Model, ModelError};
use crate::contact::rigid::{behind, presses};
use crate::scene::{InitialOverclosure, Scene};
use covact_geometry::Vec3;

/// Initial gaps of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InitialGap {
    /// Smallest signed distance of a slave point; negative where the tool starts inside the body.
    pub smallest: f64,
    /// Largest signed distance.
    pub largest: f64,
    /// Where the point with the smallest distance is.
    pub place: Vec3,
    /// Points that start in contact.
    pub touching: usize,
    /// Points that start behind the surface, deeper than its search depth: they are not in contact.
    pub behind: usize,
    /// At the nearest point, the body lies between its slave face and the surface: the wrong face is the slave.
    pub turned_away: bool,
}

/// Distances of all points of pair `index` at time 0, wherever they are.
pub fn initial_gap(model: &Model, index: usize) -> Result<InitialGap, ModelError> {
    initial_gaps(model, index, &mut Vec::new())
}

/// The same with the overclosure of every point, zero or negative, in `overclosures`.
fn initial_gaps(
    model: &Model,
    index: usize,
    overclosures: &mut Vec<f64>,
) -> Result<InitialGap, ModelError> {
    let pair = &model.pairs[index];
    let zero = vec![0.0; 3 * model.nodes.len()];
    let master = (model.surfaces[pair.surface].at(0.0, &zero))
        .map_err(|e| text(format!("/contacts/{}/master", pair.name), e.to_string()))?;
    let mut gap = InitialGap {
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        place: Vec3::zeros(),
        touching: 0,
        behind: 0,
        turned_away: false,
    };
    let mut hint = None;
    let mut nearest = None;
    for p in &pair.points {
        let x = model.point_position(p, &zero);
        let Some(foot) = master.foot(&x, hint, f64::INFINITY) else {
            overclosures.push(0.0);
            continue;
        };
        hint = Some(covact_geometry::Hint {
            patch: foot.patch,
            xi: foot.xi,
        });
        let behind = behind(&foot, master.depth);
        let counts = presses(&foot) && !behind;
        let distance = if foot.signed_distance < 0.0 && !counts {
            foot.distance
        } else {
            foot.signed_distance
        };
        if distance < gap.smallest {
            gap.smallest = distance;
            gap.place = x;
            nearest = Some((p.nodes[0], x, master.pose.rotation * foot.normal));
        }
        gap.largest = gap.largest.max(distance);
        gap.touching += usize::from(counts);
        overclosures.push(if counts { distance } else { 0.0 });
        gap.behind += usize::from(behind);
    }
    if let Some((node, x, n)) = nearest {
        gap.turned_away = turned_away(model, pair.body, node, &x, &n);
    }
    Ok(gap)
}

/// Whether the elements at a node lie clearly behind the point `x` as seen along the outward normal `n` of the surface
/// that it projects to. They should lie in front: the surface pushes the slave face into its body.
fn turned_away(model: &Model, body: usize, node: u32, x: &Vec3, n: &Vec3) -> bool {
    let body = &model.bodies[body];
    let node = node - body.first_node;
    let (mut sum, mut length) = (0.0, 0.0);
    for e in (0..body.mesh.elements()).filter(|&e| body.mesh.element(e).contains(&node)) {
        let inward = body.mesh.element_center(e) - x;
        sum += inward.dot(n);
        length += inward.norm();
    }
    sum < -0.1 * length
}

/// Refuses tools that start deep inside a body, and warns of small overclosures and of slave points too coarse for the
/// tool.
pub(super) fn check(model: &mut Model, scene: &Scene) -> Result<(), ModelError> {
    let mut warnings = Vec::new();
    let mut notes = Vec::new();
    for index in 0..model.pairs.len() {
        let mut overclosures = Vec::new();
        let gap = initial_gaps(model, index, &mut overclosures)?;
        let pair = &model.pairs[index];
        let surface = &model.surfaces[pair.surface];
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
        if gap.turned_away {
            warnings.push(format!(
                "contact `{}`: body `{}` lies between its slave faces and surface `{}`: are the faces on the other side \
                 of the body meant?",
                pair.name, model.bodies[pair.body].name, surface.name
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
        if let [Some(radius), _] = surface.radii()
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
        if gap.smallest < -1e-9 * pair.element_size {
            let choice = (scene.contacts.get(&pair.name))
                .map_or(InitialOverclosure::Strain, |c| c.initial_overclosure);
            let deepest = Deepest {
                xi3: gap.smallest,
                at: gap.place,
            };
            let told = treat(model, index, choice, overclosures, deepest)?;
            match choice {
                InitialOverclosure::Strain => warnings.push(told),
                _ => notes.push(told),
            }
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
