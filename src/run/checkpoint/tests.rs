//! Files that are whole by their checksum, but not what this program wrote.
use super::*;
use crate::assembly::Assembler;
use crate::model::{Model, build};
use crate::run::march::Kept;
use crate::run::{RunOptions, run};
use crate::scene::{self, LoadedScene};
use crate::shell::ElementBlock;
use crate::solve::event::{Event, Observer};
use covact_geometry::Vec3;
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

const SLOT: Slot = Slot {
    index: 0,
    number: 1,
};

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
    let found = newest(folder.path(), |_, _, bytes| Ok(bytes)).unwrap();
    let (bytes, passed_over) = found.unwrap();
    assert_eq!(passed_over, [""; 0]);
    (scene, folder, bytes)
}

/// Reads bytes, up to an assembler that has their memory.
fn read_back(
    bytes: Vec<u8>,
    folder: &Path,
    scene: &Fingerprint,
    model: &Model,
) -> Result<Kept, CheckpointError> {
    let sections = open(place(folder, 0), SLOT, bytes, folder, scene)?;
    let kept = Kept::read(&sections, model)?;
    let mut assembler = Assembler::new(model, &model.dofs).unwrap();
    (assembler.restore(&kept.assembler)).map_err(|e| damaged(folder, e.to_string()))?;
    Ok(kept)
}

#[test]
fn no_byte_can_do_harm() {
    let (scene, folder, good) = stopped();
    let (model, scene) = (build::build(&scene).unwrap(), Fingerprint::new(&scene));
    let read = |bytes: Vec<u8>| read_back(bytes, folder.path(), &scene, &model);
    assert!(read(good.clone()).is_ok());
    assert_eq!(resealed(good.clone()), good);
    let (mut refused, mut taken) = (0, 0);
    for at in (HEAD..good.len() - 8).step_by(3) {
        for change in [0x01, 0x80, 0xff] {
            let mut bytes = good.clone();
            bytes[at] ^= change;
            assert!(read(bytes.clone()).is_err(), "byte {at}");
            match read(resealed(bytes)) {
                Ok(_) => taken += 1,
                Err(_) => refused += 1,
            }
        }
        // Cut off, and whole by its checksum.
        let cut = resealed(good[..at + 8].to_vec());
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
            place(folder.path(), 0),
            SLOT,
            resealed(bytes),
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
        error.to_string().contains(
            "continue it with that version, or run with `--force` in place of `--resume`"
        )
    );
}

/// A keeper of checkpoints that hold one number.
fn keeper(folder: &Path) -> (Keeper, Fingerprint) {
    let scene = Fingerprint::new(&scene::parse(SCENE, "scene.json").unwrap());
    let mut keeper = Keeper::new(folder, scene.clone());
    keeper.cost = Duration::from_secs(3600);
    (keeper, scene)
}

fn put(keeper: &mut Keeper, x: u64) -> Result<(), OutputError> {
    match keeper.keep(|out| out.section("x", |out| out.u64(x)))? {
        true => keeper.flush(|| Ok(())),
        false => Ok(()),
    }
}

/// What is found: the number, where it is, and what is wrong with later ones.
fn found(folder: &Path, scene: &Fingerprint) -> Result<(u64, Slot, Vec<String>), RunError> {
    match find(folder, scene)? {
        Found::Unfinished(sections) => {
            let x = sections.read(|r| r.section("x", |r| r.u64()))?;
            Ok((x, sections.slot, sections.passed_over))
        }
        Found::Finished(_) => unreachable!(),
    }
}

/// Bytes of the slots; none of those that are missing.
fn slots(folder: &Path) -> [Option<Vec<u8>>; SLOTS] {
    std::array::from_fn(|index| std::fs::read(place(folder, index)).ok())
}

