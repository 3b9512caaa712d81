//! Parameters of the file against those of the NURBS form. IGES gives every curve its own parameter (an arc's is the
//! angle), and trims and other entities refer to that one; a rational form runs through the same points at other
//! parameters.

use std::f64::consts::TAU;

/// One piece of a [`ParameterMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    /// Range of the file's parameter, ascending.
    file: [f64; 2],
    /// Range of the NURBS form's parameter, ascending or, in a piece run through backwards, descending.
    own: [f64; 2],
    /// Angles at the ends where the NURBS parameter is affine in tan(angle / 2), between -pi and pi; the angle is affine
    /// in the file's parameter. `None` where the two parameters are affine in each other.
    angles: Option<[f64; 2]>,
}

/// A monotone map, piece by piece and exact in both directions, of a parameter as the file means it onto the parameter of
/// the NURBS form.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterMap {
    /// Never empty.
    pieces: Vec<Piece>,
    /// A full turn where the file's parameter is an angle, so that whole turns make no difference; else 0.
    turn: f64,
}

impl ParameterMap {
    /// The affine map of the file's range `file` onto the range `own` of the NURBS form; neither is empty.
    pub(in crate::io) fn affine(file: [f64; 2], own: [f64; 2]) -> Self {
        Self {
            pieces: vec![Piece {
                file,
                own,
                angles: None,
            }],
            turn: 0.0,
        }
    }

    /// Both parameters are the same.
    pub(in crate::io) fn identity(range: [f64; 2]) -> Self {
        Self::affine(range, range)
    }

    /// The map of an angle onto the parameter of rational quadratic pieces whose knots are `knots` and whose parameter is
    /// affine in tan((angle - m) / 2), with m the middle of each piece.
    pub(in crate::io) fn arcs(knots: &[f64]) -> Self {
        let pieces = knots.windows(2).map(|k| {
            let half = 0.5 * (k[1] - k[0]);
            Piece {
                file: [k[0], k[1]],
                own: [k[0], k[1]],
                angles: Some([-half, half]),
            }
        });
        Self {
            pieces: pieces.collect(),
            turn: TAU,
        }
    }

    /// The map of an angle onto a parameter of the same range that is affine in tan(angle / 2).
    pub(in crate::io) fn half_angle(range: [f64; 2]) -> Self {
        Self {
            pieces: vec![Piece {
                file: range,
                own: range,
                angles: Some(range),
            }],
            turn: 0.0,
        }
    }

