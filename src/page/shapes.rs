//! Bodies and tools of a run over time, as a page shows them.
use super::pack::{Chunk, Pack, Span, levels, planes, rounded};
use super::skin::{Skin, skin};
use super::tool::coarsened;
use crate::model::carried::nearest_motion;
use crate::output::read::{self, Array, BodyFile, Listed, Part, SurfaceFile};
use covact_geometry::Vec3;
use nalgebra::Isometry3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Flat copies of tools are off by at most this part of the size of the scene.
const TOLERANCE: f64 = 2e-4;
/// Most steps that a page shows.
const STEPS: usize = 60;

/// How much a page may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    /// Bytes of packed numbers.
    pub bytes: usize,
    /// No further step is read after this.
    pub until: Instant,
}

/// What a page shows in 3-D.
#[derive(Debug, Default, Serialize)]
pub(super) struct Shapes {
    pub parts: Vec<PartShape>,
    /// In the order of their times.
    pub steps: Vec<StepShape>,
    /// Smallest and largest coordinates over all steps.
    pub bounds: [[f64; 3]; 2],
    /// Steps that the run wrote.
    pub written: usize,
    /// What is not shown and why; empty where all is.
    pub note: String,
}

/// A body or a tool.
#[derive(Debug, Serialize)]
pub(super) struct PartShape {
    pub name: String,
    /// Moves as a whole.
    pub rigid: bool,
    /// Numbers of points, of quadrilaterals and of edges.
    pub counts: [usize; 3],
    /// Point that coordinates are relative to, and their largest magnitude.
    pub origin: [f64; 3],
    pub scale: f64,
    /// Half of the sides of the box about all points.
    #[serde(skip)]
    pub half: [f64; 3],
    /// Scalar fields of a body.
    pub fields: Vec<String>,
    /// Coordinates (3 bytes each), corners and edges (4 bytes each), of a tool normals (1 byte each).
    pub chunk: Chunk,
}

/// All parts at a time.
#[derive(Debug, Serialize)]
pub(super) struct StepShape {
    pub step: u32,
    pub time: f64,
    /// Per body its displacements (2 bytes each) and fields (1 byte each).
    pub chunk: Chunk,
    /// In the order of the parts.
    pub states: Vec<State>,
}

/// A part at a time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum State {
    Body {
        /// Largest magnitude of a component of the displacement.
        scale: f64,
        /// Its largest length.
        largest: f64,
        spans: Vec<Span>,
    },
    /// Rows of the rotation, each followed by the translation.
    Tool { pose: [f64; 12] },
    /// No file of the step tells of the part.
    Absent {},
}

/// What is kept of a part between steps.
struct Known {
    name: String,
    /// Nodes of a body that are shown.
    skin: Option<Skin>,
    fields: Vec<String>,
}

/// Files of one time: those with exact surfaces, each beside the one with its flat copy.
struct Moment {
    time: f64,
    files: Vec<[Listed; 2]>,
}

/// Reads what the collections in a folder list: the last step, the first, then those between, as far as the budget goes.
///
/// # Errors
/// In words.
pub(super) fn read(folder: &Path, pack: &mut Pack, budget: Budget) -> Result<Shapes, String> {
    let moments = moments(folder)?;
    let mut shapes = Shapes {
        written: moments.len(),
        bounds: [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]],
        ..Shapes::default()
    };
    let mut known = Vec::new();
    let mut chosen: BTreeMap<usize, StepShape> = BTreeMap::new();
    for (turn, k) in in_turns(moments.len()).into_iter().take(STEPS).enumerate() {
        if turn == 0 {
            let size = first(folder, &moments[k], &mut known, &mut shapes, pack)?;
            if size > budget.bytes {
                shapes.parts.clear();
                pack.bytes.clear();
                shapes.note =
                    "The meshes are too large for a page: open results.pvd in ParaView.".into();
                return Ok(shapes);
            }
        } else if Instant::now() > budget.until {
            break;
        }
        let before = pack.bytes.len();
        let shape = step(folder, &moments[k], &known, &mut shapes, pack)?;
        if pack.bytes.len() > budget.bytes {
            pack.bytes.truncate(before);
            break;
        }
        chosen.insert(k, shape);
    }
    shapes.steps = chosen.into_values().collect();
    if shapes.steps.is_empty() && shapes.written > 0 {
        shapes.parts.clear();
        shapes.note = "The fields are too large for a page: open results.pvd in ParaView.".into();
    } else if shapes.steps.len() < shapes.written {
        let (shown, all) = (shapes.steps.len(), shapes.written);
        shapes.note = format!("{shown} of {all} written steps are shown.");
    }
    Ok(shapes)
}

