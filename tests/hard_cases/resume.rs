//! A run that is stopped after every step, and in the middle of steps, and continued each time by a program that knows
//! nothing but the files, ends as one that was never stopped: to the last bit of every file.
use crate::support::stl_box;
use covact::output::{RunStatus, Summary};
use covact::run::{RunError, RunOptions, run};
use covact::scene::{self, LoadedScene};
use covact::solve::event::{Event, Observer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

pub fn loaded(scene: &Value) -> LoadedScene {
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    scene::parse(&text, "scene.json").expect("valid scene")
}

/// Where a part of a run is stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stop {
    Never,
    /// Before the next step.
    Accepted,
    /// At this iteration, after a step was accepted.
    Iteration(u32),
    /// At another start of a step, or before the step after next.
    Retried,
    /// After the first step of a run with edges of masters as slaves.
    OnEdges,
    /// The same with Gauss points.
    OnGauss,
}

struct Stopper<'a> {
    stop: Stop,
    steps: u32,
    chosen: bool,
    flag: &'a AtomicBool,
    notes: Vec<String>,
}

impl Observer for Stopper<'_> {
    fn event(&mut self, event: &Event) {
        let stop = match (self.stop, event) {
            (_, Event::Note { text }) => {
                self.notes.push(text.clone());
                false
            }
            (stop, Event::StepAccepted { .. }) => {
                self.steps += 1;
                match stop {
                    Stop::Accepted => true,
                    Stop::Retried => self.steps == 2,
                    Stop::OnEdges | Stop::OnGauss => self.chosen,
                    Stop::Never | Stop::Iteration(_) => false,
                }
            }
            (Stop::Iteration(n), Event::Iteration { iteration, .. }) => {
                self.steps > 0 && *iteration >= n
            }
            (Stop::OnEdges | Stop::OnGauss, Event::Model { effects, .. }) => {
                let effect = match self.stop {
                    Stop::OnEdges => "contact.passes.edges",
                    _ => "contact.points.gauss",
                };
                self.chosen = effects.iter().any(|e| e == effect);
                false
            }
            (Stop::Retried, Event::StepRetried { .. } | Event::StepCut { .. }) => self.steps > 0,
            _ => false,
        };
        self.flag.fetch_or(stop, Ordering::Relaxed);
    }
}

/// A part of a run, with what it noted.
fn part(
    scene: &LoadedScene,
    out: &Path,
    resume: bool,
    threads: usize,
    stop: Stop,
) -> Result<(Summary, Vec<String>), RunError> {
    let flag = AtomicBool::new(false);
    let mut observer = Stopper {
        stop,
        steps: 0,
        chosen: false,
        flag: &flag,
        notes: Vec::new(),
    };
    let options = RunOptions {
        threads,
        resume,
        ..RunOptions::default()
    };
    let summary = run(scene, out, &options, &mut observer, &flag)?;
    Ok((summary, observer.notes))
}

/// All files of a folder but the summary.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_owned();
    (std::fs::read_dir(folder).unwrap())
        .map(|e| e.unwrap().path())
        .filter(|p| !p.ends_with("summary.json"))
        .map(|p| (name(&p), std::fs::read(&p).unwrap()))
        .collect()
}

/// The checkpoints of a folder, the newest first.
fn slots(folder: &Path) -> Vec<PathBuf> {
    let number = |path: &PathBuf| {
        let bytes = std::fs::read(path).unwrap();
        u64::from_le_bytes(bytes[20..28].try_into().unwrap())
    };
    let paths = (0..9).map(|i| folder.join(format!("checkpoint.{i}.bin")));
    let mut found: Vec<PathBuf> = paths.filter(|path| path.exists()).collect();
    found.sort_by_key(|path| std::cmp::Reverse(number(path)));
    found
}

fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (contents(a), contents(b));
    assert_eq!(
        a.keys().collect::<Vec<_>>(),
        b.keys().collect::<Vec<_>>(),
        "other files"
    );
    for (name, bytes) in &a {
        assert!(b[name] == *bytes, "{name} differs");
    }
}

/// What a summary says of the computation, the times it took left out.
fn counts(s: &Summary) -> impl PartialEq + std::fmt::Debug {
    (
        (s.status, s.reason.clone(), s.time),
        (s.dofs, s.contact_points, s.effects.clone()),
        (s.newton_iterations, s.factorizations.clone()),
        (s.steps, s.cuts, s.pattern_rebuilds),
        (s.warnings.clone(), s.scene.clone()),
    )
}

/// Runs a scene at once and in pieces, two steps long or shorter; returns what both agree on.
pub fn in_pieces(scene: &Value) -> Summary {
    let (found, parts) = pieces(scene);
    assert!(parts >= found.steps / 2, "{parts} parts");
    found
}

/// Runs a scene at once and in pieces; returns what both agree on, and the number of pieces.
pub fn pieces(scene: &Value) -> (Summary, u32) {
    let scene = loaded(scene);
    let (whole, pieces) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (expected, _) = part(&scene, whole.path(), false, 1, Stop::Never).unwrap();
    let mut found = part(&scene, pieces.path(), false, 2, Stop::Accepted)
        .unwrap()
        .0;
    let mut parts = 0;
    while found.status == RunStatus::Interrupted {
        parts += 1;
        assert_eq!(found.resumed, parts - 1);
        let stop = match parts % 4 {
            0 => Stop::Iteration(1),
            1 => Stop::Accepted,
            2 => Stop::Iteration(3),
            _ => Stop::Retried,
        };
        let threads = 1 + parts as usize % 2;
        found = part(&scene, pieces.path(), true, threads, stop).unwrap().0;
    }
    println!("{parts} parts, {found:?}");
    assert_eq!(counts(&expected), counts(&found));
    if expected.status == RunStatus::NotConverged {
        // It can be tried once more, with the same outcome.
        assert!(!slots(whole.path()).is_empty());
        let (again, _) = part(&scene, whole.path(), true, 1, Stop::Never).unwrap();
        assert_eq!(counts(&expected), counts(&again));
        for folder in [&whole, &pieces] {
            for path in slots(folder.path()) {
                std::fs::remove_file(path).unwrap();
            }
        }
    }
    assert_same(whole.path(), pieces.path());
    (found, parts)
}

/// A slab of `elements`, a die that is pressed in, drawn along and lifted.
pub fn ironed(contact: Value) -> Value {
    let mut iron = json!({
        "slave": "slab.top", "master": "die", "points": {"gauss": 2}, "penalty": {"scaled": 3},
        "friction": {"coulomb": {"mu": 0.3}}
    });
    iron.as_object_mut()
        .unwrap()
        .extend(contact.as_object().unwrap().clone());
    json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 10, "nu": 0.3}}},
        "bodies": {"slab": {
            "mesh": {"block": {
                "min": [0, 0, -2], "max": [6, 0.5, 0], "elements": [12, 1, 2]
            }},
            "material": "rubber"
        }},
        "surfaces": {"die": {
            "cylinder": {"radius": 3, "length": 2, "center": [2, 0, 3]},
            "motion": {"translation": [
                {"table": [[0, 0], [0.2, 0], [0.8, 1.2], [1, 1.2]]}, 0,
                {"table": [[0, 0], [0.2, -0.3], [0.8, -0.3], [1, 0.1]]}
            ]}
        }},
        "contacts": {"iron": iron},
        "supports": {
            "floor": {"on": "slab.bottom", "fixed": true},
            "front": {"on": "slab.y_min", "symmetry": "y"},
            "back": {"on": "slab.y_max", "symmetry": "y"}
        },
        "solution": {"step": {"initial": 0.1, "max": 0.1}},
        "output": {"every": 3, "contact_points": true}
    })
}

