//! `covact check`.
use super::text::folded;
use super::{CheckArgs, print, print_json, report};
use crate::machine::memory::Size;
use crate::model::EffectKind;
use crate::model::error::number;
use crate::run::{self, BodyReport, CheckReport, PairReport, SetReport, SurfaceReport};
use crate::scene::{self, LoadedScene, SceneError};

/// Reads a scene and checks what needs no mesh.
pub(super) fn load(path: &std::path::Path) -> Result<LoadedScene, SceneError> {
    let loaded = scene::load(path)?;
    let problems = scene::check(&loaded);
    match problems.is_empty() {
        true => Ok(loaded),
        false => Err(loaded.error(problems)),
    }
}

pub(super) fn check(args: &CheckArgs) -> u8 {
    let scene = match load(&args.scene) {
        Ok(scene) => scene,
        Err(e) => return report::scene_error(&e, args.json),
    };
    match run::check(&scene) {
        Ok(found) if args.json => print_json(&found),
        Ok(found) => {
            let code = print(&folded(&listing(&found)));
            found.warnings.iter().for_each(|w| report::warning(w));
            code
        }
        Err(e) => report::run_error(&e, &scene, args.json),
    }
}

/// Paragraphs: a head line, and indented lines of a name and a text.
#[derive(Default)]
struct Paragraphs(String);

impl Paragraphs {
    fn head(&mut self, text: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.0 += &format!("{text}\n");
    }

    fn line(&mut self, name: &str, text: &str) {
        // A name as wide as its column still keeps its distance.
        self.0 += &format!("  {name:<15} {text}\n");
    }
}

fn listing(found: &CheckReport) -> String {
    let mut out = Paragraphs::default();
    if !found.title.is_empty() {
        out.head(&found.title);
    }
    out.head(&format!(
        "{} elements, {} nodes, {} unknown displacements (dofs), {} contact points; lengths in {}",
        found.elements, found.nodes, found.dofs, found.contact_points, found.unit
    ));
    let m = &found.memory;
    out.head("memory of a run, estimated");
    out.line("at most", &format!("about {}", Size(m.total)));
    let parts = [
        ("elements", m.elements),
        ("contact", m.contact),
        ("surfaces", m.surfaces),
        ("matrix", m.matrix),
        ("factorization", m.factor),
    ];
    let parts = parts.map(|(name, bytes)| format!("{name} {}", Size(bytes)));
    out.line("of it", &parts.join(", "));
    for b in &found.bodies {
        body(&mut out, b, notes(found, "body", &b.name));
    }
    for s in &found.surfaces {
        surface(&mut out, s, notes(found, "surface", &s.name));
    }
    for p in &found.pairs {
        contact(&mut out, p, notes(found, "contact", &p.name));
    }
    if !found.supports.is_empty() {
        out.head("supports");
        for s in &found.supports {
            let text = format!("{} on {} ({} components)", s.kind, s.on, s.components);
            out.line(&s.name, &text);
            notes(found, "support", &s.name).for_each(|n| out.line("note", n));
        }
    }
    if !found.loads.is_empty() {
        out.head("loads");
        for l in &found.loads {
            out.line(&l.name, &format!("{} on {}", l.kind, l.on));
        }
    }
    out.head("effects that are on (nothing else is computed)");
    for effect in found.effects.iter().chain(&found.details) {
        let meaning = EffectKind::named(effect).map_or("", EffectKind::meaning);
        out.0 += &format!("  {effect:<30} {meaning}\n");
    }
    out.head(&match found.warnings.len() {
        0 => "no warnings".to_owned(),
        n => format!("{n} warning(s)"),
    });
    out.0
}

/// Notes about something, without its name.
fn notes<'f>(found: &'f CheckReport, kind: &str, name: &str) -> impl Iterator<Item = &'f str> {
    let start = format!("{kind} `{name}`: ");
    (found.notes.iter()).filter_map(move |n| n.strip_prefix(start.as_str()))
}

fn range([low, high]: [f64; 2]) -> String {
    match low == high {
        true => number(low),
        false => format!("{} to {}", number(low), number(high)),
    }
}