/// The last, the first, the middle, the middles of both halves and so on.
fn in_turns(n: usize) -> Vec<usize> {
    let mut out = Vec::new();
    let mut add = |k: usize| {
        if !out.contains(&k) && out.len() <= STEPS {
            out.push(k);
        }
    };
    if n > 0 {
        add(n - 1);
        add(0);
    }
    let mut parts = 2;
    while n > 0 && parts <= 2 * STEPS.next_power_of_two() {
        (1..parts).step_by(2).for_each(|i| add((n - 1) * i / parts));
        parts *= 2;
    }
    (0..n.min(STEPS + 1)).for_each(&mut add);
    out
}

fn moments(folder: &Path) -> Result<Vec<Moment>, String> {
    let [exact, flat] = ["results.pvd", "results_tessellated.pvd"].map(|name| {
        let path = folder.join(name);
        match path.exists() {
            true => read::collection(&path),
            // A run without fields.
            false => Ok(Vec::new()),
        }
    });
    let mut out: Vec<Moment> = Vec::new();
    for pair in exact?.into_iter().zip(flat?) {
        let time = pair.0.time;
        match out.last_mut().filter(|m| m.time == time) {
            Some(moment) => moment.files.push(pair.into()),
            None => out.push(Moment {
                time,
                files: vec![pair.into()],
            }),
        }
    }
    Ok(out)
}

/// Shapes that do not change, from a step; gives their bytes.
fn first(
    folder: &Path,
    moment: &Moment,
    known: &mut Vec<Known>,
    shapes: &mut Shapes,
    pack: &mut Pack,
) -> Result<usize, String> {
    let mut tools: Vec<(String, SurfaceFile)> = Vec::new();
    let mut size = 0.0f64;
    let mut measure = |points: &[Vec3]| {
        let [low, high] = bounds(points.iter().copied());
        size = size.max((high - low).norm());
    };
    for [_, flat] in &moment.files {
        let name = unescaped(&flat.name);
        match read::part(&folder.join(&flat.file))? {
            Part::Cloud => {}
            Part::Surface(file) => {
                measure(&file.points);
                tools.push((name, file));
            }
            Part::Body(file) => {
                measure(&file.mesh.nodes);
                let skin = skin(&file.mesh);
                let scalar = |f: &&Array| !f.by_cell && f.components == 1;
                let fields: Vec<String> = (file.fields.iter().filter(scalar))
                    .map(|f| f.name.clone())
                    .collect();
                let points: Vec<Vec3> = (skin.nodes.iter())
                    .map(|&n| file.mesh.nodes[n as usize])
                    .collect();
                let shape = part(&name, &points, &skin.quads, &skin.edges, None, pack);
                shapes.parts.push(PartShape {
                    fields: fields.clone(),
                    ..shape
                });
                known.push(Known {
                    name,
                    skin: Some(skin),
                    fields,
                });
            }
        }
    }
    for (name, file) in tools {
        let quads = coarsened(&file.points, &file.quads, TOLERANCE * size);
        let mut nodes: Vec<u32> = quads.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut place = vec![0u32; file.points.len()];
        for (k, &node) in nodes.iter().enumerate() {
            place[node as usize] = k as u32;
        }
        let quads: Vec<[u32; 4]> = quads.iter().map(|q| q.map(|n| place[n as usize])).collect();
        let points: Vec<Vec3> = nodes.iter().map(|&n| file.points[n as usize]).collect();
        let normals = vectors(&file.fields, "normal").map(|all| {
            let of = nodes.iter().map(|&n| all[n as usize]);
            of.collect::<Vec<Vec3>>()
        });
        let normals = normals.unwrap_or_else(|| vec![Vec3::zeros(); points.len()]);
        let shape = part(&name, &points, &quads, &[], Some(&normals), pack);
        shapes.parts.push(shape);
        known.push(Known {
            name,
            skin: None,
            fields: Vec::new(),
        });
    }
    Ok(pack.bytes.len())
}

