use super::*;
use crate::mesh::{self, ElementKind, Mesh};
use crate::output::{BodyFields, ContactFields, Field, Place, Precision, Results};
use crate::scene::Block;
use ElementKind::{H8, Q18};
use covact_geometry::Vec3;

/// The unit square, .1 thick.
pub(super) fn square(kind: ElementKind, n: u32, layers: u32) -> Mesh {
    let block = Block {
        min: [0.0, 0.0, 0.0],
        max: [1.0, 1.0, 0.1],
        elements: [n, n, layers],
        spacing: Default::default(),
    };
    mesh::block(&block, kind).expect("a mesh")
}

/// Nodes off the boundary moved about in the plane.
fn distorted(mut mesh: Mesh) -> Mesh {
    for x in &mut mesh.nodes {
        let bubble = x.x * (1.0 - x.x) * x.y * (1.0 - x.y);
        let move_x = bubble * (7.0 * x.x + 11.0 * x.y).sin();
        let move_y = bubble * (5.0 * x.x - 13.0 * x.y).cos();
        x.x += 0.5 * move_x;
        x.y += 0.5 * move_y;
    }
    mesh
}

/// Writes the results of a body `plate` with fields, at time 0 without meaning and at time 1.
pub(super) fn results(
    folder: &Path,
    mesh: &Mesh,
    contact: Option<ContactFields>,
    fields: Vec<Field>,
) {
    let mut results = Results::create(folder).expect("folder");
    let zero = vec![Vec3::zeros(); mesh.nodes.len()];
    for (step, time) in [(0, 0.0), (1, 1.0)] {
        let body = BodyFields {
            name: "plate",
            mesh,
            displacement: &zero,
            stress: None,
            contact: contact.filter(|_| step == 1),
            fields: if step == 1 {
                fields.clone()
            } else {
                Vec::new()
            },
            precision: Precision::Full,
        };
        results
            .write(step, time, &[body], &[], &[])
            .expect("results");
    }
}

/// A run with a scalar field `f` of position.
fn scalar(bench: &mut Bench, id: &str, mesh: &Mesh, f: impl Fn(&Vec3) -> f64) {
    let folder = bench.done(id);
    let data: Vec<f64> = mesh.nodes.iter().map(f).collect();
    results(&folder, mesh, None, vec![Field::point("f", &data)]);
}

pub(super) fn of_field(name: &str) -> Json {
    json!([{
        "name": "q",
        "of": { "field": { "body": "plate", "name": name } },
        "reference": finest()
    }])
}

/// Measures field `f` against the last run.
fn against_last(bench: &mut Bench) -> (Vec<QuantityRecord>, Vec<String>) {
    bench
        .references
        .insert("fine".into(), vec![bench.runs.len() - 1]);
    let (records, mut warnings) = bench.measure(of_field("f"), refinement(json!({})));
    warnings.retain(|w| !w.contains("it has one run only"));
    (records, warnings)
}

/// Both elements hold linear fields exactly, on any mesh.
#[test]
fn linear_fields_agree_on_all_meshes() {
    let f = |x: &Vec3| 1.0 + 2.0 * x.x - 3.0 * x.y + 5.0 * x.z;
    let mut bench = Bench::new();
    let meshes = [
        ("h8", square(H8, 5, 2)),
        ("h8 distorted", distorted(square(H8, 6, 1))),
        ("q18", square(Q18, 3, 1)),
        ("q18 distorted", distorted(square(Q18, 4, 3))),
        ("other", distorted(square(H8, 7, 2))),
    ];
    for (id, mesh) in &meshes {
        scalar(&mut bench, id, mesh, f);
    }
    scalar(&mut bench, "off", &meshes[1].1, |x| f(x) + 0.01);
    scalar(&mut bench, "reference", &distorted(square(Q18, 5, 2)), f);
    let (_, warnings) = against_last(&mut bench);
    for (id, _) in &meshes {
        assert!(bench.error(id) < 1e-12, "{id}: {}", bench.error(id));
    }
    // The mean square of f on the box, by its moments: mean 0.75, variances of 2 x, 3 y and 0.5 z' over 12.
    let size = (0.75f64.powi(2) + (4.0 + 9.0 + 0.25) / 12.0).sqrt();
    near(bench.error("off"), 0.01 / size, 1e-10);
    assert!(warnings.is_empty(), "{warnings:?}");
}

