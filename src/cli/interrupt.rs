//! Ctrl-C, and the signals by which systems ask a program to end.

/// Calls `handler` at every Ctrl-C, SIGTERM and SIGHUP.
///
/// # Errors
/// In words. Where hangups are ignored, as under `nohup`, nothing is watched: a handler would make them count again, and the
/// program would stop with its terminal.
pub(super) fn watch(handler: impl FnMut() + Send + 'static) -> Result<(), String> {
    if hangups_are_ignored() {
        return Err(
            "hangups are ignored (nohup), and with them other signals are not watched".into(),
        );
    }
    ctrlc::set_handler(handler).map_err(|e| e.to_string())
}

/// As far as the system tells, which Linux does.
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    // The lowest bit is that of signal 1, SIGHUP.
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok())
        .is_some_and(|m| m & 1 == 1)
}
