//! How far an element is from the shape it computes best in, and what that costs.
//!
//! Three numbers per element, all zero for a parallelepiped of any proportions and for regular elements of cylinders with
//! directors along the radius (`tilt` of quadratic ones, which are parabolas, third order in their angle):
//!
//! - `plane`: largest logarithmic strain, `max |ln(stretch)|`, that takes the middle of the element's mid-surface (of its
//!   corners) to one of its corners: the variation of the Jacobian in the surface. 0.15, 0.4 and 0.9: a vertex of square
//!   elements moved along the diagonal by 1/8, 1/4, 3/8 of their length.
//! - `midside` (quadratic elements): `|x_,rr| / |x_,r|` in the tangent plane, along both edges and the line between, both
//!   ways: four times the offset of a node from the middle of its line, over the length of the line. Half the angle that
//!   an edge in the form of an arc turns by.
//! - `tilt`: variation over the element of the angle between director and normal (tangent of it), where the transverse
//!   shear strain is taken.
//!
//! Taper of the thickness is not among them: it changes the thickness by half within an element and the patch test by
//! 0.2 % only.
//!
//! # What the limits mean
//! [`limits`] are the values above which the error passes 0.5 % in one of the families of `tests/shell/distortion.rs`:
//! states of constant stretching and of constant curvature on patches of 2 x 2 elements (error of displacements over the
//! largest of them), and the Scordelis-Lo roof on meshes that are right within 0.5 % when regular. Straight-sided
//! elements of a flat plate pass both patch tests exactly, whatever their `plane`. No limit holds for all problems: the
//! cylinder pinched by point forces, whose bending a regular mesh hardly resolves, loses (rows of vertices moved by 1/8, a
//! `plane` of 0.15) 1.8 % on 8 x 8 and 0.15 % on 16 x 16 quadratic elements, 3.5 % on 16 x 16 and 0.8 % on 32 x 32
//! linear ones.
use crate::mesh::{ElementKind, Mesh};
use covact_geometry::Vec3;

/// Distortion of one element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Distortion {
    /// Variation of the Jacobian in the surface; infinite where a corner is flat or turned over.
    pub plane: f64,
    /// Nodes off the middle of edges; 0 for linear elements.
    pub midside: f64,
    /// Variation of the directors against the normal.
    pub tilt: f64,
}

/// Values of the three parts above which the error passes 0.5 %.
pub const fn limits(kind: ElementKind) -> Distortion {
    match kind {
        ElementKind::H8 => Distortion {
            plane: 0.55,
            midside: f64::INFINITY,
            tilt: 0.08,
        },
        // What the shape of a knot span costs was not measured.
        ElementKind::Nurbs => Distortion {
            plane: f64::INFINITY,
            midside: f64::INFINITY,
            tilt: f64::INFINITY,
        },
        ElementKind::Q18 => Distortion {
            plane: 0.95,
            midside: 0.18,
            tilt: 0.05,
        },
    }
}

impl Distortion {
    /// The largest part over its limit: above 1 the error may pass 0.5 %.
    pub fn share(&self, kind: ElementKind) -> f64 {
        let limit = limits(kind);
        (self.plane / limit.plane)
            .max(self.midside / limit.midside)
            .max(self.tilt / limit.tilt)
    }

    /// The part that decides, in words.
    pub fn cause(&self, kind: ElementKind) -> &'static str {
        let (limit, share) = (limits(kind), self.share(kind));
        if self.plane / limit.plane == share {
            "skewed or tapered in the surface"
        } else if self.midside / limit.midside == share {
            "nodes off the middle of edges"
        } else {
            "edges through the thickness not along the normal"
        }
    }
}

/// The most distorted element of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MostDistorted {
    /// Number of the element.
    pub element: u32,
    /// Mean of its corners.
    pub place: Vec3,
    /// How it is distorted.
    pub distortion: Distortion,
    /// [`Distortion::share`].
    pub share: f64,
    /// Elements above the limit.
    pub above: usize,
}

/// Distortion of an element from its nodes in the order of [`ElementKind`] (8 or 18). `None`: another number of nodes.
pub fn distortion(kind: ElementKind, nodes: &[Vec3]) -> Option<Distortion> {
    if nodes.len() != kind.nodes() || kind == ElementKind::Nurbs {
        return None;
    }
    let lines = match kind {
        ElementKind::H8 => 2,
        ElementKind::Q18 | ElementKind::Nurbs => 3,
    };
    let layer = lines * lines;
    let middle = |a: usize| (nodes[a] + nodes[a + layer]) * 0.5;
    let director = |a: usize| (nodes[a + layer] - nodes[a]) * 0.5;
    // Corners in the order i + 2 j.
    let corner = |c: usize| (c & 1) * (lines - 1) + (c >> 1) * (lines - 1) * lines;
    let plane = plane(&std::array::from_fn(|c| middle(corner(c))));
    Some(match kind {
        ElementKind::H8 => Distortion {
            plane,
            midside: 0.0,
            tilt: tilt_linear(&std::array::from_fn(middle), &std::array::from_fn(director)),
        },
        ElementKind::Q18 | ElementKind::Nurbs => {
            let y: [Vec3; 9] = std::array::from_fn(middle);
            Distortion {
                plane,
                midside: midside(&y),
                tilt: tilt_quadratic(&y, &std::array::from_fn(director)),
            }
        }
    })
}

