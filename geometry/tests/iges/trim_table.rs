//! Files of several writers: entities, patches and trims against a table, areas and boxes against an independent CAD kernel
//! (Open CASCADE; `data/cad_reference.py` made the numbers). Files that are not part of this repository are looked for in
//! the folder that the environment variable COVACT_CAD_SAMPLES names, which has the folders `made_here` and `real`.

use crate::areas::{area, extremes, trimmed_area};
use covact_geometry::io::{CadFile, FaceBorder, LengthUnit, read_path};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(serde::Deserialize)]
struct Table {
    files: BTreeMap<String, FileRow>,
}

#[derive(serde::Deserialize)]
struct FileRow {
    entities: BTreeMap<String, usize>,
    surfaces: Vec<SurfaceRow>,
    /// Lengths of the kernel over ours: it takes another unit from a file whose global section is damaged.
    #[serde(default = "one")]
    scale: f64,
}

fn one() -> f64 {
    1.0
}

/// Faces whose curves in the parameter plane and in space contradict each other: file, entity, and the relative difference of
/// the two areas (measured here, by reading the file once without the pointers to either of them). In between lies what a
/// reader may answer. Of all others with such a gap both
/// kernels take the curves in the parameter plane.
const APART: &[(&str, u32, f64)] = &[
    ("real/bearing.iges", 4117, 6.5e-6),
    ("real/bearing.iges", 4479, 1.87e-5),
    ("real/bearing.iges", 5361, 1.41e-4),
    ("real/hammer.iges", 547, 7.93e-5),
];

/// Faces whose boundary leaves their surface by more than rounding, so that the surface goes on beyond its knots; the whole
/// surface is not compared.
const CONTINUED: &[(&str, &[u32])] = &[
    ("real/bearing.iges", &[5199, 5617]),
    ("real/hammer.iges", &[341, 477, 923, 1285]),
];

/// A face or free surface, in millimetres.
#[derive(serde::Deserialize)]
struct SurfaceRow {
    entity: u32,
    #[serde(rename = "type")]
    type_number: u32,
    base: u32,
    area: f64,
    #[serde(rename = "box")]
    bounds: [f64; 6],
    /// Of the whole surface that carries the face, where that is bounded.
    base_area: Option<f64>,
    base_box: Option<[f64; 6]>,
}

/// Faces with a trim and faces whose border is a rectangle of parameters, by file. All others are whole surfaces, and
/// nothing is skipped in any file.
const TRIMS: &[(&str, usize, usize)] = &[
    ("made_here/bicubic_patch_brep.igs", 0, 1),
    ("made_here/bicubic_patch_faces.igs", 0, 0),
    ("made_here/box_brep.igs", 0, 6),
    ("made_here/box_faces.igs", 0, 6),
    ("made_here/cone_brep.igs", 2, 1),
    ("made_here/cone_faces.igs", 2, 1),
    ("made_here/cylinder_brep.igs", 2, 1),
    ("made_here/cylinder_faces.igs", 2, 1),
    ("made_here/extrusion_brep.igs", 0, 1),
    ("made_here/extrusion_faces.igs", 0, 1),
    ("made_here/revolution_brep.igs", 0, 1),
    ("made_here/revolution_faces.igs", 0, 1),
    ("made_here/sphere_brep.igs", 0, 1),
    ("made_here/sphere_faces.igs", 0, 1),
    ("made_here/sphere_nurbs_brep.igs", 0, 1),
    ("made_here/sphere_nurbs_faces.igs", 0, 1),
    ("made_here/torus_brep.igs", 0, 1),
    ("made_here/torus_faces.igs", 0, 1),
    ("made_here/trimmed_patch_brep.igs", 1, 0),
    ("made_here/trimmed_patch_faces.igs", 1, 0),
    ("real/DTMB-5415_bulbous_bow.iges", 1, 0),
    ("real/bearing.iges", 56, 157),
    ("real/example_45_faces.iges", 31, 14),
    ("real/hammer.iges", 23, 22),
    ("real/single_rounded_cube.iges", 2, 5),
    ("real/sunglasses_lens.igs", 0, 0),
    ("real/testfile.igs", 0, 0),
    ("real/wigley.iges", 0, 1),
];