/// Attraction points and multipliers on a rigid surface, enhanced strains, kinks, contact that opens; fields of every third
/// step only, with slave points.
#[test]
fn friction_with_augmentation() {
    let found = in_pieces(&ironed(
        json!({"augmentation": {"gap": 1e-3, "slip": 1e-3, "max": 25}}),
    ));
    assert_eq!(found.status, RunStatus::Done);
    // The tool is drawn back at the end.
    assert!(!found.warnings.iter().any(|w| w.contains("opened at step")));
}

/// A kill or a crash in the middle of writing a checkpoint: the one before counts, whose step is done again, and what was
/// written at the end of the part that is lost does not stay.
#[test]
fn a_torn_checkpoint() {
    let scene = loaded(&ironed(json!({})));
    let (whole, torn) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (expected, _) = part(&scene, whole.path(), false, 1, Stop::Never).unwrap();
    let mut found = part(&scene, torn.path(), false, 1, Stop::Accepted)
        .unwrap()
        .0;
    // Where the newest one ends: nowhere, in its head, in its midst, before its last byte.
    for (i, share) in [0.0, 1e-9, 0.5, 1.0].into_iter().enumerate() {
        let step = found.steps;
        let all = slots(torn.path());
        assert!(all.len() >= 2);
        let mut newest = std::fs::read(&all[0]).unwrap();
        let end = ((share * newest.len() as f64).ceil() as usize).min(newest.len() - 1);
        match i {
            // Behind it is what was there.
            2 => newest[end..].fill(7),
            _ => newest.truncate(end),
        }
        std::fs::write(&all[0], &newest).unwrap();
        let (next, notes) = part(&scene, torn.path(), true, 1, Stop::Retried).unwrap();
        let name = all[0].file_name().unwrap().to_str().unwrap();
        let passed_over = |n: &String| n.contains(&format!("{name}` is damaged: "));
        assert!(notes.iter().any(passed_over), "{notes:?}");
        let last = format!("continued after step {} (", step - 1);
        assert!(notes.iter().any(|n| n.starts_with(&last)), "{notes:?}");
        // The step that was lost, or one more.
        assert!(next.steps >= step);
        found = next;
    }
    // Without any that is whole, all are named and nothing changes.
    let all = slots(torn.path());
    let good: Vec<_> = all
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect();
    for (path, bytes) in all.iter().zip(&good) {
        // Less than the checkpoint itself, behind which there may be the end of a longer one.
        std::fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    }
    let before = contents(torn.path());
    let error = part(&scene, torn.path(), true, 1, Stop::Never).unwrap_err();
    assert_eq!(error.exit_code(), 5);
    for path in &all {
        let words = format!("{}` is damaged: it is not whole", path.display());
        assert!(error.to_string().contains(&words), "{error}");
    }
    assert!(before == contents(torn.path()));
    for (path, bytes) in all.iter().zip(&good) {
        std::fs::write(path, bytes).unwrap();
    }
    let (found, _) = part(&scene, torn.path(), true, 1, Stop::Never).unwrap();
    assert_eq!(counts(&expected), counts(&found));
    assert_same(whole.path(), torn.path());
}

/// Two blocks, the upper one pressed into the lower one and drawn along it over many facets.
pub fn sledge(way: f64, steps: u32, contact: Value) -> Value {
    let step = 1.0 / f64::from(steps);
    let mut press = json!({"slave": "sledge.bottom", "master": "bed.top", "points": {"gauss": 2}});
    press
        .as_object_mut()
        .unwrap()
        .extend(contact.as_object().unwrap().clone());
    json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "bed": {"mesh": {"block": {
                "min": [0, 0, -1], "max": [4, 1, 0], "elements": [12, 1, 1]
            }}, "material": "m"},
            "sledge": {"mesh": {"block": {
                "min": [0.5, 0, 0.01], "max": [1.5, 1, 0.6], "elements": [4, 2, 1]
            }}, "material": "m"}
        },
        "contacts": {"press": press},
        "supports": {
            "ground": {"on": "bed.bottom", "fixed": true},
            "bed_y": {"on": "bed.y_min", "symmetry": "y"},
            "sledge_y": {"on": "sledge.y_min", "symmetry": "y"},
            "push": {"on": "sledge.top", "displacement": {
                "x": {"table": [[0, 0], [0.25, 0], [1, way]]}, "y": 0,
                "z": {"table": [[0, 0], [0.25, -0.03], [1, -0.03]]}
            }}
        },
        "solution": {"step": {"initial": step, "max": step}}
    })
}