#[test]
fn slots_alternate_around_the_one_that_is_on_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (mut keeper, scene) = keeper(folder);
    let mut before = slots(folder);
    let mut written = Vec::new();
    for x in 1..=12 {
        // The fourth and the ninth are brought to the disk.
        keeper.cost = Duration::from_secs(if x == 4 || x == 9 { 0 } else { 3600 });
        put(&mut keeper, x).unwrap();
        let after = slots(folder);
        let changed: Vec<usize> = (0..SLOTS).filter(|i| before[*i] != after[*i]).collect();
        assert_eq!(changed.len(), 1);
        written.push(changed[0]);
        let slot = Slot {
            index: changed[0],
            number: x,
        };
        assert_eq!(found(folder, &scene).unwrap(), (x, slot, vec![]));
        before = after;
    }
    assert_eq!(written, [0, 1, 0, 1, 0, 2, 0, 2, 0, 1, 2, 1]);
    // What is gone on from stays, too.
    let (_, slot, _) = found(folder, &scene).unwrap();
    keeper.go_on(slot);
    for (x, index) in [(13, 0), (14, 2), (15, 0)] {
        put(&mut keeper, x).unwrap();
        assert_eq!(found(folder, &scene).unwrap().1.index, index);
        assert_eq!(slots(folder)[1], before[1]);
    }
    keeper.finish().unwrap();
    assert_eq!(slots(folder), [None, None, None]);
}

#[test]
fn a_torn_slot_gives_way_to_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (mut keeper, scene) = keeper(folder);
    for x in 1..=3 {
        put(&mut keeper, x).unwrap();
    }
    // The third is over the first.
    let [Some(third), Some(second), None] = slots(folder) else {
        panic!("other slots");
    };
    let first = {
        let other = tempfile::tempdir().unwrap();
        let (mut keeper, _) = self::keeper(other.path());
        put(&mut keeper, 1).unwrap();
        std::fs::read(place(other.path(), 0)).unwrap()
    };
    assert_eq!(first.len(), third.len());
    let path = place(folder, 0);
    for length in 0..third.len() {
        // Written up to there: over a file that was empty, over zeros, and over the checkpoint before.
        let zeros = vec![0; third.len() - length];
        for rest in [&[][..], &zeros, &first[length..]] {
            let bytes = [&third[..length], rest].concat();
            if bytes == third || bytes == first {
                continue;
            }
            std::fs::write(&path, &bytes).unwrap();
            let (x, slot, passed_over) = found(folder, &scene).unwrap();
            assert_eq!((x, slot.index, slot.number), (2, 1, 2), "{length}");
            // Whoever finds a smaller number in the head does not look further.
            let told = passed_over
                .iter()
                .all(|text| text.contains("checkpoint.0.bin` is damaged: "));
            assert!(told && passed_over.len() <= 1, "{passed_over:?}");
            let known = bytes.len() > HEAD && bytes[HEAD - 8] == 3;
            assert!(passed_over.len() == 1 || !known);
        }
    }
    // What is left of a longer one is not read.
    std::fs::write(&path, [&third[..], b"left"].concat()).unwrap();
    assert_eq!(found(folder, &scene).unwrap().0, 3);
    // Both are named where none will do.
    std::fs::write(&path, &third[..40]).unwrap();
    std::fs::write(place(folder, 1), &second[..second.len() - 1]).unwrap();
    let error = found(folder, &scene).unwrap_err().to_string();
    for index in [0, 1] {
        assert!(error.contains(&format!(
            "checkpoint.{index}.bin` is damaged: it is not whole"
        )));
    }
    // What is of somebody else is not written over.
    std::fs::write(place(folder, 1), &second).unwrap();
    std::fs::write(&path, "a text of somebody").unwrap();
    let error = found(folder, &scene).unwrap_err().to_string();
    assert!(
        error.contains("checkpoint.0.bin` is no checkpoint of covact"),
        "{error}"
    );
}

fn evaluate<const N: usize, B: ElementBlock<N>>(block: &B, u: &[Vec3; N], state: &mut [f64]) {
    block
        .evaluate(0, u, state, &mut B::System::default())
        .unwrap();
    block
        .residual(0, u, state, &mut B::NO_FORCES.clone())
        .unwrap();
}

