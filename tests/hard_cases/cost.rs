//! An effect that is not asked for costs nothing: what a frictionless contact with a rigid surface allocates.
use crate::common::plate;
use covact::assembly::Assembler;
use covact::model::state::{PointState, State};
use covact::model::{Model, build::build};
use covact::plan::Plan;
use covact::scene::{self, LoadedScene};
use serde_json::{Value, json};

fn loaded(scene: &Value) -> LoadedScene {
    scene::parse(&scene.to_string(), "scene.json").expect("valid scene")
}

fn model(scene: &Value) -> Model {
    build(&loaded(scene)).expect("valid model")
}

const N: usize = 6;
const NODES: usize = 2 * (N + 1) * (N + 1);

fn scene(element: &str) -> Value {
    let mut scene = plate(N as u32, 5.0, 8);
    scene["bodies"]["plate"]["element"] = json!(element);
    scene
}

#[test]
fn state_of_frictionless_contact_is_a_hint_and_a_flag_per_point() {
    // Patch, two coordinates and whether there is a hint: 32 bytes; the flag with its padding: 8.
    assert!(size_of::<PointState>() <= 40, "{}", size_of::<PointState>());
    let points = 4 * N * N;
    let plain = model(&scene("h8_displacement"));
    assert_eq!(plain.contact_points(), points);
    // Without enhanced strains an element has no state at all.
    let state = State::new(&plain);
    assert!(state.elements.is_empty());
    assert_eq!(
        state.bytes(),
        3 * NODES * size_of::<f64>() + points * size_of::<PointState>()
    );
    // With seven, per element: the parameters, the force on them, their coupling with 24 displacements, their factors; and what is
    // taken off the thickness strain along two directions.
    let enhanced = model(&scene("h8"));
    let per_element = 7 + 7 + 7 * 24 + 28 + 2;
    let with = State::new(&enhanced).bytes();
    assert_eq!(with - state.bytes(), N * N * per_element * size_of::<f64>());
}

#[test]
fn a_rigid_frictionless_master_adds_no_rows_and_no_entries() {
    let with = model(&scene("h8"));
    let mut free = scene("h8");
    free.as_object_mut().unwrap().remove("contacts");
    free.as_object_mut().unwrap().remove("surfaces");
    let without = model(&free);
    assert!(with.contact_points() > 0 && without.contact_points() == 0);
    assert_eq!(with.nodes.len(), NODES);
    assert_eq!(with.dofs.dofs(), 3 * NODES);
    assert_eq!(with.unknowns(), without.unknowns());
    let pattern = |m: &Model| {
        let assembler = Assembler::new(m, &m.dofs).expect("a pattern");
        assembler.matrix().pattern().clone()
    };
    assert_eq!(pattern(&with), pattern(&without));
    let names = |scene: &Value, model: &Model| Plan::new(&loaded(scene), model).names();
    let other = names(&free, &without);
    let mut named = names(&scene("h8"), &with);
    named.retain(|e| !other.contains(e));
    assert_eq!(
        named,
        [
            "contact.master.rigid",
            "contact.normal.penalty",
            "contact.points.gauss",
            "contact.tangent.exact"
        ]
    );
    // Undeformed states of both differ by the slave points alone.
    let points = with.contact_points() * size_of::<PointState>();
    assert_eq!(
        State::new(&with).bytes() - State::new(&without).bytes(),
        points
    );
}
