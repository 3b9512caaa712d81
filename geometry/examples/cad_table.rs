//! Faces, areas, volumes and boxes of the CAD files of a folder, beside those that another program found in them.
//!
//! `cargo run -p covact-geometry --example cad_table -- FOLDER [--truth TABLE.json] [--notes] [--faces]`
//!
//! The table is an object with an entry for each file name: `{"part.step": {"faces": 6, "area_mm2": 24.0, "volumes_mm3":
//! [8.0], "box_mm": [0, 0, 0, 2, 2, 2], "face_areas": [4, 4, 4, 4, 4, 4], "points": [[3, 1, 1, 1.0, 1]]}}`; any of them may be
//! missing. Volumes are positive, less voids. Points are x, y, z, the distance from the faces and -1 inside of a solid, 1 outside, 0 for none. The script
//! `tests/data/cad_truth.py` makes such a table.

use covact_geometry::io::{CadFile, LengthUnit, read_path};
use covact_geometry::project::Joining;
use covact_geometry::{NurbsPatch, PatchSet, Status, Vec3};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Curved spans are cut into so many pieces: the surface stays the same, and integrals over it get more accurate.
const PIECES: u32 = 8;
/// Distance of the eyes that see the outermost points, in sizes of the part.
const FAR: f64 = 3e6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut paths = Vec::new();
    let (mut truth, mut notes, mut faces) = (Value::Null, false, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--truth" => {
                let table = arguments.next().ok_or("expected a file after --truth")?;
                truth = serde_json::from_slice(&std::fs::read(table)?)?;
            }
            "--notes" => notes = true,
            "--faces" => faces = true,
            path => paths.extend(files(Path::new(path))?),
        }
    }
    println!(
        "{:<34} {:>9} {:>8} {:>16} {:>8} {:>18} {:>8} {:>8} {:>6}",
        "file", "faces", "not read", "area mm^2", "off", "volume mm^3", "off", "box off", "s"
    );
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let start = Instant::now();
        match read_path(&path) {
            Ok(file) => {
                let seconds = start.elapsed().as_secs_f64();
                row(&name, file, &truth[&*name], (seconds, notes, faces));
            }
            Err(error) => println!("{name:<34} {error}"),
        }
    }
    Ok(())
}