/// What a law remembers is written when a step is accepted and not by evaluations, stays as it is in the start of the next
/// step, and comes back from a checkpoint bit by bit.
#[test]
fn what_laws_remember_is_committed_and_kept() {
    use crate::model::state::{State, histories_of_laws};
    use crate::shell::material::{Hardening, J2};
    use crate::shell::{Block, Law, with_block};
    for element in [
        scene::Element::H8,
        scene::Element::H8Displacement,
        scene::Element::H8MeanDilatation,
        scene::Element::H8Eas3,
        scene::Element::Q18,
    ] {
        let mut loaded = scene::parse(SCENE, "scene.json").unwrap();
        for body in loaded.scene.bodies.values_mut() {
            body.element = element;
        }
        let mut model = build::build(&loaded).unwrap();
        let metal = Law::J2(J2 {
            lambda: 60.0,
            mu: 40.0,
            hardening: Hardening::Linear {
                initial: 1.0,
                slope: 5.0,
            },
        });
        // The second body remembers, the first does not.
        let block = Block::new(&model.bodies[1].mesh, element, metal).unwrap();
        model.bodies[1].block = block;
        let start = State::new(&model);
        let first = model.state_len(&model.bodies[0]) * model.bodies[0].block.elements();
        let numbers = |state: &State| -> Vec<f64> {
            histories_of_laws(&model)
                .filter(|range| range.start >= first)
                .flat_map(|range| state.elements[range].to_vec())
                .collect()
        };
        let points = match element {
            scene::Element::H8 => 24,
            scene::Element::H8Displacement
            | scene::Element::H8MeanDilatation
            | scene::Element::H8Eas3 => 8,
            scene::Element::Q18 => 18,
            scene::Element::Nurbs => 0,
        };
        assert_eq!(numbers(&start).len(), 14 * points);

        let sheared = |state: &mut State, by: f64| {
            for (u, x) in state.u.chunks_exact_mut(3).zip(&model.nodes) {
                u.copy_from_slice(&[by * x.z, 0.0, 0.0]);
            }
        };
        let body = &model.bodies[1];
        let mut trial = start.clone();
        for by in [0.3, -0.4, 0.1] {
            sheared(&mut trial, by);
            let state = &mut trial.elements[first..];
            with_block!(&body.block, block => {
                let u = body.displacements(block, 0, &trial.u);
                evaluate(block, &u, state);
            });
            assert_eq!(numbers(&trial), numbers(&start));
        }
        trial.remember(&model).unwrap();
        let first = numbers(&trial);
        assert!(first.iter().any(|x| x.abs() > 1e-3));

        // The next step: the predictor continues displacements alone.
        let mut next = start.clone();
        trial.extrapolate(&model, &start, 1.0, &mut next);
        assert_eq!(numbers(&next), first);
        assert!(next.u.iter().zip(&trial.u).any(|(a, b)| a != b));
        sheared(&mut next, 0.3);
        next.remember(&model).unwrap();
        assert_ne!(numbers(&next), first);

        let mut out = bytes::Writer::default();
        state::put(&model, &next, &mut out);
        let mut from = bytes::Reader::new(out.bytes());
        let back = state::take(&model, &mut from).unwrap();
        assert_eq!(numbers(&back), numbers(&next));
    }
}

#[test]
fn a_slot_that_cannot_be_written_leaves_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (mut keeper, scene) = keeper(folder);
    put(&mut keeper, 1).unwrap();
    std::fs::create_dir(place(folder, 1)).unwrap();
    let error = put(&mut keeper, 2).unwrap_err().to_string();
    assert!(
        error.contains("checkpoint.1.bin`: it exists and is not a regular file"),
        "{error}"
    );
    std::fs::remove_dir(place(folder, 1)).unwrap();
    assert_eq!(found(folder, &scene).unwrap().0, 1);
    // The slot is the next one again.
    put(&mut keeper, 2).unwrap();
    assert_eq!(found(folder, &scene).unwrap().1.index, 1);
    assert_eq!(keeper.newest.map(|slot| slot.number), Some(2));
}
