//! Ironing: a die pressed into a slab and drawn along it, in plane strain (one element across).
//!
//! ```text
//!        ( die )  --> x          V, H: forces on the slab, downwards and along the slide
//!   ------\___/------------      top: slave points
//!   |        slab          |     held below, free at both ends
//!   ------------------------
//! ```
//!
//! The problem is that of M. A. Puso and T. A. Laursen, "A mortar segment-to-segment frictional contact method for large
//! deformations", Comput. Methods Appl. Mech. Engrg. 193 (2004) 4891, in its rigid, plane version. No table of forces was
//! published, so truths that need none are held:
//!
//! - a slab that has stopped noticing its ends is the same under the die wherever that is: without friction no energy changes
//!   and the mean of H is zero;
//! - the work of H is what is dissipated and what is stored;
//! - forces are as smooth as the die is.
mod deformable;
mod rigid;
mod stiff;

use crate::support::Outcome;

/// What the slide looks like in the history.
pub struct Slide {
    /// Way slid at the end of every step, and both forces; the first entry is the start of the slide.
    pub x: Vec<f64>,
    pub h: Vec<f64>,
    pub v: Vec<f64>,
    /// Of strain and of both penalties.
    pub stored: Vec<f64>,
    pub dissipated: Vec<f64>,
}

impl Slide {
    /// From time `start` on, in which `driver`, a surface or a support, moves by `speed` along x.
    pub fn new(outcome: &Outcome, driver: &str, start: f64, speed: f64) -> Slide {
        let time = outcome.column("time");
        let first =
            (time.iter().position(|t| (t - start).abs() < 1e-9)).expect("start of the slide");
        let has = |name: &str| outcome.history.columns.iter().any(|c| c == name);
        let column = |name: &str| outcome.column(name)[first..].to_vec();
        let or_zero = |name: &str| match has(name) {
            true => column(name),
            false => vec![0.0; time.len() - first],
        };
        let mut stored = column("energy.internal");
        for name in ["energy.contact", "energy.friction"] {
            for (sum, e) in stored.iter_mut().zip(or_zero(name)) {
                *sum += e;
            }
        }
        Slide {
            x: (time[first..].iter().map(|t| speed * (t - start))).collect(),
            h: column(&format!("force.{driver}.x")),
            v: (column(&format!("force.{driver}.z")).iter().map(|f| -f)).collect(),
            stored,
            dissipated: or_zero("energy.dissipated"),
        }
    }

    /// The rows of the middle half of the slide.
    fn middle(&self) -> std::ops::Range<usize> {
        let end = self.x[self.x.len() - 1];
        let within = |x: &f64| (0.25 * end - 1e-9..=0.75 * end + 1e-9).contains(x);
        let first = self.x.iter().position(within).expect("a slide");
        let last = self.x.iter().rposition(within).expect("a slide");
        first..last + 1
    }

    /// Mean of both forces over the middle half.
    pub fn mean(&self) -> (f64, f64) {
        let mean = |f: &[f64]| f.iter().sum::<f64>() / f.len() as f64;
        let rows = self.middle();
        (mean(&self.h[rows.clone()]), mean(&self.v[rows]))
    }

    /// Means of both forces over the last `way` of the slide, by the trapezoidal rule.
    pub fn mean_of_last(&self, way: f64) -> (f64, f64) {
        let first = self.x[self.x.len() - 1] - way;
        let (mut h, mut v) = (0.0, 0.0);
        for i in 1..self.x.len() {
            let all = self.x[i] - self.x[i - 1];
            // The part of the step that counts, and how far into the step its middle is.
            let dx = (self.x[i] - first).clamp(0.0, all);
            let t = 1.0 - 0.5 * dx / all;
            h += (self.h[i - 1] + t * (self.h[i] - self.h[i - 1])) * dx;
            v += (self.v[i - 1] + t * (self.v[i] - self.v[i - 1])) * dx;
        }
        (h / way, v / way)
    }

    /// Mean of |H| over the middle half, relative to the mean of V.
    pub fn mean_abs_h(&self) -> f64 {
        let rows = self.middle();
        let sum: f64 = self.h[rows.clone()].iter().map(|h| h.abs()).sum();
        sum / rows.len() as f64 / self.mean().1
    }

    /// Peak to peak of H over the middle half, less the straight line through it that fits best (force).
    pub fn swing(&self) -> f64 {
        let rows = self.middle();
        let (x, h) = (&self.x[rows.clone()], &self.h[rows]);
        let n = x.len() as f64;
        let (mx, mh) = (x.iter().sum::<f64>() / n, h.iter().sum::<f64>() / n);
        let products = |a: &[f64], ma: f64, b: &[f64], mb: f64| -> f64 {
            (a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb))).sum()
        };
        let slope = products(x, mx, h, mh) / products(x, mx, x, mx);
        let rest = x.iter().zip(h).map(|(x, h)| h - slope * x);
        let (low, high) = rest.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), r| {
            (a.min(r), b.max(r))
        });
        high - low
    }

    /// Work of H less dissipation and change of stored energy, relative to the work of the whole slide: the sum over all
    /// steps, and the sum of the absolute values, in which nothing cancels.
    pub fn energy_residual(&self) -> (f64, f64) {
        let (mut work, mut sum, mut absolute) = (0.0, 0.0, 0.0);
        for i in 1..self.x.len() {
            let done = 0.5 * (self.h[i] + self.h[i - 1]) * (self.x[i] - self.x[i - 1]);
            let gone = self.dissipated[i] - self.dissipated[i - 1];
            let kept = self.stored[i] - self.stored[i - 1];
            let rest: f64 = done - gone - kept;
            work += done;
            sum += rest;
            absolute += rest.abs();
        }
        assert!(work > 0.0 && self.dissipated[self.x.len() - 1] > self.dissipated[0]);
        (sum / work, absolute / work)
    }
}
