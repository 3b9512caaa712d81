//! The reference, and the errors against it.
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

/// Forces of the whole plate (N) at 2.5, 5, 7.5 and 10 mm: `ball_on_plate` with 50 x 50 and 80 x 80 linear elements; an
/// independent program gives the same on the finer mesh (see `tests/verification/plate_under_ball.rs`).
const FINE: [[f64; 4]; 2] = [
    [624.0, 2553.0, 7255.0, 16590.0],
    [622.0, 2549.9, 7248.0, 16577.1],
];

/// The reference values.
pub struct Reference {
    pub forces: [f64; 4],
    /// Estimated error of the finer run that they are extrapolated from, the mean of the four depths.
    pub own: f64,
}

impl Reference {
    /// Richardson's extrapolation of both meshes with the order 2 of linear elements.
    fn new() -> Self {
        let [coarse, fine] = FINE;
        let gain = (80.0f64 / 50.0).powi(2) - 1.0;
        let forces = std::array::from_fn(|k| fine[k] + (fine[k] - coarse[k]) / gain);
        Reference {
            own: mean(&fine, &forces, f64::abs),
            forces,
        }
    }
}

/// Mean over the depths of a function of the relative difference.
fn mean(forces: &[f64; 4], reference: &[f64; 4], of: impl Fn(f64) -> f64) -> f64 {
    let all = forces.iter().zip(reference);
    all.map(|(f, r)| of(f / r - 1.0)).sum::<f64>() / 4.0
}

/// Everything that is drawn.
pub struct Errors {
    pub reference: Reference,
    pub curves: Vec<Curve>,
}

impl Errors {
    /// Errors of all runs: means over the four depths.
    pub fn new(records: &[Record]) -> Self {
        let of = |shell: Shell, master: Master| {
            let mut own: Vec<Record> = (records.iter().copied())
                .filter(|r| r.case.shell == shell && r.case.master == master)
                .collect();
            own.sort_by_key(|r| r.case.intervals);
            own
        };
        let reference = Reference::new();
        let mut curves = Vec::new();
        for shell in SHELLS {
            for master in MASTERS {
                let own = of(shell, master);
                let error = |r: &Record| mean(&r.forces, &reference.forces, f64::abs);
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
        Errors { reference, curves }
    }

    /// All runs with their errors, as CSV.
    pub fn table(&self) -> String {
        let mut out =
            "shell,master,intervals,dofs,force_2.5,force_5,force_7.5,force_10,error\n".to_owned();
        for c in &self.curves {
            for (r, p) in c.records.iter().zip(&c.points) {
                let (shell, master) = (c.shell.name(), c.master.name());
                let _ = writeln!(
                    out,
                    "{shell},{master},{},{},{},{:.4e}",
                    r.case.intervals,
                    r.dofs,
                    r.forces.map(|f| format!("{f:.3}")).join(","),
                    p[1]
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
        let shift = mean(&f.forces, &e.forces, |x| x);
        let excess = mean(&e.forces, &self.reference.forces, |x| x);
        Some(shift < 0.0 && excess > 0.0)
    }

    /// What the picture shows, in numbers.
    pub fn caption(&self) -> String {
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
                " Facets take force away, and {} shells have too much of it on the exact ball: these errors partly cancel.",
                cancels.join(" and ")
            ),
        };
        format!(
            "Force on the ball of `ball_on_plate`, error (mean of four depths) against unknowns; master facets about as \
             long as the nodes of the plate are apart. At the finest meshes: {}. The reference is extrapolated from \
             50 x 50 and 80 x 80 linear elements on the exact ball, the finer of which is {:.2} % off it.{cancels}",
            parts.join("; "),
            100.0 * self.reference.own
        )
    }
}
