//! B-spline basis functions of one parameter direction.
//!
//! The functions and their derivatives come from one pass of the Cox-de Boor recursion (L. Piegl and W. Tiller, "The
//! NURBS Book", 2nd ed. 1997, eqs. 2.5 and 2.9): level `q` is made from level `q - 1`, and the m-th derivative of level
//! `q` from the (m-1)-th of level `q - 1`. The divisions by knot differences are done once per span when the basis
//! is made.

mod refine;
mod short;
mod table;

pub(crate) use refine::Refined;
pub(crate) use short::Short;
pub(crate) use table::{Lanes, TABLE_DEGREE, Table, lanes};

use num_dual::DualNum;

/// Largest polynomial degree.
pub const MAX_DEGREE: usize = 15;

/// The most functions that are not zero at a point.
pub const WIDTH: usize = MAX_DEGREE + 1;

/// Why a knot vector cannot be used. Indices count from zero.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnotError {
    /// The degree is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree} is not supported (1 to {MAX_DEGREE})")]
    Degree {
        /// The degree given.
        degree: usize,
    },
    /// Fewer than `degree + 1` control points.
    #[error("{count} control points are too few for degree {degree}")]
    Count {
        /// Control points given.
        count: usize,
        /// The degree given.
        degree: usize,
    },
    /// The knot vector does not have `count + degree + 1` entries.
    #[error("{found} knots where count + degree + 1 = {expected} are needed")]
    Length {
        /// Entries needed.
        expected: usize,
        /// Entries found.
        found: usize,
    },
    /// A knot is infinite or not a number.
    #[error("knot {index} is not a finite number")]
    NotFinite {
        /// Index of the knot.
        index: usize,
    },
    /// A knot is smaller than the one before it.
    #[error("knot {index} is smaller than the knot before it")]
    Decreasing {
        /// Index of the smaller knot.
        index: usize,
    },
    /// A knot inside the domain is so often repeated that the surface falls apart there.
    #[error(
        "knot {index} (value {value}) is repeated {multiplicity} times inside the domain, more than the degree {degree}"
    )]
    Multiplicity {
        /// Index of the first of the repeated knots.
        index: usize,
        /// Their value.
        value: f64,
        /// How many there are.
        multiplicity: usize,
        /// The most that is allowed.
        degree: usize,
    },
    /// `knots[degree] == knots[count]`.
    #[error("the domain from knot {degree} to knot {count} is empty")]
    EmptyDomain {
        /// The degree, which is the index of the domain's first knot.
        degree: usize,
        /// The number of control points, which is the index of the domain's last knot.
        count: usize,
    },
    /// Two neighbouring knots differ by so little that the reciprocal overflows.
    #[error("knots {index} and {} are too close together", index + 1)]
    TooClose {
        /// Index of the first of both.
        index: usize,
    },
    /// A knot that is to be removed is not strictly inside the knots' own domain.
    #[error("there is no inner knot {value} to remove")]
    Absent {
        /// The value asked for.
        value: f64,
    },
    /// A domain that is empty or not inside the knots' own domain.
    #[error("domain [{}, {}] is empty or not inside [{}, {}]", asked[0], asked[1], own[0], own[1])]
    Domain {
        /// The domain asked for.
        asked: [f64; 2],
        /// What the knots allow.
        own: [f64; 2],
    },
}

/// One non-empty knot span.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Span {
    /// Knot index `i` of the span `[knots[i], knots[i + 1])`.
    knot: usize,
    /// The part of it that lies in the domain.
    range: [f64; 2],
}

/// The B-spline basis of one direction: degree, knots, domain and what fast evaluation needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    degree: usize,
    count: usize,
    knots: Vec<f64>,
    domain: [f64; 2],
    spans: Vec<Span>,
    /// Reciprocals of the knot differences, `degree * (degree + 1) / 2` per span, level after level.
    inverse: Vec<f64>,
    /// Equal pieces of the domain, each with the last span that starts in a piece before it; one entry more than there
    /// are pieces.
    buckets: Vec<u32>,
    bucket_scale: f64,
}

