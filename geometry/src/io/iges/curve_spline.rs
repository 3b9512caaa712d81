//! Parametric splines (112) and rational B-splines (126).

use super::curve::{Reader, Shape, Stop};
use super::directory::Entry;
use super::params::Params;
use crate::basis::Basis;
use crate::io::brep::{merge_close, pieces};
use crate::{NurbsCurve, Vec3};

/// Values of a 126 up to its first knot: type, K, M, PROP1 to PROP4.
const HEADER: usize = 7;

/// A 126, with its own parameter. Where a knot inside is repeated more often than the degree the curve is in pieces.
pub fn rational(reader: &mut Reader, entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    let count = params.count(1, "the upper index K")?;
    let degree = params.count(2, "the degree M")?;
    if count >= params.len() {
        let expected = format!(
            "an upper index K that the {} values of this entity can fill",
            params.len()
        );
        return Err(params.fail(1, expected).into());
    }
    let count = count + 1;
    if degree == 0 || degree >= count {
        let expected = format!("a degree M from 1 to K = {}", count - 1);
        return Err(params.fail(2, expected).into());
    }
    for i in 3..HEADER {
        // PROP1 to PROP4 say nothing that the data does not say, but a number that is none is damage.
        params.integer(i, "a property flag")?;
    }
    let knot_count = count + degree + 1;
    let mut knots = params.reals(HEADER, knot_count, "a knot")?;
    let at = HEADER + knot_count;
    let weights = params.reals(at, count, "a weight")?;
    let at = at + count;
    let x = params.reals(at, 3 * count, "a coordinate of a control point")?;
    let at = at + 3 * count;
    let range = params.reals(at, 2, "a limit of the parameter range V0, V1")?;
    let moved = merge_close(&mut knots);
    if moved > 0 {
        reader.note(entry, &format!("{moved} knots moved onto their neighbour"));
    }
    if let Some(k) = weights.iter().position(|&w| w <= 0.0) {
        let reason = format!("weight {} of control point {k} is not positive", weights[k]);
        return Err(Stop::Reason(reason));
    }
    // Equal weights mean a polynomial, whatever their value.
    let same = weights.iter().all(|&w| w == weights[0]);
    let points: Vec<[f64; 4]> = x
        .chunks_exact(3)
        .zip(&weights)
        .map(|(c, &w)| {
            let w = if same { 1.0 } else { w };
            [c[0] * w, c[1] * w, c[2] * w, w]
        })
        .collect();
    let mut shapes = Vec::new();
    for piece in pieces(degree, &knots, count) {
        let own = knots[piece.start..piece.end + degree + 1].to_vec();
        let basis = Basis::new(degree, own, piece.len()).map_err(|e| e.to_string())?;
        shapes.push(NurbsCurve::from_homogeneous(basis, points[piece].to_vec())?);
    }
    if shapes.len() > 1 {
        let text = format!(
            "knots repeated more often than the degree {degree}: read as {} curves",
            shapes.len()
        );
        reader.note(entry, &text);
    }
    restricted(reader, entry, shapes, [range[0], range[1]])
}

