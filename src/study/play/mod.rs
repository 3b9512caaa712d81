//! Does the runs of a study, each in a process of its own, so that a crash or a hang is a result.
mod process;

pub use process::{Account, running};

use super::error::StudyError;
use super::file::Timing;
use super::folder::Folder;
use super::gather::{State, state};
use super::record::Ending;
use process::{Ended, Process};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How runs are done.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The program, which is called with `run SCENE -o OUT --quiet --no-report --force --threads N`.
    pub program: PathBuf,
    /// Processes at a time.
    pub together: usize,
    /// A run that takes longer is stopped.
    pub limit: Duration,
    /// Whose runs these are.
    pub place: Place,
}

/// Where runs are done, and what a run that was cut short does there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// By the study, which wants to know how long they take: one that was cut short begins anew.
    Here,
    /// By a system that ends them and starts them again: one that was cut short goes on from its last checkpoint.
    Elsewhere,
}

impl Settings {
    /// What a study asks for.
    pub fn of(timing: &Timing, program: PathBuf) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Settings {
            program,
            together: match timing.one_at_a_time {
                true => 1,
                false => (cores / timing.threads.max(1) as usize).max(1),
            },
            // Longer than any run.
            limit: Duration::try_from_secs_f64(timing.limit).unwrap_or(Duration::MAX),
            place: Place::Here,
        }
    }
}

/// A repeat of a run that has ended, or was done before.
#[derive(Debug, Clone, PartialEq)]
pub struct Event<'a> {
    /// Name of the run's folder.
    pub id: &'a str,
    /// From 1.
    pub repeat: u32,
    /// How the run ended.
    pub ending: Ending,
    /// Elapsed time (s); none where it was not measured.
    pub wall_s: Option<f64>,
    /// Accepted steps.
    pub steps: u32,
    /// Newton iterations of all attempts.
    pub newton_iterations: u64,
    /// Repeats that are done, this one too, and all.
    pub done: usize,
    /// Number of all repeats.
    pub of: usize,
    /// It was done by an earlier call.
    pub before: bool,
}

/// Does every repeat of every run that has not been done, round after round.
///
/// # Errors
/// A folder that cannot be written, a program that cannot be started. Failed runs are results.
pub fn play(
    folder: &Folder,
    settings: &Settings,
    interrupt: &AtomicBool,
    told: &(dyn Fn(&Event) + Sync),
) -> Result<(), StudyError> {
    let all: Vec<(usize, u32)> = folder.rounds().collect();
    let of = all.len();
    let mut open = Vec::new();
    let mut done = 0;
    for (run, repeat) in all {
        let state = state(folder, run, repeat);
        match state.again(settings.limit.as_secs_f64()) {
            true => open.push((run, repeat)),
            false => {
                done += 1;
                told(&event(folder, (run, repeat), &state, (done, of), true));
            }
        }
    }
    let queue = Mutex::new(Queue {
        next: 0,
        done,
        failure: None,
    });
    std::thread::scope(|scope| {
        for _ in 0..settings.together.clamp(1, open.len().max(1)) {
            scope.spawn(|| worker(folder, settings, (interrupt, told), (&open, of), &queue));
        }
    });
    match queue.into_inner() {
        Ok(Queue {
            failure: Some(failure),
            ..
        }) => Err(failure),
        _ => Ok(()),
    }
}

/// Does one repeat of a run, unless it has ended before, and says why results that are there are not taken, where that is
/// so. None where the user interrupts it.
pub(super) fn one<'f>(
    folder: &'f Folder,
    (run, repeat): (usize, u32),
    settings: &Settings,
    interrupt: &AtomicBool,
) -> Result<Option<(Event<'f>, Option<String>)>, StudyError> {
    let before = state(folder, run, repeat);
    if !before.again(settings.limit.as_secs_f64()) {
        let event = event(folder, (run, repeat), &before, (1, 1), true);
        return Ok(Some((event, None)));
    }
    let process = Process {
        folder,
        run,
        repeat,
        settings,
    };
    if let Ended::Interrupted = process.run(interrupt)? {
        return Ok(None);
    }
    let after = state(folder, run, repeat);
    let event = event(folder, (run, repeat), &after, (1, 1), false);
    Ok(Some((event, after.stale)))
}

/// What workers share.
struct Queue {
    next: usize,
    done: usize,
    failure: Option<StudyError>,
}

fn worker(
    folder: &Folder,
    settings: &Settings,
    (interrupt, told): (&AtomicBool, &(dyn Fn(&Event) + Sync)),
    (open, of): (&[(usize, u32)], usize),
    queue: &Mutex<Queue>,
) {
    loop {
        let (run, repeat) = {
            let Ok(mut queue) = queue.lock() else {
                return;
            };
            let Some(&job) = open.get(queue.next) else {
                return;
            };
            if queue.failure.is_some() || interrupt.load(Ordering::Relaxed) {
                return;
            }
            queue.next += 1;
            job
        };
        let process = Process {
            folder,
            run,
            repeat,
            settings,
        };
        let ended = process.run(interrupt);
        let Ok(mut queue) = queue.lock() else {
            return;
        };
        match ended {
            Ok(Ended::Interrupted) => return,
            Ok(Ended::Done) => {
                queue.done += 1;
                let state = state(folder, run, repeat);
                told(&event(
                    folder,
                    (run, repeat),
                    &state,
                    (queue.done, of),
                    false,
                ));
            }
            Err(failure) => queue.failure = Some(failure),
        }
    }
}

fn event<'f>(
    folder: &'f Folder,
    (run, repeat): (usize, u32),
    state: &State,
    (done, of): (usize, usize),
    before: bool,
) -> Event<'f> {
    let summary = state.summary.as_ref();
    Event {
        id: &folder.runs[run].id,
        repeat,
        ending: state.ending.clone(),
        wall_s: state.wall(),
        steps: summary.map_or(0, |s| s.steps),
        newton_iterations: summary.map_or(0, |s| s.newton_iterations),
        done,
        of,
        before,
    }
}