    /// Maps one after the other: the file's ranges and the NURBS form's ranges are moved to follow each other from `file`
    /// and `own` on. Nothing where there are no maps.
    pub(in crate::io) fn chain<'a>(
        maps: impl IntoIterator<Item = &'a Self>,
        mut file: f64,
        mut own: f64,
    ) -> Option<Self> {
        let mut pieces: Vec<Piece> = Vec::new();
        for map in maps {
            let (range, target) = (map.file_range(), map.own_range());
            let (df, d) = (file - range[0], own - target[0]);
            for p in &map.pieces {
                let next = Piece {
                    file: p.file.map(|t| t + df),
                    own: p.own.map(|t| t + d),
                    angles: p.angles,
                };
                match pieces.last_mut() {
                    Some(last) if Piece::goes_on(last, &next) => {
                        last.file[1] = next.file[1];
                        last.own[1] = next.own[1];
                    }
                    _ => pieces.push(next),
                }
            }
            file += range[1] - range[0];
            own += target[1] - target[0];
        }
        (!pieces.is_empty()).then_some(Self { pieces, turn: 0.0 })
    }

    /// The map on a part of the file's range.
    pub(in crate::io) fn restricted(&self, file: [f64; 2]) -> Self {
        let mut pieces = Vec::new();
        for p in &self.pieces {
            let part = [p.file[0].max(file[0]), p.file[1].min(file[1])];
            if part[0] >= part[1] {
                continue;
            }
            let angle = |[a, b]: [f64; 2]| {
                let share = |t: f64| (t - p.file[0]) / (p.file[1] - p.file[0]);
                part.map(|t| between([a, b], share(t)))
            };
            pieces.push(Piece {
                file: part,
                own: part.map(|t| p.forward(t)),
                angles: p.angles.map(angle),
            });
        }
        if pieces.is_empty() {
            return self.clone();
        }
        Self {
            pieces,
            turn: self.turn,
        }
    }

    /// The same map for a file parameter that is affine in this one: its range becomes `file`, backwards where
    /// `reversed`.
    pub(in crate::io) fn with_file_range(&self, file: [f64; 2], reversed: bool) -> Self {
        let [a, b] = self.file_range();
        let to = |t: f64| {
            let s = (t - a) / (b - a);
            let s = if reversed { 1.0 - s } else { s };
            if s == 1.0 {
                file[1]
            } else {
                file[0] + (file[1] - file[0]) * s
            }
        };
        let mut pieces: Vec<Piece> = self
            .pieces
            .iter()
            .map(|p| {
                let mut q = *p;
                q.file = p.file.map(to);
                if reversed {
                    q.file.reverse();
                    q.own.reverse();
                    // The tangent is odd: the same shares from -b to -a.
                    q.angles = q.angles.map(|[a, b]| [-b, -a]);
                }
                q
            })
            .collect();
        if reversed {
            pieces.reverse();
        }
        Self {
            pieces,
            turn: self.turn * ((file[1] - file[0]) / (b - a)).abs(),
        }
    }

    /// The same map onto a NURBS parameter that is affine in this one's and has the range `own`, descending where that
    /// form runs backwards.
    pub(in crate::io) fn with_own_range(&self, own: [f64; 2]) -> Self {
        let [a, b] = self.own_range();
        let to = |t: f64| {
            if t == b {
                own[1]
            } else {
                own[0] + (own[1] - own[0]) * ((t - a) / (b - a))
            }
        };
        let pieces = self.pieces.iter().map(|p| Piece {
            own: p.own.map(to),
            ..*p
        });
        Self {
            pieces: pieces.collect(),
            turn: self.turn,
        }
    }

    /// The whole turns (in the file's unit of angles; zero where the parameter is no angle) that bring the middle of `range` nearest to
    /// the middle of [`file_range`](Self::file_range). Writers disagree where an arc's angle begins: the standard says in
    /// [0, 2 pi), many files mean a negative one.
    pub fn turns(&self, range: [f64; 2]) -> f64 {
        if self.turn == 0.0 {
            return 0.0;
        }
        let [a, b] = self.file_range();
        let distance = 0.5 * (a + b) - 0.5 * (range[0] + range[1]);
        let turns = (distance / self.turn).round() * self.turn;
        if turns.is_finite() { turns } else { 0.0 }
    }

    /// Range of the file's parameter.
    pub fn file_range(&self) -> [f64; 2] {
        let n = self.pieces.len() - 1;
        [self.pieces[0].file[0], self.pieces[n].file[1]]
    }

    /// Where the ends of [`file_range`](Self::file_range) lie on the NURBS form.
    pub fn own_range(&self) -> [f64; 2] {
        let n = self.pieces.len() - 1;
        [self.pieces[0].own[0], self.pieces[n].own[1]]
    }

    /// The file's parameters at which one piece of the map ends and the next begins; the map is only continuous there.
    pub fn breaks(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces[1..].iter().map(|p| p.file[0])
    }

    /// Factor and shift of the map `own = factor * file + shift` where it is one affine piece.
    pub fn as_affine(&self) -> Option<[f64; 2]> {
        match self.pieces[..] {
            [
                Piece {
                    file,
                    own,
                    angles: None,
                },
            ] => {
                let factor = (own[1] - own[0]) / (file[1] - file[0]);
                Some([factor, own[0] - factor * file[0]])
            }
            _ => None,
        }
    }

    /// Whether both parameters are the same.
    pub fn is_identity(&self) -> bool {
        matches!(self.pieces[..], [Piece { file, own, angles: None }] if file == own)
    }

    /// Whether equal shares of this map's range and of the other's are mapped onto equal shares.
    pub(in crate::io) fn same_shape(&self, other: &Self) -> bool {
        let unit = |m: &Self| {
            m.with_file_range([0.0, 1.0], false)
                .with_own_range([0.0, 1.0])
        };
        let (a, b) = (unit(self), unit(other));
        let close = |x: [f64; 2], y: [f64; 2]| (x[0] - y[0]).abs().max((x[1] - y[1]).abs()) < 1e-12;
        let straight = |m: &Self| {
            m.pieces
                .iter()
                .all(|p| p.angles.is_none() && close(p.file, p.own))
        };
        if straight(&a) && straight(&b) {
            return true;
        }
        a.pieces.len() == b.pieces.len()
            && a.pieces.iter().zip(&b.pieces).all(|(p, q)| {
                let angles = match (p.angles, q.angles) {
                    (None, None) => true,
                    (Some(x), Some(y)) => close(x, y),
                    _ => false,
                };
                close(p.file, q.file) && close(p.own, q.own) && angles
            })
    }

    /// The NURBS form's parameter at the file's. Beyond the ends the map goes on in the direction that it has there.
    pub fn to_own(&self, file: f64) -> f64 {
        let k = self.pieces.partition_point(|p| p.file[1] < file);
        self.pieces[k.min(self.pieces.len() - 1)].forward(file)
    }

    /// [`to_own`](Self::to_own) with its first and second derivatives; at a break those of the piece before it.
    pub fn jet(&self, file: f64) -> [f64; 3] {
        let k = self.pieces.partition_point(|p| p.file[1] < file);
        self.pieces[k.min(self.pieces.len() - 1)].jet(file)
    }

    /// The file's parameter at that of the NURBS form, the inverse of [`to_own`](Self::to_own).
    pub fn to_file(&self, own: f64) -> f64 {
        let [a, b] = self.own_range();
        let k = if b >= a {
            self.pieces.partition_point(|p| p.own[1] < own)
        } else {
            self.pieces.partition_point(|p| p.own[1] > own)
        };
        self.pieces[k.min(self.pieces.len() - 1)].back(own)
    }
}