/// Packs what of a part does not change.
fn part(
    name: &str,
    points: &[Vec3],
    quads: &[[u32; 4]],
    edges: &[[u32; 2]],
    normals: Option<&[Vec3]>,
    pack: &mut Pack,
) -> PartShape {
    let [low, high] = bounds(points.iter().copied());
    let origin = (low + high) / 2.0;
    let scale = ((high - low) / 2.0).amax();
    let mut raw = Vec::new();
    let flat =
        |vectors: &[Vec3]| -> Vec<f64> { vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect() };
    let relative: Vec<Vec3> = points.iter().map(|x| x - origin).collect();
    planes(
        &mut raw,
        &rounded(flat(&relative).into_iter(), scale, 3),
        3,
        3,
    );
    let corners: Vec<i64> = quads.iter().flatten().map(|&n| n.into()).collect();
    planes(&mut raw, &corners, 4, 4);
    let ends: Vec<i64> = edges.iter().flatten().map(|&n| n.into()).collect();
    planes(&mut raw, &ends, 2, 4);
    if let Some(normals) = normals {
        planes(&mut raw, &rounded(flat(normals).into_iter(), 1.0, 1), 3, 1);
    }
    PartShape {
        name: name.to_owned(),
        rigid: normals.is_some(),
        counts: [points.len(), quads.len(), edges.len()],
        origin: origin.into(),
        scale,
        half: ((high - low) / 2.0).into(),
        fields: Vec::new(),
        chunk: pack.add(&raw),
    }
}

/// Packs a step.
fn step(
    folder: &Path,
    moment: &Moment,
    known: &[Known],
    shapes: &mut Shapes,
    pack: &mut Pack,
) -> Result<StepShape, String> {
    let mut raw = Vec::new();
    let mut states = Vec::new();
    for (index, part) in known.iter().enumerate() {
        let listed = |[exact, flat]: &&[Listed; 2]| {
            let flat_only = exact.file != flat.file;
            unescaped(&flat.name) == part.name && flat_only == part.skin.is_none()
        };
        let Some(files) = moment.files.iter().find(listed) else {
            states.push(State::Absent {});
            continue;
        };
        let state = match &part.skin {
            Some(skin) => body(&folder.join(&files[1].file), skin, part, shapes, &mut raw)?,
            None => {
                let pose = pose([0, 1].map(|k| folder.join(&files[k].file)))?;
                stretch(shapes, index, &pose);
                let (r, t) = (pose.rotation.to_rotation_matrix(), pose.translation.vector);
                let row = |i: usize| [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]];
                let mut numbers = [0.0; 12];
                (numbers.chunks_exact_mut(4).enumerate())
                    .for_each(|(i, out)| out.copy_from_slice(&row(i)));
                State::Tool { pose: numbers }
            }
        };
        states.push(state);
    }
    let number = moment
        .files
        .iter()
        .find_map(|files| step_of(&files[0].file));
    Ok(StepShape {
        step: number.unwrap_or(0),
        time: moment.time,
        chunk: pack.add(&raw),
        states,
    })
}

