//! A folder of results: one `.vtu` per part and step, listed with their times in `.pvd` collections.
use super::atomic::{make_folder, write_whole};
use super::vtu::escape;
use super::{BodyFields, OutputError, PointCloud, SurfaceOutput};
use nalgebra::Isometry3;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A rigid surface at one time.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceState<'a> {
    /// The surface.
    pub surface: &'a SurfaceOutput,
    /// From the reference position to the current one.
    pub at: &'a Isometry3<f64>,
}

/// Writes the field files of a run and keeps the collections up to date.
#[derive(Debug)]
pub struct Results {
    folder: PathBuf,
    stems: Stems,
    exact: Vec<Entry>,
    tessellated: Vec<Entry>,
}

/// A file of a collection.
#[derive(Debug, Clone)]
struct Entry {
    time: f64,
    part: usize,
    name: String,
    file: String,
}

impl Results {
    /// Makes the folder where it is missing and begins with empty collections, so that a listing of an earlier run
    /// does not pass for this one's.
    pub fn create(folder: &Path) -> Result<Self, OutputError> {
        make_folder(folder)?;
        let results = Results {
            folder: folder.to_path_buf(),
            stems: Stems::default(),
            exact: Vec::new(),
            tessellated: Vec::new(),
        };
        results.write_collections(&[], &[])?;
        Ok(results)
    }

    /// Writes every part at an accepted step, then the collections. The part numbers and file names are those of the
    /// first call that brought the part, so parts may come and go. When a file cannot be written, the collections stay
    /// as they were.
    pub fn write(
        &mut self,
        step: u32,
        time: f64,
        bodies: &[BodyFields],
        surfaces: &[SurfaceState],
        clouds: &[PointCloud],
    ) -> Result<(), OutputError> {
        let mut exact = self.exact.clone();
        let mut tessellated = self.tessellated.clone();
        for body in bodies {
            let part = self.stems.part(Kind::Body, body.name);
            let file = format!("{}_{step:04}.vtu", self.stems.of[part].stem);
            let bytes = body.to_vtu(part as u32)?;
            write_whole(&self.folder.join(&file), &bytes)?;
            let entry = Entry {
                time,
                part,
                name: body.name.to_string(),
                file,
            };
            exact.push(entry.clone());
            tessellated.push(entry);
        }
        for state in surfaces {
            let name = state.surface.name();
            let part = self.stems.part(Kind::Surface, name);
            let stem = &self.stems.of[part].stem;
            for (list, file, bytes) in [
                (
                    &mut exact,
                    format!("{stem}_{step:04}.vtu"),
                    state.surface.to_vtu(state.at)?,
                ),
                (
                    &mut tessellated,
                    format!("{stem}_tessellated_{step:04}.vtu"),
                    state.surface.to_tessellated_vtu(state.at)?,
                ),
            ] {
                write_whole(&self.folder.join(&file), &bytes)?;
                list.push(Entry {
                    time,
                    part,
                    name: name.to_string(),
                    file,
                });
            }
        }
        for cloud in clouds {
            let part = self.stems.part(Kind::Cloud, &cloud.name);
            let file = format!("{}_{step:04}.vtu", self.stems.of[part].stem);
            write_whole(&self.folder.join(&file), &cloud.to_vtu()?)?;
            let entry = Entry {
                time,
                part,
                name: cloud.name.clone(),
                file,
            };
            exact.push(entry.clone());
            tessellated.push(entry);
        }
        self.write_collections(&exact, &tessellated)?;
        self.exact = exact;
        self.tessellated = tessellated;
        Ok(())
    }

    fn write_collections(&self, exact: &[Entry], tessellated: &[Entry]) -> Result<(), OutputError> {
        write_whole(
            &self.folder.join("results.pvd"),
            collection(exact).as_bytes(),
        )?;
        write_whole(
            &self.folder.join("results_tessellated.pvd"),
            collection(tessellated).as_bytes(),
        )
    }
}

/// ParaView's collection format; file names are relative to it.
fn collection(entries: &[Entry]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
    );
    for e in entries {
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "    <DataSet timestep=\"{:?}\" part=\"{}\" name=\"{}\" file=\"{}\"/>",
            e.time,
            e.part,
            escape(&e.name),
            e.file
        );
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    text
}

/// Bodies, surfaces and clouds of points may share names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Body,
    Surface,
    Cloud,
}

#[derive(Debug)]
struct Part {
    kind: Kind,
    name: String,
    stem: String,
}

/// File names of the parts, each its own.
#[derive(Debug, Default)]
struct Stems {
    of: Vec<Part>,
    /// In lower case: some file systems do not tell `Tool` from `tool`.
    taken: BTreeSet<String>,
}

impl Stems {
    /// Number of a part, new or known.
    fn part(&mut self, kind: Kind, name: &str) -> usize {
        if let Some(known) = self
            .of
            .iter()
            .position(|p| p.kind == kind && p.name == name)
        {
            return known;
        }
        let base = file_stem(name);
        let mut stem = base.clone();
        let mut n = 2;
        while !self.free(kind, &stem) {
            stem = format!("{base}_{n}");
            n += 1;
        }
        self.taken.insert(stem.to_lowercase());
        if kind == Kind::Surface {
            self.taken
                .insert(format!("{stem}_tessellated").to_lowercase());
        }
        self.of.push(Part {
            kind,
            name: name.to_string(),
            stem,
        });
        self.of.len() - 1
    }

    fn free(&self, kind: Kind, stem: &str) -> bool {
        let stem = stem.to_lowercase();
        let tessellated = format!("{stem}_tessellated");
        !self.taken.contains(&stem) && (kind != Kind::Surface || !self.taken.contains(&tessellated))
    }
}

/// A name as the start of a file name that every file system takes: letters, digits, `-` and `_` of ASCII, everything
/// else as `_`, at most 60 characters, `part` for an empty name.
pub fn file_stem(name: &str) -> String {
    let stem: String = name
        .chars()
        .take(60)
        .map(|c| {
            if c.is_ascii_alphanumeric() || c == '-' || c == '_' {
                c
            } else {
                '_'
            }
        })
        .collect();
    if stem.is_empty() {
        return "part".to_string();
    }
    // A leading dash reads as an option on a command line.
    match stem.strip_prefix('-') {
        Some(rest) => format!("_{rest}"),
        None => stem,
    }
}
