//! Integration segments: slave faces cut by the facets of their master, so that no shape function has a kink inside a
//! piece.
//!
//! Facets are projected onto a slave face along its mean normal (M. A. Puso and T. A. Laursen, "A mortar
//! segment-to-segment contact method for large deformation solid mechanics", Computer Methods in Applied Mechanics and
//! Engineering 193 (2004)), and cut it in its parameters, where it is a square whatever its shape. What no facet covers
//! keeps its points too.
use crate::contact::clip::{self, Point, Polygon};
use crate::contact::points::{ROUNDING, SlavePoint};
use crate::fem::FaceNodes;
use crate::fem::Quad;
use crate::fem::face::shape;
use covact_geometry::{MovingFacets, Vec3};
use rayon::prelude::*;

/// How far an edge may bend from the straight lines that stand for it, relative to its size. The integrals are wrong by
/// the square of this, as a kink that is met too early or too late is small near itself.
const BEND: f64 = 1e-3;
/// An edge is divided into at most two to this power.
const HALVINGS: u32 = 3;
/// Cosine between the normals of slave face and facet above which the facet does not face it.
const FACING: f64 = -0.1;

/// The border of a master facet.
struct Outline {
    facet: u32,
    points: Vec<Vec3>,
    low: Vec3,
    high: Vec3,
    normal: Vec3,
}

/// Slave points on `faces` (with node numbers of the model), cut by `facets` where those are now: at the points of a rule
/// of `degree` on the triangles of every piece. `start` are the undeformed positions of nodes, `now` the present ones.
/// Facets farther from a face than `reach` do not cut it. Points come face by face, and every face has some.
///
/// Areas are undeformed. Those of a curved or warped face are scaled so that they sum to the face's (by the 3 x 3 Gauss
/// rule), from which they differ by the error of the rule; on a plane one the factor is one.
pub fn segments(
    faces: &[FaceNodes],
    facets: &MovingFacets,
    start: impl Fn(u32) -> Vec3 + Sync,
    now: impl Fn(u32) -> Vec3 + Sync,
    degree: u8,
    reach: f64,
) -> Vec<SlavePoint> {
    let mut outlines: Vec<Outline> = (0..facets.len() as u32)
        .map(|f| Outline::new(facets, f))
        .filter(|o| o.low.iter().chain(o.high.iter()).all(|x| x.is_finite()))
        .collect();
    outlines.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    let widest = (outlines.iter()).fold(0.0f64, |w, o| w.max(o.high.x - o.low.x));
    let cut = |face: &FaceNodes| {
        let place = Place::new(Quad::new(face, &now));
        let mut open = vec![vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]];
        let mut pieces = Vec::new();
        if let Some(place) = &place {
            let [low, high] = place.bounds(reach);
            let first = outlines.partition_point(|o| o.low.x < low.x - widest);
            let near = outlines[first..].iter().take_while(|o| o.low.x <= high.x);
            let mut near: Vec<_> = near.filter(|o| o.meets(&low, &high)).collect();
            // The pieces depend on the order, which is not to depend on where the bodies have turned to.
            near.sort_by_key(|o| o.facet);
            for outline in near {
                if outline.normal.dot(&place.normal) > FACING {
                    continue;
                }
                for part in clip::convex_parts(place.project(&outline.points)) {
                    clip::cut(&mut open, &part, &mut pieces);
                }
            }
        }
        pieces.append(&mut open);
        sample(face, &Quad::new(face, &start), &pieces, degree)
    };
    let points: Vec<Vec<SlavePoint>> = faces.par_iter().map(cut).collect();
    points.concat()
}