/// Cuts the curves at the parameter range V0, V1 of the file.
fn restricted(
    reader: &mut Reader,
    entry: &Entry,
    curves: Vec<NurbsCurve<3>>,
    [mut from, mut to]: [f64; 2],
) -> Result<Vec<Shape>, Stop> {
    let (Some(first), Some(last)) = (curves.first(), curves.last()) else {
        return Err(Stop::Reason("a spline without spans".to_owned()));
    };
    let (start, end) = (first.domain()[0], last.domain()[1]);
    if from == to {
        reader.note(
            entry,
            "the parameter range V0, V1 is empty; the knots' range was used",
        );
        (from, to) = (start, end);
    }
    let backwards = from > to;
    if backwards {
        reader.note(
            entry,
            &format!(
                "the parameter range V0 = {from}, V1 = {to} runs backwards, and so does the curve"
            ),
        );
        (from, to) = (to, from);
    }
    if to <= start || from >= end {
        return Err(Stop::Reason(format!(
            "the parameter range V = {from} to {to} lies outside of the knots' range {start} to {end}"
        )));
    }
    let slack = 1e-8 * (end - start);
    if from < start - slack || to > end + slack {
        let text = format!(
            "the parameter range V = {from} to {to} exceeds the knots' range {start} to {end}, where the curve ends"
        );
        reader.note(entry, &text);
    }
    let mut shapes = Vec::with_capacity(curves.len());
    for curve in curves {
        let [a, b] = curve.domain();
        let low = if from <= a + slack { a } else { from };
        let high = if to >= b - slack { b } else { to };
        if low >= high {
            continue;
        }
        let curve = if [low, high] == [a, b] {
            curve
        } else {
            curve.with_domain([low, high])?
        };
        shapes.push(Shape::exact(curve));
    }
    if backwards {
        shapes.reverse();
        for shape in &mut shapes {
            // The file's parameter grows with the curve's direction: its range is the same, mirrored.
            *shape = Shape::exact(shape.curve.reversed()?);
        }
    }
    Ok(shapes)
}

/// A 112: polynomials A + B s + C s^2 + D s^3, s = u - T(i), between the break points T(i). Its parameter is u.
///
/// Where the derivatives up to an order agree on both sides of a break (to what the digits of the file allow) the spline
/// is made so smooth; where the pieces do not meet it falls apart into several curves.
pub fn parametric(reader: &mut Reader, entry: &Entry, params: &Params) -> Result<Vec<Shape>, Stop> {
    let dimension = params.integer(3, "the number NDIM of dimensions")?;
    let segments = params.count(4, "the number N of segments")?;
    if segments == 0 || segments >= params.len() {
        let expected = format!(
            "a number N of segments that the {} values of this entity can fill",
            params.len()
        );
        return Err(params.fail(4, expected).into());
    }
    let breaks = params.reals(5, segments + 1, "a break point")?;
    let numbers = params.reals(6 + segments, 12 * segments, "a coefficient")?;
    if let Some(k) = (0..segments).find(|&k| breaks[k] >= breaks[k + 1]) {
        let reason = format!("the break points {k} and {} do not ascend", k + 1);
        return Err(Stop::Reason(reason));
    }
    let polynomials: Vec<[Vec3; 4]> = numbers
        .chunks_exact(12)
        .map(|c| {
            // Coefficients by coordinate; a planar spline has a constant z.
            let z = |k: usize| {
                if dimension == 2 && k > 0 {
                    0.0
                } else {
                    c[8 + k]
                }
            };
            [0, 1, 2, 3].map(|k| Vec3::new(c[k], c[4 + k], z(k)))
        })
        .collect();
    let spline = Polynomials {
        breaks,
        polynomials,
    };
    spline.curves(reader, entry)
}

struct Polynomials {
    breaks: Vec<f64>,
    polynomials: Vec<[Vec3; 4]>,
}

impl Polynomials {
    fn degree(&self) -> usize {
        (1..4)
            .rev()
            .find(|&k| self.polynomials.iter().any(|p| p[k] != Vec3::zeros()))
            .unwrap_or(1)
    }

    /// Value and derivatives, each divided by the factorial of its order, of piece `i` at `u`.
    fn taylor(&self, i: usize, u: f64) -> [Vec3; 4] {
        let [a, b, c, d] = self.polynomials[i];
        let s = u - self.breaks[i];
        [
            a + (b + (c + d * s) * s) * s,
            b + (c * 2.0 + d * (3.0 * s)) * s,
            c + d * (3.0 * s),
            d,
        ]
    }

