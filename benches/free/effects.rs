//! What every effect costs that is on, as the program does it.
use crate::Meter;
use crate::kernel::{Turn, position};
use crate::program::Program;
use crate::scene::{self, Distance, Effects, TIME};
use covact_geometry::Vec3;
use serde_json::{Value, json};

/// An effect: its name, what it adds to the contact and to the ball, and what it needs of the state.
type Effect = (&'static str, Value, Value, fn(&mut Program));

/// Nothing beyond the scene.
pub const NONE: &str = "no effect";

fn list() -> Vec<Effect> {
    let coulomb = || json!({ "coulomb": { "mu": 0.3 } });
    let ellipse = || json!({ "orthotropic": { "mu": [0.2, 0.4], "direction": [1, 0, 0] } });
    let facets = |kind: &str| json!({ "facets": { "kind": kind, "count": [12, 12] } });
    let contact = |c: Value| (c, Value::Null);
    let none: fn(&mut Program) = |_| {};
    let entry = |name, (contact, ball): (Value, Value), state| (name, contact, ball, state);
    vec![
        entry(NONE, contact(Value::Null), none),
        entry(
            "published tangent",
            contact(json!({ "tangent": { "published": {} } })),
            none,
        ),
        entry("offset", contact(json!({ "offset": 0.01 })), none),
        entry(
            "augmentation",
            contact(json!({ "augmentation": {} })),
            |p| {
                p.start
                    .histories
                    .iter_mut()
                    .for_each(|h| h.lambda_n = -50.0)
            },
        ),
        entry("averaged gap", contact(json!({ "gap": "averaged" })), none),
        entry(
            "Coulomb friction, stick",
            contact(json!({ "friction": coulomb() })),
            |p| base(p, 1e-4),
        ),
        entry(
            "Coulomb friction, slip",
            contact(json!({ "friction": coulomb() })),
            |p| base(p, 1.0),
        ),
        entry(
            "orthotropic friction, slip",
            contact(json!({ "friction": ellipse() })),
            |p| base(p, 1.0),
        ),
        entry(
            "friction and augmentation, stick",
            contact(json!({ "friction": coulomb(), "augmentation": {} })),
            |p| base(p, 1e-4),
        ),
        entry("bilinear facets", (Value::Null, facets("bilinear")), none),
        entry(
            "biquadratic facets",
            (Value::Null, facets("biquadratic")),
            none,
        ),
        entry("smooth facets", (Value::Null, facets("smooth")), none),
    ]
}

/// Ties every point to a place on the ball at a distance from where it is.
fn base(program: &mut Program, chord: f64) {
    let model = program.model;
    let pose = model.surfaces[0].pose(TIME, &[]).expect("a motion");
    let turn = Turn::new(&pose);
    let points = model.pairs[0].points.iter();
    for (h, p) in program.start.histories.iter_mut().zip(points) {
        h.base = turn.local(&position(model, &program.start.u, p)) + Vec3::new(chord, 0.0, 0.0);
    }
}

/// Measures all, with points that are closed and open.
pub fn measure(meter: &mut Meter) {
    for (name, contact, ball, prepare) in list() {
        let model = scene::counted(&Effects { contact, ball });
        let mut program = Program::new(&model);
        for distance in [Distance::Closed, Distance::Open] {
            program.bring(distance);
            prepare(&mut program);
            let label = format!("effect {name}/{}", distance.name());
            meter.measure(&label, &mut program, Program::reset, Program::evaluate);
            let points = model.pairs[0].points.len();
            let closed = program.state.points.iter().filter(|p| p.closed).count();
            let all = if distance == Distance::Closed {
                points
            } else {
                0
            };
            assert_eq!(closed, all, "{label}");
        }
    }
}