impl Basis {
    /// Checks a full knot vector (`count + degree + 1` entries, clamped or not, first and last knot included).
    /// The domain is `[knots[degree], knots[count]]`.
    pub fn new(degree: usize, knots: Vec<f64>, count: usize) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(KnotError::Degree { degree });
        }
        if count <= degree {
            return Err(KnotError::Count { count, degree });
        }
        let expected = count.saturating_add(degree + 1);
        if knots.len() != expected {
            return Err(KnotError::Length {
                expected,
                found: knots.len(),
            });
        }
        if let Some(index) = knots.iter().position(|t| !t.is_finite()) {
            return Err(KnotError::NotFinite { index });
        }
        if let Some(index) = (1..knots.len()).find(|&i| knots[i] < knots[i - 1]) {
            return Err(KnotError::Decreasing { index });
        }
        let domain = [knots[degree], knots[count]];
        if domain[0] >= domain[1] {
            return Err(KnotError::EmptyDomain { degree, count });
        }
        let mut index = 0;
        while index < knots.len() {
            let value = knots[index];
            let multiplicity = knots[index..].iter().take_while(|&&t| t == value).count();
            if multiplicity > degree && value > domain[0] && value < domain[1] {
                return Err(KnotError::Multiplicity {
                    index,
                    value,
                    multiplicity,
                    degree,
                });
            }
            index += multiplicity;
        }
        Self::build(degree, knots, count, domain)
    }

    /// The same functions on a smaller domain. Ends that stick out of the knots' own domain by rounding (1e-9 of
    /// its length) are moved onto it.
    pub fn with_domain(&self, asked: [f64; 2]) -> Result<Self, KnotError> {
        let own = [self.knots[self.degree], self.knots[self.count]];
        let slack = 1e-9 * (own[1] - own[0]);
        let domain = [asked[0].max(own[0]), asked[1].min(own[1])];
        // Written so that NaN fails too.
        let inside = asked[0] >= own[0] - slack && asked[1] <= own[1] + slack;
        if !(inside && domain[0] < domain[1]) {
            return Err(KnotError::Domain { asked, own });
        }
        Self::build(self.degree, self.knots.clone(), self.count, domain)
    }

    fn build(
        degree: usize,
        knots: Vec<f64>,
        count: usize,
        domain: [f64; 2],
    ) -> Result<Self, KnotError> {
        let mut spans = Vec::new();
        let mut inverse = Vec::new();
        for i in degree..count {
            let range = [knots[i].max(domain[0]), knots[i + 1].min(domain[1])];
            if knots[i] >= knots[i + 1] || range[0] >= range[1] {
                continue;
            }
            spans.push(Span { knot: i, range });
            for q in 1..=degree {
                for r in 0..q {
                    let inv = 1.0 / (knots[i + 1 + r] - knots[i + 1 + r - q]);
                    if !inv.is_finite() || inv == 0.0 {
                        return Err(KnotError::TooClose { index: i });
                    }
                    inverse.push(inv);
                }
            }
        }
        let pieces = (2 * spans.len()).next_power_of_two();
        let bucket_scale = pieces as f64 / (domain[1] - domain[0]);
        // The number of the piece grows with the parameter, rounding included, so what starts in a piece before lies
        // below all parameters of this piece.
        let mut buckets = Vec::with_capacity(pieces + 1);
        let mut span = 0;
        for piece in 0..=pieces {
            while span + 1 < spans.len()
                && bucket(spans[span + 1].range[0], domain[0], bucket_scale, pieces) < piece
            {
                span += 1;
            }
            buckets.push(span as u32);
        }
        Ok(Self {
            degree,
            count,
            knots,
            domain,
            spans,
            inverse,
            buckets,
            bucket_scale,
        })
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of basis functions (control points).
    pub fn count(&self) -> usize {
        self.count
    }

    /// The full knot vector.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Where the functions are evaluated.
    pub fn domain(&self) -> [f64; 2] {
        self.domain
    }

    /// Number of non-empty spans in the domain.
    pub fn span_count(&self) -> usize {
        self.spans.len()
    }

    /// The part of span `span` that lies in the domain; the last span for numbers past the end.
    pub fn span_range(&self, span: usize) -> [f64; 2] {
        self.span(span).range
    }

    /// Index of the first of the `degree + 1` functions that are not zero in span `span`.
    pub fn first_function(&self, span: usize) -> usize {
        self.span(span).knot - self.degree
    }

    #[inline]
    fn span(&self, span: usize) -> &Span {
        &self.spans[span.min(self.spans.len() - 1)]
    }

    /// `t`, moved onto the domain if it lies outside by no more than rounding (1e-12 of the domain's length).
    #[inline]
    pub fn snap(&self, t: f64) -> f64 {
        let [a, b] = self.domain;
        let slack = 1e-12 * (b - a);
        if t < a && t >= a - slack {
            a
        } else if t > b && t <= b + slack {
            b
        } else {
            t
        }
    }

    /// Number of the non-empty span with `start <= t < end`: at an inner knot the span to its right. The last span
    /// at the end of the domain; the nearest one outside of it.
    #[inline]
    pub fn find_span(&self, t: f64) -> usize {
        let pieces = self.buckets.len() - 1;
        let piece = bucket(t, self.domain[0], self.bucket_scale, pieces);
        let (mut low, mut high) = (
            self.buckets[piece] as usize,
            self.buckets[piece + 1] as usize,
        );
        while high - low > 1 {
            let middle = (low + high) / 2;
            if self.spans[middle].range[0] <= t {
                low = middle;
            } else {
                high = middle;
            }
        }
        // Without a jump, which would be guessed wrong every other time.
        let after = usize::from(self.spans[high].range[0] <= t);
        low + (after & (high - low))
    }

    /// As [`find_span`](Self::find_span) with `start < t <= end`: at an inner knot the span to its left.
    pub fn find_span_left(&self, t: f64) -> usize {
        let span = self.find_span(t);
        if span > 0 && t <= self.spans[span].range[0] {
            span - 1
        } else {
            span
        }
    }

    /// Knots strictly inside the domain that are repeated `degree` times or more: only the value of a spline is
    /// continuous there.
    pub fn crease_knots(&self) -> Vec<f64> {
        let mut creases = Vec::new();
        for pair in self.spans.windows(2) {
            let t = pair[0].range[1];
            // The knots between the spans `i` and `k` are i+1 ..= k.
            if pair[1].knot - pair[0].knot >= self.degree {
                creases.push(t);
            }
        }
        creases
    }

    /// Values and derivatives of the `degree + 1` functions that are not zero in span `span`, at `t`: `out[m][r]` is
    /// the m-th derivative of function `first_function(span) + r`. Outside of the span its polynomials are continued.
    /// `K` is the highest derivative plus one; entries beyond the degree are left as they are.
    #[inline]
    pub fn evaluate<D: DualNum<f64> + Copy, const K: usize>(
        &self,
        span: usize,
        t: D,
        out: &mut [[D; WIDTH]; K],
    ) {
        const { assert!(K > 0, "room for the functions themselves") };
        let (knots, inverse) = self.span_data(span);
        recursion(self.degree, knots, inverse, t, out);
    }

    /// [`evaluate`](Self::evaluate) for degrees up to 5.
    #[inline]
    pub(crate) fn evaluate_short<const K: usize>(&self, span: usize, t: f64, out: &mut Short<K>) {
        let (knots, inverse) = self.span_data(span);
        match self.degree {
            1 => short::evaluate::<1, K>(knots, inverse, t, out),
            2 => short::evaluate::<2, K>(knots, inverse, t, out),
            3 => short::evaluate::<3, K>(knots, inverse, t, out),
            4 => short::evaluate::<4, K>(knots, inverse, t, out),
            _ => short::evaluate::<5, K>(knots, inverse, t, out),
        }
    }

    /// The 2 * degree knots around a span, and its reciprocals.
    #[inline]
    fn span_data(&self, span: usize) -> (&[f64], &[f64]) {
        let span = span.min(self.spans.len() - 1);
        let p = self.degree;
        let size = p * (p + 1) / 2;
        let i = self.spans[span].knot;
        (
            &self.knots[i + 1 - p..i + 1 + p],
            &self.inverse[span * size..(span + 1) * size],
        )
    }

    /// Coefficients that give the Bezier points of the spline on `range`, a part of span `span`:
    /// `b_k = sum_r out[k][r] d_(first_function + r)`. They are values of the blossom with arguments `a` (degree - k
    /// times) and `b` (k times), L. Ramshaw, "Blossoms are polar forms" (1989); inside the span every step of its
    /// evaluation is a convex combination.
    pub(crate) fn bezier_coefficients(
        &self,
        span: usize,
        range: [f64; 2],
        out: &mut [[f64; WIDTH]; WIDTH],
    ) {
        let p = self.degree;
        let (knots, inverse) = self.span_data(span);
        for (k, row) in out.iter_mut().enumerate().take(p + 1) {
            *row = [0.0; WIDTH];
            row[0] = 1.0;
            let mut offset = 0;
            for q in 1..=p {
                let t = if q <= p - k { range[0] } else { range[1] };
                let mut saved = 0.0;
                for r in 0..q {
                    let scaled = row[r] * inverse[offset + r];
                    row[r] = saved + (knots[p + r] - t) * scaled;
                    saved = (t - knots[p + r - q]) * scaled;
                }
                row[q] = saved;
                offset += q;
            }
        }
    }
}

