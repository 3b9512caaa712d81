//! Everything that can be wrong with a scene that has been read, without its mesh and CAD files being read.
mod augmentation;
mod checker;
mod dynamics;
mod friction;
mod loads;
mod material;
mod names;
mod shapes;
mod small;
mod solver;
mod stages;

use super::document::Document;
use super::load::LoadedScene;
use super::problem::{Problem, shorten, suggestion};
use super::types::*;
use super::value::{POSITION_AND_TIME, TIME};
pub(crate) use checker::Checker;
use checker::path;
use loads::{check_load, check_support};
use names::Sets;

/// All problems of a scene, in the order of the file; none: the scene can be built.
pub fn check(loaded: &LoadedScene) -> Vec<Problem> {
    problems(&loaded.scene, loaded.document())
}

/// [`check`] of a scene that may be read in part only.
pub(super) fn problems(scene: &Scene, document: &Document) -> Vec<Problem> {
    let mut c = Checker::new(document);
    if !names::check(&mut c, scene) {
        return c.finish();
    }
    for (name, material) in &scene.materials {
        material::check(&mut c, name, material, &scene.units);
    }
    if scene.bodies.is_empty() {
        c.add("/bodies", "a scene needs at least one body", None);
    }
    for (name, body) in &scene.bodies {
        let at = path(&["bodies", name]);
        c.refers(
            &format!("{at}/material"),
            "material",
            "materials",
            &body.material,
            scene.materials.keys(),
        );
        material::check_body(&mut c, name, body, scene);
        shapes::check_mesh(&mut c, &format!("{at}/mesh"), &body.mesh);
        shapes::check_placement(&mut c, &format!("{at}/placement"), &body.placement);
        for (set, selection) in &body.sets {
            let at = path(&["bodies", name, "sets", set]);
            shapes::check_selection(&mut c, &at, selection);
        }
    }
    for (name, surface) in &scene.surfaces {
        shapes::check_surface(&mut c, &path(&["surfaces", name]), surface);
    }
    let sets = Sets::new(scene);
    for (name, contact) in &scene.contacts {
        check_contact(&mut c, &path(&["contacts", name]), contact, scene, &sets);
    }
    for (name, support) in &scene.supports {
        check_support(&mut c, &path(&["supports", name]), support, &sets);
    }
    for (name, load) in &scene.loads {
        check_load(&mut c, &path(&["loads", name]), load, &sets, scene);
    }
    for (name, probe) in &scene.probes {
        check_probe(&mut c, &path(&["probes", name]), probe, scene, &sets);
    }
    check_solution(&mut c, &scene.solution);
    small::check(&mut c, scene);
    dynamics::check(&mut c, scene);
    stages::check(&mut c, scene);
    c.whole("/output/tessellation", scene.output.tessellation, 1, 200);
    if scene.output.contact_points && scene.contacts.values().all(|c| c.friction.is_none()) {
        c.add(
            "/output/contact_points",
            "no contact has friction: there are no slave points with values of their own",
            Some("leave it out, or give a contact `friction`".into()),
        );
    }
    c.finish()
}

