//! What a run costs, over all the parts that it was done in.
use super::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::machine::clock::{Phases, cpu_seconds};
use crate::machine::memory::peak_memory_mb;
use std::collections::BTreeMap;
use std::time::Instant;

/// What a run has cost.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Spent {
    pub wall_s: f64,
    pub cpu_s: Option<f64>,
    /// Seconds by phase.
    pub phases: BTreeMap<String, f64>,
    pub peak_memory_mb: Option<f64>,
    /// Times that the run was continued.
    pub resumed: u32,
}

/// Measures a run.
pub(super) struct Cost {
    since: Instant,
    cpu: Option<f64>,
    /// What earlier parts of the run cost, up to the step that this one goes on from.
    pub earlier: Spent,
}

impl Cost {
    /// From now on.
    pub fn start() -> Self {
        Cost {
            since: Instant::now(),
            cpu: cpu_seconds(),
            earlier: Spent::default(),
        }
    }

    /// All so far, with the phases of this part.
    pub fn spent(&self, phases: &Phases) -> Spent {
        let Spent {
            wall_s,
            cpu_s,
            phases: by_phase,
            peak_memory_mb: peak,
            resumed,
        } = &self.earlier;
        let cpu = cpu_seconds().zip(self.cpu).map(|(now, then)| now - then);
        let mut all = phases.seconds();
        for (name, seconds) in by_phase {
            *all.entry(name.clone()).or_default() += seconds;
        }
        Spent {
            wall_s: wall_s + self.since.elapsed().as_secs_f64(),
            cpu_s: cpu.map(|s| s + cpu_s.unwrap_or(0.0)),
            phases: all,
            // NaN-free, and none only where neither is known.
            peak_memory_mb: match (peak_memory_mb(), *peak) {
                (Some(now), Some(before)) => Some(now.max(before)),
                (now, before) => now.or(before),
            },
            resumed: *resumed,
        }
    }
}

impl Spent {
    pub fn put(&self, out: &mut Writer) {
        let Spent {
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb,
            resumed,
        } = self;
        out.f64(*wall_s);
        out.option(*cpu_s, Writer::f64);
        out.count(phases.len());
        for (name, seconds) in phases {
            out.text(name);
            out.f64(*seconds);
        }
        out.option(*peak_memory_mb, Writer::f64);
        out.u32(*resumed);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let wall_s = from.f64()?;
        let cpu_s = from.option(|r| r.f64())?;
        let mut phases = BTreeMap::new();
        for _ in 0..from.count(16)? {
            let name = from.text()?.to_owned();
            phases.insert(name, from.f64()?);
        }
        Ok(Spent {
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb: from.option(|r| r.f64())?,
            resumed: from.u32()?,
        })
    }
}
