//! How the contact pairs stand before anything moves.
use super::error::{number, text};
use super::friction::LawNow;
use super::master::{Master, MasterNow, Masters};
use super::overclosure::{Deepest, treat};
use super::reach::convex_radius;
use super::sagitta::Sides;
use super::sharp::SharpEdges;
use super::{Model, ModelError, PairModel, SurfaceModel, sharp};
use crate::contact::points::SlavePoint;
use crate::scene::{InitialOverclosure, Scene};
use covact_geometry::Vec3;

/// Cosine between the normals of slave and master above which their faces look the same way.
const SAME_WAY: f64 = 0.5;

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
    /// Mean of `n_slave . n_master` at the points nearest to the master (within an element of the nearest); above zero
    /// the faces look the same way. None for rigid masters.
    pub facing: Option<f64>,
    /// At the nearest point, the slave looks towards the body that the master belongs to.
    pub looks_at_master: bool,
    /// At the nearest point, the body lies between its slave face and the surface: the wrong face is the slave. Never so
    /// in self contact.
    pub turned_away: bool,
}

/// Distances of all points of pair `index` at time 0, wherever they are.
pub fn initial_gap(model: &Model, index: usize) -> Result<InitialGap, ModelError> {
    initial_gaps(model, index, &mut Vec::new())
}

/// The same with the gap of every point in `gaps`; not-a-number for those that nothing of the master lies in front of.
fn initial_gaps(
    model: &Model,
    index: usize,
    gaps: &mut Vec<f64>,
) -> Result<InitialGap, ModelError> {
    let pair = &model.pairs[index];
    let offsets = pair.offsets(0.0);
    let zero = vec![0.0; 3 * model.nodes.len()];
    let masters = Masters::new(model);
    let master = (masters.at(model, index, &zero, 0.0))
        .map_err(|e| text(format!("/contacts/{}/master", pair.name), e.to_string()))?;
    let mut gap = InitialGap {
        smallest: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        place: Vec3::zeros(),
        touching: 0,
        behind: 0,
        facing: None,
        looks_at_master: false,
        turned_away: false,
    };
    let mut hint = None;
    let mut nearest = None;
    let mut nearest_distance = f64::INFINITY;
    let mut facing: Vec<(f64, f64)> = Vec::new();
    let rim = model.of_rims(pair);
    let normals = (pair.body_master().filter(|_| !rim)).map(|_| slave_normals(model, pair));
    for (i, p) in pair.points.iter().enumerate() {
        let x = model.point_position(p, &zero);
        let z0 = offsets.map_or(0.0, |o| o.at(i));
        let from = (z0, p.overhang(false));
        let Some(seen) = master.see_hanging((i, &x), hint, f64::INFINITY, from) else {
            gaps.push(f64::NAN);
            continue;
        };
        hint = Some(seen.hint);
        let distance = seen.gap(z0);
        if distance < gap.smallest {
            gap.smallest = distance;
            gap.place = x;
            nearest = (model.terms(p).next()).map(|(n, _)| (n as u32, x, seen.normal));
        }
        if let Some(normals) = &normals {
            facing.push((seen.distance, normals[i].dot(&seen.normal)));
            if let Some(master) = pair.body_master()
                && seen.distance <= nearest_distance
            {
                nearest_distance = seen.distance;
                let face = master.faces[master.facets.source(seen.hint.patch) as usize];
                let element = model.bodies[master.body]
                    .mesh
                    .element_center(face.element as usize);
                gap.looks_at_master = normals[i].dot(&(element - x)) > 0.0;
            }
        }
        gap.largest = gap.largest.max(distance);
        gap.touching += usize::from(seen.closed(z0));
        gaps.push(if seen.counts() { distance } else { f64::NAN });
        gap.behind += usize::from(seen.behind);
    }
    let least = facing.iter().fold(f64::INFINITY, |a, f| a.min(f.0));
    let near = |f: &&(f64, f64)| f.0 <= least + pair.element_size;
    let near: Vec<f64> = facing.iter().filter(near).map(|f| f.1).collect();
    if !near.is_empty() {
        gap.facing = Some(near.iter().sum::<f64>() / near.len() as f64);
    }
    // Faces of one body that see each other do so from opposite sides, maybe at a right angle: nothing to be judged there.
    if let Some((node, x, n)) = nearest
        && !pair.master.is_own()
        && !rim
    {
        gap.turned_away = turned_away(model, pair.body, node, &x, &n);
    }
    Ok(gap)
}

