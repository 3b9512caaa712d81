//! The signals of the operating system: those by which it asks a program to end, and that of files that grow too large.

/// Calls `handler` at every Ctrl-C, SIGTERM and SIGHUP. A hangup that is ignored, as under `nohup`, stays so.
///
/// # Errors
/// In words.
#[cfg(unix)]
pub(super) fn watch(mut handler: impl FnMut() + Send + 'static) -> Result<(), String> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut watched = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP) {
        watched.push(SIGHUP);
    }
    let mut signals = signal_hook::iterator::Signals::new(watched).map_err(|e| e.to_string())?;
    let wait = move || signals.forever().for_each(|_| handler());
    let thread = std::thread::Builder::new().name("signals".to_owned());
    thread.spawn(wait).map(drop).map_err(|e| e.to_string())
}

/// Calls `handler` at every Ctrl-C and closing of the console.
///
/// # Errors
/// In words.
#[cfg(not(unix))]
pub(super) fn watch(handler: impl FnMut() + Send + 'static) -> Result<(), String> {
    ctrlc::set_handler(handler).map_err(|e| e.to_string())
}

/// Makes writes beyond the limit on the size of files (`ulimit -f`) fail, as those to a full disk do, where the system would
/// end the program without a word. Returns whether it could.
#[cfg(unix)]
pub(super) fn survive_large_files() -> bool {
    use std::sync::{Arc, atomic::AtomicBool};
    // Whoever writes is told by the error; the flag is not read.
    let arrived = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, arrived).is_ok()
}

/// Nothing to do: other systems have no such signal.
#[cfg(not(unix))]
pub(super) fn survive_large_files() -> bool {
    true
}

/// Whether the process was started with a signal ignored, as far as the system tells, which Linux does.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    // The lowest bit is that of signal 1.
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok())
        .is_some_and(|m| m >> (signal - 1) & 1 == 1)
}