/// Attraction points on facets that move, and a structure of the system that has grown as the block slid.
#[test]
fn friction_between_bodies() {
    let found = in_pieces(&sledge(
        1.6,
        12,
        json!({"friction": {"coulomb": {"mu": 0.2}}}),
    ));
    assert_eq!(found.status, RunStatus::Done);
    assert!(found.pattern_rebuilds >= 2, "{}", found.pattern_rebuilds);
}

/// Slave points that are cut anew in every step, and are other ones each time.
#[test]
fn segments() {
    let found = in_pieces(&sledge(1.3, 8, json!({"points": {"segments": 2}})));
    assert_eq!(found.status, RunStatus::Done);
    assert!(found.pattern_rebuilds >= 1, "{}", found.pattern_rebuilds);
}

/// What slave points that are cut anew remember of friction, and their multipliers.
#[test]
fn histories_of_segments() {
    let found = in_pieces(&sledge(
        1.3,
        8,
        json!({
            "points": {"segments": 2}, "friction": {"coulomb": {"mu": 0.2}}, "augmentation": {}
        }),
    ));
    assert_eq!(found.status, RunStatus::Done);
    assert!(found.pattern_rebuilds >= 1, "{}", found.pattern_rebuilds);
}

/// Averaged gaps with two passes.
#[test]
fn averaged_gaps() {
    let contact = json!({"gap": "averaged", "passes": "two_half"});
    let found = in_pieces(&sledge(0.6, 6, contact));
    assert_eq!(found.status, RunStatus::Done);
}

/// Multipliers of nodes.
#[test]
fn averaged_gaps_with_multipliers() {
    let contact = json!({"gap": "averaged", "points": {"gauss": 2}, "augmentation": {}});
    let found = in_pieces(&sledge(0.6, 6, contact));
    assert_eq!(found.status, RunStatus::Done);
}

/// The histories of points whose tractions are those of nodes, on facets that move.
#[test]
fn averaged_gaps_with_friction() {
    let contact = json!({
        "gap": "averaged", "points": {"gauss": 3}, "friction": {"coulomb": {"mu": 0.2}}
    });
    let mut scene = sledge(1.6, 12, contact);
    scene["output"] = json!({"every": 3, "contact_points": true});
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::Done);
    assert!(found.pattern_rebuilds >= 2, "{}", found.pattern_rebuilds);
}

/// The same on a rigid surface that is drawn back at the end.
#[test]
fn averaged_gaps_with_friction_on_a_tool() {
    let mut scene = ironed(json!({"gap": "averaged", "points": {"gauss": 3}}));
    scene["bodies"]["slab"]["element"] = json!("q18");
    for scene in [
        ironed(json!({"gap": "averaged", "points": {"gauss": 3}})),
        scene,
    ] {
        assert_eq!(in_pieces(&scene).status, RunStatus::Done);
    }
}

