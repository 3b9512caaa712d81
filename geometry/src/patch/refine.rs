//! Operations on knots and degree, none of which moves the surface or changes its parameters.
//!
//! They accept whatever a patch may be: knots that are not clamped, creases, a narrowed domain, weights of any size.
//! truck-geometry 0.5 inserts knots just as well (see [`to_truck`](NurbsPatch::to_truck)), but its degree elevation is right
//! for clamped knots only, needs its `optimize` afterwards, and leaves control points of weight zero where knots are not
//! clamped.

use super::{NurbsPatch, PatchError, knot_error};
use crate::basis::{Basis, KnotError, Refined};
use crate::bezier::BezierPiece;

impl NurbsPatch {
    /// The patch with more knots in direction `dir`, each strictly inside of the domain that its own knots allow, in any order and
    /// as often as it is to be inserted. A trim is kept.
    ///
    /// # Errors
    /// A knot outside, or one that would be repeated more often than the degree.
    pub fn insert_knots(&self, dir: usize, knots: &[f64]) -> Result<Self, PatchError> {
        self.refined(dir, |basis| basis.with_knots(knots))
    }

    /// The patch with the degree of direction `dir` raised `times` times; every knot is then repeated so much more often, so
    /// creases stay creases and smooth places smooth. A trim is kept.
    ///
    /// # Errors
    /// A degree above [`MAX_DEGREE`](crate::basis::MAX_DEGREE).
    pub fn elevated(&self, dir: usize, times: usize) -> Result<Self, PatchError> {
        let mut patch = self.clone();
        for _ in 0..times {
            patch = patch.refined(dir, Basis::elevated)?;
        }
        Ok(patch)
    }

    /// The patch with the ends of direction `dir`'s knots repeated `degree + 1` times, so that its outer control points lie on
    /// its edges. A domain that was narrowed keeps its ends, which are then not those of the knots. A trim is kept.
    ///
    /// # Errors
    /// Knots outside of the domain so far away that rounding spoils the new ones.
    pub fn clamped(&self, dir: usize) -> Result<Self, PatchError> {
        self.refined(dir, Basis::clamped)
    }

    /// The same surface with knots that end, clamped, where its domain does. A trim is kept.
    ///
    /// # Errors
    /// As [`clamped`](Self::clamped).
    pub fn cut_to_domain(&self) -> Result<Self, PatchError> {
        let mut patch = self.clone();
        for dir in 0..2 {
            let domain = patch.domain()[dir];
            patch = patch.clamped(dir)?;
            patch = patch.refined(dir, |basis| basis.part(domain))?;
        }
        Ok(patch)
    }

    /// The two patches on both sides of parameter `t` of direction `dir`, first the one below, each clamped at `t`.
    ///
    /// # Errors
    /// `t` not strictly inside the domain; a trimmed patch, whose loops would have to be cut.
    pub fn split(&self, dir: usize, t: f64) -> Result<[Self; 2], PatchError> {
        if self.trim.is_some() {
            return Err(PatchError::SplitTrimmed);
        }
        let dir = dir.min(1);
        let own = self.basis[dir].domain();
        if !(t > own[0] && t < own[1]) {
            let asked = [t, t];
            return Err(knot_error(dir)(KnotError::Domain { asked, own }));
        }
        let ends = self.basis[dir].own_domain();
        let below = self.refined(dir, |basis| basis.part([ends[0], t]))?;
        let above = self.refined(dir, |basis| basis.part([t, ends[1]]))?;
        Ok([below, above])
    }

    /// The patch with each of `knots` once less in direction `dir`, the inverse of [`insert_knots`](Self::insert_knots). A
    /// trim is kept.
    ///
    /// # Errors
    /// [`KnotError::Absent`] where there is no such inner knot, [`PatchError::KnotNeeded`] where the surface would change:
    /// a homogeneous control point by more than `tolerance` times the largest one.
    pub fn remove_knots(
        &self,
        dir: usize,
        knots: &[f64],
        tolerance: f64,
    ) -> Result<Self, PatchError> {
        let mut patch = self.clone();
        for &t in knots {
            patch = patch.without_knot(dir.min(1), t, tolerance)?;
        }
        Ok(patch)
    }