impl Piece {
    /// Whether `next` is affine and so steep as this affine piece before it.
    fn goes_on(&self, next: &Self) -> bool {
        let slope = |p: &Self| (p.own[1] - p.own[0]) / (p.file[1] - p.file[0]);
        let (a, b) = (slope(self), slope(next));
        self.angles.is_none() && next.angles.is_none() && (a - b).abs() <= 1e-15 * a.abs()
    }

    fn forward(&self, t: f64) -> f64 {
        let s = (t - self.file[0]) / (self.file[1] - self.file[0]);
        let share = match self.angles {
            Some(angles) => tangent_share(angles, s),
            None => s,
        };
        between(self.own, share)
    }

    fn jet(&self, t: f64) -> [f64; 3] {
        let length = self.file[1] - self.file[0];
        let s = (t - self.file[0]) / length;
        let [share, d1, d2] = match self.angles {
            Some([a, b]) => {
                let share = tangent_share([a, b], s);
                let x = (0.5 * (a + (b - a) * s.clamp(0.0, 1.0))).tan();
                let rise = (0.5 * b).tan() - (0.5 * a).tan();
                // d tan(x / 2) / dx = (1 + tan^2) / 2, and once more.
                let d1 = 0.5 * (1.0 + x * x) * (b - a) / rise;
                let bend = 0.5 * x * (1.0 + x * x) * (b - a) * (b - a) / rise;
                [share, d1, if (0.0..=1.0).contains(&s) { bend } else { 0.0 }]
            }
            None => [s, 1.0, 0.0],
        };
        let width = self.own[1] - self.own[0];
        [
            between(self.own, share),
            width * d1 / length,
            width * d2 / (length * length),
        ]
    }

    fn back(&self, t: f64) -> f64 {
        let share = (t - self.own[0]) / (self.own[1] - self.own[0]);
        let s = match self.angles {
            Some(angles) => angle_share(angles, share),
            None => share,
        };
        between(self.file, s)
    }
}

/// Exact at both ends.
fn between([a, b]: [f64; 2], s: f64) -> f64 {
    if s == 1.0 { b } else { a + (b - a) * s }
}

/// Share of the way from tan(a / 2) to tan(b / 2) at share `s` of the angle from a to b; linear outside.
fn tangent_share([a, b]: [f64; 2], s: f64) -> f64 {
    let tangent = |x: f64| (0.5 * x).tan();
    let (ta, tb) = (tangent(a), tangent(b));
    // Half of the slope of the tangent at an end, in shares.
    let slope = |t: f64| 0.5 * (1.0 + t * t) * (b - a) / (tb - ta);
    if s < 0.0 {
        s * slope(ta)
    } else if s > 1.0 {
        1.0 + (s - 1.0) * slope(tb)
    } else if s == 1.0 {
        1.0
    } else {
        (tangent(a + (b - a) * s) - ta) / (tb - ta)
    }
}

/// Inverse of [`tangent_share`].
fn angle_share([a, b]: [f64; 2], share: f64) -> f64 {
    let (ta, tb) = ((0.5 * a).tan(), (0.5 * b).tan());
    let slope = |t: f64| 0.5 * (1.0 + t * t) * (b - a) / (tb - ta);
    if share < 0.0 {
        share / slope(ta)
    } else if share > 1.0 {
        1.0 + (share - 1.0) / slope(tb)
    } else if share == 1.0 {
        1.0
    } else {
        (2.0 * (ta + (tb - ta) * share).atan() - a) / (b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The point of the quarter circle at the mapped parameter has the angle asked for.
    #[test]
    fn angles_go_there_and_back() {
        let map = ParameterMap::arcs(&[0.0, FRAC_PI_2, PI]);
        for k in -3..=43 {
            let angle = PI * f64::from(k) / 40.0;
            let back = map.to_file(map.to_own(angle));
            assert!((back - angle).abs() < 1e-14, "{angle} {back}");
        }
        assert_eq!(map.to_own(PI), PI);
        let quarter = map.to_own(PI / 8.0);
        let expected = PI / 4.0 * (1.0 - (PI / 16.0).tan() / (PI / 8.0).tan());
        assert!((quarter - expected).abs() < 1e-15, "{quarter}");
    }

    #[test]
    fn reversed_and_rescaled() {
        let map = ParameterMap::arcs(&[1.0, 2.0, 3.0]).with_file_range([0.0, 1.0], true);
        assert_eq!((map.to_own(0.0), map.to_own(1.0)), (3.0, 1.0));
        for k in 0..=20 {
            let s = f64::from(k) / 20.0;
            assert!((map.to_file(map.to_own(s)) - s).abs() < 1e-14);
        }
        let other = ParameterMap::arcs(&[5.0, 6.0, 7.0]);
        assert!(ParameterMap::arcs(&[1.0, 2.0, 3.0]).same_shape(&other));
        assert!(!other.same_shape(&ParameterMap::identity([5.0, 7.0])));
        let line = ParameterMap::affine([0.0, 2.0], [5.0, 1.0]);
        assert_eq!(line.as_affine(), Some([-2.0, 5.0]));
        assert!(!line.is_identity() && ParameterMap::identity([0.0, 1.0]).is_identity());
    }
}
