//! Plans of the shipped scenes: what is on, what is off, and where that is decided.
use crate::scenes::{loaded, plate, with};
use covact::plan::{Effect, Plan};
use covact::run::{PlanReport, plan};
use covact::scene;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::Command;

struct Shipped {
    text: String,
    report: PlanReport,
}

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenes/{name}.json"))
}

impl Shipped {
    fn new(name: &str) -> Self {
        let text = std::fs::read_to_string(path(name)).unwrap();
        let report = plan(&scene::load(path(name)).unwrap()).unwrap();
        Shipped { text, report }
    }

    fn plan(&self) -> &Plan {
        &self.report.plan
    }

    fn effect(&self, name: &str) -> &Effect {
        effect(self.plan(), name)
    }

    /// An effect is on or off, decided in the line that holds `text`, for a reason that holds `why`.
    fn decided(&self, name: &str, on: bool, text: &str, why: &str) {
        let found = self.effect(name);
        assert_eq!(found.on, on, "{name}: {}", found.why);
        assert!(found.why.contains(why), "{name}: {}", found.why);
        let line = self
            .text
            .lines()
            .position(|l| l.contains(text))
            .expect(text);
        assert_eq!(found.place.line, line + 1, "{name}");
        if !on {
            assert!(found.held.is_empty() && found.cost.is_empty(), "{name}");
        }
    }
}

fn effect<'p>(plan: &'p Plan, name: &str) -> &'p Effect {
    let mut all = plan.effects();
    all.find(|e| e.name == name)
        .unwrap_or_else(|| panic!("no effect {name}"))
}

#[test]
fn ironing() {
    let s = Shipped::new("ironing");
    s.decided(
        "contact.friction.coulomb",
        true,
        "\"friction\"",
        "`friction` is coulomb",
    );
    s.decided(
        "contact.tangent.rotational",
        false,
        "\"master\"",
        "rigid master has no rotational part",
    );
    s.decided(
        "contact.tangent.curvature",
        true,
        "\"cylinder\"",
        "convex of radius 4",
    );
    s.decided(
        "contact.augmentation",
        false,
        "\"iron\"",
        "no `augmentation`",
    );
    s.decided(
        "contact.points.gauss",
        true,
        "\"points\"",
        "2 x 2 Gauss points a face: 128",
    );
    s.decided(
        "contact.normal.penalty",
        true,
        "\"penalty\"",
        "3 times the automatic one",
    );
    s.decided("material.neo_hooke", true, "\"neo_hooke\"", "`slab`");
    s.decided("element.h8_solid_shell", true, "\"slab\"", "128 elements");
    assert!(!s.plan().symmetric && s.effect("contact.friction.coulomb").unsymmetric);
    assert_eq!(
        s.plan().pairs[0].kernel.to_string(),
        "rigid_nurbs.penalty.coulomb.exact"
    );
}

#[test]
fn bend_and_release() {
    let s = Shipped::new("bend_and_release");
    s.decided(
        "stages",
        true,
        "\"stages\"",
        "`bend` until 1, `release` until 1.5 (the forces of `carried`, `pressed` are let down)",
    );
    s.decided(
        "surface.motion",
        true,
        "\"tools\"",
        "`punch` is moved by `stages`",
    );
    s.decided("material.j2", true, "\"j2\"", "`strip`");
}

#[test]
fn ball_on_plate() {
    let s = Shipped::new("ball_on_plate");
    s.decided("stages", false, "{", "no `stages`");
    s.decided("contact.friction.coulomb", false, "\"press\"", "no history");
    s.decided("contact.master.deformable", false, "\"master\"", "no nodes");
    s.decided("load.dead", false, "{", "no loads");
    assert!(s.plan().symmetric && s.plan().effects().all(|e| !e.unsymmetric));
    // Nothing but a hint and a flag is remembered of a point.
    let remembered: Vec<&str> = (s.plan().pairs[0].effects.iter())
        .flat_map(|e| &e.held)
        .filter(|h| h.holder == covact::plan::Holder::State)
        .map(|h| h.part)
        .collect();
    assert_eq!(remembered, ["points"]);
}

#[test]
fn crossed_tubes() {
    let s = Shipped::new("crossed_tubes");
    s.decided(
        "contact.master.smooth",
        true,
        "\"master_surface\"",
        "smooth",
    );
    s.decided(
        "contact.master.rigid",
        false,
        "\"master\"",
        "faces of a body",
    );
    s.decided(
        "contact.tangent.rotational",
        true,
        "\"tubes\"",
        "turn with its nodes",
    );
    s.decided(
        "contact.tangent.curvature",
        true,
        "\"master\"",
        "smooth surface",
    );
    s.decided("surface.motion", false, "{", "no rigid surfaces");
    assert_eq!(
        s.plan().pairs[0].kernel.to_string(),
        "faces.penalty.frictionless.exact"
    );
}