fn table() -> Table {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cad_table.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

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

/// Every difference from the table is collected, so that one run shows all of them.
fn check(filter: &str) {
    let mut faults = Vec::new();
    let mut seen = 0;
    for (name, row) in table().files {
        if !name.starts_with(filter) {
            continue;
        }
        seen += 1;
        let Some(path) = locate(&name) else { continue };
        let mut file = read_path(&path).unwrap();
        let mm = LengthUnit::from_name("mm").unwrap();
        if file.unit.to_metre.is_some() {
            file.convert_to(&mm).unwrap();
        }
        let mut fault = |text: String| faults.push(format!("{name}: {text}"));
        counts(&name, &file, &row, &mut fault);
        for surface in &row.surfaces {
            compare(&name, &file, surface, row.scale, &mut fault);
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

fn counts(name: &str, file: &CadFile, row: &FileRow, fault: &mut impl FnMut(String)) {
    let entities: BTreeMap<String, usize> = file
        .entities
        .iter()
        .map(|e| (format!("{}.{}", e.type_number, e.form), e.count))
        .collect();
    if entities != row.entities {
        fault(format!("entities {entities:?}, not {:?}", row.entities));
    }
    let &(_, trimmed, rectangles) = TRIMS.iter().find(|t| t.0 == name).unwrap();
    let summary = file.summary();
    let expected = (row.surfaces.len(), trimmed, rectangles, 0);
    let found = (
        summary.patches,
        summary.trimmed,
        summary.rectangles,
        summary.skipped,
    );
    if found != expected {
        let reasons = file
            .skipped
            .iter()
            .map(|s| format!("{}: {}", s.entity, s.reason));
        fault(format!(
            "patches, trimmed, rectangles, skipped {found:?}, not {expected:?}; {:?}; {:?}",
            reasons.collect::<Vec<_>>(),
            file.trims
        ));
    }
    if file
        .patches
        .iter()
        .any(|p| p.trimmed() != (p.border == FaceBorder::Trimmed))
    {
        fault("trims and borders disagree".to_owned());
    }
    let longest = file.notes.iter().take(4).collect::<Vec<_>>();
    println!(
        "{name}: {found:?} {:?} {} notes {longest:?}",
        file.trims,
        file.notes.len()
    );
}

/// Areas to 1e-6, boxes to 1e-6 of their diagonal; the kernel widens boxes by its confusion distance of 1e-7.
fn compare(
    file_name: &str,
    file: &CadFile,
    row: &SurfaceRow,
    scale: f64,
    fault: &mut impl FnMut(String),
) {
    let apart = APART.iter().find(|a| (a.0, a.1) == (file_name, row.entity));
    let name = format!("entity {} ({})", row.entity, row.type_number);
    let Some(found) = file.patches.iter().find(|p| p.entity == row.entity) else {
        return;
    };
    if (found.type_number, found.base) != (row.type_number, row.base) {
        fault(format!(
            "{name}: type {}, base {}",
            found.type_number, found.base
        ));
    }
    let continued = CONTINUED
        .iter()
        .any(|c| c.0 == file_name && c.1.contains(&row.entity));
    let text = "its boundary leaves the surface";
    let start = format!("entity {} ", row.entity);
    if continued
        != file
            .notes
            .iter()
            .any(|n| n.starts_with(&start) && n.contains(text))
    {
        fault(format!(
            "{name}: notes that its boundary leaves the surface, {continued} expected"
        ));
    }
    let mut near = |what: &str, value: f64, reference: f64, tolerance: f64| {
        let reference = reference / (scale * scale);
        let error = (value / reference - 1.0).abs();
        if error.is_nan() || error > tolerance {
            fault(format!(
                "{name}: {what} {value}, not {reference} ({error:.1e})"
            ));
        }
    };
    near(
        "area",
        trimmed_area(&found.patch),
        row.area,
        apart.map_or(1e-6, |a| a.2),
    );
    // The kernel's surfaces have all of their knots' range.
    let full = [0, 1].map(|d| {
        let basis = found.patch.basis(d);
        [basis.knots()[basis.degree()], basis.knots()[basis.count()]]
    });
    let base = row.base_area.zip(row.base_box).filter(|_| !continued);
    let (whole, reference) = match base {
        Some((area_of_base, bounds)) => {
            let patch = found.patch.clone().with_trim(None).with_domain(full);
            let patch = patch.unwrap();
            near(
                "area of the whole surface",
                area(&patch),
                area_of_base,
                1e-6,
            );
            (patch, Some(bounds))
        }
        None if found.border == FaceBorder::Trimmed => (found.patch.clone(), None),
        None => (found.patch.clone(), Some(row.bounds)),
    };
    if let Some(reference) = reference {
        let reference = reference.map(|x| x / scale);
        let diagonal = (0..3)
            .map(|k| (reference[k + 3] - reference[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        let found = extremes(&whole);
        for k in 0..6 {
            let error = (found[k] - reference[k]).abs();
            if error.is_nan() || error > 1e-6 * diagonal + 1.5e-7 {
                fault(format!(
                    "{name}: box {found:?}, not {reference:?} ({error:.1e})"
                ));
                break;
            }
        }
    }
}

#[test]
fn files_made_here() {
    check("made_here/");
}

#[test]
fn bearing() {
    check("real/bearing");
}

#[test]
fn hammer() {
    check("real/hammer");
}

#[test]
fn bulbous_bow() {
    check("real/DTMB");
}

#[test]
fn forty_five_faces() {
    check("real/example");
}

#[test]
fn rounded_cube() {
    check("real/single");
}

#[test]
fn lens() {
    check("real/sunglasses");
}

#[test]
fn plane() {
    check("real/testfile");
}

#[test]
fn wigley() {
    check("real/wigley");
}
