//! What a run costs, over all the parts that it was done in.
use super::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::machine::clock::{Phases, cpu_seconds};
use crate::machine::memory::peak_memory_mb;
use crate::output::GivenUp;
use std::collections::BTreeMap;
use std::time::Instant;

/// What a run has cost.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ResourceUse {
    pub wall_s: f64,
    pub cpu_s: Option<f64>,
    /// Seconds by phase.
    pub phases: BTreeMap<String, f64>,
    pub peak_memory_mb: Option<f64>,
    /// Times that the run was continued.
    pub resumed: u32,
    /// Runs that were given up before this one took their place; what they cost is in the seconds above.
    pub given_up: GivenUp,
}

/// Measures a run.
pub(super) struct Cost {
    since: Instant,
    cpu: Option<f64>,
    /// What earlier parts of the run cost, up to the step that this one goes on from.
    pub earlier: ResourceUse,
}

impl Cost {
    /// From now on.
    pub fn start() -> Self {
        Cost {
            since: Instant::now(),
            cpu: cpu_seconds(),
            earlier: ResourceUse::default(),
        }
    }

    /// All so far, with the phases of this part.
    pub fn spent(&self, phases: &Phases) -> ResourceUse {
        let ResourceUse {
            wall_s,
            cpu_s,
            phases: by_phase,
            peak_memory_mb: peak,
            resumed,
            given_up,
        } = &self.earlier;
        let cpu = cpu_seconds().zip(self.cpu).map(|(now, then)| now - then);
        let mut all = phases.seconds();
        for (name, seconds) in by_phase {
            *all.entry(name.clone()).or_default() += seconds;
        }
        ResourceUse {
            wall_s: wall_s + self.since.elapsed().as_secs_f64(),
            cpu_s: cpu.map(|s| s + cpu_s.unwrap_or(0.0)),
            phases: all,
            // NaN-free, and none only where neither is known.
            peak_memory_mb: match (peak_memory_mb(), *peak) {
                (Some(now), Some(before)) => Some(now.max(before)),
                (now, before) => now.or(before),
            },
            resumed: *resumed,
            given_up: *given_up,
        }
    }
}

impl ResourceUse {
    pub fn put(&self, out: &mut Writer) {
        let ResourceUse {
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb,
            resumed,
            given_up,
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
        out.u32(given_up.runs);
        out.u64(given_up.newton_iterations);
    }

    pub fn take(from: &mut Reader) -> Result<Self, Malformed> {
        let wall_s = from.f64()?;
        let cpu_s = from.option(|r| r.f64())?;
        let mut phases = BTreeMap::new();
        for _ in 0..from.count(16)? {
            let name = from.text()?.to_owned();
            phases.insert(name, from.f64()?);
        }
        Ok(ResourceUse {
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb: from.option(|r| r.f64())?,
            resumed: from.u32()?,
            given_up: GivenUp {
                runs: from.u32()?,
                newton_iterations: from.u64()?,
            },
        })
    }
}