#[test]
fn strip_drawn() {
    let s = Shipped::new("strip_drawn");
    s.decided("contact.friction.coulomb", true, "\"friction\"", "coulomb");
    s.decided("load.dead", true, "\"tension\"", "`tension`");
    s.decided("contact.points.nodes", true, "\"wrap\"", "no `points`");
    assert!(s.plan().unsymmetric[0].contains("`wrap`"));
}

#[test]
fn ball_by_weight() {
    let s = Shipped::new("ball_by_weight");
    s.decided("surface.driven_by_force", true, "\"free\"", "free along z");
    s.decided("element.h8_displacement", true, "\"element\"", "`cushion`");
    s.decided(
        "element.enhanced_strains",
        false,
        "\"element\"",
        "takes strains as they are",
    );
    assert!(s.plan().symmetric);
}

#[test]
fn a_flat_rigid_master_has_no_curvature_part() {
    let flat = json!({"plane": {"center": [0, 0, 1], "normal": [0, 0, -1], "size": [100, 100]}});
    let scene = loaded(&with(plate(), &[("/surfaces/ball", flat)]));
    let report = plan(&scene).unwrap();
    let curvature = effect(&report.plan, "contact.tangent.curvature");
    assert!(!curvature.on && curvature.why.contains("flat master has no curvature part"));
    assert!(curvature.pointer.ends_with("/surfaces/ball/plane"));
    assert!(!effect(&report.plan, "contact.tangent.edges").on);
    assert!(effect(&report.plan, "contact.tangent.main").on);
    // Left out by hand, it is that which is told.
    let tangent = json!({"published": {"curvature": false}});
    let scene = loaded(&with(plate(), &[("/contacts/press/tangent", tangent)]));
    let report = plan(&scene).unwrap();
    let curvature = effect(&report.plan, "contact.tangent.curvature");
    assert!(!curvature.on && curvature.why.contains("`curvature` is false"));
}

#[test]
fn every_effect_of_a_list_is_in_every_plan() {
    let names = |scene: &Value| -> Vec<&'static str> {
        let report = plan(&loaded(scene)).unwrap();
        report.plan.effects().map(|e| e.name).collect()
    };
    let first = names(&plate());
    assert!(first.len() > 45, "{}", first.len());
    assert_eq!(first, names(&crate::scenes::blocks()));
    // Without contacts, too: all of contact is off.
    let mut alone = plate();
    for key in ["contacts", "surfaces"] {
        alone.as_object_mut().unwrap().remove(key);
    }
    assert_eq!(first, names(&alone));
    let report = plan(&loaded(&alone)).unwrap();
    let mut contact = report
        .plan
        .effects()
        .filter(|e| e.name.starts_with("contact."));
    assert!(contact.all(|e| !e.on && e.why == "the scene has no contacts"));
    let details = |scene: &Value| -> Vec<bool> {
        let report = plan(&loaded(scene)).unwrap();
        report.plan.effects().map(|e| e.detail).collect()
    };
    assert_eq!(details(&plate()), details(&alone));
}

#[test]
fn the_command_prints_a_table_and_json() {
    let covact = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_covact"));
        command.arg("plan").arg(path("ironing")).args(more);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
        String::from_utf8(output.stdout).unwrap()
    };
    let text = covact(&[]);
    let mut lines = text.lines();
    let line = lines.find(|l| l.contains("contact.friction.coulomb"));
    let line = line.expect("friction");
    assert!(line.starts_with("  on "), "{line}");
    assert!(line.contains("1072 B"), "{line}");
    // Below it, where it was decided and why.
    let below = lines.next().unwrap();
    assert!(below.contains("ironing.json:41:"), "{below}");
    assert!(text.contains("rigid_nurbs.penalty.coulomb.exact"));
    let json: Value = serde_json::from_str(&covact(&["--json"])).unwrap();
    assert_eq!(
        json["pairs"][0]["kernel"],
        "rigid_nurbs.penalty.coulomb.exact"
    );
    let effects = json["pairs"][0]["effects"].as_array().unwrap();
    let friction = (effects.iter()).find(|e| e["name"] == "contact.friction.coulomb");
    let friction = friction.unwrap();
    assert_eq!(
        (&friction["on"], &friction["line"]),
        (&json!(true), &json!(41))
    );
    assert_eq!(json["symmetric"], json!(false));
}