/// Points on the pieces of a face.
fn sample(face: &FaceNodes, quad: &Quad, pieces: &[Polygon], degree: u8) -> Vec<SlavePoint> {
    let mut out = Vec::new();
    for piece in pieces {
        clip::integrate(piece, degree, |[u, v], w| {
            out.push(SlavePoint {
                nodes: face.nodes,
                shape: shape(face.count, u, v),
                count: face.nodes().len() as u8,
                area: w * quad.area_vector(u, v).norm(),
                rounding: ROUNDING * quad.spacing(),
            });
        });
    }
    let sum: f64 = out.iter().map(|p| p.area).sum();
    if sum > 0.0 {
        let factor = quad.area() / sum;
        out.iter_mut().for_each(|p| p.area *= factor);
    }
    out
}

/// Appends the curve from `a` (at 0) up to `b` (at 1), without `b`, as straight lines.
fn divide<P: Copy>(
    a: P,
    b: P,
    at: &impl Fn(f64) -> P,
    bends: &impl Fn(&P, &P, &P) -> bool,
    out: &mut Vec<P>,
) {
    // Ends in the parameter, the points there, and how often they were halved; the last is the next.
    let mut open = vec![(0.0, 1.0, a, b, 0)];
    while let Some((s, t, a, b, level)) = open.pop() {
        let r = 0.5 * (s + t);
        let middle = at(r);
        if level < HALVINGS && bends(&a, &middle, &b) {
            open.push((r, t, middle, b, level + 1));
            open.push((s, r, a, middle, level + 1));
        } else {
            out.push(a);
        }
    }
}

impl Outline {
    fn new(facets: &MovingFacets, facet: u32) -> Outline {
        const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let at = |xi| facets.jet(facet, xi).rho;
        let corners = CORNERS.map(at);
        let size = (corners[2] - corners[0])
            .norm()
            .max((corners[3] - corners[1]).norm());
        let mut points = Vec::new();
        for k in 0..4 {
            let (a, b) = (CORNERS[k], CORNERS[(k + 1) % 4]);
            if facets.degree() == 1 {
                points.push(corners[k]);
                continue;
            }
            let along = |s: f64| at([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]);
            let bends = |p: &Vec3, m: &Vec3, q: &Vec3| ((p + q) * 0.5 - m).norm() > BEND * size;
            divide(
                corners[k],
                corners[(k + 1) % 4],
                &along,
                &bends,
                &mut points,
            );
        }
        let jet = facets.jet(facet, [0.0; 2]);
        let normal = jet.rho_i[0].cross(&jet.rho_i[1]);
        Outline {
            facet,
            low: points.iter().fold(corners[0], |l, p| l.inf(p)),
            high: points.iter().fold(corners[0], |h, p| h.sup(p)),
            points,
            normal: normal.try_normalize(0.0).unwrap_or_else(Vec3::zeros),
        }
    }

    fn meets(&self, low: &Vec3, high: &Vec3) -> bool {
        (0..3).all(|c| self.low[c] <= high[c] && self.high[c] >= low[c])
    }
}

/// A slave face where it is now, as seen along its mean normal; lengths in the plane are relative to its size.
struct Place {
    quad: Quad,
    size: f64,
    middle: Vec3,
    normal: Vec3,
    axes: [Vec3; 2],
    /// Inverse of the derivative of the place in the plane by the parameters, at the middle.
    inverse: [[f64; 2]; 2],
}

impl Place {
    /// None where the face has no area.
    fn new(quad: Quad) -> Option<Place> {
        // The integral of the area vectors by 2 x 2 Gauss points.
        let g = 1.0 / 3f64.sqrt();
        let normal = [[-g, -g], [g, -g], [-g, g], [g, g]]
            .iter()
            .fold(Vec3::zeros(), |n, [u, v]| n + quad.area_vector(*u, *v));
        let size = normal.norm().sqrt();
        let normal = normal.try_normalize(0.0)?;
        let [a, b] = quad.tangents(0.0, 0.0);
        let first = (a - normal * a.dot(&normal)).try_normalize(0.0)?;
        let axes = [first, normal.cross(&first)];
        let j = |t: &Vec3, c: usize| t.dot(&axes[c]) / size;
        let determinant = j(&a, 0) * j(&b, 1) - j(&b, 0) * j(&a, 1);
        if !(determinant.is_finite() && determinant > 0.0) {
            return None;
        }
        let inverse = [
            [j(&b, 1) / determinant, -j(&b, 0) / determinant],
            [-j(&a, 1) / determinant, j(&a, 0) / determinant],
        ];
        Some(Place {
            middle: quad.point(0.0, 0.0),
            quad,
            size,
            normal,
            axes,
            inverse,
        })
    }

