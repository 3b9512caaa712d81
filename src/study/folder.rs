//! The folder of a study, which holds all that its runs need: `files` with what scenes name, each once; `runs/ID/scene.json`;
//! and the results of every repeat in `runs/ID/1`, `runs/ID/2`, ...
use super::error::StudyError;
use super::expand::{Expansion, Planned};
use super::file::{Measure, Study};
use super::gather::state;
use super::jobs::{Jobs, Standing};
use super::record::{Ending, Record};
use super::scripts::{System, Work};
use crate::output::OutputError;
use crate::output::atomic::{make_folder, remove_file, write_whole};
use crate::run;
use crate::scene::{self, pointer};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// No run has as many steps, so that of the fields only the first and the last are written.
const RARELY: u32 = 1_000_000_000;

/// A study whose scenes are written.
#[derive(Debug, Clone)]
pub struct Folder {
    /// The folder.
    pub path: PathBuf,
    /// In the order of the study.
    pub runs: Vec<Ready>,
    /// Times that every run is done.
    pub repeats: u32,
    /// Threads of a run.
    pub threads: u32,
}

/// A run whose scene is written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ready {
    /// Name of its folder.
    pub id: String,
    /// Checksum of its scene and of the files that it names.
    pub checksum: String,
}

impl Folder {
    /// Writes the scenes of a study, with all files that they name. What is there already and the same is left alone.
    ///
    /// # Errors
    /// [`StudyError::Occupied`] before anything is written, where `study.json` there is something else than an earlier record
    /// of this study; files that cannot be read or written.
    pub fn write(path: &Path, study: &Study, expansion: &Expansion) -> Result<Self, StudyError> {
        own(&path.join("study.json"), study)?;
        make_folder(path)?;
        let fields = (study.quantities.iter()).any(|q| matches!(q.of, Measure::Field { .. }));
        let mut files = Files::new(path, &expansion.dir);
        let mut runs = Vec::with_capacity(expansion.runs.len());
        for run in &expansion.runs {
            let folder = path.join("runs").join(&run.id);
            make_folder(&folder)?;
            let text = written(run, fields, &mut files)?;
            let file = folder.join("scene.json");
            put(&file, text.as_bytes())?;
            let mut scene = scene::parse(&text, &file.display().to_string())?;
            scene.dir = folder;
            runs.push(Ready {
                id: run.id.clone(),
                checksum: run::checksum(&scene),
            });
        }
        Ok(Folder {
            path: path.to_path_buf(),
            runs,
            repeats: study.timing.repeats,
            threads: study.timing.threads,
        })
    }

    /// Where the results of a repeat (from 1) are.
    pub fn results(&self, id: &str, repeat: u32) -> PathBuf {
        self.path.join("runs").join(id).join(repeat.to_string())
    }

    /// Arguments of the program, in the study's folder, for a repeat of a run that begins, or that goes on.
    pub fn arguments(&self, id: &str, repeat: u32, resume: bool) -> [String; 9] {
        [
            "run".to_owned(),
            format!("runs/{id}/scene.json"),
            "-o".to_owned(),
            format!("runs/{id}/{repeat}"),
            "--quiet".to_owned(),
            "--no-report".to_owned(),
            match resume {
                true => "--resume".to_owned(),
                // What an earlier process has left is replaced.
                false => "--force".to_owned(),
            },
            "--threads".to_owned(),
            self.threads.to_string(),
        ]
    }

    /// All repeats of all runs, round after round: index of the run, and repeat.
    pub fn rounds(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        (1..=self.repeats).flat_map(|repeat| (0..self.runs.len()).map(move |run| (run, repeat)))
    }

    /// Writes `jobs.txt`: a command for every repeat of every run, to be called in the study's folder. Accounts of processes
    /// that failed here are removed, since they would pass for those of the jobs.
    ///
    /// # Errors
    /// The file cannot be written, or an account cannot be removed.
    pub fn write_jobs(&self, program: &str) -> Result<usize, OutputError> {
        let mut text = String::new();
        let mut count = 0;
        for (run, repeat) in self.rounds() {
            let arguments = self.arguments(&self.runs[run].id, repeat, false);
            text += &format!("{} {}\n", quoted(program), arguments.join(" "));
            count += 1;
            if state(self, run, repeat).ending != Ending::Done {
                let results = self.results(&self.runs[run].id, repeat);
                remove_file(&results.join("process.json"))?;
            }
        }
        write_whole(&self.path.join("jobs.txt"), text.as_bytes())?;
        Ok(count)
    }

    /// Writes the list of the study's runs, and the script that has a system do those that are open; no script where none
    /// is.
    ///
    /// # Errors
    /// [`StudyError::Occupied`]: there is a file of others in the script's place. A file cannot be written or removed.
    pub fn write_script(
        &self,
        study: &Study,
        system: System,
        program: &str,
    ) -> Result<Standing, StudyError> {
        let path = self.path.join(system.file());
        match std::fs::read_to_string(&path) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Ok(text) if text.lines().take(2).any(|l| l.starts_with(&system.mark())) => {}
            _ => {
                return Err(StudyError::Occupied {
                    path,
                    what: "was not written by this program".to_owned(),
                });
            }
        }
        let jobs = Jobs::of(self, study.timing.limit, study.may_fail);
        jobs.write(&self.path)?;
        let standing = jobs.standing(&self.path);
        // Snakemake's marks of what is not done, or not any more.
        for name in &standing.open {
            remove_file(&self.path.join("runs").join(format!("{name}.done")))?;
        }
        if standing.open.is_empty() {
            remove_file(&path)?;
            return Ok(standing);
        }
        let text = system.script(&Work {
            program,
            open: &standing.open,
            threads: self.threads,
            limit: study.timing.limit,
            one_at_a_time: study.timing.one_at_a_time,
            files: self.path.join("files").is_dir(),
        });
        write_whole(&path, text.as_bytes())?;
        Ok(standing)
    }
}