/// A sheet bent over the border of a table and drawn back, with nodes of the border as slaves.
#[test]
fn edges_of_a_rigid_surface() {
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {"sheet": {
            "mesh": {"plate": {"size": [4, 0.5], "thickness": 0.2, "elements": [16, 1], "origin": [-2, 0, 0.1]}},
            "material": "m"
        }},
        "surfaces": {"table": {
            "plane": {"center": [-1.9, 0, 0], "size": [4, 4]},
            "motion": {"translation": [{"table": [[0, 0], [0.5, 0], [1, -0.2]]}, 0, 0]}
        }},
        "contacts": {"rest": {"slave": "sheet.bottom", "master": "table", "passes": "edges", "friction": 0.2}},
        "supports": {
            "clamp": {"on": "sheet.x_min", "fixed": true},
            "plane": {"on": ["sheet.y_min", "sheet.y_max"], "symmetry": "y"},
            "end": {"on": "sheet.x_max", "mid_surface": true, "displacement": {"z": {"table": [[0, 0], [0.5, -0.8], [1, -0.8]]}}}
        },
        "solution": {"step": {"initial": 0.1, "max": 0.1}},
        "output": {"every": 3, "contact_points": true}
    });
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::Done);
    assert!(
        found.effects.iter().any(|e| *e == "contact.passes.edges"),
        "{:?}",
        found.effects
    );
}

/// A surface driven by force with friction, whose motion is among the unknowns.
#[test]
fn a_driven_surface() {
    let mut scene = ironed(json!({}));
    scene["surfaces"]["die"]["motion"] = json!({
        "translation": [{"table": [[0, 0], [0.2, 0], [1, 1]]}, 0, 0],
        "free": {"force": {"z": {"table": [[0, -0.2], [0.2, -1], [1, -1.2]]}}}
    });
    scene["surfaces"]["die"]["cylinder"]["center"] = json!([2, 0, 3.05]);
    scene["output"] = json!({});
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::Done);
}

/// An automatic penalty is changed on the way.
#[test]
fn raised_penalties() {
    let mut scene = ironed(json!({"penalty": "auto", "friction": null}));
    scene["contacts"]["iron"]
        .as_object_mut()
        .unwrap()
        .remove("friction");
    scene["surfaces"]["die"]["motion"]["translation"][2] =
        json!({"table": [[0, 0], [0.2, -0.7], [0.8, -0.7], [1, 0.1]]});
    scene["output"] = json!({});
    // The default gives way where the die squeezes it, and the run would begin again with this one.
    scene["bodies"]["slab"]["element"] = json!("h8_displacement");
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::Done);
    let start = assembled(&scene);
    let end = found.accuracy.contacts[0].penalty;
    assert!((end / start - 1.0).abs() > 0.5, "{start} {end}");
}

/// The penalty that a run of a scene with one contact starts with.
pub fn assembled(scene: &Value) -> f64 {
    let loaded = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    (covact::model::build::build(&loaded).expect("a model")).pairs[0].eps_n
}

/// A strip that is stretched or pressed along its length, its end moved as a table says.
fn strip(way: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 100, "nu": 0.3}}},
        "bodies": {"strip": {
            "mesh": {"plate": {"size": [20, 1], "thickness": 0.5, "elements": [10, 1]}}, "material": "m",
            "element": "h8"
        }},
        "supports": {
            "wall": {"on": "strip.x_min", "fixed": true},
            "push": {"on": "strip.x_max", "displacement": {"x": {"table": way}, "y": 0}}
        },
        "solution": {"step": {"initial": 0.1, "max": 0.1}}
    })
}

/// Pressed beyond the load at which it could buckle, and released: the solver remembers that the last matrix was indefinite.
#[test]
fn an_indefinite_matrix() {
    let found = in_pieces(&strip(json!([[0, 0], [0.5, -0.2], [1, 0.2]])));
    assert_eq!(found.status, RunStatus::Done);
    let of = |method: &str| found.factorizations.get(method).copied().unwrap_or(0);
    assert!(
        of("llt") > 2 && of("ldlt") > 2,
        "{:?}",
        found.factorizations
    );
}

