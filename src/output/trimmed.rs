//! Pieces of trimmed patches for output: exact where no trim curve passes, small flat ones along the trim curves.
use super::bezier::SurfacePiece;
use covact_geometry::trim::Part;
use covact_geometry::{NurbsPatch, Trim, Vec3, bezier_pieces};

/// Cells a side into which a whole trimmed patch is cut at least, where its spans are not finer.
const CELLS: usize = 64;
/// Fewest and most times that the piece of a span is halved in both directions on the way to these cells.
const HALVINGS: std::ops::RangeInclusive<u32> = 2..=5;
/// Bisections for a point on the border: down to rounding of the drawing.
const BISECTIONS: usize = 30;

/// Rectangle of parameters: `[direction][start, end]`.
type Rectangle = [[f64; 2]; 2];

struct Cutter<'a> {
    surface: &'a NurbsPatch,
    trim: &'a Trim,
    patch: u32,
    entity: u32,
    reversed: bool,
    /// Halvings that lead to a cell.
    halvings: u32,
    out: Vec<SurfacePiece>,
}

/// The pieces of a patch with a trim. Along the trim curves they are flat cells, 4 to 32 to a side of a span, with corners
/// on the curves. In the flat copy all of the patch is cut in such cells, so that there are no gaps between its pieces.
pub(super) fn pieces(
    surface: &NurbsPatch,
    trim: &Trim,
    patch: u32,
    entity: u32,
    reversed: bool,
) -> Vec<SurfacePiece> {
    let whole = surface.clone().with_trim(None);
    let spans = whole.spans(0).len().max(whole.spans(1).len());
    let wanted = CELLS.div_ceil(spans).next_power_of_two().ilog2();
    let mut cutter = Cutter {
        surface: &whole,
        trim,
        patch,
        entity,
        reversed,
        halvings: wanted.clamp(*HALVINGS.start(), *HALVINGS.end()),
        out: Vec::new(),
    };
    for piece in bezier_pieces(&whole) {
        cutter.add(piece.domain, 0);
    }
    cutter.out
}

impl Cutter<'_> {
    fn add(&mut self, part: Rectangle, halved: u32) {
        match self.trim.part(part) {
            Part::Outside => {}
            Part::Inside => self.exact(part, halved),
            Part::Cut if halved == self.halvings => self.flat(part),
            Part::Cut => {
                let middle = part.map(|[a, b]| 0.5 * (a + b));
                for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                    let half = |k: usize, upper: usize| match upper {
                        0 => [part[k][0], middle[k]],
                        _ => [middle[k], part[k][1]],
                    };
                    self.add([half(0, i), half(1, j)], halved + 1);
                }
            }
        }
    }

    fn exact(&mut self, part: Rectangle, halved: u32) {
        // The part lies in the domain, so this fails only where it is thinner than rounding: nothing to be seen.
        let Ok(patch) = self.surface.with_domain(part) else {
            return;
        };
        for piece in bezier_pieces(&patch) {
            self.out.push(SurfacePiece {
                degree: piece.degree,
                points: piece.points,
                patch: self.patch,
                entity: self.entity,
                reversed: self.reversed,
                divisions: Some([1 << (self.halvings - halved); 2]),
            });
        }
    }

    /// What lies inside of a small rectangle: its corners inside and the points where its sides cross the border.
    fn flat(&mut self, part: Rectangle) {
        let [[a1, b1], [a2, b2]] = part;
        let corners = [[a1, a2], [b1, a2], [b1, b2], [a1, b2]];
        let inside = corners.map(|c| self.trim.contains(c));
        let mut polygon = Vec::with_capacity(8);
        for k in 0..4 {
            let next = (k + 1) % 4;
            if inside[k] {
                polygon.push(corners[k]);
            }
            if inside[k] != inside[next] {
                let (mut from, mut to) = (corners[k], corners[next]);
                for _ in 0..BISECTIONS {
                    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
                    if self.trim.contains(middle) == inside[k] {
                        from = middle;
                    } else {
                        to = middle;
                    }
                }
                polygon.push(from);
            }
        }
        let points: Vec<Vec3> = polygon.iter().map(|&xi| self.surface.point(xi)).collect();
        // A fan of quadrilaterals, the last one with a repeated corner where the number of corners is odd.
        let mut k = 1;
        while k + 1 < points.len() {
            let last = if k + 2 < points.len() { k + 2 } else { k + 1 };
            let quad = [points[0], points[k], points[last], points[k + 1]];
            self.out.push(SurfacePiece {
                degree: [1, 1],
                points: quad.map(|p| [p.x, p.y, p.z, 1.0]).to_vec(),
                patch: self.patch,
                entity: self.entity,
                reversed: self.reversed,
                divisions: Some([1; 2]),
            });
            k += 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use covact_geometry::{NurbsCurve, TrimCurve, TrimLoop};
    use nalgebra::Vector2;

    /// A square of side 2 with a round hole: the pieces have its area but for the chords along the circle.
    #[test]
    fn pieces_of_a_plate_with_a_hole() {
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        let points = corners.map(|[x, y]| Vec3::new(x, y, 0.5));
        let plate = NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &points, None).unwrap();
        // Radius 0.6 in space is 0.3 of the parameters.
        let arc = |k: u32| {
            let turn = |a: f64| {
                let (sin, cos) = (std::f64::consts::FRAC_PI_2 * (f64::from(k) + a)).sin_cos();
                Vector2::new(cos, sin)
            };
            let (a, b) = (turn(0.0), turn(1.0));
            let at = |v: Vector2<f64>| v * 0.3 + Vector2::new(0.5, 0.5);
            let w = 0.5f64.sqrt();
            let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
            let points = [at(a), at(a + b), at(b)];
            NurbsCurve::<2>::new(2, knots, &points, Some(&[1.0, w, 1.0])).unwrap()
        };
        let curves = (0..4).map(|k| TrimCurve {
            parameter: arc(k),
            space: None,
            entity: 0,
        });
        let hole = TrimLoop {
            curves: curves.collect(),
        };
        let trimmed = plate.trimmed_by(vec![hole], false, 1e-9).unwrap().patch;
        let pieces = SurfacePiece::of_patch(&trimmed, 0, 0, false);
        let mut area = 0.0;
        for piece in &pieces {
            piece.check().unwrap();
            let [x, y] = [0, 1].map(|k| {
                let c = |n: usize| piece.points[n][k] / piece.points[n][3];
                [c(0), c(1), c(3), c(2)]
            });
            // Every piece is flat with straight sides: its corners around.
            let twice: f64 = (0..4)
                .map(|k| x[k] * y[(k + 1) % 4] - x[(k + 1) % 4] * y[k])
                .sum();
            assert!(twice > -1e-12, "{piece:?}");
            area += 0.5 * twice;
        }
        let exact = 4.0 - std::f64::consts::PI * 0.36;
        // Chords of at most 2/32 sqrt(2) over the circle: sagitta h^2 / (8 r), two thirds of it lost along 2 pi r.
        let h: f64 = 2.0 / 32.0 * 2f64.sqrt();
        let allowed = 2.0 / 3.0 * h * h / 8.0 * std::f64::consts::TAU;
        assert!((area - exact).abs() < allowed, "{area} {exact}");
        assert!(
            pieces.iter().any(|p| p.divisions >= Some([4; 2])),
            "large pieces inside"
        );
        for piece in &pieces {
            for p in &piece.points {
                assert!(p[0].hypot(p[1]) > 0.6 * p[3] - h * h, "{p:?} in the hole");
            }
        }
    }
}
