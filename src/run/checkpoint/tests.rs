//! Files that are whole by their checksum, but not what this program wrote.
use super::*;
use crate::assembly::Assembler;
use crate::model::{Model, build};
use crate::run::march::Kept;
use crate::run::{RunOptions, run};
use crate::scene::{self, LoadedScene};
use crate::solve::event::{Event, Observer};
use std::sync::atomic::{AtomicBool, Ordering};

/// Two blocks with friction, cut into segments elsewhere: every section has something in it.
const SCENE: &str = r#"{
    "covact": 1,
    "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
    "bodies": {
        "bed": {"mesh": {"block": {"min": [0, 0, -1], "max": [2, 1, 0], "elements": [2, 1, 1]}}, "material": "m"},
        "sledge": {"mesh": {"block": {"min": [0.2, 0, 0], "max": [1.2, 1, 0.5], "elements": [1, 1, 1]}}, "material": "m"}
    },
    "contacts": {
        "rub": {
            "slave": "sledge.bottom", "master": "bed.top", "points": {"gauss": 2}, "friction": {"coulomb": {"mu": 0.2}},
            "augmentation": {"gap": 0.01, "slip": 0.01, "max": 25}
        },
        "cut": {"slave": "bed.top", "master": "sledge.bottom", "points": {"segments": 2}}
    },
    "supports": {
        "ground": {"on": "bed.bottom", "fixed": true},
        "push": {"on": "sledge.top", "displacement": {"x": "0.2*t", "y": 0, "z": "-0.05*t"}}
    },
    "solution": {"step": {"initial": 0.25, "max": 0.25}}
}"#;

struct StopAfter<'a>(u32, &'a AtomicBool);

impl Observer for StopAfter<'_> {
    fn event(&mut self, event: &Event) {
        if matches!(event, Event::StepAccepted { step, .. } if *step == self.0) {
            self.1.store(true, Ordering::Relaxed);
        }
    }
}

/// A scene, the folder of a run of it that was stopped after two steps, and its checkpoint.
fn stopped() -> (LoadedScene, tempfile::TempDir, Vec<u8>) {
    let scene = scene::parse(SCENE, "scene.json").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let flag = AtomicBool::new(false);
    let options = RunOptions {
        threads: 1,
        ..RunOptions::default()
    };
    run(
        &scene,
        folder.path(),
        &options,
        &mut StopAfter(2, &flag),
        &flag,
    )
    .unwrap();
    let bytes = std::fs::read(place(folder.path())).unwrap();
    (scene, folder, bytes)
}

/// Reads bytes, up to an assembler that has their memory.
fn read_back(
    bytes: Vec<u8>,
    folder: &Path,
    scene: &Fingerprint,
    model: &Model,
) -> Result<Kept, CheckpointError> {
    let sections = open(place(folder), bytes, folder, scene)?;
    let kept = Kept::read(&sections, model)?;
    let mut assembler = Assembler::new(model, &model.dofs).unwrap();
    (assembler.restore(&kept.assembler)).map_err(|e| damaged(folder, e.to_string()))?;
    Ok(kept)
}

/// The bytes with a checksum that fits them.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len() - 8);
    let sum = Sum::of(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn no_byte_can_do_harm() {
    let (scene, folder, good) = stopped();
    let (model, scene) = (build::build(&scene).unwrap(), Fingerprint::new(&scene));
    let read = |bytes: Vec<u8>| read_back(bytes, folder.path(), &scene, &model);
    assert!(read(good.clone()).is_ok());
    assert_eq!(sealed(good.clone()), good);
    let (mut refused, mut taken) = (0, 0);
    for at in (HEAD..good.len() - 8).step_by(3) {
        for change in [0x01, 0x80, 0xff] {
            let mut bytes = good.clone();
            bytes[at] ^= change;
            assert!(read(bytes.clone()).is_err(), "byte {at}");
            match read(sealed(bytes)) {
                Ok(_) => taken += 1,
                Err(_) => refused += 1,
            }
        }
        // Cut off, and whole by its checksum.
        let cut = sealed(good[..at + 8].to_vec());
        assert!(read(cut).is_err(), "{at} bytes");
    }
    // A number is as good as another; lengths, names and places are not.
    assert!(taken > 1000 && refused > 200, "{taken} {refused}");
}

#[test]
fn other_versions_are_named() {
    let (scene, folder, good) = stopped();
    let fingerprint = Fingerprint::new(&scene);
    let opened = |bytes: Vec<u8>| {
        open(
            place(folder.path()),
            sealed(bytes),
            folder.path(),
            &fingerprint,
        )
    };
    assert!(opened(good.clone()).is_ok());
    let mut format = good.clone();
    format[MARK.len()] += 1;
    let error = opened(format).unwrap_err();
    let words = format!("with format {} of checkpoints (here {FORMAT})", FORMAT + 1);
    assert!(error.to_string().contains(&words), "{error}");
    let mut program = good;
    program[HEAD + 8] = b'9';
    let error = opened(program).unwrap_err();
    assert!(matches!(&error, CheckpointError::Version { found, .. } if found.starts_with('9')));
    assert!(
        error
            .to_string()
            .contains("continue it with that version, or run without `--resume`")
    );
}