/// A run that fails at its smallest step does so again.
#[test]
fn a_run_that_does_not_converge() {
    let mut scene = strip(json!([[0, 0], [0.5, 2], [1, -30]]));
    scene["solution"]["step"]["min"] = json!(0.02);
    scene["solution"]["newton"] = json!({"max_iterations": 5});
    let found = in_pieces(&scene);
    assert_eq!(found.status, RunStatus::NotConverged);
    assert!(found.steps > 5 && found.cuts > 1, "{found:?}");
}

/// A run that is repeated with the edges of a master as slaves, broken off in its second attempt: it goes on with the edges.
#[test]
fn a_repetition_with_edges() {
    let plate = json!({"plate": {"size": [50, 8], "thickness": 2, "elements": [25, 2]}});
    let turned = json!({"axis": [0, 0, 1], "angle": 90, "translation": [43.5, -25, 2.2]});
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 2000, "nu": 0.35}}},
        "bodies": {
            "lower": {"mesh": plate, "material": "m"},
            "upper": {"mesh": plate, "material": "m", "placement": turned}
        },
        "contacts": {"c": {"slave": "lower.top", "master": "upper.bottom"}},
        "supports": {
            "wall": {"on": "lower.x_min", "fixed": true},
            "press": {"on": ["upper.x_min", "upper.x_max"], "displacement": {"x": 0, "y": 0, "z": "-4*t"}}
        }
    });
    let scene = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let (ended, _) = part(&scene, whole.path(), false, 1, Stop::Never).unwrap();
    assert_eq!(ended.status, RunStatus::Done);
    assert!(ended.given_up.runs > 0);
    let (broken, _) = part(&scene, parts.path(), false, 1, Stop::OnEdges).unwrap();
    assert_eq!(broken.status, RunStatus::Interrupted);
    assert!(broken.steps > 0 && broken.given_up.runs > 0);
    let (resumed, _) = part(&scene, parts.path(), true, 1, Stop::Never).unwrap();
    assert_eq!(resumed.status, RunStatus::Done);
    let table = |folder: &Path| std::fs::read_to_string(folder.join("history.csv")).unwrap();
    assert_eq!(table(whole.path()), table(parts.path()));
}

/// A sharp wedge is pressed deep into rubber: the run is repeated with its edge as a slave, goes on with other elements, and is repeated at last without
/// the edge. Interrupted while the edge is tried for the first time, it goes the same way to the same end, and counts all runs.
#[test]
fn a_repetition_that_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let text = stl_box([-4.0, -3.0, -4.0], [4.0, 3.0, 4.0]);
    std::fs::write(folder.path().join("box.stl"), text).unwrap();
    let scene = json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 5, "nu": 0.45}}},
        "bodies": {"block": {
            "mesh": {"block": {"min": [-5, -0.25, -4], "max": [5, 0.25, 0], "elements": [15, 1, 5]}}, "material": "rubber"
        }},
        "surfaces": {"wedge": {
            "cad": "box.stl",
            "placement": {"axis": [0, 1, 0], "angle": 45, "translation": [0.1, 0, 5.707]},
            "motion": {"translation": [0, 0, "-1.5*t"]}
        }},
        "contacts": {"c": {"slave": "block.top", "master": "wedge", "friction": 0.3}},
        "supports": {
            "below": {"on": "block.bottom", "fixed": true},
            "plane": {"on": ["block.y_min", "block.y_max"], "symmetry": "y"}
        },
        "output": {"every": 0}
    });
    let mut scene = covact::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
    scene.dir = folder.path().to_path_buf();
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let (ended, _) = part(&scene, whole.path(), false, 1, Stop::Never).unwrap();
    println!("{:?} {:?}", ended.given_up, ended.warnings);
    assert_eq!((ended.status, ended.given_up.runs), (RunStatus::Done, 2));
    let (broken, _) = part(&scene, parts.path(), false, 1, Stop::OnEdges).unwrap();
    assert_eq!(
        (broken.status, broken.given_up.runs),
        (RunStatus::Interrupted, 1)
    );
    let (resumed, _) = part(&scene, parts.path(), true, 1, Stop::Never).unwrap();
    assert_eq!(resumed.status, RunStatus::Done);
    let table = |folder: &Path| std::fs::read_to_string(folder.join("history.csv")).unwrap();
    assert_eq!(table(whole.path()), table(parts.path()));
    assert_eq!(resumed.given_up, ended.given_up);
    assert_eq!(resumed.newton_iterations, ended.newton_iterations);
}