/// The most distorted element. `None` for a mesh without elements, or with nodes it does not have.
pub fn most_distorted(mesh: &Mesh) -> Option<MostDistorted> {
    let mut worst: Option<MostDistorted> = None;
    let mut above = 0;
    let mut nodes = Vec::with_capacity(mesh.kind.nodes());
    for e in 0..mesh.elements() {
        nodes.clear();
        for &n in mesh.element(e) {
            nodes.push(*mesh.nodes.get(n as usize)?);
        }
        let distortion = distortion(mesh.kind, &nodes)?;
        let share = distortion.share(mesh.kind);
        above += usize::from(share > 1.0);
        if worst.is_none_or(|w| share > w.share) {
            worst = Some(MostDistorted {
                element: e as u32,
                place: mesh.element_center(e),
                distortion,
                share,
                above: 0,
            });
        }
    }
    worst.map(|w| MostDistorted { above, ..w })
}

/// Largest logarithmic strain between the centre of a bilinear surface and its corners.
fn plane(x: &[Vec3; 4]) -> f64 {
    // Derivatives along r on the lines s = -1 and +1, along s on r = -1 and +1.
    let along_r = [x[1] - x[0], x[3] - x[2]];
    let along_s = [x[2] - x[0], x[3] - x[1]];
    let centre = [
        (along_r[0] + along_r[1]) * 0.5,
        (along_s[0] + along_s[1]) * 0.5,
    ];
    let metric = |g: &[Vec3; 2]| [g[0].dot(&g[0]), g[1].dot(&g[1]), g[0].dot(&g[1])];
    let [a, b, c] = metric(&centre);
    let (det, normal) = (a * b - c * c, centre[0].cross(&centre[1]));
    let mut largest = 0.0f64;
    for corner in 0..4 {
        let g = [along_r[corner >> 1], along_s[corner & 1]];
        let [p, q, r] = metric(&g);
        // Eigenvalues of the metric here in terms of that at the centre: squares of the stretches.
        let half = 0.5 * (p * b + q * a - 2.0 * r * c) / det;
        let product = (p * q - r * r) / det;
        let high = half + (half * half - product).max(0.0).sqrt();
        let low = product / high;
        let turned = g[0].cross(&g[1]).dot(&normal) > 0.0;
        // Written so that NaN counts as flat.
        if !(low > 0.0 && turned) {
            return f64::INFINITY;
        }
        largest = largest.max(0.5 * high.ln().abs().max(low.ln().abs()));
    }
    largest
}

/// Second derivative over the first in the tangent plane, along six lines of a biquadratic surface.
fn midside(y: &[Vec3; 9]) -> f64 {
    let mut largest = 0.0f64;
    for line in 0..3 {
        for (start, step) in [(3 * line, 1), (line, 3)] {
            let [a, b, c] = [0, 1, 2].map(|k| y[start + k * step]);
            let (first, second) = ((c - a) * 0.5, a - b * 2.0 + c);
            // The other direction, across the line in its middle.
            let other = 3 / step;
            let across = match line {
                0 => {
                    (y[start + step + other] * 4.0
                        - y[start + step] * 3.0
                        - y[start + step + 2 * other])
                        * 0.5
                }
                1 => (y[start + step + other] - y[start + step - other]) * 0.5,
                _ => {
                    (y[start + step] * 3.0 - y[start + step - other] * 4.0
                        + y[start + step - 2 * other])
                        * 0.5
                }
            };
            let normal = first.cross(&across).normalize();
            let inside = second - normal * normal.dot(&second);
            largest = largest.max(inside.norm() / first.norm());
        }
    }
    not_nan(largest)
}

/// Tangents of the angles between a director and the normal, along both surface directions.
fn tilt([r, s]: &[Vec3; 2], director: &Vec3) -> [f64; 2] {
    let normal = r.cross(s).normalize();
    let height = director.dot(&normal);
    [r, s].map(|g| director.dot(g) / (g.norm() * height))
}

fn not_nan(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}

/// H8: along r in the middle of both edges s = -+1, along s of both edges r = -+1.
fn tilt_linear(y: &[Vec3; 4], d: &[Vec3; 4]) -> f64 {
    let along_r = [y[1] - y[0], y[3] - y[2]];
    let along_s = [y[2] - y[0], y[3] - y[1]];
    let mean = [along_r[0] + along_r[1], along_s[0] + along_s[1]];
    let centre = tilt(&mean, &(d[0] + d[1] + d[2] + d[3]));
    let mut largest = 0.0f64;
    for side in 0..2 {
        let (a, b) = (2 * side, 2 * side + 1);
        let found = tilt(&[along_r[side], mean[1]], &(d[a] + d[b]))[0] - centre[0];
        largest = nan_max(largest, found.abs());
        let (a, b) = (side, side + 2);
        let found = tilt(&[mean[0], along_s[side]], &(d[a] + d[b]))[1] - centre[1];
        largest = nan_max(largest, found.abs());
    }
    largest
}

