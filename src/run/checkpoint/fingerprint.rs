//! What a run depends on: the scene, and the bytes of the files that it names.
use super::bytes::{Malformed, Reader, Writer};
use crate::output::sum::Sum;
use crate::scene::{LoadedScene, MeshSource};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Checksums of the parts of a scene, by their JSON pointers, and of the files that it names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fingerprint {
    /// By what a message calls them.
    parts: BTreeMap<String, u64>,
}

impl Fingerprint {
    /// Of a scene as it is meant, however it is written: the order of keys, defaults and blanks make no difference, nor does
    /// the number of threads, which no result depends on.
    pub fn new(loaded: &LoadedScene) -> Self {
        let mut parts = BTreeMap::new();
        let mut scene = serde_json::to_value(&loaded.scene).unwrap_or_default();
        if let Some(scene) = scene.as_object_mut() {
            scene.remove("$schema");
        }
        if let Some(Value::Object(solution)) = scene.get_mut("solution") {
            solution.remove("threads");
        }
        for (key, value) in scene.as_object().into_iter().flatten() {
            match value {
                Value::Object(inner) => parts.extend((inner.iter()).map(|(name, value)| {
                    (
                        format!("`/{key}/{name}`"),
                        Sum::of(value.to_string().as_bytes()),
                    )
                })),
                value => {
                    let sum = Sum::of(value.to_string().as_bytes());
                    parts.insert(format!("`/{key}`"), sum);
                }
            }
        }
        let meshes = (loaded.scene.bodies.values()).filter_map(|body| match &body.mesh {
            MeshSource::File(file) => Some(&file.path),
            MeshSource::Nurbs(nurbs) => Some(&nurbs.file),
            _ => None,
        });
        let surfaces = loaded.scene.surfaces.values();
        let cad = surfaces.filter_map(|surface| Some(&surface.cad.as_ref()?.file));
        for path in meshes.chain(cad) {
            // One that cannot be read is for the reader of meshes and surfaces to report.
            let sum = file_sum(&loaded.resolve(path)).unwrap_or(0);
            parts.insert(format!("file `{}`", path.display()), sum);
        }
        Fingerprint { parts }
    }

    /// A number that stands for all of it.
    pub fn value(&self) -> u64 {
        let mut sum = Sum::new();
        for (name, part) in &self.parts {
            sum.add(name.as_bytes());
            sum.add(&part.to_le_bytes());
        }
        sum.value()
    }

    /// What is not as in `other`, which was before; nothing where both are the same.
    pub fn difference(&self, other: &Fingerprint) -> Option<String> {
        let changed = |(name, sum): (&String, &u64)| match other.parts.get(name) {
            None => Some(format!("{name} is new")),
            Some(before) if before != sum => Some(format!("{name} has changed")),
            Some(_) => None,
        };
        let gone = |name: &&String| !self.parts.contains_key(*name);
        let mut all: Vec<String> = self.parts.iter().filter_map(changed).collect();
        all.extend((other.parts.keys().filter(gone)).map(|name| format!("{name} is gone")));
        match &all[..] {
            [] => None,
            [one] => Some(one.clone()),
            [first, rest @ ..] => Some(format!("{first}, and {} more", rest.len())),
        }
    }

    pub fn put(&self, out: &mut Writer) {
        let Fingerprint { parts } = self;
        out.count(parts.len());
        for (name, sum) in parts {
            out.text(name);
            out.u64(*sum);
        }
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let count = from.count(16)?;
        let mut parts = BTreeMap::new();
        for _ in 0..count {
            let name = from.text()?.to_owned();
            parts.insert(name, from.u64()?);
        }
        Ok(Fingerprint { parts })
    }
}

/// Checksum of a regular file.
fn file_sum(path: &Path) -> std::io::Result<u64> {
    if !std::fs::metadata(path)?.is_file() {
        return Ok(0);
    }
    let (mut file, mut sum) = (File::open(path)?, Sum::new());
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(sum.value()),
            read => sum.add(&buffer[..read]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    fn of(text: &str) -> Fingerprint {
        Fingerprint::new(&scene::parse(text, "scene.json").unwrap())
    }

    #[test]
    fn what_is_meant_counts_and_not_how_it_is_written() {
        let body = r#""b": {"mesh": {"plate": {"size": [1, 2], "thickness": 1, "elements": [1, 1]}}, "material": "m"}"#;
        let text = |young: &str, more: &str| {
            format!(
                r#"{{"covact": 1, "materials": {{"m": {{"neo_hooke": {{"E": {young}, "nu": 0.3}}}}}},
                "bodies": {{{body}}}{more}}}"#
            )
        };
        let first = of(&text("10", ""));
        for same in [
            text("1e1", ""),
            text("10.0", r#", "solution": {"threads": 3}, "title": """#),
        ] {
            assert_eq!(first, of(&same));
            assert_eq!(first.value(), of(&same).value());
        }
        let other = of(&text("11", ""));
        assert_ne!(first.value(), other.value());
        let difference = other.difference(&first);
        assert_eq!(difference.as_deref(), Some("`/materials/m` has changed"));
        let more = of(&text(
            "10",
            r#", "surfaces": {"s": {"sphere": {"radius": 1}}}"#,
        ));
        assert_eq!(
            more.difference(&first).as_deref(),
            Some("`/surfaces/s` is new")
        );
        assert_eq!(
            first.difference(&more).as_deref(),
            Some("`/surfaces/s` is gone")
        );
    }
}
