//! Which bodies of a CAD file a surface takes.
use crate::scene::{self, nearest};
use covact_geometry::io::{CadFile, CadPatch};
use std::collections::BTreeSet;

/// Names that a message lists; the rest is counted.
const LISTED: usize = 20;

/// Numbers of the bodies that a surface takes, `None` for all.
pub(super) struct Bodies(Option<BTreeSet<usize>>);

impl Bodies {
    /// The bodies that a scene names, or message and help where one is not in the file.
    pub(super) fn chosen(cad: &scene::CadFile, file: &CadFile) -> Result<Self, (String, String)> {
        if cad.bodies.is_empty() {
            return Ok(Self(None));
        }
        let mut chosen = BTreeSet::new();
        for name in &cad.bodies {
            let bodies = file.bodies.iter().enumerate();
            let bears =
                bodies.filter(|(_, b)| b.name.as_ref() == Some(name) || b.path.contains(name));
            let found: Vec<usize> = bears.map(|(k, _)| k).collect();
            if found.is_empty() {
                let message = format!("{} has no body or product `{name}`", cad.file.display());
                return Err((message, help(name, file)));
            }
            chosen.extend(found);
        }
        Ok(Self(Some(chosen)))
    }

    /// Whether a patch belongs to them.
    pub(super) fn hold(&self, patch: &CadPatch) -> bool {
        let chosen = self.0.as_ref();
        chosen.is_none_or(|chosen| patch.tags.body.is_some_and(|body| chosen.contains(&body)))
    }

    /// Whether they were chosen by name and all of their faces were read.
    pub(super) fn are_complete(&self, file: &CadFile) -> bool {
        let chosen = self.0.as_ref();
        chosen.is_some_and(|chosen| chosen.iter().all(|&k| file.bodies[k].skipped == 0))
    }
}

fn help(name: &str, file: &CadFile) -> String {
    let names = || {
        let all = file
            .bodies
            .iter()
            .flat_map(|b| b.name.iter().chain(&b.path));
        all.map(String::as_str).collect::<BTreeSet<_>>()
    };
    if let Some(near) = nearest(name, names()) {
        return format!("did you mean `{near}`?");
    }
    let names = names();
    if names.is_empty() {
        return "this file names no bodies; choose faces by `entities`".to_owned();
    }
    let shown: Vec<&str> = names.iter().copied().take(LISTED).collect();
    let rest = match names.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    format!(
        "bodies and products of this file: {}{rest}",
        shown.join(", ")
    )
}
