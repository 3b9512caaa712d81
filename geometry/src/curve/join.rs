//! Curves made from curves: clamped, of higher degree, with more knots, reversed, moved, joined to one.

use nalgebra::SVector;

use super::{CurveError, NurbsCurve};
use crate::basis::{Basis, KnotError, MAX_DEGREE, WIDTH};

impl<const D: usize> NurbsCurve<D> {
    /// The same curve with the same parameters on clamped knots (the domain's ends repeated `degree + 1` times), of
    /// degree `degree` and with the knots `extra` (value, multiplicity) beside its own. A degree below the curve's own
    /// is taken as that; multiplicities are limited to the degree, knots outside of the domain are passed over.
    ///
    /// The new control points are values of the curve's blossom at the new knots (L. Ramshaw, "Blossoms are polar
    /// forms", 1989); a blossom of higher degree is the mean of those that leave out one of its arguments.
    ///
    /// # Errors
    /// A degree above [`MAX_DEGREE`], or knots so close that no basis stands on them.
    pub fn refined(&self, degree: usize, extra: &[(f64, usize)]) -> Result<Self, CurveError> {
        let own = self.degree();
        let degree = degree.max(own);
        if degree > MAX_DEGREE {
            return Err(KnotError::Degree { degree }.into());
        }
        let inner = inner_knots(&self.basis);
        let already = self.is_clamped() && degree == own;
        if already && extra.iter().all(|&(t, m)| has(&inner, t, m.min(own))) {
            return Ok(self.clone());
        }
        let [start, end] = self.domain();
        // A span of degree p that is smooth to order p - m stays so: m grows with the degree.
        let mut merged: Vec<(f64, usize)> = inner
            .iter()
            .map(|&(t, m)| (t, m + degree - own))
            .chain(
                extra
                    .iter()
                    .map(|&(t, m)| (t, m.min(degree)))
                    .filter(|&(t, m)| m > 0 && t > start && t < end),
            )
            .collect();
        merged.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut knots = vec![start; degree + 1];
        let mut at = 0;
        while at < merged.len() {
            let (t, mut m) = merged[at];
            at += 1;
            while at < merged.len() && merged[at].0 == t {
                m = m.max(merged[at].1);
                at += 1;
            }
            knots.extend(std::iter::repeat_n(t, m));
        }
        knots.extend(std::iter::repeat_n(end, degree + 1));
        let count = knots.len() - degree - 1;
        let points = (0..count)
            .map(|i| self.blossom(&knots[i + 1..=i + degree]))
            .collect();
        Self::from_homogeneous(Basis::new(degree, knots, count)?, points)
    }

    /// Whether the knots at both ends of the domain are repeated `degree + 1` times and nothing lies outside of them.
    pub fn is_clamped(&self) -> bool {
        let (knots, [start, end]) = (self.basis.knots(), self.domain());
        let p = self.degree();
        knots[..=p].iter().all(|&t| t == start)
            && knots[knots.len() - p - 1..].iter().all(|&t| t == end)
    }

    /// The blossom of degree `arguments.len()`, at least the curve's own and at most [`MAX_DEGREE`], of the piece in which
    /// their mean lies.
    fn blossom(&self, arguments: &[f64]) -> [f64; 4] {
        let (p, n) = (self.degree(), arguments.len());
        let mean = arguments.iter().sum::<f64>() / n as f64;
        let span = self.basis.find_span(mean);
        // All choices of p arguments as bits, each made from the one before (R. W. Gosper's step).
        let (mut choice, mut choices) = ((1u32 << p) - 1, 0.0);
        let mut sum = [0.0; 4];
        while choice < 1 << n {
            let mut chosen = [0.0; WIDTH];
            let bits = (0..n).filter(|k| choice >> k & 1 == 1);
            for (slot, k) in chosen.iter_mut().zip(bits) {
                *slot = arguments[k];
            }
            for (sum, x) in sum.iter_mut().zip(self.own_blossom(span, &chosen[..p])) {
                *sum += x;
            }
            choices += 1.0;
            let low = choice & choice.wrapping_neg();
            let next = choice + low;
            choice = (((next ^ choice) >> 2) / low) | next;
        }
        sum.map(|x| x / choices)
    }

    /// De Boor's recursion with one argument per level.
    fn own_blossom(&self, span: usize, arguments: &[f64]) -> [f64; 4] {
        let p = self.degree();
        let first = self.basis.first_function(span);
        let knots = self.basis.knots();
        let mut d = [[0.0; 4]; WIDTH];
        d[..=p].copy_from_slice(&self.points[first..=first + p]);
        for (level, &t) in arguments.iter().enumerate() {
            for j in (level + 1..=p).rev() {
                // Point j stands for the knots first + j + 1 .. first + j + p.
                let (a, b) = (knots[first + j], knots[first + j + p - level]);
                let s = (t - a) / (b - a);
                let low = d[j - 1];
                for (x, low) in d[j].iter_mut().zip(low) {
                    *x = low + (*x - low) * s;
                }
            }
        }
        d[p]
    }