/// The CAD files of a folder in order, or the file itself.
fn files(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(path)? {
        let path = entry?.path();
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        if ["step", "stp", "igs", "iges"].contains(&extension.to_lowercase().as_str()) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// What is measured on the faces of one body, or of those of no body.
struct Measures {
    /// Number of the face and its area.
    areas: Vec<(u32, f64)>,
    /// Volume enclosed, less its voids; `None` where it is open.
    volume: Option<f64>,
    extent: [Vec3; 2],
}

fn row(name: &str, mut file: CadFile, truth: &Value, (seconds, notes, faces): (f64, bool, bool)) {
    if let Some(mm) = LengthUnit::from_name("mm")
        && let Err(error) = file.convert_to(&mm)
    {
        println!("  {error}");
    }
    let mut bodies: Vec<Option<usize>> = file.patches.iter().map(|p| p.tags.body).collect();
    bodies.sort();
    bodies.dedup();
    let mut measured = Vec::new();
    for body in bodies {
        match measures(&file, body) {
            Ok(found) => measured.push(found),
            Err(error) => println!("  body {body:?}: {error}"),
        }
    }
    let areas = || measured.iter().flat_map(|m| &m.areas);
    let area: f64 = areas().map(|a| a.1).sum();
    let volumes: Vec<f64> = measured.iter().filter_map(|m| m.volume).collect();
    let count = |n: u64| match truth["faces"].as_u64() {
        Some(t) => format!("{n}/{t}"),
        None => n.to_string(),
    };
    let (volume_off, other) = volumes_off(&volumes, &truth["volumes_mm3"]);
    let volume = match volumes.is_empty() {
        true => "-".to_owned(),
        false => format!("{:.6}", volumes.iter().sum::<f64>()),
    };
    println!(
        "{name:<34} {:>9} {:>8} {area:>16.6} {:>8} {volume:>18} {:>8} {:>8} {seconds:>6.2}",
        count(file.patches.len() as u64),
        file.skipped.len(),
        shown(truth["area_mm2"].as_f64().map(|t| area / t - 1.0)),
        shown(volume_off),
        shown(box_off(&measured, &truth["box_mm"])),
    );
    if let Some(text) = other {
        println!("  {text}");
    }
    for s in &file.skipped {
        println!(
            "  not read: #{} {}: {:?}: {}",
            s.entity, s.name, s.kind, s.reason
        );
    }
    if truth["points"].is_array() {
        println!("  {}", points_off(&file, &truth["points"], faces));
    }
    if notes {
        for note in &file.notes {
            println!("  note: {note}");
        }
        println!("  {:?}", file.trims);
        if let Ok(surface) = file.surface() {
            println!("  sides {:?}", surface.set().sides());
        }
    }
    if faces {
        println!("  volumes {volumes:?}");
        let mut known = numbers(&truth["face_areas"]);
        for (entity, area) in areas() {
            // Each known area counts once: that which is nearest.
            let off = |t: f64| (area / t - 1.0).abs();
            let nearest = (0..known.len()).min_by(|&i, &j| off(known[i]).total_cmp(&off(known[j])));
            let off = nearest.map(|k| area / known.swap_remove(k) - 1.0);
            println!("    #{entity} {area:.9} {}", shown(off));
        }
    }
}

fn shown(off: Option<f64>) -> String {
    off.map_or_else(|| "-".to_owned(), |off| format!("{off:.1e}"))
}

fn numbers(list: &Value) -> Vec<f64> {
    let list = list.as_array().into_iter().flatten();
    list.filter_map(Value::as_f64).collect()
}

/// The largest relative difference of volumes, in order of size.
fn volumes_off(found: &[f64], truth: &Value) -> (Option<f64>, Option<String>) {
    if !truth.is_array() {
        return (None, None);
    }
    let (mut found, mut known) = (found.to_vec(), numbers(truth));
    if found.len() != known.len() {
        let text = format!(
            "{} closed bodies instead of {} solids",
            found.len(),
            known.len()
        );
        return (None, Some(text));
    }
    found.sort_by(f64::total_cmp);
    known.sort_by(f64::total_cmp);
    let off = found.iter().zip(known).map(|(v, t)| v / t - 1.0);
    (off.max_by(|a, b| a.abs().total_cmp(&b.abs())), None)
}

/// The largest difference of a side of the box, as a share of its diagonal.
fn box_off(measured: &[Measures], truth: &Value) -> Option<f64> {
    let known = numbers(truth);
    let known: [f64; 6] = known.try_into().ok()?;
    let low = measured
        .iter()
        .map(|m| m.extent[0])
        .reduce(|a, b| a.inf(&b))?;
    let high = measured
        .iter()
        .map(|m| m.extent[1])
        .reduce(|a, b| a.sup(&b))?;
    let own = [low.x, low.y, low.z, high.x, high.y, high.z];
    let off = own.iter().zip(known).map(|(a, b)| (a - b).abs());
    Some(off.fold(0.0, f64::max) / (high - low).norm())
}

/// The largest difference of distances, as a share of the size, and how many points are on another side.
fn points_off(file: &CadFile, points: &Value, listed: bool) -> String {
    let surface = match file.surface() {
        Ok(surface) => surface,
        Err(error) => return error.to_string(),
    };
    let size = surface.set().size();
    let (mut farther, mut nearer, mut count, mut wrong) = (0.0f64, 0.0f64, 0, 0);
    // Bodies may touch or hold each other: a point is inside where it is inside of one.
    let mut bodies: Vec<Option<usize>> = file.patches.iter().map(|p| p.tags.body).collect();
    bodies.sort();
    bodies.dedup();
    let bodies: Vec<PatchSet> = bodies.into_iter().filter_map(|b| solid(file, b)).collect();
    for row in points.as_array().into_iter().flatten() {
        let row = numbers(row);
        let [x, y, z, distance, side] = row[..] else {
            return "a point without five numbers".to_owned();
        };
        let q = Vec3::new(x, y, z);
        let foot = match surface.closest(&q) {
            Ok(foot) => foot,
            Err(error) => return error.to_string(),
        };
        let off = (foot.distance - distance) / size;
        (farther, nearer) = (farther.max(off), nearer.max(-off));
        count += 1;
        let signs = bodies.iter().filter_map(|b| b.closest(&q).ok());
        let own = signs.fold(1.0, |s: f64, f| s.min(f.signed_distance.signum()));
        let differs = side != 0.0 && own != side;
        wrong += usize::from(differs);
        if listed && (off.abs() > 1e-6 || differs) {
            println!(
                "    {x} {y} {z}: {} on #{} {:?} instead of {distance} (side {side})",
                foot.signed_distance,
                surface.entity(foot.patch),
                foot.location
            );
        }
    }
    format!(
        "{count} points: at most {farther:.1e} of the size farther and {nearer:.1e} nearer; {wrong} on another side; {} closed bodies",
        bodies.len()
    )
}

/// One body by itself, if it is closed.
fn solid(file: &CadFile, body: Option<usize>) -> Option<PatchSet> {
    let own = file.patches.iter().filter(|p| p.tags.body == body);
    let patches = own.map(|p| p.patch.clone()).collect();
    let mut set = PatchSet::join(patches, file.joining()).ok()?;
    set.turn_cavities(|_| ());
    set.volumes().iter().any(Option::is_some).then_some(set)
}

fn measures(file: &CadFile, body: Option<usize>) -> Result<Measures, Box<dyn std::error::Error>> {
    let own = file.patches.iter().filter(|p| p.tags.body == body);
    let (patches, entities): (Vec<_>, Vec<_>) = own.map(|p| (fine(&p.patch), p.entity)).unzip();
    let joining = file.joining();
    let mut set = PatchSet::join(patches.clone(), joining)?;
    // The knots added above part edges, which are joined over a tenth of the gaps that whole ones are joined over.
    if set.volumes().iter().any(Option::is_none) {
        let tolerance = Some(10.0 * set.edges().tolerance);
        set = PatchSet::join(
            patches,
            Joining {
                tolerance,
                ..joining
            },
        )?;
    }
    // Voids count negative, whichever way the file parametrises them.
    set.turn_cavities(|_| ());
    let volume = set.volumes().iter().copied().sum();
    Ok(Measures {
        areas: entities.into_iter().zip(set.areas()).collect(),
        volume,
        extent: extent(&set),
    })
}

/// Lowest and highest coordinates, by the closest points to eyes far away.
fn extent(set: &PatchSet) -> [Vec3; 2] {
    let mut out = set.bounds();
    let centre = (out[0] + out[1]) / 2.0;
    for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
        for k in 0..3 {
            let mut eye = centre;
            eye[k] += sign * FAR * set.size();
            if let Some(foot) = set.project(&eye, None, f64::INFINITY)
                && foot.status != Status::NotConverged
            {
                out[side][k] = foot.jet.rho[k];
            }
        }
    }
    out
}

/// The patch with more knots in its curved directions.
fn fine(patch: &NurbsPatch) -> NurbsPatch {
    let mut out = patch.clone();
    for dir in (0..2).filter(|&dir| patch.degree()[dir] > 1) {
        let spans = patch.spans(dir).into_iter();
        let cut = |[a, b]: [f64; 2]| {
            (1..PIECES).map(move |k| a + (b - a) * f64::from(k) / f64::from(PIECES))
        };
        let knots: Vec<f64> = spans.flat_map(cut).collect();
        if let Ok(refined) = out.insert_knots(dir, &knots) {
            out = refined;
        }
    }
    out
}