/// Outward unit normals of the undeformed slave faces at the points of a pair.
fn slave_normals(model: &Model, pair: &PairModel) -> Vec<Vec3> {
    let body = &model.bodies[pair.body];
    let mut at_node = vec![Vec3::zeros(); body.mesh.nodes.len()];
    let solid = body.block.sheet().is_none();
    for &face in pair.faces.iter().filter(|_| solid) {
        let (area, normal) = body.mesh.face_area_normal(face);
        for &n in body.mesh.face_nodes(face).nodes() {
            at_node[n as usize] += normal * area;
        }
    }
    let first = body.first_node as usize;
    let normal = |p: &SlavePoint| {
        if let Some(number) = p.lever_number() {
            return model.levers[number].outward(|n| model.nodes[n as usize]);
        }
        let sum = (p.terms()).fold(Vec3::zeros(), |s, (n, w)| s + at_node[n - first] * w);
        sum.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    };
    pair.points.iter().map(normal).collect()
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

/// When a contact without slave points in a stage begins to act, where that is in a later one.
fn acts_later(scene: &Scene, model: &Model, index: usize) -> Option<String> {
    let name = model.pairs[index].name.as_str();
    let now = model.stage.as_ref().map_or(0, |s| s.start.index);
    let acts = |k: &usize| scene.active_contacts(*k).contains(name);
    let first = (now + 1..scene.stages.len()).find(acts)?;
    Some(format!(
        "contact `{name}`: acts from stage `{}` on",
        scene.stages[first].name
    ))
}

/// Refuses tools that start deep inside a body, and warns of small overclosures and of slave points too coarse for the
/// tool.
pub(super) fn check(model: &mut Model, scene: &Scene) -> Result<(), ModelError> {
    let mut warnings = Vec::new();
    let mut notes = Vec::new();
    for index in 0..model.pairs.len() {
        if model.pairs[index].points.is_empty() {
            notes.extend(acts_later(scene, model, index));
            continue;
        }
        let mut gaps = Vec::new();
        let mut gap = initial_gaps(model, index, &mut gaps)?;
        if let Some(found) =
            Sides::new(model, index).and_then(|sides| sides.correction(model, index, &gaps))
            && resolved(scene, &model.pairs[index])
        {
            match found.refused {
                Some(why) => warnings.push(format!(
                    "{}. Pressures are wrong by that, since {why}: use finer faces, element `q18`, or the same nodes on both \
                     sides",
                    found.told
                )),
                None if found.bow.is_empty() => model.pairs[index].below = found.below,
                None => {
                    notes.push(format!(
                        "{}; gaps are measured between these, as the points lie at the start",
                        found.told
                    ));
                    let pair = &mut model.pairs[index];
                    (pair.bow, pair.below) = (found.bow, found.below);
                    gaps.clear();
                    gap = initial_gaps(model, index, &mut gaps)?;
                }
            }
        }
        let pair = &model.pairs[index];
        let master = pair.master_words(model);
        if let Some(master) = pair.body_master()
            && gap.facing.is_some_and(|cosine| cosine > SAME_WAY)
        {
            let (side, set) = match gap.looks_at_master {
                false => ("slave", &pair.slave),
                true => ("master", &master.name),
            };
            return Err(text(
                format!("/contacts/{}/{side}", pair.name),
                format!(
                    "the faces `{}` and `{}` look the same way where they are closest: `{set}` lies on the side of its \
                     body that is turned away from the other",
                    pair.slave, master.name
                ),
            )
            .help("take the faces on the other side of that body, whose outward normals point at the other faces"));
        }
        let overlaps = gap.smallest < -1e-9 * pair.element_size;
        let in_front = gap.smallest.is_finite() && !overlaps && gap.behind == 0;
        let deepest = Deepest {
            gap: gap.smallest,
            at: gap.place,
        };
        if model.of_rims(pair) {
            // What there is to say of it is said of the contact itself.
            if overlaps {
                let overclosures = gaps.iter().map(|gap| gap.min(0.0)).collect();
                treat(model, index, choice(scene, pair), overclosures, deepest)?;
            }
            continue;
        }
        model.pairs[index].starts_in_front = in_front;
        let pair = &model.pairs[index];
        let (name, points) = (&pair.name, pair.points.len());
        notes.push(match gap.smallest.is_finite() {
            true => format!(
                "contact `{name}`: initial gaps from {} to {} at {points} points, {} of them in contact",
                number(gap.smallest),
                number(gap.largest),
                gap.touching
            ),
            false => format!("contact `{name}`: at the start none of its {points} points has the other side in front of it"),
        });
        let (limit, beyond) = match choice(scene, pair) {
            // A fit is meant.
            InitialOverclosure::Shrink { .. } => (pair.master.depth(model), "its `depth`"),
            _ => (0.5 * pair.element_size, "half an element"),
        };
        if gap.smallest < -limit {
            let (pointer, start, help) = match &pair.master {
                Master::Rigid(surface) => (
                    format!("/surfaces/{}", model.surfaces[*surface].name),
                    format!("{master} starts"),
                    "move it back with `placement`, or choose the other `side`",
                ),
                Master::Body(_) => (
                    format!("/contacts/{}/master", pair.name),
                    format!("{master} start"),
                    "move one of the bodies, or take the faces that face each other",
                ),
            };
            let (deep, smaller) = match pair.offset > 0.0 {
                false => ("deep inside", ""),
                true => ("within the `offset` of", "; or take a smaller `offset`"),
            };
            return Err(text(
                pointer,
                format!(
                    "{start} {} {deep} body `{}` (contact `{}`), more than {beyond}, {}",
                    number(-gap.smallest),
                    model.bodies[pair.body].name,
                    pair.name,
                    number(limit)
                ),
            )
            .help(format!("{help}{smaller}")));
        }
        if gap.turned_away {
            warnings.push(format!(
                "contact `{}`: body `{}` lies between its slave faces and {master}: are the faces on the other side of \
                 the body meant?",
                pair.name, model.bodies[pair.body].name
            ));
        }
        if gap.behind > 0 {
            let own = pair.master.is_own();
            let help = match &pair.master {
                _ if own => {
                    "they see the other side of a fold there, or the mesh goes through itself"
                }
                Master::Rigid(_) => "move the surface with `placement`, or choose the other `side`",
                Master::Body(_) => "move one of the bodies, or take the faces that face each other",
            };
            let told = if own { &mut notes } else { &mut warnings };
            told.push(format!(
                "contact `{}`: {} point(s) start behind {master}, deeper than its `depth` {}, and are not in contact: \
                 {help}",
                pair.name,
                gap.behind,
                number(pair.master.depth(model))
            ));
        }
        warnings.extend(without_direction(model, index));
        if let Some(number) = pair.rigid_master() {
            if let Some((text, far)) = too_coarse(
                model,
                index,
                &model.surfaces[number],
                scene.solution.end_time,
            ) {
                let told = if far { &mut warnings } else { &mut notes };
                told.push(text);
            }
            warnings.extend(too_hollow(pair, &model.surfaces[number]));
            if let Some(edges) = SharpEdges::of(&model.surfaces[number]) {
                let name = &model.surfaces[number].name;
                notes.push(edges.note(&pair.name, name, sharp::spacing(model, pair)));
            }
        }
        if overlaps {
            let choice = choice(scene, pair);
            let overclosures = gaps.iter().map(|gap| gap.min(0.0)).collect();
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

/// What becomes of overclosures of a pair.
fn choice(scene: &Scene, pair: &PairModel) -> InitialOverclosure {
    (scene.contacts.get(&pair.name)).map_or(InitialOverclosure::Strain, |c| c.initial_overclosure)
}

/// Whether overclosures of a pair become strains, at once or over a time.
fn resolved(scene: &Scene, pair: &PairModel) -> bool {
    choice(scene, pair).is_resolved()
}

/// Distance of slave points over the smallest convex radius of a rigid surface up to which it sinks in little between them: a
/// thirtieth of the radius. And the one from which on forces are off. Strips that are bent by rollers came to 0.1 to 2 % of the forces
/// of meshes twice as fine at distances from 0.52 to 0.6, a sheet drawn over the edge of a punch to 17 % at 0.9.
const CLOSE: f64 = 0.5;
const APART: f64 = 0.75;

/// What to tell of slave points that are far apart for a rigid surface, and whether that is a warning.
fn too_coarse(
    model: &Model,
    index: usize,
    surface: &SurfaceModel,
    end: f64,
) -> Option<(String, bool)> {
    // What is curved ever more towards a tip bears there with the tip, where that is a slave.
    let tips = || SharpEdges::of(surface).is_some_and(|edges| edges.tips > 0);
    if model.pairs.iter().any(|p| p.edges_of == Some(index)) && tips() {
        return None;
    }
    let spacing = point_spacing(model, index);
    let [smallest, _] = surface.radii();
    let smallest = smallest.filter(|radius| spacing > CLOSE * radius)?;
    let radius = convex_radius(model, (&model.pairs[index], surface), smallest, end)?;
    if spacing <= CLOSE * radius {
        return None;
    }
    let far = spacing > APART * radius;
    let what = match far {
        true => "too coarse for",
        false => "more than half of",
    };
    let sinks = if far { "will" } else { "may" };
    let text = format!(
        "contact `{}`: its slave points are {} apart, {what} the smallest convex radius {} of surface `{}`, which {sinks} sink in \
         between them: refine the mesh or take more `points` a face (at most {} apart)",
        model.pairs[index].name,
        number(spacing),
        number(radius),
        surface.name,
        number(CLOSE * radius)
    );
    Some((text, far))
}

/// A warning of an offset that a hollow does not leave room for.
fn too_hollow(pair: &PairModel, surface: &SurfaceModel) -> Option<String> {
    let [_, Some(radius)] = surface.radii() else {
        return None;
    };
    (pair.offset > 0.0 && pair.offset >= radius).then(|| {
        format!(
            "contact `{}`: its offset {} is not smaller than the smallest hollow radius {} of surface `{}`: points there have \
             no unique closest point, and steps fail",
            pair.name,
            number(pair.offset),
            number(radius),
            surface.name
        )
    })
}

/// A warning of friction with a direction that means nothing where the body lies on the master.
fn without_direction(model: &Model, index: usize) -> Option<String> {
    let pair = &model.pairs[index];
    let LawNow::Orthotropic(law) = pair.friction.as_ref()?.law.at(0.0).ok()? else {
        return None;
    };
    let zero = vec![0.0; 3 * model.nodes.len()];
    let masters = Masters::new(model);
    let master = masters.at(model, index, &zero, 0.0).ok()?;
    let mut hint = None;
    let blurred = pair.points.iter().enumerate().filter(|(i, p)| {
        let x = model.point_position(p, &zero);
        // In the coordinates that the direction is given in.
        let found = match &master {
            MasterNow::Rigid(master) => {
                let foot = master.foot(&x, hint, f64::INFINITY);
                foot.map(|f| (f.hint(), f.normal))
            }
            MasterNow::Body { .. } => master.see(*i, &x, hint).map(|s| (s.hint, s.normal)),
        };
        hint = found.map(|f| f.0).or(hint);
        found.is_some_and(|(_, normal)| law.blurs(&normal))
    });
    let (blurred, all) = (blurred.count(), pair.points.len());
    (2 * blurred > all).then(|| {
        format!(
            "contact `{}`: the `direction` of its friction is nearly that of the normal of {} at {blurred} of {all} slave points: \
             there the two coefficients are brought nearer to each other",
            pair.name,
            pair.master_words(model)
        )
    })
}

/// Mean distance of neighbouring slave points: the square root of the mean tributary area.
pub fn point_spacing(model: &Model, index: usize) -> f64 {
    let points = &model.pairs[index].points;
    let area: f64 = points.iter().map(|p| p.area).sum();
    (area / points.len().max(1) as f64).sqrt()
}
