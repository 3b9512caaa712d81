//! A folder of results: one `.vtu` per part and step, listed with their times in `.pvd` collections.
use super::atomic::{make_folder, remove_file, sync_files, write_soon};
use super::vtu::escaped;
use super::{BodyFields, MidSurface, OutputError, PointCloud, SurfaceOutput};
use nalgebra::Isometry3;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A rigid surface at one time.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceState<'a> {
    /// The surface.
    pub surface: &'a SurfaceOutput,
    /// From its own coordinates to where it starts.
    pub start: &'a Isometry3<f64>,
    /// From its own coordinates to where it is.
    pub at: &'a Isometry3<f64>,
    /// It never moves: its files are written with the first step and listed with all.
    pub still: bool,
}

/// Writes the field files of a run and keeps the collections up to date.
#[derive(Debug)]
pub struct Results {
    folder: PathBuf,
    stems: Stems,
    exact: Vec<Entry>,
    tessellated: Vec<Entry>,
    /// Steps that were written, with their times.
    written: Vec<(u32, f64)>,
    /// Field files that may not be on the disk yet.
    unsynced: Vec<PathBuf>,
    /// Whether that holds of the collections.
    listed: bool,
}

/// Names of the parts of a run, in the order they are written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PartNames {
    /// Deformable bodies.
    pub bodies: Vec<String>,
    /// Rigid surfaces.
    pub surfaces: Vec<String>,
    /// Those of them that never move.
    pub still: Vec<String>,
    /// Clouds of slave points.
    pub clouds: Vec<String>,
    /// Mid-surfaces of sheets.
    pub sheets: Vec<String>,
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
        let mut results = Results::empty(folder);
        results.write_collections(&[], &[])?;
        Ok(results)
    }

    /// Goes on in a folder that holds the files of the steps `written`, each with all of `parts`; the collections list these
    /// again, and no later ones.
    pub fn resume(
        folder: &Path,
        written: Vec<(u32, f64)>,
        parts: &PartNames,
    ) -> Result<Self, OutputError> {
        let mut results = Results::empty(folder);
        results.written = written;
        for (step, time) in results.written.clone() {
            for [exact, tessellated] in results.entries(step, time, &parts.listed()) {
                results.exact.push(exact);
                results.tessellated.push(tessellated);
            }
        }
        let (exact, tessellated) = (results.exact.clone(), results.tessellated.clone());
        results.write_collections(&exact, &tessellated)?;
        Ok(results)
    }

    fn empty(folder: &Path) -> Self {
        Results {
            folder: folder.to_path_buf(),
            stems: Stems::default(),
            exact: Vec::new(),
            tessellated: Vec::new(),
            written: Vec::new(),
            unsynced: Vec::new(),
            listed: true,
        }
    }

    /// Brings every file written so far to the disk, and the folder that names them.
    ///
    /// # Errors
    /// The operating system's; the next call tries again.
    pub fn sync(&mut self) -> Result<(), OutputError> {
        if self.unsynced.is_empty() && self.listed {
            return Ok(());
        }
        let listings = COLLECTIONS.map(|name| self.folder.join(name));
        self.unsynced.extend(listings);
        sync_files(&self.folder, &self.unsynced)?;
        self.unsynced.clear();
        self.listed = true;
        Ok(())
    }

    /// Steps that were written, with their times.
    pub fn written(&self) -> &[(u32, f64)] {
        &self.written
    }

    /// Removes the files of a step that is not listed, where there are any.
    pub fn remove(&mut self, step: u32, parts: &PartNames) -> Result<(), OutputError> {
        let mut parts = parts.listed();
        if !self.written.is_empty() {
            // Those of surfaces that never move are another step's.
            parts.retain(|(kind, _)| *kind != Kind::Still);
        }
        for file in self.entries(step, 0.0, &parts).iter().flatten() {
            remove_file(&self.folder.join(&file.file))?;
        }
        Ok(())
    }

    /// Writes every part at an accepted step, surfaces that never move with the first one only, then the collections. The part numbers and file names are those of the
    /// first call that brought the part, so parts may come and go. When a file cannot be written, the collections stay
    /// as they were. Files are whole at once, and on the disk after [`Results::sync`].
    ///
    /// # Errors
    /// Fields that do not fit together, and those of the operating system.
    pub fn write(
        &mut self,
        step: u32,
        time: f64,
        bodies: &[BodyFields],
        surfaces: &[SurfaceState],
        clouds: &[PointCloud],
    ) -> Result<(), OutputError> {
        self.write_all(step, time, bodies, surfaces, (clouds, &[]))
    }

    /// [`Results::write`] with the mid-surfaces of sheets.
    ///
    /// # Errors
    /// As there.
    pub fn write_all(
        &mut self,
        step: u32,
        time: f64,
        bodies: &[BodyFields],
        surfaces: &[SurfaceState],
        (clouds, sheets): (&[PointCloud], &[MidSurface]),
    ) -> Result<(), OutputError> {
        let parts: Vec<(Kind, &str)> = (bodies.iter().map(|b| (Kind::Body, b.name)))
            .chain(
                surfaces
                    .iter()
                    .map(|s| (Kind::surface(s.still), s.surface.name())),
            )
            .chain(clouds.iter().map(|c| (Kind::Cloud, c.name.as_str())))
            .chain(sheets.iter().map(|s| (Kind::Sheet, s.name.as_str())))
            .collect();
        let entries = self.entries(step, time, &parts);
        let first = self.written.is_empty();
        let (folder, unsynced) = (&self.folder, &mut self.unsynced);
        let mut put = |entry: &Entry, bytes: Vec<u8>| -> Result<(), OutputError> {
            let path = folder.join(&entry.file);
            write_soon(&path, &bytes)?;
            unsynced.push(path);
            Ok(())
        };
        let (of_bodies, rest) = entries.split_at(bodies.len());
        let (of_surfaces, rest) = rest.split_at(surfaces.len());
        let (of_clouds, of_sheets) = rest.split_at(clouds.len());
        for (body, [entry, _]) in bodies.iter().zip(of_bodies) {
            put(entry, body.to_vtu(entry.part as u32)?)?;
        }
        for (state, [exact, tessellated]) in surfaces.iter().zip(of_surfaces) {
            if state.still && !first {
                continue;
            }
            let poses = [state.start, state.at];
            put(exact, state.surface.to_vtu(poses)?)?;
            put(tessellated, state.surface.to_tessellated_vtu(poses)?)?;
        }
        for (cloud, [entry, _]) in clouds.iter().zip(of_clouds) {
            put(entry, cloud.to_vtu()?)?;
        }
        for (sheet, [entry, _]) in sheets.iter().zip(of_sheets) {
            put(entry, sheet.to_vtu()?)?;
        }
        let mut exact = self.exact.clone();
        let mut tessellated = self.tessellated.clone();
        for [first, second] in entries {
            exact.push(first);
            tessellated.push(second);
        }
        self.write_collections(&exact, &tessellated)?;
        self.exact = exact;
        self.tessellated = tessellated;
        self.written.push((step, time));
        Ok(())
    }

    /// What the collections list of a step: per part the file with the exact surface, and the tessellated one, which of
    /// anything but a surface is the same.
    fn entries(&mut self, step: u32, time: f64, parts: &[(Kind, &str)]) -> Vec<[Entry; 2]> {
        (parts.iter())
            .map(|&(kind, name)| {
                let part = self.stems.part(kind, name);
                let stem = &self.stems.of[part].stem;
                let step = match (kind, self.written.first()) {
                    (Kind::Still, Some(first)) => first.0,
                    _ => step,
                };
                let entry = |file| Entry {
                    time,
                    part,
                    name: name.to_string(),
                    file,
                };
                let exact = entry(format!("{stem}_{step:04}.vtu"));
                match kind {
                    Kind::Surface | Kind::Still => {
                        [exact, entry(format!("{stem}_tessellated_{step:04}.vtu"))]
                    }
                    Kind::Body | Kind::Cloud | Kind::Sheet => [exact.clone(), exact],
                }
            })
            .collect()
    }

    fn write_collections(
        &mut self,
        exact: &[Entry],
        tessellated: &[Entry],
    ) -> Result<(), OutputError> {
        self.listed = false;
        for (name, entries) in COLLECTIONS.iter().zip([exact, tessellated]) {
            write_soon(&self.folder.join(name), collection(entries).as_bytes())?;
        }
        Ok(())
    }
}