/// Q18: at all nine places.
fn tilt_quadratic(y: &[Vec3; 9], d: &[Vec3; 9]) -> f64 {
    // Derivative in the three nodes of a line.
    let derivative = |line: [Vec3; 3], at: usize| {
        let [a, b, c] = line;
        match at {
            0 => b * 2.0 - a * 1.5 - c * 0.5,
            1 => (c - a) * 0.5,
            _ => a * 0.5 - b * 2.0 + c * 1.5,
        }
    };
    let at = |i: usize, j: usize| {
        let g = [
            derivative([y[3 * j], y[3 * j + 1], y[3 * j + 2]], i),
            derivative([y[i], y[i + 3], y[i + 6]], j),
        ];
        tilt(&g, &d[i + 3 * j])
    };
    let centre = at(1, 1);
    let mut largest = 0.0f64;
    for j in 0..3 {
        for i in 0..3 {
            for (found, centre) in at(i, j).iter().zip(centre) {
                largest = nan_max(largest, (found - centre).abs());
            }
        }
    }
    largest
}

/// Like `max`, but NaN counts as infinite.
fn nan_max(a: f64, b: f64) -> f64 {
    a.max(not_nan(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(kind: ElementKind, x: impl Fn(f64, f64, f64) -> [f64; 3]) -> Vec<Vec3> {
        let p = if kind == ElementKind::H8 { 1 } else { 2 };
        let mut out = vec![];
        for k in 0..2 {
            for j in 0..=p {
                for i in 0..=p {
                    let (a, b) = (i as f64 / p as f64, j as f64 / p as f64);
                    out.push(Vec3::from(x(a, b, k as f64 - 0.5)));
                }
            }
        }
        out
    }

    fn of(kind: ElementKind, x: impl Fn(f64, f64, f64) -> [f64; 3]) -> Distortion {
        distortion(kind, &nodes(kind, x)).unwrap()
    }

    const KINDS: [ElementKind; 2] = [ElementKind::H8, ElementKind::Q18];

    #[test]
    fn regular_elements_are_not_distorted() {
        for kind in KINDS {
            let slab = of(kind, |a, b, c| {
                [3.0 * a + 0.7 * b + 0.2 * c, 0.1 * a + b, 0.05 * c + 0.3 * a]
            });
            let sector = of(kind, |a, b, c| {
                let (angle, r) = (0.4 * a, 10.0 + c);
                [r * angle.sin(), 2.0 * b, r * angle.cos()]
            });
            for d in [slab, sector] {
                // Radial directors of a parabola in place of the arc: third order in the angle.
                assert!(d.plane < 1e-12 && d.tilt < 2e-3, "{kind:?} {d:?}");

                assert!(d.midside < 1e-12, "{kind:?} {d:?}");
            }
        }
    }

    /// A trapezoid 1 and 2 wide, 1 high: at the middle the stretches along x are 1.5, at the corners 1 and 2, with a
    /// shear; by hand for the rectangle's sides moved inwards.
    #[test]
    fn parts_by_hand() {
        for kind in KINDS {
            // Sides turned by 1/4 at the middle's width: metric at the corner of the narrow side against the centre.
            let d = of(kind, |a, b, c| [(a - 0.5) * (2.0 - b), b, 0.1 * c]);
            // Corner (-1/2 of width 1): g_r = (1, 0), g_s = (1/2, 1); centre: (1.5, 0), (0, 1).
            let (p, q, r) = (1.0 / 2.25, 1.25, 0.5 / 1.5);
            let root = (0.25f64 * (p - q) * (p - q) + r * r).sqrt();
            let low: f64 = 0.5 * (p + q) - root;
            assert!((d.plane + 0.5 * low.ln()).abs() < 1e-12, "{kind:?} {d:?}");
            assert!(d.tilt < 1e-12);
            // Directors that lean by 0.1 c at one end and not at the other: 0.05 about their mean.
            let d = of(kind, |a, b, c| [a + 0.02 * c * b, b, 0.2 * c]);
            assert!((d.tilt - 0.05).abs() < 1e-12, "{kind:?} {d:?}");
            // Turned over.
            let d = of(kind, |a, b, c| {
                let m = 0.7 * a * b;
                [a - m, b - m, c]
            });
            assert_eq!(d.plane, f64::INFINITY);
            assert!(d.share(kind) > 1.0 && d.cause(kind).starts_with("skewed"));
        }
        // The middle node of the edge s = -1 moved by 1/40 of its length along it: 4 / 40.
        let mut x = nodes(ElementKind::Q18, |a, b, c| [a, b, 0.1 * c]);
        x[1].x += 0.025;
        x[10].x += 0.025;
        let d = distortion(ElementKind::Q18, &x).unwrap();
        assert!((d.midside - 0.1).abs() < 1e-12, "{d:?}");
        assert_eq!(d.plane, 0.0);
        assert!(distortion(ElementKind::H8, &x).is_none());
    }
}
