//! What is worked out once about the points of a knot span.
use super::super::kinematics::{V, dot};
use super::frame::{DOFS, Frame, NODES, Normal, Rest, Second, combine, metric};
use super::plane_stress::Place;
use covact_geometry::{NurbsPatch, PatchShape};

/// Gauss points of a span with assumed membrane strains.
pub(super) const ASSUMED: usize = 9;

/// Gauss points of a span without.
pub(super) const PLAIN: usize = 16;

/// Takes covariant strains (11, 22, twice 12) to the Cartesian axes of the element.
pub(super) type Turn = [[f64; 3]; 3];

/// A Gauss point.
#[derive(Debug, Clone)]
pub(super) struct GaussPoint {
    pub n: Second,
    pub rest: Rest,
    pub place: Place,
    /// Undeformed area.
    pub weight: f64,
    pub turn: Turn,
    /// The inverse of `turn`.
    pub back: Turn,
}

/// A point that membrane strains are taken from.
#[derive(Debug, Clone)]
pub(super) struct TyingPoint {
    pub n: [[f64; NODES]; 2],
    /// Undeformed tangents.
    pub rest: [V<f64>; 2],
    pub turn: Turn,
}

/// A point on an edge of the patch where the normal is held.
#[derive(Debug, Clone)]
pub(super) struct BorderPoint {
    pub n: [[f64; NODES]; 2],
    /// The direction that is compared with the normal.
    pub toward: V<f64>,
    /// The normal stays along `toward`, else across it.
    pub along: bool,
    /// `n . toward` at rest, which is round-off where the normal stays across.
    pub rest: f64,
    /// Stiffness times undeformed length.
    pub stiffness: f64,
}

/// Shape functions of a span at a point, on the stack.
pub(super) struct Shapes {
    pub nodes: [u32; NODES],
    pub n: [f64; NODES],
    pub second: Second,
}

/// The shape functions of a bicubic patch in a span.
pub(super) fn shapes(
    patch: &NurbsPatch,
    span: [usize; 2],
    xi: [f64; 2],
    room: &mut PatchShape,
) -> Shapes {
    patch.shape_in_span(span, xi, room);
    let mut out = Shapes {
        nodes: [0; NODES],
        n: [0.0; NODES],
        second: [[0.0; NODES]; 5],
    };
    for a in 0..NODES {
        out.nodes[a] = room.indices[a];
        out.n[a] = room.n[a];
        for (k, value) in (room.n_i[a].iter())
            .chain([room.n_ij[a][0], room.n_ij[a][2], room.n_ij[a][1]].iter())
            .enumerate()
        {
            out.second[k][a] = *value;
        }
    }
    out
}

/// `T` of a point: `e_1` is `first` projected on the tangent plane, `e_2 = n x e_1`.
fn turn(at: &Normal<f64>, first: &V<f64>) -> Turn {
    let along = dot(first, &at.n);
    let e1 = [0, 1, 2].map(|c| first[c] - along * at.n[c]);
    let size = dot(&e1, &e1).sqrt();
    let e1 = e1.map(|c| c / size);
    let e2 = super::frame::cross(&at.n, &e1);
    let g = |i: usize, e: &V<f64>| dot(&at.up[i], e);
    let (g11, g21, g12, g22) = (g(0, &e1), g(1, &e1), g(0, &e2), g(1, &e2));
    [
        [g11 * g11, g21 * g21, g11 * g21],
        [g12 * g12, g22 * g22, g12 * g22],
        [2.0 * g11 * g12, 2.0 * g21 * g22, g11 * g22 + g12 * g21],
    ]
}

fn invert(m: &Turn) -> Turn {
    let minor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let det: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / det))
}

impl GaussPoint {
    pub fn new(shapes: &Shapes, x: &[V<f64>; NODES], first: &V<f64>, weight: f64) -> Self {
        let p = shapes.second.each_ref().map(|n| combine(n, x));
        let frame = Frame::new(p);
        let turn = turn(&frame.at, first);
        GaussPoint {
            n: shapes.second,
            rest: Rest {
                p,
                n: frame.at.n,
                area: frame.at.area,
            },
            place: Place {
                metric: metric(&frame.at.r),
                curvature: frame.h,
            },
            weight: weight * frame.at.area,
            back: invert(&turn),
            turn,
        }
    }
}

impl TyingPoint {
    pub fn new(shapes: &Shapes, x: &[V<f64>; NODES], first: &V<f64>) -> Self {
        let n = [shapes.second[0], shapes.second[1]];
        let at = Normal::new([combine(&n[0], x), combine(&n[1], x)]);
        TyingPoint {
            n,
            rest: at.r,
            turn: turn(&at, first),
        }
    }
}

/// Values at a point of the nine biquadratic functions of the tying points, which lie at 0, 1/2, 1 in both directions.
pub(super) fn biquadratic(s: f64, t: f64) -> [f64; ASSUMED] {
    let line = |s: f64| {
        [
            (2.0 * s - 1.0) * (s - 1.0),
            4.0 * s * (1.0 - s),
            s * (2.0 * s - 1.0),
        ]
    };
    let (a, b) = (line(s), line(t));
    std::array::from_fn(|c| a[c % 3] * b[c / 3])
}

/// Rows of the membrane strains of a point by the degrees of freedom: `deps_ij = (rho_i.drho_j + rho_j.drho_i) / 2`.
#[inline(always)]
pub(super) fn membrane_rows(n: [&[f64; NODES]; 2], r: &[V<f64>; 2], out: &mut [[f64; DOFS]; 3]) {
    for a in 0..NODES {
        for c in 0..3 {
            out[0][3 * a + c] = n[0][a] * r[0][c];
            out[1][3 * a + c] = n[1][a] * r[1][c];
            out[2][3 * a + c] = n[0][a] * r[1][c] + n[1][a] * r[0][c];
        }
    }
}