/// The collections: of exact surfaces, and of tessellated ones.
pub(crate) const COLLECTIONS: [&str; 2] = ["results.pvd", "results_tessellated.pvd"];
/// First lines of a collection.
const HEAD: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
     <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n";
/// Its last ones.
const FOOT: &str = "  </Collection>\n</VTKFile>\n";

/// File names that a collection of this program lists; none where the text is not one.
pub(crate) fn listed(text: &str) -> Option<BTreeSet<String>> {
    let entries = text.strip_prefix(HEAD)?.strip_suffix(FOOT)?;
    let file = |line: &str| {
        let name = line.strip_prefix("    <DataSet timestep=\"")?;
        let name = name.strip_suffix("\"/>")?.rsplit_once(" file=\"")?.1;
        // Names are those of files in the same folder.
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        (name.ends_with(".vtu") && name.chars().all(plain)).then(|| name.to_owned())
    };
    entries.lines().map(file).collect()
}

impl PartNames {
    /// What the names of their files begin with, up to the number of the step.
    pub(crate) fn stems(&self) -> BTreeSet<String> {
        let mut stems = Stems::default();
        for (kind, name) in self.listed() {
            stems.part(kind, name);
        }
        let surfaces = stems.of.iter().filter(|part| part.kind.is_surface());
        let tessellated: Vec<String> =
            (surfaces.map(|part| format!("{}_tessellated", part.stem))).collect();
        (stems.of.into_iter().map(|part| part.stem))
            .chain(tessellated)
            .collect()
    }

    fn listed(&self) -> Vec<(Kind, &str)> {
        (self.bodies.iter().map(|n| (Kind::Body, n.as_str())))
            .chain(
                (self.surfaces.iter()).map(|n| (Kind::surface(self.still.contains(n)), n.as_str())),
            )
            .chain(self.clouds.iter().map(|n| (Kind::Cloud, n.as_str())))
            .chain(self.sheets.iter().map(|n| (Kind::Sheet, n.as_str())))
            .collect()
    }
}

/// ParaView's collection format; file names are relative to it.
fn collection(entries: &[Entry]) -> String {
    let mut text = String::from(HEAD);
    for e in entries {
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "    <DataSet timestep=\"{:?}\" part=\"{}\" name=\"{}\" file=\"{}\"/>",
            e.time,
            e.part,
            escaped(&e.name),
            e.file
        );
    }
    text.push_str(FOOT);
    text
}

/// Bodies, surfaces and clouds of points may share names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Body,
    Surface,
    /// A surface that never moves.
    Still,
    Cloud,
    /// The mid-surface of a body.
    Sheet,
}

impl Kind {
    fn surface(still: bool) -> Kind {
        match still {
            true => Kind::Still,
            false => Kind::Surface,
        }
    }

    fn is_surface(self) -> bool {
        matches!(self, Kind::Surface | Kind::Still)
    }
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
        if kind.is_surface() {
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
        !self.taken.contains(&stem) && (!kind.is_surface() || !self.taken.contains(&tessellated))
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