    /// Box around the face and what is nearer than `reach`.
    fn bounds(&self, reach: f64) -> [Vec3; 2] {
        let n = self.quad.count[0] as usize * self.quad.count[1] as usize;
        let nodes = &self.quad.nodes[..n];
        let margin = Vec3::repeat(reach);
        [
            nodes.iter().fold(nodes[0], |l, p| l.inf(p)) - margin,
            nodes.iter().fold(nodes[0], |h, p| h.sup(p)) + margin,
        ]
    }

    fn seen(&self, x: &Vec3) -> Point {
        let d = x - self.middle;
        self.axes.map(|e| d.dot(&e) / self.size)
    }

    /// The polygon of an outline in the parameters of the face, counterclockwise, as far as it is near the face.
    fn project(&self, outline: &[Vec3]) -> Polygon {
        let mut seen: Polygon = outline.iter().map(|x| self.seen(x)).collect();
        // The facet looks at the face, so that it is seen from behind.
        if clip::area(&seen) < 0.0 {
            seen.reverse();
        }
        // Far from the face its parameters mean nothing.
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let n = self.quad.count[0] as usize * self.quad.count[1] as usize;
        for x in &self.quad.nodes[..n] {
            let p = self.seen(x);
            for c in 0..2 {
                low[c] = low[c].min(p[c] - 0.05);
                high[c] = high[c].max(p[c] + 0.05);
            }
        }
        let near = clip::within(seen, low, high);
        let mut out = Polygon::new();
        for (k, a) in near.iter().enumerate() {
            let b = near[(k + 1) % near.len()];
            let along =
                |s: f64| self.parameters([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])]);
            let bends = |p: &Point, m: &Point, q: &Point| {
                (0.5 * (p[0] + q[0]) - m[0]).hypot(0.5 * (p[1] + q[1]) - m[1]) > BEND
            };
            divide(along(0.0), along(1.0), &along, &bends, &mut out);
        }
        out
    }

    /// Parameters of the point of the face that is seen at `x`; where the face turns away before it gets there, those of
    /// the plane through its middle.
    fn parameters(&self, x: Point) -> Point {
        let [[a, b], [c, d]] = self.inverse;
        let center = self.seen(&self.quad.point(0.0, 0.0));
        let r = [x[0] - center[0], x[1] - center[1]];
        let plane = [a * r[0] + b * r[1], c * r[0] + d * r[1]];
        let least = 0.1 / (a * d - b * c);
        let mut at = plane;
        for _ in 0..20 {
            let p = self.seen(&self.quad.point(at[0], at[1]));
            let r = [x[0] - p[0], x[1] - p[1]];
            let [t, s] = self.quad.tangents(at[0], at[1]);
            let j = |t: &Vec3, c: usize| t.dot(&self.axes[c]) / self.size;
            let determinant = j(&t, 0) * j(&s, 1) - j(&s, 0) * j(&t, 1);
            // Not finite, or turned over.
            if determinant.is_nan() || determinant <= least {
                return plane;
            }
            let step = [
                (j(&s, 1) * r[0] - j(&s, 0) * r[1]) / determinant,
                (j(&t, 0) * r[1] - j(&t, 1) * r[0]) / determinant,
            ];
            at = [at[0] + step[0], at[1] + step[1]];
            if step[0].hypot(step[1]) < 1e-13 {
                return at;
            }
        }
        plane
    }
}

/// Distance (length) up to which a master's facets cut the slave faces of a pair, from the depth of contact and the size
/// of a slave face.
pub fn reach(depth: f64, element_size: f64) -> f64 {
    2.0 * depth.max(element_size)
}