fn body<'n>(out: &mut Paragraphs, b: &BodyReport, notes: impl Iterator<Item = &'n str>) {
    out.head(&format!("body `{}`", b.name));
    let parts = match b.parts {
        1 => String::new(),
        n => format!(" in {n} unconnected parts"),
    };
    out.line(
        "mesh",
        &format!("{} elements, {} nodes{parts}", b.elements, b.nodes),
    );
    if !b.sets.is_empty() {
        let count = |n: usize, what: &str| match n {
            1 => format!("1 {what}"),
            n => format!("{n} {what}s"),
        };
        let set = |set: &SetReport| match set.faces {
            0 => format!("{} ({})", set.name, count(set.nodes, "node")),
            n => format!("{} ({})", set.name, count(n, "face")),
        };
        let sets: Vec<String> = b.sets.iter().map(set).collect();
        out.line("sets", &sets.join(", "));
    }
    out.line("element", b.element);
    out.line("material", &b.material);
    out.line("extent", &extent(&b.bounds));
    out.line(
        "element size",
        &format!(
            "edges {}, layers {} thick",
            range(b.edge),
            range(b.thickness)
        ),
    );
    out.line(
        "element shape",
        &format!(
            "{} at worst (1: right-angled, 0: collapsed)",
            number(b.worst_shape)
        ),
    );
    if let Some(d) = &b.distortion {
        let text = match d.share < 1e-6 {
            true => "none".to_owned(),
            false => format!(
                "{} of the limit at worst: element {} at ({}), {}",
                number(d.share),
                d.element,
                d.place.map(number).join(", "),
                d.cause
            ),
        };
        out.line("distortion", &text);
    }
    notes.for_each(|n| out.line("note", n));
}

fn extent([low, high]: &[[f64; 3]; 2]) -> String {
    let axis = |i: usize| format!("{} {}", ["x", "y", "z"][i], range([low[i], high[i]]));
    [0, 1, 2].map(axis).join(", ")
}

fn surface<'n>(out: &mut Paragraphs, s: &SurfaceReport, notes: impl Iterator<Item = &'n str>) {
    out.head(&format!("surface `{}` (rigid)", s.name));
    out.line("source", &s.source);
    let parts = match s.parts {
        1 => "all connected".to_owned(),
        n => format!("in {n} unconnected parts"),
    };
    out.line("patches", &format!("{}, {parts}", s.patches));
    let mut edges = vec![
        format!("{} shared and smooth", s.smooth_edges),
        format!("{} shared and sharp", s.sharp_edges),
        format!("{} free (the surface ends there)", s.free_edges),
    ];
    for (count, what) in [
        (s.partial_edges, "shared in part"),
        (s.branching_edges, "of more than two patches"),
        (s.poles, "shrunk to a point"),
    ] {
        if count > 0 {
            edges.push(format!("{count} {what}"));
        }
    }
    if s.largest_gap > 0.0 {
        edges.push(format!("largest gap {}", number(s.largest_gap)));
    }
    out.line("edges", &edges.join(", "));
    let radius = |r: Option<f64>, none: &str| r.map_or(none.to_owned(), number);
    out.line(
        "smallest radii",
        &format!(
            "{} convex (bulging), {} concave (hollow)",
            radius(s.smallest_convex_radius, "none"),
            radius(s.smallest_concave_radius, "none")
        ),
    );
    out.line(
        "extent",
        &format!("{} before it is placed", extent(&s.bounds)),
    );
    for n in notes {
        match n.strip_prefix("its outside is ") {
            Some(text) => out.line("outside", text),
            None => out.line("note", n),
        }
    }
}

fn contact<'n>(out: &mut Paragraphs, p: &PairReport, notes: impl Iterator<Item = &'n str>) {
    out.head(&format!("contact `{}`", p.name));
    let slave = match p.points {
        // It does not act in the first stage.
        0 => p.slave.clone(),
        points => format!(
            "{}: {points} points, {}, {} apart",
            p.slave,
            p.sampling,
            number(p.spacing)
        ),
    };
    out.line("slave", &slave);
    out.line("master", &p.master);
    for n in notes {
        match n.split_once(' ') {
            Some(("penalty", text)) => out.line("penalty", text),
            _ => match n.strip_prefix("initial gaps ") {
                Some(text) => out.line("initial gaps", text),
                None => out.line("note", n),
            },
        }
    }
}