fn check_contact(c: &mut Checker, at: &str, contact: &Contact, scene: &Scene, sets: &Sets) {
    sets.check_side(c, &format!("{at}/slave"), &contact.slave, "contact");
    check_master(c, at, contact, scene, sets);
    match contact.points {
        Points::Auto | Points::Nodes => {}
        Points::Gauss(n) => c.whole(&format!("{at}/points/gauss"), n.into(), 1, 10),
        Points::Lobatto(n) => c.whole(&format!("{at}/points/lobatto"), n.into(), 2, 10),
        Points::Segments(n) => {
            check_segments(c, &format!("{at}/points/segments"), n, contact, scene)
        }
    }
    if contact.passes == Passes::TwoHalf && contact.surface(&scene.surfaces).is_some() {
        c.add(
            &format!("{at}/passes"),
            format!(
                "the master `{}` is a rigid surface, which has no pass of its own",
                contact.master
            ),
            Some("`two_half` is for masters that are faces of a body".into()),
        );
    }
    let rigid = contact.surface(&scene.surfaces).is_some();
    let solution = &scene.solution;
    let large = solution.kinematics != Kinematics::Small && solution.dynamics.is_none();
    if contact.passes == Passes::Edges && rigid && !large {
        c.add(
            &format!("{at}/passes"),
            format!(
                "the edges of the rigid surface `{}` are slaves in static runs with large displacements only",
                contact.master
            ),
            Some("leave `passes` out".into()),
        );
    }
    if contact.gap == Gap::Averaged && matches!(contact.points, Points::Auto | Points::Nodes) {
        c.add(
            &format!("{at}/gap"),
            "an averaged gap is the mean over points of the faces, but the points are the nodes"
                .to_owned(),
            Some("take `\"points\": {\"gauss\": 3}` or `{\"lobatto\": 3}`".into()),
        );
    }
    // The nodes' weights belong to points that stay, and their tangent to both sides.
    let with = match (contact.points, contact.passes) {
        (Points::Segments(_), _) => Some("segments, which are cut anew at every step"),
        (_, Passes::TwoHalf) => Some("two half passes"),
        _ => None,
    };
    if let (Gap::Averaged, Some(with)) = (contact.gap, with) {
        c.add(
            &format!("{at}/gap"),
            format!("an averaged gap does not go with {with}"),
            Some("take `pointwise`, or Gauss points and one pass".into()),
        );
    }
    if let InitialOverclosure::Shrink { until } = contact.initial_overclosure {
        let at = format!("{at}/initial_overclosure/shrink/until");
        c.positive(&at, "the time until which the overclosure shrinks", until);
        let end = scene.solution.end_time;
        if until > end {
            let message = format!(
                "the overclosure would shrink until t = {until}, but the run ends at {end}"
            );
            c.add(
                &at,
                message,
                Some("end the run later, or shrink sooner".into()),
            );
        }
    }
    check_penalty(c, &format!("{at}/penalty"), contact.penalty);
    if let Some(accuracy) = contact.accuracy {
        let at = format!("{at}/accuracy");
        if !(1e-6..=0.1).contains(&accuracy) {
            let message = format!("the accuracy is {accuracy}");
            let help = "a relative error of forces from 1e-6 to 0.1, usually 1e-3";
            c.add(&at, message, Some(help.into()));
        }
        if contact.penalty != Penalty::Auto || contact.augmentation.is_some() {
            let message = "an accuracy rules an automatic penalty, and there is none here";
            let help = "leave out `penalty` and `augmentation`, or the accuracy";
            c.add(&at, message, Some(help.into()));
        }
    }
    friction::check(c, at, contact, scene);
    augmentation::check(c, at, contact);
}

fn check_penalty(c: &mut Checker, at: &str, penalty: Penalty) {
    match penalty {
        Penalty::Auto => {}
        Penalty::Value(p) => c.positive(&format!("{at}/value"), "the penalty", p),
        Penalty::Scaled(p) => {
            c.positive(&format!("{at}/scaled"), "the factor of the penalty", p);
        }
    }
}

/// Segments need facets to cut with that are not the slave's own, and have no points that last.
fn check_segments(c: &mut Checker, at: &str, degree: u8, contact: &Contact, scene: &Scene) {
    c.whole(at, degree.into(), 1, 5);
    if contact.surface(&scene.surfaces).is_some() {
        c.add(
            at,
            format!(
                "the master `{}` is a rigid surface, which has no facets to cut the slave faces with",
                contact.master
            ),
            Some(
                "take `{\"gauss\": n}` or `{\"lobatto\": n}`; segments are for masters that are faces of a body".into(),
            ),
        );
    }
    if contact.is_own(&scene.surfaces) {
        let message = "slave and master belong to one body, whose faces do not cut one another";
        let help = "take `{\"gauss\": n}`";
        c.add(at, message.to_owned(), Some(help.to_owned()));
    }
    if !matches!(
        contact.initial_overclosure,
        InitialOverclosure::Strain | InitialOverclosure::Refuse
    ) {
        let message =
            "gaps cannot be measured from where points start that are cut anew in every step";
        let help = "take `{\"gauss\": n}`, or `initial_overclosure` `strain` or `refuse`";
        c.add(at, message.to_owned(), Some(help.to_owned()));
    }
}

/// The master is a rigid surface or a face set of a body.
fn check_master(c: &mut Checker, at: &str, contact: &Contact, scene: &Scene, sets: &Sets) {
    let pointer = format!("{at}/master");
    let rigid = contact.surface(&scene.surfaces).is_some();
    let name = contact.master.single();
    let of_body = !name.is_empty() && (name.contains('.') || scene.bodies.contains_key(name));
    match &contact.master {
        _ if rigid && sets.knows(name) => c.add(
            &pointer,
            format!("`{name}` is both a rigid surface and a set of a body"),
            Some("rename the surface".into()),
        ),
        _ if rigid => {}
        SetNames::One(_) if !of_body => {
            let mut help = suggestion(
                name,
                "surfaces",
                scene.surfaces.keys().map(String::as_str),
            );
            help += "; a face set of a body is written `body.set`";
            let message = format!("there is no surface `{}`", shorten(name));
            c.add(&pointer, message, Some(help));
        }
        SetNames::List(names) if names.iter().any(|n| scene.surfaces.contains_key(n)) => c.add(
            &pointer,
            "a rigid surface is one of several masters",
            Some("give every rigid surface a contact of its own: a list is for face sets of one body".into()),
        ),
        sides => sets.check_side(c, &pointer, sides, "a master"),
    }
    if rigid && contact.master_surface.is_some() {
        c.add(
            &format!("{at}/master_surface"),
            format!("the master `{}` is a rigid surface", contact.master),
            Some("`master_surface` is for masters that are faces of a body".into()),
        );
    }
    if let Some(depth) = contact.depth {
        c.positive(&format!("{at}/depth"), "the depth", depth);
        if rigid {
            c.add(
                &format!("{at}/depth"),
                format!("the master `{}` is a rigid surface", contact.master),
                Some(format!(
                    "give the `depth` of the surface: `/surfaces/{}/depth`",
                    contact.master
                )),
            );
        }
    }
}

