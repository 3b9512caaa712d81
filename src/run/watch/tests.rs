use super::*;
use crate::model::build::build;
use crate::scene;
use serde_json::json;

/// A block on the floor below a plane that touches it, or that is pushed into it at the start.
fn pressed(overclosure: bool) -> Model {
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e4, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1] } }, "material": "m"
        } },
        "surfaces": { "tool": {
            "plane": { "center": [0.5, 0.5, 1], "size": [4, 4] }, "side": { "point": [0.5, 0.5, 0.5] }
        } },
        "contacts": { "press": { "slave": "block.top", "master": "tool" } },
        "supports": { "floor": { "on": "block.bottom", "fixed": true } }
    });
    if overclosure {
        scene["surfaces"]["tool"]["plane"]["center"][2] = json!(0.99);
        scene["contacts"]["press"]["initial_overclosure"] = json!({ "shrink": { "until": 0.5 } });
    }
    let loaded = scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
    build(&loaded).unwrap_or_else(|e| panic!("{e}"))
}

/// What nobody put in is too much above half of the work, or of what was stored before; above twice that where penalties
/// change, which put in energy of their own. A first step, an overclosure and what a large step explains are not judged.
#[test]
fn energy_out_of_nothing_is_told_from_that_of_large_steps() {
    let [open, closed] = [false, true].map(pressed);
    let watch = Watch {
        external: 10.0,
        turnover: 10.0,
        ..Watch::new(&open)
    };
    let work = Work {
        external: 2.0,
        turnover: 2.0,
        coarse: 0.5,
        ..Work::default()
    };
    let sized = |size, work: &Work, more: f64| watch.gained(&open, size, work, 12.0 + more);
    let gained = |step, work: &Work, more: f64| sized((step, true), work, more);
    assert_eq!(gained(2, &work, 5.9), None);
    let part = gained(2, &work, 6.6).expect("too much");
    assert!((part - 0.55).abs() < 1e-12, "{part}");
    assert_eq!(gained(1, &work, 6.6), None);
    let coarse = Work {
        coarse: 7.0,
        ..work
    };
    assert_eq!(gained(2, &coarse, 6.6), None);
    let changed = Work {
        changed: true,
        ..work
    };
    assert_eq!(gained(2, &changed, 5.9), None);
    assert!(gained(2, &changed, 6.6).is_some());
    assert_eq!(sized((2, false), &changed, 23.9), None);
    assert!(sized((2, false), &changed, 24.1).is_some());
    assert_eq!(watch.gained(&closed, (2, true), &work, 18.6), None);
}

/// What a step from a softened penalty loses or gains beside what its size explains is a jump from a hundredth of the work on. A
/// first step, changed penalties and overclosures are not judged.
#[test]
fn energy_that_a_jump_loses_is_told_from_that_of_large_steps() {
    let [open, closed] = [false, true].map(pressed);
    let watch = Watch {
        external: 8.0,
        turnover: 8.0,
        ..Watch::new(&open)
    };
    let work = Work {
        external: 2.0,
        turnover: 2.0,
        coarse: 0.005,
        ..Work::default()
    };
    let jumped = |step, work: &Work, lost: f64| watch.jumped(&open, step, work, 10.0 - lost);
    assert_eq!(jumped(2, &work, 0.09), None);
    let part = jumped(2, &work, 0.2).expect("a jump");
    assert!((part - 0.02).abs() < 1e-12, "{part}");
    assert!(jumped(2, &work, -0.2).is_some());
    assert_eq!(jumped(1, &work, 0.2), None);
    let coarse = Work {
        coarse: 0.3,
        ..work
    };
    assert_eq!(jumped(2, &coarse, 0.2), None);
    let changed = Work {
        changed: true,
        ..work
    };
    assert_eq!(jumped(2, &changed, 0.2), None);
    assert_eq!(watch.jumped(&closed, 2, &work, 9.8), None);
    let snaps = Watch {
        snaps: true,
        ..watch
    };
    assert_eq!(snaps.jumped(&open, 2, &work, 9.8), None);
}

/// A penalty that becomes three times as stiff takes out at most two thirds of what it stored, and puts in at most twice as much;
/// what a step lacks beyond that and beyond the error of its rule is not put in by it. Nothing is known of a first step.
#[test]
fn a_change_of_penalties_explains_what_it_stored() {
    let watch = Watch {
        stored: 3.0,
        penalties: vec![100.0],
        ratios: vec![0.0],
        ..Watch::new(&pressed(false))
    };
    let eased = watch.eased([&[300.0], &[0.0]]);
    assert!((eased - 3.0).abs() < 1e-12, "{eased}");
    let work = Work {
        eased,
        coarse: 0.5,
        changed: true,
        ..Work::default()
    };
    for (step, lacks, put_in) in [
        (2, -1.5, -1.5),
        (2, -2.4, -2.4),
        (2, -9.0, -2.0),
        (2, 9.0, 6.0),
        (1, -9.0, -9.0),
    ] {
        let found = watch.put_in_by_penalties(step, &work, lacks);
        assert!((found - put_in).abs() < 1e-12, "{step} {lacks}: {found}");
    }
}