/// Q18 holds products of quadratics in the plane, linear through the thickness.
#[test]
fn quadratic_fields_agree_on_quadratic_meshes() {
    let f = |x: &Vec3| (1.0 + x.x * x.x) * (2.0 - x.y + x.y * x.y) * (1.0 + 4.0 * x.z);
    let mut bench = Bench::new();
    scalar(&mut bench, "two", &square(Q18, 2, 1), f);
    scalar(&mut bench, "seven", &square(Q18, 7, 2), f);
    scalar(&mut bench, "h8", &square(H8, 7, 2), f);
    scalar(&mut bench, "reference", &square(Q18, 3, 1), f);
    against_last(&mut bench);
    assert!(bench.error("two") < 1e-12);
    assert!(bench.error("seven") < 1e-12);
    assert!(bench.error("h8") > 1e-3);
}

/// Linear interpolation of x^2 between nodes h apart is too large by s (h - s): its root of mean square is h^2/sqrt(30), that
/// of x^2 is 1/sqrt(5). Among themselves, interpolations of h and h/2 differ by hats of height h^2/4.
#[test]
fn linear_elements_converge_quadratically() {
    let f = |x: &Vec3| x.x * x.x;
    let mut bench = Bench::new();
    for n in [2, 4, 8] {
        scalar(&mut bench, &format!("h8 {n}"), &square(H8, n, 1), f);
    }
    scalar(&mut bench, "reference", &square(Q18, 8, 1), f);
    against_last(&mut bench);
    for n in [2, 4, 8] {
        let h = 1.0 / f64::from(n);
        near(bench.error(&format!("h8 {n}")), h * h / 6f64.sqrt(), 1e-10);
    }
    // The three linear ones as a refinement.
    bench.references.insert("fine".into(), vec![0, 1, 2]);
    let (records, _) = bench.measure(of_field("f"), refinement(json!({})));
    let reference = records[0].reference.as_ref().unwrap();
    near(reference.order.unwrap(), 2.0, 1e-9);
    assert!(reference.observed);
    assert_eq!((reference.value, &reference.curve), (None, &None));
    // (h^2/4)/sqrt(3)/3 of h = 1/4, and the interpolation's own root of mean square to first order in its error.
    let size = (0.2 + 2.0 / 3.0 / 6.0 / 64.0f64).sqrt();
    let estimate = (1.0 / 64.0) / 27f64.sqrt() / size;
    near(reference.error.unwrap(), estimate, 2e-3);
    // What it is off in truth is h^2/sqrt(30) of h = 1/8.
    near(estimate, (1.0 / 64.0) / 6f64.sqrt(), 0.07);
}

