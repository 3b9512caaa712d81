//! `covact check`.
use super::{CheckArgs, print, print_json, report};
use crate::run::{self, CheckReport};
use crate::scene::{self, LoadedScene, SceneError};
use std::fmt::Write;

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
            let code = print(&listing(&found));
            found.warnings.iter().for_each(|w| report::warning(w));
            code
        }
        Err(e) => report::run_error(&e, &scene, args.json),
    }
}

fn listing(found: &CheckReport) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(out, "{name:<16}{value}");
    };
    if !found.title.is_empty() {
        line("title", found.title.clone());
    }
    line("nodes", found.nodes.to_string());
    line("elements", found.elements.to_string());
    line("dofs", found.dofs.to_string());
    line("contact points", found.contact_points.to_string());
    for p in &found.pairs {
        let [low, high] = p.gap;
        line(
            &format!("contact {}", p.name),
            format!(
                "{} points, {} touching, initial gaps {low:.6} to {high:.6}, penalty {:.6e}",
                p.points, p.touching, p.penalty
            ),
        );
    }
    for (i, effect) in found.effects.iter().enumerate() {
        line(if i == 0 { "effects" } else { "" }, effect.clone());
    }
    for (i, note) in found.notes.iter().enumerate() {
        line(if i == 0 { "notes" } else { "" }, note.clone());
    }
    let warnings = match found.warnings.len() {
        0 => "none".to_string(),
        n => n.to_string(),
    };
    line("warnings", warnings);
    out
}