    /// Polar form of piece `i` at `u`, as many arguments as the degree.
    fn blossom(&self, i: usize, u: &[f64]) -> Vec3 {
        let [a, b, c, d] = self.polynomials[i];
        let s = |k: usize| u[k] - self.breaks[i];
        match u.len() {
            1 => a + b * s(0),
            2 => a + b * (0.5 * (s(0) + s(1))) + c * (s(0) * s(1)),
            _ => {
                let pairs = s(0) * s(1) + s(1) * s(2) + s(0) * s(2);
                a + b * ((s(0) + s(1) + s(2)) / 3.0) + c * (pairs / 3.0) + d * (s(0) * s(1) * s(2))
            }
        }
    }

    fn curves(&self, reader: &mut Reader, entry: &Entry) -> Result<Vec<Shape>, Stop> {
        let degree = self.degree();
        let n = self.polynomials.len();
        let (mut low, mut high) = (self.polynomials[0][0], self.polynomials[0][0]);
        for i in 0..n {
            for u in [self.breaks[i], self.breaks[i + 1]] {
                let x = self.taylor(i, u)[0];
                (low, high) = (low.inf(&x), high.sup(&x));
            }
        }
        // Differences in the last digits that writers print.
        let noise = 1e-9
            * (high - low)
                .norm()
                .max(1e-3 * low.abs().max().max(high.abs().max()));
        let gap_allowed = noise.max(reader.resolution());
        let mut shapes = Vec::new();
        let mut knots = vec![self.breaks[0]; degree + 1];
        let mut owner = vec![0; degree + 1];
        let mut neglected = 0.0f64;
        for i in 1..=n {
            let u = self.breaks[i];
            let mut multiplicity = degree + 1;
            if i < n {
                let (left, right) = (self.taylor(i - 1, u), self.taylor(i, u));
                let h = (u - self.breaks[i - 1]).max(self.breaks[i + 1] - u);
                let jump = |k: usize| (left[k] - right[k]).norm() * h.powi(k as i32);
                if jump(0) <= gap_allowed {
                    let smooth = (1..degree).take_while(|&k| jump(k) <= noise).count();
                    multiplicity = degree - smooth;
                    neglected = (0..=smooth).map(jump).fold(neglected, f64::max);
                } else {
                    let text = format!(
                        "the pieces {} and {} lie {:.1e} apart: read as curves of their own",
                        i,
                        i + 1,
                        jump(0)
                    );
                    reader.note(entry, &text);
                }
            }
            knots.extend(std::iter::repeat_n(u, multiplicity));
            owner.extend(std::iter::repeat_n(i.min(n - 1), multiplicity));
            if multiplicity > degree {
                shapes.push(self.shape(degree, &knots, &owner, neglected)?);
                knots = vec![u; degree + 1];
                owner = vec![i.min(n - 1); degree + 1];
                neglected = 0.0;
            }
        }
        Ok(shapes)
    }

    /// The spline on `knots`; `owner` is the piece that begins at each knot.
    fn shape(
        &self,
        degree: usize,
        knots: &[f64],
        owner: &[usize],
        neglected: f64,
    ) -> Result<Shape, Stop> {
        let count = knots.len() - degree - 1;
        let points: Vec<Vec3> = (0..count)
            .map(|i| {
                // Any piece under the function will do; the middle one extrapolates least.
                let middle = (i..=i + degree.div_ceil(2))
                    .rev()
                    .find(|&j| knots[j] < knots[i + degree + 1]);
                let piece = owner[middle.unwrap_or(i)];
                self.blossom(piece, &knots[i + 1..=i + degree])
            })
            .collect();
        let curve = NurbsCurve::new(degree, knots.to_vec(), &points, None)?;
        let mut shape = Shape::exact(curve);
        // Each jump moves control points next to it by at most its own size, a few of them in one span.
        shape.deviation = if neglected > 1e-14 * points.iter().fold(0.0f64, |m, x| m.max(x.norm()))
        {
            4.0 * neglected
        } else {
            0.0
        };
        Ok(shape)
    }
}
