//! Stopwatches: seconds by phase, processor time.
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Wall-clock seconds by phase. A phase that starts inside another interrupts it, so the seconds of all phases add up
/// to no more than the time that passed.
#[derive(Debug, Default)]
pub struct Phases {
    totals: Vec<(&'static str, Duration)>,
    /// Phases that are running, the innermost last: place in `totals`.
    running: Vec<usize>,
    /// When the innermost phase started or went on.
    since: Option<Instant>,
}

impl Phases {
    /// No phase runs, none has taken time.
    pub fn new() -> Self {
        Phases::default()
    }

    /// Starts a phase, inside whichever runs.
    pub fn start(&mut self, name: &'static str) {
        let now = Instant::now();
        self.settle(now);
        let place = self.place(name);
        self.running.push(place);
        self.since = Some(now);
    }

    /// Ends the innermost phase of this name, with any left running inside it. Nothing happens, and the answer is
    /// false, when no such phase runs.
    pub fn stop(&mut self, name: &str) -> bool {
        let Some(depth) = self.running.iter().rposition(|&p| self.totals[p].0 == name) else {
            return false;
        };
        let now = Instant::now();
        self.settle(now);
        self.running.truncate(depth);
        self.since = (!self.running.is_empty()).then_some(now);
        true
    }

    /// Runs `work` as a phase.
    pub fn time<T>(&mut self, name: &'static str, work: impl FnOnce(&mut Self) -> T) -> T {
        self.start(name);
        let result = work(self);
        self.stop(name);
        result
    }

    /// Seconds by phase, those of running phases up to now.
    pub fn seconds(&self) -> BTreeMap<String, f64> {
        let open = self.since.map_or(Duration::ZERO, |since| since.elapsed());
        let mut out = BTreeMap::new();
        for (place, (name, total)) in self.totals.iter().enumerate() {
            let extra = if self.running.last() == Some(&place) {
                open
            } else {
                Duration::ZERO
            };
            out.insert(name.to_string(), (*total + extra).as_secs_f64());
        }
        out
    }

    /// Books the time since the last change to the innermost phase.
    fn settle(&mut self, now: Instant) {
        if let (Some(&place), Some(since)) = (self.running.last(), self.since) {
            self.totals[place].1 += now.duration_since(since);
        }
    }

    fn place(&mut self, name: &'static str) -> usize {
        match self.totals.iter().position(|(n, _)| *n == name) {
            Some(place) => place,
            None => {
                self.totals.push((name, Duration::ZERO));
                self.totals.len() - 1
            }
        }
    }
}

/// Processor seconds of all threads of this process, user and system, to a hundredth of a second. Linux only.
pub fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    ticks(&stat).map(|t| t as f64 / ticks_per_second())
}

/// utime + stime of `/proc/self/stat`, fields 14 and 15; the second field is a name in parentheses and may hold blanks.
fn ticks(stat: &str) -> Option<u64> {
    let after = &stat[stat.rfind(')')? + 1..];
    let mut fields = after.split_ascii_whitespace().skip(11);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    Some(user + system)
}

/// The kernel's clock ticks, AT_CLKTCK (17) of the auxiliary vector; 100 where it cannot be read.
fn ticks_per_second() -> f64 {
    const CLOCK_TICKS: usize = 17;
    const WORD: usize = size_of::<usize>();
    let vector = std::fs::read("/proc/self/auxv").unwrap_or_default();
    let word = |bytes: &[u8]| bytes.try_into().map(usize::from_ne_bytes).unwrap_or(0);
    vector
        .chunks_exact(2 * WORD)
        .find(|pair| word(&pair[..WORD]) == CLOCK_TICKS)
        .map(|pair| word(&pair[WORD..]) as f64)
        .filter(|&t| t > 0.0)
        .unwrap_or(100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_ticks_are_read() {
        let stat = "12 (a b) c) R 1 2 3 4 5 6 7 8 9 10 123 45 0 0 20 0 1 0";
        assert_eq!(ticks(stat), Some(168));
        assert_eq!(ticks("nonsense"), None);
    }

    #[test]
    fn an_inner_phase_interrupts_the_outer() {
        let mut phases = Phases::new();
        let wall = Instant::now();
        phases.start("outer");
        std::thread::sleep(Duration::from_millis(5));
        phases.time("inner", |_| std::thread::sleep(Duration::from_millis(20)));
        assert!(phases.stop("outer"));
        let wall = wall.elapsed().as_secs_f64();
        assert!(!phases.stop("outer"));
        let s = phases.seconds();
        assert!(s["inner"] >= 0.020 && s["outer"] >= 0.005, "{s:?}");
        assert!(s["inner"] + s["outer"] <= wall, "{s:?} {wall}");
    }

    #[test]
    fn stopping_the_outer_phase_ends_the_inner() {
        let mut phases = Phases::new();
        phases.start("outer");
        phases.start("inner");
        assert!(phases.stop("outer"));
        assert!(!phases.stop("inner"));
        let s = phases.seconds();
        assert_eq!(s, phases.seconds());
        assert_eq!(s.len(), 2);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn processor_time_is_plausible() {
        let before = cpu_seconds().unwrap();
        // Until the kernel's clock ticks, however busy the machine is.
        let start = Instant::now();
        let (mut x, mut used) = (1.0f64, 0.0);
        while used == 0.0 && start.elapsed() < Duration::from_secs(20) {
            for _ in 0..10_000 {
                x = (x * 1.000001).sin() + 1.0;
            }
            used = cpu_seconds().unwrap() - before;
        }
        assert!(used > 0.0 && x.is_finite(), "{used}");
        assert!(ticks_per_second() >= 1.0);
    }
}
