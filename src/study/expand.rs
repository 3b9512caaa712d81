//! From a study to the scenes of its runs.
use super::change::{Fault, Variant};
use super::check;
use super::choice::apply;
use super::file::{Choice, Grid};
use super::load::LoadedStudy;
use super::record::Label;
use super::triangles::Maker;
use crate::output::file_stem;
use crate::run;
use crate::scene::{self, Problem, SceneError};
use serde_json::Value as Json;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::PathBuf;

/// Characters of what a run's folder says about it.
const SLUG: usize = 60;

/// A run that the study asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Name of its folder: it stays as it is when the study gets more grids behind those that it has.
    pub id: String,
    /// By name of the choice.
    pub choices: BTreeMap<String, Label>,
    /// Name of the reference that it belongs to.
    pub reference: Option<String>,
    /// Its scene, with paths relative to the folder of the study's scene.
    pub scene: Json,
}

/// All runs of a study, equal ones once: those of the grids in their order, then those of references.
pub struct Expansion {
    /// The runs.
    pub runs: Vec<Planned>,
    /// Names of the choices, in the order of the study.
    pub choices: Vec<String>,
    /// Indices of the runs of every reference, coarse to fine.
    pub references: BTreeMap<String, Vec<usize>>,
    /// Folder that paths in the scenes are relative to.
    pub dir: PathBuf,
    /// Keeps the STL files that the scenes name.
    _files: Maker,
}

/// Finds out what a study asks for, and everything that is wrong with it or with any of its scenes.
///
/// # Errors
/// [`SceneError`] about the study, or about the scene that it names.
///
/// ```
/// let study = covact::study::load("examples/studies/shells.json")?;
/// let expansion = covact::study::expand(&study)?;
/// assert!(expansion.runs.len() > 5);
/// # Ok::<(), covact::scene::SceneError>(())
/// ```
pub fn expand(loaded: &LoadedStudy) -> Result<Expansion, SceneError> {
    let study = &loaded.study;
    let path = loaded.resolve(&study.scene);
    if path.is_dir() {
        let message = format!("`{}` is a folder, and no scene file", path.display());
        let help = "name a file in it".to_owned();
        return Err(loaded.error(vec![loaded.problem("/scene", message, Some(help))]));
    }
    if path.as_os_str().is_empty() || !path.is_file() {
        let near = scene::nearest_file(&path).map(|n| format!("did you mean `{n}`?"));
        let help = near.unwrap_or_else(|| "paths are relative to the study file".to_owned());
        let message = format!("there is no scene file `{}`", path.display());
        return Err(loaded.error(vec![loaded.problem("/scene", message, Some(help))]));
    }
    let base = scene::load(&path)?;
    let problems = check::check(loaded, &base.scene);
    if !problems.is_empty() {
        return Err(loaded.error(problems));
    }
    let mut root: Json = base.to_json();
    if let Json::Object(members) = &mut root {
        // Its path, if it is one, would lead elsewhere.
        members.remove("$schema");
    }
    let files = Maker::new(&base.dir).map_err(|e| SceneError::Io {
        what: "study",
        path: std::env::temp_dir(),
        reason: format!("no folder for temporary files can be made: {e}"),
    })?;
    let mut expander = Expander {
        loaded,
        dir: base.dir.clone(),
        files,
        problems: Vec::new(),
        told: HashSet::new(),
        runs: Vec::new(),
        known: HashMap::new(),
        grid_runs: 0,
    };
    let mut start = Variant::new(root);
    expander.change(&mut start, &study.set, "/set");
    let references = expander.references(&start);
    let of_references = expander.runs.len();
    let mut order = Vec::new();
    for (i, grid) in study.grids.iter().enumerate() {
        expander.grid(&start, grid, &format!("/grids/{i}"), &mut order);
    }
    if !expander.problems.is_empty() {
        let mut problems = expander.problems;
        problems.sort_by_key(|p| p.span.start);
        return Err(loaded.error(problems));
    }
    // Runs of grids first; of references those that no grid has.
    let mut seen = HashSet::new();
    order.retain(|run| seen.insert(*run));
    order.extend((0..of_references).filter(|run| !seen.contains(run)));
    let mut place = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        place[*old] = new;
    }
    let references = (references.into_iter())
        .map(|(name, runs)| (name, runs.into_iter().map(|run| place[run]).collect()))
        .collect();
    let runs = order
        .iter()
        .map(|old| expander.runs[*old].clone())
        .collect();
    Ok(Expansion {
        runs,
        choices: names(&study.grids),
        references,
        dir: expander.dir,
        _files: expander.files,
    })
}

/// What records call the choices of all grids, each once.
fn names(grids: &[Grid]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for grid in grids {
        for choice in &grid.choices {
            let name = name(choice, grid);
            if !all.contains(&name) {
                all.push(name);
            }
        }
    }
    all
}

/// What records call a choice: with the part that it is about where the grid has another of its kind.
fn name(choice: &Choice, grid: &Grid) -> String {
    let alike = grid.choices.iter().filter(|c| c.name() == choice.name());
    match (alike.count(), choice.target()) {
        (2.., Some(target)) => format!("{} of {target}", choice.name()),
        _ => choice.name().to_owned(),
    }
}

struct Expander<'l> {
    loaded: &'l LoadedStudy,
    dir: PathBuf,
    files: Maker,
    problems: Vec<Problem>,
    /// Problems that were told already, by place and message.
    told: HashSet<(String, String)>,
    runs: Vec<Planned>,
    /// Runs by the checksum of their scene.
    known: HashMap<String, usize>,
    grid_runs: usize,
}