/// The record of a study takes the place of an earlier record of the same study, and of nothing else.
fn own(path: &Path, study: &Study) -> Result<(), StudyError> {
    let refuse = |what: String| StudyError::Occupied {
        path: path.to_path_buf(),
        what,
    };
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(refuse(format!("cannot be read ({e})"))),
    };
    let record: Record = serde_json::from_slice(&bytes)
        .map_err(|_| refuse("is no record of a study that this version reads".to_owned()))?;
    let (scene, title) = (study.scene_name(), study.title.as_str());
    let differ = |what: &str, there: &str, here: &str| {
        let what = format!("is the record of another study: its {what} is `{there}`, not `{here}`");
        Err(refuse(what))
    };
    if record.scene != scene {
        return differ("scene", &record.scene, &scene);
    }
    if record.title != title {
        return differ("title", &record.title, title);
    }
    Ok(())
}

/// As one word for a shell.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:@".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// The scene of a run as text; files that it names are copied.
fn written(run: &Planned, fields: bool, files: &mut Files) -> Result<String, StudyError> {
    let mut scene = run.scene.clone();
    let mut places = Vec::new();
    for (section, key) in [
        ("bodies", "/mesh/file/path"),
        ("bodies", "/nurbs/file"),
        ("surfaces", "/cad/file"),
    ] {
        let members = scene.get(section).and_then(Json::as_object);
        let names = members.into_iter().flat_map(|m| m.keys());
        places.extend(names.map(|name| pointer(&[section, name]) + key));
    }
    for place in places {
        if let Some(Json::String(path)) = scene.pointer_mut(&place) {
            *path = format!("../../files/{}", files.copy(Path::new(path))?);
        }
    }
    let every = if fields { RARELY } else { 0 };
    if !scene["output"].is_object() {
        scene["output"] = json!({});
    }
    scene["output"]["every"] = json!(every);
    if fields {
        // Runs that are compared may differ by less than the digits that are left out of fields to look at.
        scene["output"]["full_precision"] = json!(true);
    }
    Ok(text(&scene))
}

/// Sections of a scene in the order in which people write them.
const ORDER: [&str; 12] = [
    "covact",
    "title",
    "units",
    "materials",
    "bodies",
    "surfaces",
    "contacts",
    "supports",
    "loads",
    "probes",
    "solution",
    "output",
];

/// A scene as text, for people to read.
fn text(scene: &Json) -> String {
    let place = |key: &str| ORDER.iter().position(|k| *k == key).unwrap_or(ORDER.len());
    let mut members: Vec<(&String, &Json)> = scene.as_object().into_iter().flatten().collect();
    members.sort_by_key(|(key, _)| place(key));
    let member = |(key, value): (&String, &Json)| {
        // Writing JSON values into memory cannot fail.
        let value = serde_json::to_string_pretty(value).unwrap_or_default();
        format!("  {}: {}", json!(key), value.replace('\n', "\n  "))
    };
    let members: Vec<String> = members.into_iter().map(member).collect();
    format!("{{\n{}\n}}\n", members.join(",\n"))
}

/// Writes a file unless it is there with the same bytes.
fn put(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    match std::fs::read(path) {
        Ok(there) if there == bytes => Ok(()),
        _ => write_whole(path, bytes),
    }
}

/// Copies of files, each under a name of its own.
struct Files {
    folder: PathBuf,
    /// Folder that paths are relative to.
    dir: PathBuf,
    copied: BTreeMap<PathBuf, String>,
    /// In lower case: some file systems do not tell `Tool` from `tool`.
    taken: BTreeSet<String>,
}

impl Files {
    fn new(out: &Path, dir: &Path) -> Self {
        Files {
            folder: out.join("files"),
            dir: dir.to_path_buf(),
            copied: BTreeMap::new(),
            taken: BTreeSet::new(),
        }
    }

    /// Name of the copy.
    fn copy(&mut self, path: &Path) -> Result<String, OutputError> {
        let source = self.dir.join(path);
        let failed = |e| OutputError::io("read", &source, e);
        let key = source.canonicalize().map_err(failed)?;
        if let Some(name) = self.copied.get(&key) {
            return Ok(name.clone());
        }
        let bytes = std::fs::read(&source).map_err(failed)?;
        let text = |part: Option<&std::ffi::OsStr>| {
            part.map_or(String::new(), |p| p.to_string_lossy().into_owned())
        };
        let (stem, extension) = (text(source.file_stem()), text(source.extension()));
        let name = |n: usize| match n {
            1 => format!("{stem}.{extension}"),
            n => format!("{stem}_{n}.{extension}"),
        };
        let mut n = 1;
        while !self.taken.insert(name(n).to_lowercase()) {
            n += 1;
        }
        make_folder(&self.folder)?;
        put(&self.folder.join(name(n)), &bytes)?;
        self.copied.insert(key, name(n));
        Ok(name(n))
    }
}