fn body(
    path: &Path,
    skin: &Skin,
    part: &Known,
    shapes: &mut Shapes,
    raw: &mut Vec<u8>,
) -> Result<State, String> {
    let BodyFile { mesh, fields } = read::body(path)?;
    let fails = |what: &str| format!("`{}` {what}", path.display());
    let u = vectors(&fields, "displacement").ok_or_else(|| fails("has no displacement"))?;
    let last = skin.nodes.last().map_or(0, |&n| n as usize + 1);
    if u.len() < last || mesh.nodes.len() < last {
        return Err(fails("has another mesh than other steps"));
    }
    let own: Vec<Vec3> = skin.nodes.iter().map(|&n| u[n as usize]).collect();
    let scale = own.iter().map(|u| u.amax()).fold(0.0, f64::max);
    let components = own.iter().flat_map(|u| [u.x, u.y, u.z]);
    planes(raw, &rounded(components, scale, 2), 3, 2);
    let now = skin
        .nodes
        .iter()
        .map(|&n| mesh.nodes[n as usize] + u[n as usize]);
    widen(shapes, bounds(now));
    let mut spans = Vec::new();
    for name in &part.fields {
        let field = fields.iter().find(|f| f.name == *name && !f.by_cell);
        let value = |n: &u32| {
            field
                .and_then(|f| f.data.get(*n as usize))
                .map_or(f64::NAN, |v| *v)
        };
        let (span, levels) = levels(&skin.nodes.iter().map(value).collect::<Vec<f64>>());
        planes(raw, &levels, 1, 1);
        spans.push(span);
    }
    Ok(State::Body {
        scale,
        largest: own.iter().map(|u| u.norm()).fold(0.0, f64::max),
        spans,
    })
}

/// Where a tool is: by the exact surface, which is smaller, else by the flat copy.
fn pose(paths: [std::path::PathBuf; 2]) -> Result<Isometry3<f64>, String> {
    let of = |path: &Path| {
        let Part::Surface(file) = read::part(path)? else {
            return Err(format!("`{}` is no surface", path.display()));
        };
        let way = vectors(&file.fields, "displacement");
        Ok(way.map_or_else(Isometry3::identity, |way| {
            nearest_motion(&file.points, &way)
        }))
    };
    of(&paths[0]).or_else(|_| of(&paths[1]))
}

/// Makes room for a tool where it is.
fn stretch(shapes: &mut Shapes, part: usize, pose: &Isometry3<f64>) {
    let shape = &shapes.parts[part];
    let (origin, half) = (Vec3::from(shape.origin), shape.half);
    let corners = (0..8).map(|k| {
        let side = |bit: usize| {
            if k >> bit & 1 == 1 {
                half[bit]
            } else {
                -half[bit]
            }
        };
        (pose * nalgebra::Point3::from(origin + Vec3::new(side(0), side(1), side(2)))).coords
    });
    let corners: Vec<Vec3> = corners.collect();
    widen(shapes, bounds(corners.into_iter()));
}

fn widen(shapes: &mut Shapes, [low, high]: [Vec3; 2]) {
    let [a, b] = &mut shapes.bounds;
    for k in 0..3 {
        a[k] = a[k].min(low[k]);
        b[k] = b[k].max(high[k]);
    }
}

/// Smallest and largest coordinates; zeros where there are none.
fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    let ends = points.fold(None, |ends: Option<[Vec3; 2]>, x| match ends {
        Some([low, high]) => Some([low.inf(&x), high.sup(&x)]),
        None => Some([x, x]),
    });
    ends.unwrap_or([Vec3::zeros(); 2])
}

/// A field of vectors.
fn vectors(fields: &[Array], name: &str) -> Option<Vec<Vec3>> {
    let field = (fields.iter()).find(|f| f.name == name && f.components == 3 && !f.by_cell)?;
    Some(
        field
            .data
            .chunks_exact(3)
            .map(Vec3::from_column_slice)
            .collect(),
    )
}

/// The step in the name of a file.
fn step_of(file: &str) -> Option<u32> {
    file.strip_suffix(".vtu")?.rsplit_once('_')?.1.parse().ok()
}

/// A name as it was before it became an attribute.
fn unescaped(name: &str) -> String {
    let name = name.replace("&lt;", "<").replace("&gt;", ">");
    let name = name.replace("&quot;", "\"").replace("&apos;", "'");
    name.replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_taken_from_the_ends_inwards_each_once() {
        assert_eq!(in_turns(5), [4, 0, 2, 1, 3]);
        assert_eq!(in_turns(1), [0]);
        assert!(in_turns(0).is_empty());
        for n in [2, 7, 59, 60, 61, 1000] {
            let turns = in_turns(n);
            let mut sorted = turns.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), turns.len());
            assert!(
                turns.len() >= n.min(STEPS) && turns.iter().all(|k| *k < n),
                "{n}"
            );
        }
    }
}