impl Expander<'_> {
    fn fault(&mut self, fault: Fault) {
        if self.told.insert((fault.at.clone(), fault.message.clone())) {
            let problem = self.loaded.problem(&fault.at, fault.message, fault.help);
            self.problems.push(problem);
        }
    }

    /// Makes changes; the faults of those that are wrong are kept.
    fn change(&mut self, variant: &mut Variant, set: &BTreeMap<String, Json>, at: &str) {
        for (pointer, value) in set {
            let from = format!("{at}{}", scene::pointer(&[pointer]));
            if let Err(fault) = variant.set(pointer, value, &from) {
                self.fault(fault);
            }
        }
    }

    /// Plans the runs of the references; their indices.
    fn references(&mut self, start: &Variant) -> BTreeMap<String, Vec<usize>> {
        let mut all = BTreeMap::new();
        for (name, refinement) in &self.loaded.study.references {
            let mut indices = Vec::new();
            for (k, set) in refinement.runs.iter().enumerate() {
                let mut variant = start.clone();
                let at = scene::pointer(&["references", name, "runs", &k.to_string()]);
                self.change(&mut variant, set, &at);
                let text = format!("run {} of the reference `{name}`", k + 1);
                let id = format!("{}_{}", file_stem(&format!("reference_{name}")), k + 1);
                let new = Planned {
                    id,
                    choices: BTreeMap::new(),
                    reference: Some(name.clone()),
                    scene: Json::Null,
                };
                indices.extend(self.run(variant, &text, new));
            }
            all.insert(name.clone(), indices);
        }
        all
    }

    /// Plans the runs of a grid; `order` gets their indices.
    fn grid(&mut self, start: &Variant, grid: &Grid, at: &str, order: &mut Vec<usize>) {
        let mut first = start.clone();
        self.change(&mut first, &grid.set, &format!("{at}/set"));
        let counts: Vec<usize> = grid.choices.iter().map(Choice::count).collect();
        let total: usize = counts.iter().product();
        for n in 0..total {
            let (mut variant, mut labels) = (first.clone(), BTreeMap::new());
            let mut texts = Vec::new();
            let (mut rest, mut weight) = (n, total);
            let mut right = true;
            for (i, choice) in grid.choices.iter().enumerate() {
                weight /= counts[i];
                let k = rest / weight;
                rest %= weight;
                let at = format!("{at}/choices/{i}");
                let tools = (&mut self.files, self.loaded.dir.as_path());
                if let Err(fault) = apply(choice, k, &at, &mut variant, tools) {
                    self.fault(fault);
                    right = false;
                }
                if let Some(label) = choice.label(k) {
                    texts.push(label.text.clone());
                    labels.insert(name(choice, grid), label);
                }
            }
            if !right {
                continue;
            }
            let slug = file_stem(&texts.join("_").replace([' ', ','], "_").replace("__", "_"));
            let id = format!("{:03}_{slug}", self.grid_runs + 1);
            let id: String = id.chars().take(SLUG).collect();
            let new = Planned {
                id: id.trim_end_matches('_').to_owned(),
                choices: labels,
                reference: None,
                scene: Json::Null,
            };
            let Some(index) = self.run(variant, &texts.join(", "), new) else {
                continue;
            };
            if !order.contains(&index) {
                order.push(index);
            }
        }
    }

    /// Takes a run in, unless there is an equal one, which gets its labels where it has none. The index of the one or the
    /// other; none where its scene is wrong.
    fn run(&mut self, variant: Variant, text: &str, new: Planned) -> Option<usize> {
        let written = variant.scene.to_string();
        let problems = match scene::parse(&written, "the scene") {
            Ok(mut scene) => {
                scene.dir.clone_from(&self.dir);
                let problems = scene::check(&scene);
                if problems.is_empty() {
                    let sum = run::checksum(&scene);
                    return Some(self.take(sum, variant.scene, new));
                }
                problems
            }
            Err(SceneError::Wrong { problems, .. }) => problems,
            Err(other) => {
                self.fault(Fault::new("/scene", other.to_string()));
                return None;
            }
        };
        for problem in problems {
            let at = variant
                .cause(&problem.pointer)
                .unwrap_or("/scene")
                .to_owned();
            let message = format!(
                "the scene is wrong at `{}`: {}",
                problem.pointer, problem.message
            );
            // Once for all variants that have it.
            if self.told.insert((at.clone(), message.clone())) {
                let message = format!("with {text}, {message}");
                self.problems
                    .push(self.loaded.problem(&at, message, problem.help));
            }
        }
        None
    }

    fn take(&mut self, sum: String, scene: Json, new: Planned) -> usize {
        if let Some(&index) = self.known.get(&sum) {
            let known = &mut self.runs[index];
            if known.choices.is_empty() {
                known.choices = new.choices;
            }
            if known.reference.is_none() {
                known.reference = new.reference;
            }
            return index;
        }
        if new.reference.is_none() {
            self.grid_runs += 1;
        }
        let mut id = new.id;
        // Names of references that differ in more than letters and digits, or in nothing but case.
        while (self.runs.iter()).any(|run| run.id.eq_ignore_ascii_case(&id)) {
            id.push('_');
        }
        self.runs.push(Planned { id, scene, ..new });
        self.known.insert(sum, self.runs.len() - 1);
        self.runs.len() - 1
    }
}
