//! Rigid surfaces for the page: their flat copies with fewer quadrilaterals, and where they are in a step.
use covact_geometry::Vec3;

/// A grid of points that the writer of flat copies made of one piece of a surface.
struct Block {
    first: u32,
    /// Quadrilaterals along its rows, and rows.
    n: [u32; 2],
}

/// The quadrilaterals of a surface without those that change it by less than `tolerance`, as corners in `points`.
///
/// A piece is a grid, of which every second, third and so on line is kept, each direction for itself. Other
/// quadrilaterals stay as they are.
pub(super) fn coarsened(points: &[Vec3], quads: &[[u32; 4]], tolerance: f64) -> Vec<[u32; 4]> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < quads.len() {
        match block(points, &quads[at..]) {
            Some(block) => {
                let [su, sv] = strides(points, &block, tolerance);
                let row = block.n[0] + 1;
                for j in (0..block.n[1]).step_by(sv as usize) {
                    for i in (0..block.n[0]).step_by(su as usize) {
                        let corner = block.first + i + row * j;
                        let up = corner + row * sv;
                        out.push([corner, corner + su, up + su, up]);
                    }
                }
                at += block.n[0] as usize * block.n[1] as usize;
            }
            None => {
                out.push(quads[at]);
                at += 1;
            }
        }
    }
    out
}

/// The grid that begins with the first of these quadrilaterals, where there is one.
fn block(points: &[Vec3], quads: &[[u32; 4]]) -> Option<Block> {
    let [first, _, _, up] = *quads.first()?;
    let n = up.checked_sub(first)?.checked_sub(1).filter(|&n| n > 0)?;
    let fits = |(k, quad): (u32, &[u32; 4])| {
        let corner = first + k % n + (n + 1) * (k / n);
        *quad == [corner, corner + 1, corner + n + 2, corner + n + 1]
    };
    let count = (0..).zip(quads).take_while(|at| fits(*at)).count();
    let rows = count as u32 / n;
    let last = first as usize + (n as usize + 1) * (rows as usize + 1);
    (rows > 0 && last <= points.len()).then_some(Block {
        first,
        n: [n, rows],
    })
}

/// Steps in both directions with which a piece stays within the tolerance.
fn strides(points: &[Vec3], block: &Block, tolerance: f64) -> [u32; 2] {
    let row = block.n[0] + 1;
    let close = |direction: usize, stride: u32| {
        let (along, across) = match direction {
            0 => (1, row),
            _ => (row, 1),
        };
        (0..=block.n[1 - direction]).all(|line| {
            let at = |i: u32| points[(block.first + line * across + i * along) as usize];
            (0..block.n[direction])
                .step_by(stride as usize)
                .all(|start| {
                    let (a, b) = (at(start), at(start + stride));
                    (1..stride).all(|k| {
                        let t = f64::from(k) / f64::from(stride);
                        (at(start + k) - (a + (b - a) * t)).norm() <= tolerance
                    })
                })
        })
    };
    [0, 1].map(|direction| {
        let n = block.n[direction];
        let divisors = (1..=n).rev().filter(|s| n.is_multiple_of(*s));
        (divisors.into_iter())
            .find(|&stride| stride == 1 || close(direction, stride))
            .unwrap_or(1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of n x n quadrilaterals, as the writer lays it out.
    fn piece(n: u32, at: impl Fn(f64, f64) -> Vec3) -> (Vec<Vec3>, Vec<[u32; 4]>) {
        let mut points = Vec::new();
        for j in 0..=n {
            points.extend(
                (0..=n).map(|i| at(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n))),
            );
        }
        let quads = (0..n * n).map(|k| {
            let corner = k % n + (n + 1) * (k / n);
            [corner, corner + 1, corner + n + 2, corner + n + 1]
        });
        (points, quads.collect())
    }

    #[test]
    fn flat_pieces_become_one_quadrilateral_and_round_ones_keep_the_tolerance() {
        let (points, quads) = piece(8, |u, v| Vec3::new(u, 2.0 * v, u + v));
        assert_eq!(coarsened(&points, &quads, 1e-9), [[0, 8, 80, 72]]);
        // A quarter of a cylinder, round along u: a chord over an angle a is off by 1 - cos(a / 2).
        let round = |u: f64, v: f64| {
            let (sin, cos) = (u * std::f64::consts::FRAC_PI_2).sin_cos();
            Vec3::new(cos, sin, v)
        };
        let (points, quads) = piece(8, round);
        assert_eq!(
            coarsened(&points, &quads, 1.1 * (1.0 - 22.5f64.to_radians().cos())).len(),
            2
        );
        assert_eq!(coarsened(&points, &quads, 1e-6).len(), 8);
        // What is no grid stays.
        let loose = [[0, 1, 3, 2], [5, 6, 7, 7]];
        assert_eq!(coarsened(&points[..9], &loose, 1.0), loose);
    }
}