/// The piece of the domain in which `t` lies; the nearest one outside.
#[inline(always)]
fn bucket(t: f64, start: f64, scale: f64, pieces: usize) -> usize {
    // The cast takes NaN and negative values to zero.
    (((t - start) * scale) as u32 as usize).min(pieces - 1)
}

/// The recursion from level 0 to level `p`. `knots[p - 1]` and `knots[p]` are the ends of the span.
#[inline]
fn recursion<D: DualNum<f64> + Copy, const K: usize>(
    p: usize,
    knots: &[f64],
    inverse: &[f64],
    t: D,
    out: &mut [[D; WIDTH]; K],
) {
    let zero = D::from(0.0);
    for row in out.iter_mut() {
        for value in row.iter_mut().take(p + 1) {
            *value = zero;
        }
    }
    out[0][0] = D::from(1.0);
    let knots = &knots[..2 * p];
    let inverse = &inverse[..p * (p + 1) / 2];
    let mut offset = 0;
    for q in 1..=p {
        let inv = &inverse[offset..offset + q];
        // Derivatives that the levels above still need; highest first, for each is made from the one below it.
        for m in (1..K).rev() {
            if m > q || m + p >= K + q {
                continue;
            }
            let mut saved = zero;
            for r in 0..q {
                let scaled = out[m - 1][r] * (inv[r] * q as f64);
                out[m][r] = saved - scaled;
                saved = scaled;
            }
            out[m][q] = saved;
        }
        let mut saved = zero;
        for r in 0..q {
            let scaled = out[0][r] * inv[r];
            out[0][r] = saved + (-t + knots[p + r]) * scaled;
            saved = (t - knots[p + r - q]) * scaled;
        }
        out[0][q] = saved;
        offset += q;
    }
}
