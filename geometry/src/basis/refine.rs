//! Other bases for the same splines: finer knots, a higher degree.
//!
//! A control point of a spline in another basis is a value of the spline's blossom at the knots between the ends of that
//! point's function (L. Ramshaw, "Blossoms are polar forms", 1989). Those values come from the Oslo algorithm (E. Cohen,
//! T. Lyche and R. Riesenfeld, "Discrete B-splines and subdivision techniques", 1980), which only makes convex
//! combinations: no accuracy is lost, however unequal the spans are. Unlike truck-geometry's, these operations accept knots that
//! are not clamped.

use super::{Basis, KnotError};

/// The control points of the new basis: each is a sum of neighbouring old ones.
#[derive(Debug)]
pub(crate) struct Refined {
    pub basis: Basis,
    pub rows: Vec<Row>,
}

/// One new control point: numbers of old ones with their factors.
pub(crate) type Row = Vec<(usize, f64)>;

impl Basis {
    /// Where the knots allow evaluation: `[knots[degree], knots[count]]`, the domain before it was narrowed.
    pub(crate) fn own_domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.count]]
    }

    /// With more knots, each strictly inside of the knots' own domain.
    pub(crate) fn with_knots(&self, more: &[f64]) -> Result<Refined, KnotError> {
        let own = self.own_domain();
        if let Some(&t) = more.iter().find(|&&t| !(t > own[0] && t < own[1])) {
            let asked = [t, t];
            return Err(KnotError::Domain { asked, own });
        }
        let mut knots = self.knots.clone();
        knots.extend_from_slice(more);
        knots.sort_by(f64::total_cmp);
        self.on_knots(knots)
    }

    /// With both ends of the knots' own domain repeated `degree + 1` times.
    pub(crate) fn clamped(&self) -> Result<Refined, KnotError> {
        let own = self.own_domain();
        let ends = |t: f64| std::iter::repeat_n(t, self.degree + 1);
        let inside = self.knots.iter().copied();
        let inside = inside.filter(|&t| t > own[0] && t < own[1]);
        let knots = ends(own[0]).chain(inside).chain(ends(own[1])).collect();
        self.on_knots(knots)
    }

    /// The part of the knots' own domain between `a` and `b`, clamped at both where they are inner points.
    pub(crate) fn part(&self, [a, b]: [f64; 2]) -> Result<Refined, KnotError> {
        let own = self.own_domain();
        let p = self.degree;
        let mut knots = Vec::with_capacity(self.knots.len() + 2 * p);
        if a > own[0] {
            knots.extend(std::iter::repeat_n(a, p + 1));
        } else {
            knots.extend(self.knots.iter().take_while(|&&t| t <= a));
        }
        knots.extend(self.knots.iter().filter(|&&t| t > a && t < b));
        if b < own[1] {
            knots.extend(std::iter::repeat_n(b, p + 1));
        } else {
            knots.extend(self.knots.iter().skip_while(|&&t| t < b));
        }
        self.on_knots(knots)
    }

    /// The same splines on `knots`, whose domain must lie in this one's and which must hold every knot inside of it as
    /// often as here. The narrowed domain is kept.
    fn on_knots(&self, knots: Vec<f64>) -> Result<Refined, KnotError> {
        let p = self.degree;
        let count = knots.len().saturating_sub(p + 1);
        let basis = Self::new(p, knots, count)?.narrowed_as(self)?;
        let mut part = vec![0.0; p + 1];
        let rows = (0..count)
            .map(|i| {
                let mut row = Row::new();
                let first = self.blossom(basis.knots[i], &basis.knots[i + 1..=i + p], &mut part);
                self.add(&mut row, first, &part, 1.0);
                row
            })
            .collect();
        Ok(Refined { basis, rows })
    }

    /// The same splines with the degree raised by one: every knot once more, and each blossom value the mean of those
    /// that leave one argument out (Ramshaw 1989, section 7).
    pub(crate) fn elevated(&self) -> Result<Refined, KnotError> {
        let (p, own) = (self.degree, self.own_domain());
        let mut knots = Vec::with_capacity(2 * self.knots.len());
        for (k, &t) in self.knots.iter().enumerate() {
            if k == 0 || self.knots[k - 1] < t {
                knots.push(t);
            }
            knots.push(t);
        }
        // Of the knots up to the start of the domain as many as the new degree asks for, likewise at its end.
        let before = knots.partition_point(|&t| t <= own[0]);
        let behind = knots.len() - knots.partition_point(|&t| t < own[1]);
        let excess = |n: usize| n.saturating_sub(p + 2);
        let knots = knots[excess(before)..knots.len() - excess(behind)].to_vec();
        let count = knots.len().saturating_sub(p + 2);
        let basis = Self::new(p + 1, knots, count)?.narrowed_as(self)?;
        let mut rows = Vec::with_capacity(count);
        let mut arguments = Vec::with_capacity(p);
        let mut part = vec![0.0; p + 1];
        for i in 0..count {
            let knots = &basis.knots[i + 1..=i + p + 1];
            let mut row = Row::new();
            for omitted in 0..=p {
                arguments.clear();
                arguments.extend(knots.iter().take(omitted));
                arguments.extend(knots.iter().skip(omitted + 1));
                let first = self.blossom(self.before(&arguments), &arguments, &mut part);
                self.add(&mut row, first, &part, 1.0 / (p + 1) as f64);
            }
            rows.push(row);
        }
        Ok(Refined { basis, rows })
    }

    /// The knot before the first argument once the arguments are among the knots.
    fn before(&self, arguments: &[f64]) -> f64 {
        let t = arguments[0];
        let here = |knots: &[f64]| knots.iter().filter(|&&k| k == t).count();
        // Arguments that go on past `t` follow its last copies; otherwise any copies will do, and the first ones are
        // those of a function that reaches into the span to the left.
        if here(arguments) < arguments.len() && here(&self.knots) > here(arguments) {
            return t;
        }
        let below = self.knots.partition_point(|&k| k < t);
        self.knots[below.saturating_sub(1)]
    }

    /// Factors of `degree + 1` control points in the blossom value at `arguments`, in order, which together with the knot
    /// `before` them are knots of a refinement. Returns the number of the first point, below zero where that point and
    /// others do not exist; their factors are zero.
    fn blossom(&self, before: f64, arguments: &[f64], row: &mut [f64]) -> isize {
        let last = self.knots.len() - 1;
        let beyond = self.knots[last] - self.knots[0];
        let knot = |k: isize| match usize::try_from(k) {
            Err(_) => self.knots[0] + beyond * k as f64,
            Ok(k) if k > last => self.knots[last] + beyond * (k - last) as f64,
            Ok(k) => self.knots[k],
        };
        // The span that holds the knot in front, where the recursion stays convex.
        let mu = self.knots.partition_point(|&t| t <= before).max(1) as isize - 1;
        row.fill(0.0);
        row[0] = 1.0;
        for (q, &t) in (1..).zip(arguments) {
            let mut saved = 0.0;
            for r in 0..q {
                let above = mu + 1 + r as isize;
                let (low, high) = (knot(above - q as isize), knot(above));
                let value = row[r];
                // Quotients of equal numbers are exactly one, so points that stay are not touched by rounding.
                row[r] = saved + (high - t) / (high - low) * value;
                saved = (t - low) / (high - low) * value;
            }
            row[q] = saved;
        }
        mu - self.degree as isize
    }

    /// Adds `factor` times the points `first..` weighted with `part` to a row, leaving out points that do not exist.
    fn add(&self, sum: &mut Row, first: isize, part: &[f64], factor: f64) {
        let points = (first..).zip(part);
        for (k, &x) in points.filter(|&(_, &x)| x != 0.0) {
            let Some(k) = usize::try_from(k).ok().filter(|&k| k < self.count) else {
                continue;
            };
            match sum.iter_mut().find(|(other, _)| *other == k) {
                Some((_, sum)) => *sum += factor * x,
                None => sum.push((k, factor * x)),
            }
        }
    }

    /// Cut at the part of `other`'s domain that is left of it, where that is narrower than its knots allow.
    fn narrowed_as(self, other: &Self) -> Result<Self, KnotError> {
        let own = self.own_domain();
        let [a, b] = other.domain;
        if a <= own[0] && b >= own[1] {
            return Ok(self);
        }
        self.with_domain([a.max(own[0]), b.min(own[1])])
    }
}
