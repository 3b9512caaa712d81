//! How finely a piece of a surface is divided for its flat copy.
use super::bezier::SurfacePiece;
use covact_geometry::Vec3;

/// Intervals and lines on which the curvature of a piece is sampled.
const SAMPLES: usize = 8;
const LINES: usize = 5;

impl SurfacePiece {
    /// Divides the pieces of a whole patch for the flat copy, those of xi1 fastest, `columns` to a row: within `tolerance` (length) of
    /// it, into `most` quadrilaterals a side at most. Pieces beside each other have the same corners on their common side, so that
    /// none of it looks like a border.
    pub fn divide(pieces: &mut [Self], columns: usize, tolerance: f64, most: u32) {
        let columns = columns.max(1);
        let mut along = vec![1; columns];
        let mut across = vec![1; pieces.len().div_ceil(columns)];
        for (k, piece) in pieces.iter().enumerate() {
            let [n, m] = piece.divisions_within(tolerance, most);
            along[k % columns] = n.max(along[k % columns]);
            across[k / columns] = m.max(across[k / columns]);
        }
        for (k, piece) in pieces.iter_mut().enumerate() {
            piece.divisions = Some([along[k % columns], across[k / columns]]);
        }
    }

    /// Quadrilaterals along either direction, `most` at most, whose chords lie within `tolerance` (length) of the piece. Chords of a
    /// curve come closer with the square of their number. The numbers are powers of two and three times these, so that a page may
    /// take every second or third line.
    fn divisions_within(&self, tolerance: f64, most: u32) -> [u32; 2] {
        if tolerance <= 0.0 {
            return [most; 2];
        }
        let number = |off: f64| {
            let least = ((off / tolerance).sqrt().ceil() as u32).clamp(1, most);
            let power = least.next_power_of_two();
            let number = if least <= power / 4 * 3 {
                power / 4 * 3
            } else {
                power
            };
            number.min(most)
        };
        let bent = [0, 1].map(|direction| {
            let lines = (0..LINES).map(|line| {
                let across = line as f64 / (LINES - 1) as f64;
                let samples: [Vec3; SAMPLES + 1] = std::array::from_fn(|k| {
                    let along = k as f64 / SAMPLES as f64;
                    let [u, v] = match direction {
                        0 => [along, across],
                        _ => [across, along],
                    };
                    self.evaluate(u, v).point.into()
                });
                samples.windows(3).map(sagitta).fold(0.0, f64::max)
            });
            // Of one chord for the whole length.
            lines.fold(0.0, f64::max) * (SAMPLES * SAMPLES) as f64
        });
        // Straight lines may still span a twisted quadrilateral.
        let corner = |u: f64, v: f64| Vec3::from(self.evaluate(u, v).point);
        let twist = corner(0.0, 0.0) + corner(1.0, 1.0) - corner(1.0, 0.0) - corner(0.0, 1.0);
        let twisted = number(0.25 * twist.norm());
        let of = bent.map(number);
        match of {
            [1, 1] => [twisted; 2],
            _ => of,
        }
    }
}

/// How far a curve through three samples in succession lies off the chord of one of its intervals: a quarter of what the middle one
/// lies off the chord of the other two.
fn sagitta(samples: &[Vec3]) -> f64 {
    let (chord, off) = (samples[2] - samples[0], samples[1] - samples[0]);
    let part = off.dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE);
    0.25 * (off - chord * part).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a cylinder of radius 2 and length 30: straight along xi1, round along xi2.
    fn quarter() -> SurfacePiece {
        let half = 0.5f64.sqrt();
        let arc = [[2.0, 0.0, 1.0], [2.0, 2.0, half], [0.0, 2.0, 1.0]];
        let point = |x: f64, [y, z, w]: [f64; 3]| [x * w, y * w, z * w, w];
        SurfacePiece {
            degree: [1, 2],
            points: (arc.into_iter())
                .flat_map(|a| [point(0.0, a), point(30.0, a)])
                .collect(),
            patch: 0,
            entity: 0,
            reversed: false,
            divisions: None,
        }
    }

    #[test]
    fn chords_of_a_round_piece_lie_within_the_tolerance() {
        let piece = quarter();
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let [along, around] = piece.divisions_within(tolerance, 200);
            assert_eq!(along, 1);
            let sagitta = |n: u32| {
                let middles = (0..n).map(|k| {
                    let at =
                        |k: u32| Vec3::from(piece.evaluate(0.0, f64::from(k) / f64::from(n)).point);
                    2.0 - (0.5 * (at(k) + at(k + 1))).norm()
                });
                middles.fold(0.0, f64::max)
            };
            // No finer than the uneven speed of the parameter and whole numbers ask for.
            assert!(sagitta(around) <= tolerance, "{tolerance:e}: {around}");
            assert!(
                around == 1 || sagitta(around / 2) > tolerance,
                "{tolerance:e}: {around}"
            );
        }
        assert_eq!(piece.divisions_within(1e-9, 16), [1, 16]);
        assert_eq!(piece.divisions_within(0.0, 16), [16, 16]);
    }

    #[test]
    fn a_twisted_piece_with_straight_sides_is_divided() {
        let piece = SurfacePiece {
            degree: [1, 1],
            points: vec![
                [0.0, 0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0, 1.0],
                [0.0, 1.0, 0.0, 1.0],
                [1.0, 1.0, 1.0, 1.0],
            ],
            patch: 0,
            entity: 0,
            reversed: false,
            divisions: None,
        };
        assert_eq!(piece.divisions_within(0.01, 16), [6, 6]);
        assert_eq!(piece.divisions_within(0.3, 16), [1, 1]);
    }

    /// Of three by two pieces of a sheet that is bent over its middle column only, all have what their column and row need.
    #[test]
    fn pieces_beside_each_other_share_their_corners() {
        let piece = |column: usize, row: usize, rise: f64| SurfacePiece {
            degree: [2, 1],
            points: (0..2)
                .flat_map(|j| (0..3).map(move |i| (i, j)))
                .map(|(i, j)| {
                    let up = if i == 1 { rise } else { 0.0 };
                    [(2 * column + i) as f64, (row + j) as f64, up, 1.0]
                })
                .collect(),
            patch: 0,
            entity: 0,
            reversed: false,
            divisions: None,
        };
        let rise = [[0.0, 0.4, 0.0], [0.0, 0.0, 0.0]];
        let mut pieces: Vec<_> = (0..6)
            .map(|k| piece(k % 3, k / 3, rise[k / 3][k % 3]))
            .collect();
        SurfacePiece::divide(&mut pieces, 3, 0.01, 16);
        // A parabola of height .2 over one chord.
        let middle = [6, 1];
        let divisions: Vec<_> = pieces.iter().map(|p| p.divisions.unwrap()).collect();
        assert_eq!(divisions, [[1, 1], middle, [1, 1], [1, 1], middle, [1, 1]]);
    }
}
