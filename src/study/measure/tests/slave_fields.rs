use super::fields::{of_field, results, square};
use super::*;
use crate::mesh::{ElementKind, Mesh};
use crate::output::{CLOSED, ContactFields, NOT_A_SLAVE};
use ElementKind::{H8, Q18};

/// A run whose slave nodes are those where there is a pressure; gaps are the negative of it, NaN elsewhere.
fn run(bench: &mut Bench, id: &str, mesh: &Mesh, pressure: impl Fn([f64; 3]) -> Option<f64>) {
    let folder = bench.done(id);
    let values: Vec<Option<f64>> = (mesh.nodes.iter())
        .map(|x| pressure([x.x, x.y, x.z]))
        .collect();
    let pressure: Vec<f64> = values.iter().map(|p| p.unwrap_or(0.0)).collect();
    let gap: Vec<f64> = values.iter().map(|p| p.map_or(f64::NAN, |p| -p)).collect();
    let status: Vec<u8> = (values.iter())
        .map(|p| if p.is_some() { CLOSED } else { NOT_A_SLAVE })
        .collect();
    let contact = ContactFields {
        pressure: &pressure,
        gap: &gap,
        status: &status,
    };
    results(&folder, mesh, Some(contact), Vec::new());
}

fn top(x: [f64; 3]) -> bool {
    x[2] > 0.1 - 1e-9
}

/// Slave faces are compared, whatever the layers below: 1.1 times a pressure is 10 % off.
#[test]
fn pressure_on_one_side() {
    let mut bench = Bench::new();
    let p = |x: [f64; 3], by: f64| top(x).then_some(by * (1.0 + x[0] + 3.0 * x[1]));
    run(&mut bench, "layers", &square(H8, 6, 3), |x| p(x, 1.1));
    run(&mut bench, "same", &square(Q18, 3, 1), |x| p(x, 1.0));
    // A slave on half of the face has half of its area; the rest takes the values at its edge.
    let half = |x: [f64; 3]| p(x, 1.0).filter(|_| x[0] < 0.5 + 1e-9);
    run(&mut bench, "half", &square(H8, 4, 1), half);
    run(&mut bench, "reference", &square(Q18, 4, 1), |x| p(x, 1.0));
    bench.references.insert("fine".into(), vec![3]);
    for name in ["contact_pressure", "contact_gap"] {
        let (records, warnings) = bench.measure(of_field(name), refinement(json!({})));
        near(bench.error("layers"), 0.1, 1e-12);
        assert!(bench.error("same") < 1e-12);
        assert!(bench.missing("half").contains("different regions"));
        assert!(records[0].measure.contains("slave faces of body `plate`"));
        assert!(
            warnings.iter().all(|w| !w.contains("left out")),
            "{warnings:?}"
        );
    }
}

/// Bottom and top are slaves: the sides between them are not, though their nodes are.
#[test]
fn pressure_on_both_sides() {
    let mut bench = Bench::new();
    let p = |x: [f64; 3], above: f64| Some(if top(x) { above } else { 2.0 });
    run(&mut bench, "other", &square(H8, 3, 1), |x| p(x, 1.1));
    run(&mut bench, "reference", &square(Q18, 2, 1), |x| p(x, 1.0));
    bench.references.insert("fine".into(), vec![1]);
    bench.measure(of_field("contact_pressure"), refinement(json!({})));
    // 0.1 on half of the area against a mean square of (1 + 4)/2.
    near(bench.error("other"), 0.1 / 5f64.sqrt(), 1e-12);
}
