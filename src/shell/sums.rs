//! What the points of a solid-shell element gather before its forces and tangent are put together ([`super::tangent`]), for any
//! number of points over the thickness.
use super::VOIGT;
use super::kinematics::V;
use super::reference::{BASE, LINE, TYING, WEIGHT, sign};

/// Lanes: three combinations of bottom and top times six component pairs.
pub(super) const LANES: usize = 18;

/// What the loop over Gauss points gathers, for `P` parameters.
pub(super) struct Sums<const P: usize> {
    /// Membrane blocks at the in-plane points: `[point][11, 22, 12, 21][lane]`.
    pub membrane: [[[f64; LANES]; 4]; 4],
    /// Coupling of displacements `8 axis + node` with parameters; the last slot are the membrane forces.
    pub z: [[f64; 24]; P],
    /// Stiffness among parameters; the last column are the forces on them.
    pub c: [[f64; P]; P],
    pub energy: f64,
    /// Forces on the tying points by the stresses of the geometric part; nothing where these are the true ones.
    pub carried: [f64; TYING],
}

impl<const P: usize> Sums<P> {
    #[inline(always)]
    pub fn new() -> Self {
        Sums {
            membrane: [[[0.0; LANES]; 4]; 4],
            z: [[0.0; 24]; P],
            c: [[0.0; P]; P],
            energy: 0.0,
            carried: [0.0; TYING],
        }
    }
}

/// What the points over the thickness at one in-plane point gather, before shape functions along r and s: coupling of displacements
/// `[bottom, top][along g_1, g_2][axis]` with the `B` base strains, and their stiffness; the last column are the forces.
pub(super) struct Column<const B: usize> {
    pub line: [[[[f64; B]; 3]; 2]; 2],
    pub base: [[f64; B]; B],
}

impl<const B: usize> Column<B> {
    #[inline(always)]
    pub fn new() -> Self {
        Column {
            line: [[[[0.0; B]; 3]; 2]; 2],
            base: [[0.0; B]; B],
        }
    }

    /// Adds one point: the stresses of unit base strains by the membrane components 11, 22, 12 (the last column the stress itself),
    /// the current vectors g_1 and g_2, and the linear shape functions along t.
    #[inline(always)]
    pub fn add_line(
        &mut self,
        [m11, m22, m12]: [&[f64; B]; 3],
        (g1, g2): (&V<f64>, &V<f64>),
        along_t: &[f64; 2],
    ) {
        for x in 0..3 {
            for n in 0..B {
                let along1 = m11[n] * g1[x] + m12[n] * g2[x];
                let along2 = m12[n] * g1[x] + m22[n] * g2[x];
                self.line[0][0][x][n] += along_t[0] * along1;
                self.line[0][1][x][n] += along_t[0] * along2;
                self.line[1][0][x][n] += along_t[1] * along1;
                self.line[1][1][x][n] += along_t[1] * along2;
            }
        }
    }
}

#[inline(always)]
const fn used<const NE: usize, const P: usize>(parameter: usize) -> bool {
    parameter < TYING + NE || parameter == P - 1
}

/// Membrane blocks of one Gauss point: `Q_ab[ij] = c^(a k b l) g_k,i g_l,j + S^ab delta_ij`, times the three products
/// of shape functions along t.
#[inline(always)]
pub(super) fn add_membrane(
    sum: &mut [[f64; LANES]; 4],
    c: &[[f64; 6]; 6],
    s: &[f64; 6],
    g1: &V<f64>,
    g2: &V<f64>,
    along_t: &[f64; 2],
) {
    let mut q = [[0.0; 6]; 4];
    for (lane, (i, j)) in VOIGT.into_iter().enumerate() {
        let (aa, bb) = (g1[i] * g1[j], g2[i] * g2[j]);
        let (ab, ba) = (g1[i] * g2[j], g2[i] * g1[j]);
        let (mixed, sides) = (ab + ba, c[0][3] * aa + c[1][3] * bb);
        q[0][lane] = c[0][0] * aa + c[0][3] * mixed + c[3][3] * bb;
        q[1][lane] = c[1][1] * bb + c[1][3] * mixed + c[3][3] * aa;
        q[2][lane] = c[0][1] * ab + c[3][3] * ba + sides;
        q[3][lane] = c[0][1] * ba + c[3][3] * ab + sides;
    }
    for lane in 0..3 {
        q[0][lane] += s[0];
        q[1][lane] += s[1];
        q[2][lane] += s[3];
        q[3][lane] += s[3];
    }
    let [lower, upper] = *along_t;
    for (combination, w) in [lower * lower, lower * upper, upper * upper]
        .into_iter()
        .enumerate()
    {
        for kind in 0..4 {
            for lane in 0..6 {
                sum[kind][6 * combination + lane] += w * q[kind][lane];
            }
        }
    }
}

/// Spreads the sums of one in-plane point to parameters and nodes.
#[inline(always)]
pub(super) fn add_parameters<const NE: usize, const B: usize, const P: usize>(
    sums: &mut Sums<P>,
    q: usize,
    Column { line, base }: &Column<B>,
) {
    let (i, j) = (q & 1, q >> 1);
    let n1 = [0, 1, 2, 3].map(|c| 0.5 * sign(c, 0) * LINE[j][c >> 1]);
    let n2 = [0, 1, 2, 3].map(|c| 0.5 * sign(c, 1) * LINE[i][c & 1]);
    let mut nodes = [[0.0; 24]; B];
    for (n, nodes) in nodes.iter_mut().enumerate() {
        for x in 0..3 {
            for t in 0..2 {
                let (a, b) = (line[t][0][x][n], line[t][1][x][n]);
                for c in 0..4 {
                    nodes[8 * x + 4 * t + c] = n1[c] * a + n2[c] * b;
                }
            }
        }
    }
    let w = &WEIGHT[q];
    for p in 0..P {
        if used::<NE, P>(p) {
            for r in 0..24 {
                sums.z[p][r] += w[p] * nodes[BASE[p]][r];
            }
        }
    }
    let mut spread = [[0.0; P]; B];
    for v in 0..B - 1 {
        for p in 0..P {
            spread[v][p] = w[p] * base[v][BASE[p]];
        }
    }
    for p in 0..TYING + NE {
        for n in 0..P {
            sums.c[p][n] += w[p] * spread[BASE[p]][n];
        }
    }
}
