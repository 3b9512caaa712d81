//! Counts instructions: runs this program again under valgrind's callgrind and reads what it counted.
use std::path::Path;
use std::process::{Command, Stdio};

/// Name of [`counted_by_callgrind`] in the program.
const COUNTED: &str = "free::callgrind::counted_by_callgrind";

/// Runs `f`; under [`count`] nothing but what it executes is counted, and every call is counted apart.
#[inline(never)]
pub fn counted_by_callgrind(f: &mut dyn FnMut()) {
    f();
}

/// Runs this program with `--count` under callgrind. It prints a line for every call of [`counted_by_callgrind`] that
/// begins with `counted `; returned are the rest of those lines, each with the number of instructions.
pub fn count(dir: &Path) -> Result<Vec<(String, u64)>, String> {
    let program = std::env::current_exe().map_err(|e| format!("this program has no path: {e}"))?;
    let out = dir.join("callgrind.out");
    let output = Command::new("valgrind")
        .arg("--tool=callgrind")
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(format!("--dump-before={COUNTED}"))
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(&program)
        .arg("--count")
        .stdin(Stdio::null())
        .output()
        .map_err(|e| format!("valgrind cannot be run ({e}): install it to count instructions"))?;
    let (said, errors) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    if !output.status.success() {
        return Err(format!("{} under valgrind:\n{errors}", output.status));
    }
    let labels: Vec<&str> = said
        .lines()
        .filter_map(|l| l.strip_prefix("counted "))
        .collect();
    let each = labels.iter().enumerate().map(|(i, label)| {
        // Dumps are written as the next call begins: the first is empty, and the last, at the end, has no number.
        let dump = match i + 1 == labels.len() {
            true => out.clone(),
            false => dir.join(format!("callgrind.out.{}", i + 2)),
        };
        let text = std::fs::read_to_string(&dump)
            .map_err(|e| format!("callgrind left no {}: {e}\n{errors}", dump.display()))?;
        let total = (text.lines().find_map(|l| l.strip_prefix("summary: ")))
            .and_then(|n| n.split_whitespace().next()?.parse().ok())
            .ok_or_else(|| format!("{} has no total", dump.display()))?;
        Ok(((*label).to_owned(), total))
    });
    each.collect()
}