/// A chord of angle a leaves the arc by R (1 - cos(a/2)): points there take the nearest value, and the error of a linear field
/// is of second order.
#[test]
fn curved_meshes() {
    let panel = |n: u32, kind: ElementKind| {
        let panel = serde_json::from_value(json!({
            "radius": 10.0, "thickness": 0.002, "angles": [0.0, 90.0], "y": [0.0, 3.0],
            "elements": [n, 1]
        }));
        mesh::cylinder_panel(&panel.expect("a panel"), kind).expect("a mesh")
    };
    let mut bench = Bench::new();
    let f = |x: &Vec3| x.x + 2.0 * x.z;
    for n in [4, 8, 16] {
        scalar(&mut bench, &format!("h8 {n}"), &panel(n, H8), f);
    }
    scalar(&mut bench, "reference", &panel(16, Q18), f);
    let (_, warnings) = against_last(&mut bench);
    let error = |n: u32| bench.error(&format!("h8 {n}"));
    let rate = |n: u32| (error(n) / error(2 * n)).log2();
    for n in [4, 8] {
        assert!((1.8..2.2).contains(&rate(n)), "{}", rate(n));
    }
    says(&warnings, &["nearest place", "`h8 4`", "`h8 16`"]);
    // Nothing is further away than the arc from the chord, outside.
    let told = warnings
        .iter()
        .find(|w| w.contains("nearest place"))
        .unwrap();
    let at = told.find("`h8 4` (up to ").unwrap() + "`h8 4` (up to ".len();
    let distance: f64 = told[at..].split(' ').next().unwrap().parse().unwrap();
    let arrow = 10.001 * (1.0 - (90f64 / 8.0).to_radians().cos());
    assert!(
        distance > 0.5 * arrow && distance < arrow,
        "{distance} {arrow}"
    );
    // A panel elsewhere is another body.
    let far = serde_json::from_value(json!({
        "radius": 10.0, "thickness": 0.002, "angles": [90.0, 180.0], "y": [0.0, 3.0],
        "elements": [8, 1]
    }));
    let far = mesh::cylinder_panel(&far.expect("a panel"), H8).expect("a mesh");
    let mut bench = Bench::new();
    scalar(&mut bench, "far", &far, f);
    scalar(&mut bench, "reference", &panel(8, Q18), f);
    let (_, warnings) = against_last(&mut bench);
    assert!(bench.missing("far").contains("different regions"));
    says(&warnings, &["different regions", "`far`"]);
}

#[test]
fn fields_that_are_nan_somewhere() {
    let mut bench = Bench::new();
    let (a, b) = (square(H8, 4, 1), square(H8, 5, 2));
    // NaN at x < 0.2: the first of four columns of cells; and at x > 0.9: the last of five.
    let first = |x: &Vec3| if x.x < 0.2 { f64::NAN } else { 1.0 };
    let last = |x: &Vec3| if x.x > 0.9 { f64::NAN } else { 1.1 };
    scalar(&mut bench, "other", &b, last);
    scalar(&mut bench, "nowhere", &a, |_| f64::NAN);
    scalar(&mut bench, "reference", &a, first);
    let (_, warnings) = against_last(&mut bench);
    near(bench.error("other"), 0.1, 1e-12);
    // The fifth column covers .8 of the fourth one: 3 of 4 Gauss points are not those of exact parts, so compare loosely.
    let told = warnings
        .iter()
        .find(|w| w.contains("left out"))
        .expect("a warning");
    let share = told.split("(").nth(1).and_then(|s| s.split(' ').next());
    let share: f64 = share.unwrap().parse().unwrap();
    assert!((40.0..50.0).contains(&share), "{told}");
    assert!(bench.missing("nowhere").contains("NaN everywhere"));
    // Only the reference: a quarter exactly.
    scalar(&mut bench, "whole", &b, |_| 1.1);
    bench.references.insert("fine".into(), vec![2]);
    let (_, warnings) = bench.measure(of_field("f"), refinement(json!({})));
    says(
        &warnings,
        &["left out of the norm", "`whole` (25.000 % of the region)"],
    );
    near(bench.error("whole"), 0.1, 1e-12);
}

