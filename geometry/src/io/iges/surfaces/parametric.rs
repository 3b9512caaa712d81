//! Parametric spline surfaces (114).

use super::super::curve::Stop;
use super::{BasePatch, BaseSurface, Found, SurfaceReader};
use crate::{NurbsPatch, Vec3};

/// A 114: bicubic polynomials between the break points TU(i) and TV(j) in s = u - TU(i) and t = v - TV(j), with the
/// parameters u and v.
///
/// Knots are repeated as often as the smoothness of the pieces (to what the digits of the file allow) asks for; where
/// pieces do not meet along a whole break the surface falls apart into several patches.
pub fn read(mut reader: SurfaceReader) -> Found {
    let params = &reader.params;
    let counts = [
        params.count(3, "the number M of segments in u")?,
        params.count(4, "the number N of segments in v")?,
    ];
    for (k, &count) in counts.iter().enumerate() {
        if count == 0 || count >= params.len() {
            let expected = format!(
                "a number of segments that the {} values of this entity can fill",
                params.len()
            );
            return Err(params.fail(3 + k, expected).into());
        }
    }
    let [m, n] = counts;
    let breaks = [
        params.reals(5, m + 1, "a break point TU")?,
        params.reals(6 + m, n + 1, "a break point TV")?,
    ];
    for breaks in &breaks {
        if breaks.windows(2).any(|b| b[0] >= b[1]) {
            return Err(Stop::Reason("the break points do not ascend".to_owned()));
        }
    }
    // Behind each row of pieces in v stands one that means nothing, and a whole such row behind the last; the very last
    // ones are left out by some writers.
    let first = 7 + m + n;
    let row = 48usize.saturating_mul(n + 1);
    let needed = row.saturating_mul(m) - 48;
    let values = params.reals(
        first,
        needed,
        "a coefficient of a parametric spline surface",
    )?;
    let whole = first + row * (m + 1);
    let mut pieces = Vec::with_capacity(m * n);
    for j in 0..n {
        for i in 0..m {
            let c = &values[i * row + 48 * j..][..48];
            let mut coefficients = [[Vec3::zeros(); 4]; 4];
            for (b, line) in coefficients.iter_mut().enumerate() {
                for (a, x) in line.iter_mut().enumerate() {
                    let k = 4 * b + a;
                    *x = reader.place(Vec3::new(c[k], c[16 + k], c[32 + k]));
                    if k > 0 {
                        // A vector, not a point.
                        *x -= reader.place(Vec3::zeros());
                    }
                }
            }
            pieces.push(coefficients);
        }
    }
    let spline = Spline { breaks, pieces };
    let patches = spline.patches(&mut reader)?;
    Ok((BaseSurface::Patches(patches), whole))
}

/// Coefficients of t^b s^a as `[b][a]`, pieces in u fastest.
struct Spline {
    breaks: [Vec<f64>; 2],
    pieces: Vec<[[Vec3; 4]; 4]>,
}

/// Knots of one direction, and the piece that begins at each.
#[derive(Default, Clone)]
struct Knots {
    values: Vec<f64>,
    owner: Vec<usize>,
    /// Largest jump that was taken for none.
    neglected: f64,
}

impl Spline {
    fn columns(&self) -> usize {
        self.breaks[0].len() - 1
    }

    fn piece(&self, i: usize, j: usize) -> &[[Vec3; 4]; 4] {
        &self.pieces[i + self.columns() * j]
    }

    fn degree(&self, dir: usize) -> usize {
        (1..4)
            .rev()
            .find(|&k| {
                self.pieces.iter().any(|c| {
                    (0..4).any(|l| {
                        let x = if dir == 0 { c[l][k] } else { c[k][l] };
                        x != Vec3::zeros()
                    })
                })
            })
            .unwrap_or(1)
    }

