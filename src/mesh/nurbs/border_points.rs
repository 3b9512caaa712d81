//! Points along borders.
use super::borders::width_across;
use super::{Border, BorderPoint, NurbsSheet};
use crate::fem::gauss;
use covact_geometry::{PatchShape, Vec3};

impl NurbsSheet {
    /// Gauss points along a border, element after element.
    pub fn border_points(&self, border: Border, count: usize) -> Vec<Vec<BorderPoint>> {
        let line = self.patches[border.patch()].line(border);
        self.points_along(border, &line.pieces(line.whole()), count)
    }

    /// The same on given parts of a border, of which those of a curve of a trim may cross elements.
    pub fn points_along(
        &self,
        border: Border,
        parts: &[[f64; 2]],
        count: usize,
    ) -> Vec<Vec<BorderPoint>> {
        let part = &self.patches[border.patch()];
        let line = part.line(border);
        let rule = gauss(count).expect("a rule of this many points exists");
        let positions = part.patch.points();
        let mut room = PatchShape::default();
        let nu = part.spans()[0];
        let mut of = |[a, b]: &[f64; 2]| {
            let points = rule.iter().map(|(s, w)| {
                let s = 0.5 * (a + b) + 0.5 * s * (b - a);
                let span = line.span(s);
                let weight = 0.5 * w * (b - a);
                let p = part.point(span, line.xi(s), weight, &positions, &mut room);
                let tangents = p.n_i.map(|n_i| -> Vec3 {
                    (p.nodes.iter().zip(n_i))
                        .map(|(n, d)| positions[(*n - part.first_node) as usize] * d)
                        .sum()
                });
                let [x, y] = line.direction(s);
                let outward = line.outward(s);
                let sides = [0, 1].map(|dir| {
                    let [a, b] = part.patch.basis(dir).span_range(span[dir]);
                    b - a
                });
                BorderPoint {
                    at: p,
                    element: part.first_element as usize + span[0] + nu * span[1],
                    length: p.weight * (tangents[0] * x + tangents[1] * y).norm(),
                    outward,
                    width: width_across(border, tangents, outward, sides),
                }
            });
            points.collect()
        };
        parts.iter().map(&mut of).collect()
    }
}