/// The sets that something acts on: at least one, each of them known; `faces`: each of them of faces.
fn check_sets(c: &mut Checker, at: &str, on: &SetNames, sets: &Sets, (faces, user): (bool, &str)) {
    let at = format!("{at}/on");
    if on.iter().next().is_none() {
        c.add(
            &at,
            "the list of sets is empty",
            Some("write `body.set`".into()),
        );
    }
    for (at, name) in on.places(&at) {
        sets.check(c, &at, name, faces, user);
    }
}

fn check_probe(c: &mut Checker, at: &str, probe: &Probe, scene: &Scene, sets: &Sets) {
    let whole = probe.body.is_some() && probe.near.is_none();
    c.exactly_one(
        at,
        "probe",
        &[
            ("on", probe.on.is_some()),
            ("near", probe.near.is_some()),
            ("body", whole),
        ],
    );
    if let Some(on) = &probe.on {
        check_sets(c, at, on, sets, (false, "a probe"));
    }
    if let Some(near) = &probe.near {
        c.finite(&format!("{at}/near"), near);
    }
    if let Some(body) = &probe.body {
        let bodies = scene.bodies.keys();
        c.refers(&format!("{at}/body"), "body", "bodies", body, bodies);
    }
}

fn check_solution(c: &mut Checker, solution: &Solution) {
    c.positive("/solution/end_time", "the end time", solution.end_time);
    let step = &solution.steps(|key| c.has(&format!("/solution/step/{key}")));
    for (key, value) in [
        ("initial", step.initial),
        ("min", step.min),
        ("max", step.max),
    ] {
        c.positive(
            &format!("/solution/step/{key}"),
            &format!("the {key} step"),
            value,
        );
    }
    let default = Step::default();
    // Of two sizes in the wrong order the one that the user wrote is meant.
    let blamed = |a: &'static str, a_given: bool, b: &'static str| if a_given { a } else { b };
    if step.min > step.initial {
        let key = blamed("min", step.min != default.min, "initial");
        let message = format!(
            "the smallest step {} is larger than the first step {}",
            step.min, step.initial
        );
        c.add(
            &format!("/solution/step/{key}"),
            message,
            Some("min <= initial <= max".into()),
        );
    }
    if step.initial > step.max {
        let key = blamed("initial", step.initial != default.initial, "max");
        let message = format!(
            "the first step {} is larger than the largest step {}",
            step.initial, step.max
        );
        c.add(
            &format!("/solution/step/{key}"),
            message,
            Some("min <= initial <= max".into()),
        );
    }
    if let Some(i) = solution
        .stops
        .windows(2)
        .position(|w| w[1] <= w[0] || w[1].is_nan())
    {
        let message = format!(
            "the stop {} comes after {}",
            solution.stops[i + 1],
            solution.stops[i]
        );
        c.add(
            &format!("/solution/stops/{}", i + 1),
            message,
            Some("times must increase".into()),
        );
    }
    let newton = &solution.newton;
    c.whole(
        "/solution/newton/max_iterations",
        newton.max_iterations,
        1,
        10_000,
    );
    if !(newton.tolerance > 0.0 && newton.tolerance < 1.0) {
        let message = format!("the tolerance is {}", newton.tolerance);
        let help = "a part of the largest force: between 0 and 1, usually 1e-8";
        c.add("/solution/newton/tolerance", message, Some(help.into()));
    }
    solver::check(c, &solution.linear_solver);
    if let Stabilization::Viscous { factor, until } = solution.stabilization {
        let at = "/solution/stabilization/viscous";
        c.positive(&format!("{at}/factor"), "the factor", factor);
        if let Some(until) = until {
            c.positive(&format!("{at}/until"), "the time", until);
        }
    }
    c.whole("/solution/threads", solution.threads, 0, 4096);
}