    /// Largest change of the `order`-th derivative across break `k` of direction `dir`, times the powers of the spans:
    /// what it can mean in length.
    fn jump(&self, dir: usize, k: usize, order: usize) -> f64 {
        let breaks = &self.breaks[dir];
        let step = breaks[k] - breaks[k - 1];
        let reach = step.max(breaks[k + 1] - breaks[k]);
        let across = &self.breaks[1 - dir];
        let binomial = [
            [1.0; 4],
            [1.0, 2.0, 3.0, 0.0],
            [1.0, 3.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
        ];
        let mut largest = 0.0f64;
        for l in 0..across.len() - 1 {
            let width = across[l + 1] - across[l];
            let (before, after) = if dir == 0 {
                (self.piece(k - 1, l), self.piece(k, l))
            } else {
                (self.piece(l, k - 1), self.piece(l, k))
            };
            let mut sum = 0.0;
            for other in 0..4 {
                let at = |c: &[[Vec3; 4]; 4], power: usize| {
                    if dir == 0 {
                        c[other][power]
                    } else {
                        c[power][other]
                    }
                };
                let left: Vec3 = (order..4)
                    .map(|p| {
                        at(before, p) * (binomial[order][p - order] * step.powi((p - order) as i32))
                    })
                    .sum();
                sum += (left - at(after, order)).norm() * width.powi(other as i32);
            }
            largest = largest.max(sum * reach.powi(order as i32));
        }
        largest
    }

    fn patches(&self, reader: &mut SurfaceReader) -> Result<Vec<BasePatch>, Stop> {
        let mut low = Vec3::from_element(f64::INFINITY);
        let mut high = -low;
        for c in &self.pieces {
            (low, high) = (low.inf(&c[0][0]), high.sup(&c[0][0]));
        }
        let far = low.abs().max().max(high.abs().max());
        let noise = 1e-9 * (high - low).norm().max(1e-3 * far);
        let resolution = reader.model.global.resolution.unwrap_or(0.0);
        let allowed = noise.max(resolution / reader.model.global.scale);
        let degree = [self.degree(0), self.degree(1)];
        let ranges = [0, 1].map(|dir| self.knots(dir, degree[dir], noise, allowed, reader));
        let mut patches = Vec::new();
        for along_v in &ranges[1] {
            for along_u in &ranges[0] {
                patches.push(self.patch(degree, along_u, along_v)?);
            }
        }
        Ok(patches)
    }

    /// Knot vectors of the parts into which the spline falls along one direction.
    fn knots(
        &self,
        dir: usize,
        degree: usize,
        noise: f64,
        allowed: f64,
        reader: &mut SurfaceReader,
    ) -> Vec<Knots> {
        let breaks = &self.breaks[dir];
        let last = breaks.len() - 1;
        let start = |k: usize| Knots {
            values: vec![breaks[k]; degree + 1],
            owner: vec![k; degree + 1],
            neglected: 0.0,
        };
        let mut parts = Vec::new();
        let mut part = start(0);
        for k in 1..=last {
            let mut multiplicity = degree + 1;
            if k < last {
                let gap = self.jump(dir, k, 0);
                if gap <= allowed {
                    let smooth = (1..degree)
                        .take_while(|&order| self.jump(dir, k, order) <= noise)
                        .count();
                    multiplicity = degree - smooth;
                    for order in 0..=smooth {
                        part.neglected = part.neglected.max(self.jump(dir, k, order));
                    }
                } else {
                    let name = ["u", "v"][dir];
                    reader.note(&format!(
                        "the pieces on both sides of {name} = {} lie up to {gap:.1e} apart: read as several patches",
                        breaks[k]
                    ));
                }
            }
            let owner = k.min(last - 1);
            part.values
                .extend(std::iter::repeat_n(breaks[k], multiplicity));
            part.owner.extend(std::iter::repeat_n(owner, multiplicity));
            if multiplicity > degree {
                parts.push(std::mem::replace(&mut part, start(owner)));
            }
        }
        parts
    }

    fn patch(&self, degree: [usize; 2], u: &Knots, v: &Knots) -> Result<BasePatch, Stop> {
        let count = |knots: &Knots, degree: usize| knots.values.len() - degree - 1;
        let counts = [count(u, degree[0]), count(v, degree[1])];
        let mut net = Vec::with_capacity(counts[0] * counts[1]);
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let piece = [under(u, i, degree[0]), under(v, j, degree[1])];
                let arguments = [
                    &u.values[i + 1..=i + degree[0]],
                    &v.values[j + 1..=j + degree[1]],
                ];
                net.push(self.blossom(piece, arguments));
            }
        }
        let knots = [u.values.clone(), v.values.clone()];
        let patch = NurbsPatch::new(degree, knots, counts, &net, None)?;
        let mut base = BasePatch::exact(patch);
        let size = net.iter().fold(0.0f64, |m, x| m.max(x.norm()));
        let neglected = u.neglected.max(v.neglected);
        if neglected > 1e-14 * size {
            // Each jump moves the control points beside it by at most its own size, in both directions.
            base.deviation = 8.0 * neglected;
        }
        Ok(base)
    }

    /// Polar form of a piece, in both directions.
    fn blossom(&self, [i, j]: [usize; 2], [u, v]: [&[f64]; 2]) -> Vec3 {
        let c = self.piece(i, j);
        let (a, b) = (
            polar_powers(u, self.breaks[0][i]),
            polar_powers(v, self.breaks[1][j]),
        );
        let mut sum = Vec3::zeros();
        for (line, b) in c.iter().zip(b) {
            for (x, a) in line.iter().zip(a) {
                sum += x * (a * b);
            }
        }
        sum
    }
}

/// A piece under B-spline `i`, near its middle.
fn under(knots: &Knots, i: usize, degree: usize) -> usize {
    let end = knots.values[i + degree + 1];
    let middle = (i..=i + degree.div_ceil(2))
        .rev()
        .find(|&j| knots.values[j] < end);
    knots.owner[middle.unwrap_or(i)]
}

/// Polar forms of 1, s, s^2, s^3 with s = u - start, of as many arguments as there are (1 to 3); those of powers above
/// that are zero.
fn polar_powers(u: &[f64], start: f64) -> [f64; 4] {
    let s: Vec<f64> = u.iter().map(|u| u - start).collect();
    match s[..] {
        [a] => [1.0, a, 0.0, 0.0],
        [a, b] => [1.0, 0.5 * (a + b), a * b, 0.0],
        [a, b, c] => [
            1.0,
            (a + b + c) / 3.0,
            (a * b + b * c + a * c) / 3.0,
            a * b * c,
        ],
        _ => [1.0, 0.0, 0.0, 0.0],
    }
}