/// Piecewise constant fields, and tensors.
#[test]
fn fields_on_cells_and_of_several_components() {
    let mut bench = Bench::new();
    let write = |bench: &mut Bench, id: &str, n: u32, changed: usize| {
        let folder = bench.done(id);
        let mesh = square(H8, n, 1);
        let place = |e: usize| (e % n as usize * 2 / n as usize) as f64;
        let mut cells: Vec<f64> = (0..mesh.elements()).map(|e| 1.0 + place(e)).collect();
        cells[..changed].fill(4.0);
        let tensors: Vec<f64> = (mesh.nodes.iter())
            .flat_map(|x| (0..9).map(|c| f64::from(c) + x.y).collect::<Vec<_>>())
            .collect();
        let field = |name, components, data, place| Field {
            name,
            components,
            component_names: &[],
            data,
            place,
        };
        let fields = vec![
            field("c", 1, &cells[..], Place::Cell),
            field("f", 9, &tensors[..], Place::Point),
        ];
        results(&folder, &mesh, None, fields);
    };
    write(&mut bench, "two", 2, 0);
    write(&mut bench, "changed", 4, 2);
    write(&mut bench, "reference", 4, 0);
    against_last(&mut bench);
    assert!(bench.error("two") < 1e-13);
    bench.measure(of_field("c"), refinement(json!({})));
    assert_eq!(bench.error("two"), 0.0);
    // Two of sixteen cells hold 4 instead of 1; the reference's mean square is (1 + 4)/2.
    near(
        bench.error("changed"),
        (2.0 / 16.0 * 9.0 / 2.5f64).sqrt(),
        1e-12,
    );
}

#[test]
fn files_that_do_not_hold_what_they_say() {
    let mut bench = Bench::new();
    let f = |x: &Vec3| x.x;
    for id in ["cut", "broken", "late", "none", "shared", "reference"] {
        scalar(&mut bench, id, &square(H8, 3, 1), f);
    }
    let edit_bytes = |id: &str, file: &str, change: &dyn Fn(&[u8]) -> Vec<u8>| {
        let path = bench.folder(id).join(file);
        let bytes = std::fs::read(&path).unwrap();
        let changed = change(&bytes);
        assert_ne!(bytes, changed);
        std::fs::write(&path, &changed).unwrap();
    };
    let edit = |id: &str, file: &str, change: &dyn Fn(String) -> String| {
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        edit_bytes(id, file, &|bytes| change(text(bytes)).into_bytes());
    };
    edit_bytes("cut", "plate_0001.vtu", &|b| b[..b.len() / 2].to_vec());
    // A block that is not compressed as it says: vtkio leaves such an array out without a word.
    edit_bytes("broken", "plate_0001.vtu", &|b| {
        let text = String::from_utf8_lossy(b);
        let number = |from: usize| {
            let value = &text[from + text[from..].find(" offset=\"").unwrap() + 9..];
            value[..value.find('"').unwrap()].parse::<usize>().unwrap()
        };
        let data = text.find("\"raw\">_").unwrap() + 7;
        let array = data + number(text.find("Name=\"f\"").unwrap());
        let mut changed = b.to_vec();
        changed[array + 32] ^= 0xff;
        changed
    });
    edit("late", "results.pvd", &|t| {
        t.replace("\"1.0\" part", "\"0.5\" part")
    });
    edit("none", "results.pvd", &|t| {
        t.replace("\"plate\"", "\"slab\"")
    });
    // A surface of the body's name comes after it.
    edit("shared", "results.pvd", &|t| {
        let surface =
            "<DataSet timestep=\"1.0\" part=\"1\" name=\"plate\" file=\"ball_0001.vtu\"/>";
        t.replace("</Collection>", &format!("{surface}</Collection>"))
            .replace("<Collection>", &format!("<Collection>{surface}"))
    });
    let (_, warnings) = against_last(&mut bench);
    assert!(bench.error("shared") < 1e-14);
    assert!(bench.missing("cut").contains("cannot be read"));
    assert!(
        bench
            .missing("broken")
            .contains("`f` that cannot be decoded")
    );
    assert!(
        bench
            .missing("late")
            .contains("time 0.5, those of the reference of time 1")
    );
    assert!(
        bench
            .missing("none")
            .contains("no results of a body `plate`")
    );
    says(&warnings, &["`cut`", "cannot be read"]);
    let (_, warnings) = bench.measure(of_field("ff"), refinement(json!({})));
    says(&warnings, &["no field `ff`; did you mean `f`?"]);
}
