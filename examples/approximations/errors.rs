//! The reference, and the errors against it.
use super::Outcome;
use super::cases::{MASTERS, Master, SHELLS, Shell};
use super::record::Record;
use std::fmt::Write as _;

/// Runs of one shell on one master, coarse to fine.
pub struct Curve {
    pub shell: Shell,
    pub master: Master,
    /// Unknowns and relative error of the force.
    pub points: Vec<[f64; 2]>,
    /// Order in the distance of nodes between the last two points.
    pub rate: f64,
    records: Vec<Record>,
}

/// The reference value and where it comes from.
pub struct Reference {
    pub force: f64,
    /// Estimated relative error of the finest run that it is extrapolated from.
    pub own: f64,
    /// Order that the extrapolation found.
    pub rate: f64,
    pub shell: Shell,
    pub intervals: u32,
}

pub struct Errors {
    pub reference: Reference,
    pub curves: Vec<Curve>,
}

impl Errors {
    /// Errors of all runs. The reference is Richardson's extrapolation of the three finest runs on the exact ball, of
    /// quadratic shells where there are any: no other master or element enters it.
    pub fn new(records: &[Record]) -> Outcome<Self> {
        let of = |shell: Shell, master: Master| {
            let mut own: Vec<Record> = (records.iter().copied())
                .filter(|r| r.case.shell == shell && r.case.master == master)
                .collect();
            own.sort_by_key(|r| r.case.intervals);
            own
        };
        let reference = (SHELLS.iter().rev())
            .find_map(|&shell| reference(&of(shell, Master::Nurbs)))
            .ok_or(
                "no three runs on the exact ball, one twice as fine as the other, that converge",
            )?;
        let mut curves = Vec::new();
        for shell in SHELLS {
            for master in MASTERS {
                let own = of(shell, master);
                let error = |r: &Record| (r.force / reference.force - 1.0).abs();
                let points: Vec<[f64; 2]> = own.iter().map(|r| [r.dofs as f64, error(r)]).collect();
                let rate = match own.as_slice() {
                    [.., a, b] => {
                        let finer = f64::from(b.case.intervals) / f64::from(a.case.intervals);
                        (error(a) / error(b)).ln() / finer.ln()
                    }
                    _ => continue,
                };
                curves.push(Curve {
                    shell,
                    master,
                    points,
                    rate,
                    records: own,
                });
            }
        }
        Ok(Errors { reference, curves })
    }

    /// All runs with their errors, as CSV.
    pub fn table(&self) -> String {
        let mut out = "shell,master,intervals,dofs,force,error\n".to_owned();
        for c in &self.curves {
            for (r, p) in c.records.iter().zip(&c.points) {
                let (shell, master) = (c.shell.name(), c.master.name());
                let _ = writeln!(
                    out,
                    "{shell},{master},{},{},{:.6},{:.4e}",
                    r.case.intervals, r.dofs, r.force, p[1]
                );
            }
        }
        out
    }

    /// Whether facets take force away from a shell that has too much of it on the exact ball, at the finest common mesh.
    fn cancels(&self, shell: Shell) -> Option<bool> {
        let of = |master| {
            let own = |c: &&Curve| c.shell == shell && c.master == master;
            self.curves.iter().find(own).map(|c| &c.records)
        };
        let (facets, exact) = (of(Master::Facets)?, of(Master::Nurbs)?);
        let (f, e) = (facets.iter().rev())
            .find_map(|f| Some((f, exact.iter().find(|e| e.dofs == f.dofs)?)))?;
        Some(f.force < e.force && e.force > self.reference.force)
    }

    /// What the picture shows, in numbers.
    pub fn caption(&self) -> String {
        let r = &self.reference;
        let mut parts = Vec::new();
        for c in &self.curves {
            if let Some([dofs, error]) = c.points.last() {
                parts.push(
                    format!(
                        "{} on {} {:.2} %, rate {:.1}",
                        c.shell.name(),
                        c.master.name(),
                        100.0 * error,
                        c.rate
                    ) + if parts.is_empty() {
                        format!(" ({dofs:.0} unknowns, the finest of all)")
                    } else {
                        String::new()
                    }
                    .as_str(),
                );
            }
        }
        let cancels: Vec<&str> = (SHELLS.into_iter())
            .filter(|&s| self.cancels(s).unwrap_or(false))
            .map(Shell::name)
            .collect();
        let cancels = match cancels.is_empty() {
            true => String::new(),
            false => format!(
                " Facets take force away, {} on the exact ball has too much: these errors partly cancel.",
                cancels.join(" and ")
            ),
        };
        format!(
            "Force on the ball of `ball_on_plate` at a depth of 5 mm, error against unknowns; master facets about as \
             long as the nodes of the plate are apart. At the finest meshes: {}. Reference {:.2} N, extrapolated from \
             {} on the exact ball (order {:.1}), whose finest run, with {} nodes along an edge of the quarter, is \
             {:.3} % off it.{cancels}",
            parts.join("; "),
            r.force,
            r.shell.name(),
            r.rate,
            r.intervals + 1,
            100.0 * r.own
        )
    }
}

/// Richardson's extrapolation from the last three runs, where each is twice as fine as the one before and they converge.
fn reference(runs: &[Record]) -> Option<Reference> {
    let [.., a, b, c] = runs else { return None };
    let doubled = |x: &Record, y: &Record| y.case.intervals == 2 * x.case.intervals;
    let ratio = (b.force - a.force) / (c.force - b.force);
    if !doubled(a, b) || !doubled(b, c) || ratio <= 1.0 || !ratio.is_finite() {
        return None;
    }
    let force = c.force + (c.force - b.force) / (ratio - 1.0);
    Some(Reference {
        force,
        own: (c.force / force - 1.0).abs(),
        rate: ratio.log2(),
        shell: c.case.shell,
        intervals: c.case.intervals,
    })
}