    /// The curve on a part of its domain, with the same parameters.
    ///
    /// # Errors
    /// A domain that is empty or not inside that of the knots.
    pub fn with_domain(&self, domain: [f64; 2]) -> Result<Self, CurveError> {
        Ok(Self {
            basis: self.basis.with_domain(domain)?,
            points: self.points.clone(),
        })
    }

    /// The curve with its parameter moved and scaled so that its domain becomes `domain`, which must not be empty.
    ///
    /// # Errors
    /// A domain that is empty or too short for the knots.
    pub fn with_parameters(&self, domain: [f64; 2]) -> Result<Self, CurveError> {
        let own = self.domain();
        if own == domain {
            return Ok(self.clone());
        }
        let scale = (domain[1] - domain[0]) / (own[1] - own[0]);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(KnotError::Domain { asked: domain, own }.into());
        }
        let to = |t: f64| {
            if t == own[0] {
                domain[0]
            } else if t == own[1] {
                domain[1]
            } else {
                domain[0] + (t - own[0]) * scale
            }
        };
        let knots = self.basis.knots().iter().map(|&t| to(t)).collect();
        let basis = Basis::new(self.degree(), knots, self.basis.count())?.with_domain(domain)?;
        Self::from_homogeneous(basis, self.points.clone())
    }

    /// The curve with every control point mapped, weights kept: the mapped curve where the map is affine.
    ///
    /// # Errors
    /// A mapped point that is not finite.
    pub fn transformed(
        &self,
        map: &dyn Fn(SVector<f64, D>) -> SVector<f64, D>,
    ) -> Result<Self, CurveError> {
        let points = self.points.iter().map(|h| {
            let y = map(SVector::from_fn(|i, _| h[i] / h[3]));
            let mut p = [0.0, 0.0, 0.0, h[3]];
            for (p, y) in p.iter_mut().zip(y.iter()) {
                *p = y * h[3];
            }
            p
        });
        Self::from_homogeneous(self.basis.clone(), points.collect())
    }

    /// One curve of all `parts`, in order, each starting where the one before ends: clamped, of their highest degree,
    /// its knots the parts' own (the domain of a part follows that of the one before, lengths kept; the first starts
    /// where it did) and `degree`-fold where parts meet. Also returns the largest gap between parts, which is closed by
    /// starting each part at the end of the one before.
    ///
    /// # Errors
    /// No parts, a domain too short beside the others, weights that over- or underflow.
    pub fn joined(parts: &[Self]) -> Result<(Self, f64), CurveError> {
        let degree = parts.iter().map(Self::degree).max().unwrap_or(0);
        let mut knots: Vec<f64> = Vec::new();
        let mut points: Vec<[f64; 4]> = Vec::new();
        let mut gap = 0.0f64;
        for part in parts {
            let part = part.refined(degree, &[])?;
            let own = part.basis.knots();
            let Some(last) = points.last().copied() else {
                knots.extend_from_slice(&own[..own.len() - 1]);
                points.extend_from_slice(&part.points);
                continue;
            };
            let end = knots[knots.len() - 1];
            let shift = end - own[0];
            // The multiplicity of the joint is the degree: the first `degree + 1` knots and the last are left out.
            knots.extend(own[degree + 1..own.len() - 1].iter().map(|t| t + shift));
            let first = part.points[0];
            let factor = last[3] / first[3];
            gap = gap.max(
                (0..D)
                    .map(|i| (last[i] / last[3] - first[i] / first[3]).powi(2))
                    .sum::<f64>()
                    .sqrt(),
            );
            points.extend(part.points[1..].iter().map(|p| p.map(|x| x * factor)));
        }
        if let Some(&end) = knots.last() {
            knots.push(end);
        }
        let basis = Basis::new(degree, knots, points.len())?;
        Ok((Self::from_homogeneous(basis, points)?, gap))
    }
}

impl NurbsCurve<3> {
    /// The curve's projection along z.
    pub fn in_plane(&self) -> NurbsCurve<2> {
        let points = self.points.iter().map(|p| [p[0], p[1], 0.0, p[3]]);
        NurbsCurve {
            basis: self.basis.clone(),
            points: points.collect(),
        }
    }
}

/// Knots strictly inside of the domain, with their multiplicities.
pub(crate) fn inner_knots(basis: &Basis) -> Vec<(f64, usize)> {
    let [start, end] = basis.domain();
    let mut inner: Vec<(f64, usize)> = Vec::new();
    for &t in basis.knots() {
        if t <= start || t >= end {
            continue;
        }
        match inner.last_mut() {
            Some((last, m)) if *last == t => *m += 1,
            _ => inner.push((t, 1)),
        }
    }
    inner
}

fn has(inner: &[(f64, usize)], t: f64, multiplicity: usize) -> bool {
    inner.iter().any(|&(s, m)| s == t && m >= multiplicity)
}
