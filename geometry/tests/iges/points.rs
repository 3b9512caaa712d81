//! Closest points of whole files: statuses and finite distances at 1,000 random points, distances and sides at 50 points
//! against an independent CAD kernel (Open CASCADE; `data/cad_points.py` made the numbers). Files that are not part of this
//! repository are looked for in the folder that the environment variable COVACT_CAD_SAMPLES names.

use covact_geometry::io::{LengthUnit, read_path};
use covact_geometry::{EdgeKind, Location, PatchSet, Status, Vec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(serde::Deserialize)]
struct Table {
    files: BTreeMap<String, Row>,
}

#[derive(serde::Deserialize)]
struct Row {
    /// Diagonal of the box around the file.
    size: f64,
    /// x, y, z, distance, and -1 inside, 1 outside, 0 of a file that encloses nothing; in millimetres.
    points: Vec<[f64; 5]>,
}

/// Lengths of the kernel over ours. The global section of this file gives 38 characters as the length of a name of 32: the
/// kernel counts them off, loses the parameters that follow and takes the unit for an inch. Units flag (2), unit name (MM) and
/// the largest coordinate of the section (39.02, which is the file's own) say millimetres, as do the kernel's numbers once the
/// name is counted right.
const SCALES: &[(&str, f64)] = &[("real/testfile.igs", 25.4)];

/// The file of a row: files made here are assets of this repository.
fn locate(name: &str) -> Option<PathBuf> {
    if let Some(own) = name.strip_prefix("made_here/") {
        let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/cad");
        return Some(Path::new(assets).join(own));
    }
    match std::env::var_os("COVACT_CAD_SAMPLES") {
        Some(folder) => Some(Path::new(&folder).join(name)),
        None => {
            println!("skipped: {name}; COVACT_CAD_SAMPLES names no folder of CAD files");
            None
        }
    }
}

/// `allowed` is a share of the size: 1e-6, more only where a file contradicts itself by as much.
fn check(filter: &str, allowed: f64) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cad_points.json");
    let table: Table = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let mut faults = Vec::new();
    let mut seen = 0;
    for (name, row) in table.files {
        if !name.starts_with(filter) {
            continue;
        }
        seen += 1;
        let Some(path) = locate(&name) else { continue };
        let mut file = read_path(&path).unwrap();
        if file.unit.to_metre.is_some() {
            file.convert_to(&LengthUnit::from_name("mm").unwrap())
                .unwrap();
        }
        let scale = SCALES.iter().find(|s| s.0 == name).map_or(1.0, |s| s.1);
        let size = row.size / scale;
        let patches = file.patches.iter().map(|p| p.patch.clone()).collect();
        let set = PatchSet::new(patches, None).unwrap();
        let mut fault = |text: String| faults.push(format!("{name}: {text}"));
        statuses(&set, &mut fault);
        let (mut worst, mut inside, mut rim) = (0.0f64, 0, 0);
        for &[x, y, z, distance, side] in &row.points {
            let q = Vec3::new(x, y, z) / scale;
            let foot = set.project(&q, None, f64::INFINITY).unwrap();
            let error = (foot.distance - distance / scale).abs() / size;
            worst = worst.max(error);
            let at = || {
                format!(
                    "{x} {y} {z}: patch {} at {:?}, {:?}",
                    foot.patch, foot.xi, foot.location
                )
            };
            if error.is_nan() || error > allowed {
                fault(format!(
                    "{} distance {}, not {} ({error:.1e} of the size)",
                    at(),
                    foot.distance,
                    distance / scale
                ));
            }
            inside += usize::from(side < 0.0);
            // bearing.iges lacks a face: beside the hole, both sides are one.
            let open = matches!(
                foot.location,
                Location::Edge {
                    kind: EdgeKind::Free,
                    ..
                } | Location::Corner {
                    kind: EdgeKind::Free,
                    ..
                }
            );
            rim += usize::from(open && side != 0.0);
            if !open && side != 0.0 && foot.signed_distance * side <= 0.0 {
                fault(format!(
                    "{} signed distance {}, side {side}",
                    at(),
                    foot.signed_distance
                ));
            }
        }
        println!(
            "{name}: distances to {worst:.1e} of the size, {inside} points inside, {rim} beside a hole"
        );
        if rim > if name == "real/bearing.iges" { 13 } else { 0 } {
            faults.push(format!("{name}: {rim} points lie beside holes"));
        }
    }
    assert!(seen > 0);
    assert!(
        faults.is_empty(),
        "{} faults\n{}",
        faults.len(),
        faults.join("\n")
    );
}

/// 1,000 points of an additive sequence (multiples of powers of the plastic number's root) in a box 1.5 times that of the
/// set: all converge, to finite distances whose sign is that of the side.
fn statuses(set: &PatchSet, fault: &mut impl FnMut(String)) {
    let [low, high] = set.bounds();
    let (middle, half) = ((low + high) * 0.5, (high - low) * 0.75);
    let steps = [
        0.819_172_513_396_164_5,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_3,
    ];
    for k in 1..=1000 {
        let q = Vec3::from_fn(|d, _| {
            middle[d] + half[d] * (2.0 * (f64::from(k) * steps[d]).fract() - 1.0)
        });
        let Some(foot) = set.project(&q, None, f64::INFINITY) else {
            fault(format!("no closest point to {q:?}"));
            continue;
        };
        let signed = foot.signed_distance;
        let off = (foot.jet.rho - q).norm();
        if foot.status == Status::NotConverged
            || !signed.is_finite()
            || (signed.abs() - foot.distance).abs() > 1e-12 * set.size()
            || (off - foot.distance).abs() > 1e-9 * set.size()
        {
            fault(format!(
                "{q:?}: {:?}, distance {}, signed {signed}, patch {} at {:?}",
                foot.status, foot.distance, foot.patch, foot.xi
            ));
        }
    }
}

#[test]
fn files_made_here() {
    check("made_here/", 1e-6);
}

#[test]
fn bearing() {
    check("real/bearing", 1e-6);
}

#[test]
fn hammer() {
    // Its boundary curves in the parameter plane and in space lie up to 2.34 mm apart, which is 5.7e-5 of the size.
    check("real/hammer", 5.8e-5);
}

#[test]
fn other_real_files() {
    for filter in [
        "real/DTMB",
        "real/example",
        "real/single",
        "real/sunglasses",
        "real/testfile",
        "real/wigley",
    ] {
        check(filter, 1e-6);
    }
}