    /// Removes one knot: the equations of its insertion are solved for the old points from both ends inwards (Piegl and
    /// Tiller 1997, section 5.4), and the one equation that remains says whether that was possible.
    fn without_knot(&self, dir: usize, t: f64, tolerance: f64) -> Result<Self, PatchError> {
        let fine = &self.basis[dir];
        let (p, own) = (fine.degree(), fine.own_domain());
        let absent = || knot_error(dir)(KnotError::Absent { value: t });
        let at = fine
            .knots()
            .iter()
            .rposition(|&k| k == t)
            .ok_or_else(absent)?;
        if !(t > own[0] && t < own[1]) || fine.count() <= p + 1 {
            return Err(absent());
        }
        let mut knots = fine.knots().to_vec();
        knots.remove(at);
        let coarse = Basis::new(p, knots, fine.count() - 1).map_err(knot_error(dir))?;
        // Inserting `t` again gives back the fine points: fine i = a coarse i + (1 - a) coarse (i - 1) for these i.
        let Refined { rows, .. } = coarse.with_knots(&[t]).map_err(knot_error(dir))?;
        let moved = |i: &usize| rows[*i].len() == 2;
        let first = (0..rows.len()).find(moved).ok_or_else(absent)?;
        let last = (first..rows.len()).rfind(moved).unwrap_or(first);
        let share = |i: usize, k: usize| {
            let entry = rows[i].iter().find(|&&(old, _)| old == k);
            entry.map_or(0.0, |&(_, f)| f)
        };
        // The factor a falls from row to row. Where both sweeps meet at 1/2 neither divides by less.
        let middle = (first..=last).find(|&i| share(i, i) < 0.5).unwrap_or(last);
        let size = |p: &[f64; 4]| p.iter().fold(0f64, |m, x| m.max(x.abs()));
        let largest = self.points.iter().map(size).fold(0.0, f64::max);
        let mut change = 0f64;
        let mut lines = Vec::new();
        for line in self.lines(dir) {
            let mut old = vec![[0.0; 4]; rows.len() - 1];
            old[..first].copy_from_slice(&line[..first]);
            old[last..].copy_from_slice(&line[last + 1..]);
            let solve = |near: [f64; 4], fine: [f64; 4], own: f64, other: f64| {
                std::array::from_fn(|c| (fine[c] - other * near[c]) / own)
            };
            for i in first..middle {
                old[i] = solve(old[i - 1], line[i], share(i, i), share(i, i - 1));
            }
            for i in (middle + 1..=last).rev() {
                old[i - 1] = solve(old[i], line[i], share(i, i - 1), share(i, i));
            }
            for (row, fine) in rows.iter().zip(&line) {
                let again = combine(row, &old);
                let off: [f64; 4] = std::array::from_fn(|c| again[c] - fine[c]);
                change = change.max(size(&off) / largest);
            }
            lines.push(old);
        }
        if change.is_nan() || change > tolerance {
            let (direction, value) = (dir, t);
            return Err(PatchError::KnotNeeded {
                direction,
                value,
                change,
            });
        }
        let coarse = coarse.with_domain(fine.domain()).map_err(knot_error(dir))?;
        self.on_lines(dir, coarse, lines)
    }

    fn refined(
        &self,
        dir: usize,
        change: impl Fn(&Basis) -> Result<Refined, KnotError>,
    ) -> Result<Self, PatchError> {
        let dir = dir.min(1);
        let Refined { basis, rows } = change(&self.basis[dir]).map_err(knot_error(dir))?;
        let lines = self.lines(dir).map(|line| {
            let new = rows.iter().map(|row| combine(row, &line));
            new.collect::<Vec<_>>()
        });
        self.on_lines(dir, basis, lines.collect())
    }

    /// The rows of the control net along direction `dir`.
    fn lines(&self, dir: usize) -> impl Iterator<Item = Vec<[f64; 4]>> {
        let counts = self.counts();
        let strides = [1, counts[0]];
        (0..counts[1 - dir]).map(move |other| {
            let start = other * strides[1 - dir];
            let line = (0..counts[dir]).map(|k| self.points[start + k * strides[dir]]);
            line.collect()
        })
    }

    /// The patch with another basis in direction `dir` and the rows of its net along it.
    fn on_lines(
        &self,
        dir: usize,
        changed: Basis,
        lines: Vec<Vec<[f64; 4]>>,
    ) -> Result<Self, PatchError> {
        let points = if dir == 0 {
            lines.concat()
        } else {
            let across = |k| lines.iter().map(move |line: &Vec<[f64; 4]>| line[k]);
            (0..changed.count()).flat_map(across).collect()
        };
        let mut points: Vec<[f64; 4]> = points;
        if !self.rational {
            // Means of equal weights differ from them by rounding.
            points.iter_mut().for_each(|p| p[3] = self.points[0][3]);
        }
        let mut basis = self.basis.clone();
        basis[dir] = changed;
        let mut patch = Self::from_homogeneous(basis, points)?;
        patch.trim = self.trim.clone();
        Ok(patch)
    }
}

impl BezierPiece {
    /// The piece as a patch of its own, with the parameters of the one it comes from and without a trim.
    ///
    /// # Errors
    /// Fields that do not fit each other, which is not so in the pieces that a patch gives.
    pub fn patch(&self) -> Result<NurbsPatch, PatchError> {
        let basis = |dir: usize| {
            let (p, [a, b]) = (self.degree[dir], self.domain[dir]);
            let knots = [vec![a; p + 1], vec![b; p + 1]].concat();
            Basis::new(p, knots, p + 1).map_err(knot_error(dir))
        };
        NurbsPatch::from_homogeneous([basis(0)?, basis(1)?], self.points.clone())
    }
}

fn combine(row: &[(usize, f64)], points: &[[f64; 4]]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for &(k, f) in row {
        for (sum, x) in sum.iter_mut().zip(points[k]) {
            *sum += f * x;
        }
    }
    sum
}