/// A ball sinks into a plate between its nodes: the run is repeated with Gauss points. Broken off then, it goes on with them, is refused by
/// what has changed in its scene alone, and is the run of its scene once it has ended.
#[test]
fn a_repetition_with_more_points() {
    let scene = |young: f64| {
        loaded(&json!({
            "covact": 1,
            "materials": {"rubber": {"neo_hooke": {"E": young, "nu": 0.4}}},
            "bodies": {"plate": {"mesh": {"plate": {"size": [10, 10], "thickness": 0.5, "elements": [8, 8]}}, "material": "rubber"}},
            "surfaces": {"ball": {"sphere": {"radius": 3, "center": [5, 5, 3.25]}, "motion": {"translation": [0, 0, "-t"]}}},
            "contacts": {"press": {"slave": "plate.top", "master": "ball"}},
            "supports": {"rim": {"on": ["plate.x_min", "plate.x_max", "plate.y_min", "plate.y_max"], "fixed": true}},
            "solution": {"end_time": 0.3}
        }))
    };
    let given = scene(2.0);
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let (ended, _) = part(&given, whole.path(), false, 1, Stop::Never).unwrap();
    assert_eq!((ended.status, ended.given_up.runs), (RunStatus::Done, 1));
    assert_eq!(ended.scene, covact::run::checksum(&given));
    let (broken, _) = part(&given, parts.path(), false, 1, Stop::OnGauss).unwrap();
    assert_eq!(broken.status, RunStatus::Interrupted);
    assert_eq!((broken.steps, broken.given_up.runs), (1, 1));
    let error = part(&scene(3.0), parts.path(), true, 1, Stop::Never).unwrap_err();
    let words = "`/materials/rubber` has changed";
    assert!(error.to_string().contains(words), "{error}");
    assert!(!error.to_string().contains("press"), "{error}");
    let (resumed, _) = part(&given, parts.path(), true, 1, Stop::Never).unwrap();
    assert_eq!(counts(&resumed), counts(&ended));
    assert_same(whole.path(), parts.path());
    let (again, notes) = part(&given, parts.path(), true, 1, Stop::Never).unwrap();
    assert_eq!(counts(&again), counts(&ended));
    assert!(
        notes.iter().any(|n| n.contains("reached its end already")),
        "{notes:?}"
    );
}

/// Rubber squeezed between a floor and a tool with friction, until its elements give way and others go on from there: broken off before
/// that and after it.
#[test]
fn elements_that_others_go_on_from() {
    let found = in_pieces(&json!({
        "covact": 1,
        "materials": {"rubber": {"neo_hooke": {"E": 5, "nu": 0.45}}},
        "bodies": {"pad": {
            "mesh": {"block": {"min": [0, 0, 0], "max": [4, 1, 2], "elements": [8, 2, 4]}}, "material": "rubber"
        }},
        "surfaces": {"tool": {
            "plane": {"size": [20, 20], "center": [2, 0.5, 2], "normal": [0, 0, -1]},
            "motion": {"translation": [0, 0, "-t"]}
        }},
        "contacts": {"press": {"slave": "pad.top", "master": "tool", "friction": 0.3}},
        "supports": {"below": {"on": "pad.bottom", "fixed": true}},
        "output": {"every": 1}
    }));
    assert_eq!((found.status, found.given_up.runs), (RunStatus::Done, 0));
    let told = |words: &str| found.warnings.iter().any(|w| w.contains(words));
    assert!(
        told("from there the run went on with"),
        "{:?}",
        found.warnings
    );
}
