//! Master surfaces in any scalar: the (rational) polynomials of moving facets, recovered from their shape functions, and a
//! rational patch; closest points on their faces, edges and vertices.
use crate::support::{self, V};
use covact_geometry::{Jet, MovingFacets, ShapeRows};
use nalgebra::DMatrix;
use num_dual::DualNum;

/// Which parameters of a foot are free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    Face,
    /// Along this direction only (one of the parameters).
    Edge(usize),
    Vertex,
}

/// A surface whose points are fixed combinations of nodes.
pub enum Surface {
    /// Facets with the coefficients of their shape functions: `[facet][node][power of xi1 + m power of xi2]`; of rational
    /// ones of the numerators, whose sum is the denominator.
    Facets {
        facets: Box<MovingFacets>,
        coefficients: Vec<Vec<Vec<f64>>>,
        rational: bool,
    },
    /// A rational bicubic patch over `[0, 1]^2` whose control points are the nodes.
    Patch { weights: [f64; 16] },
}

impl Surface {
    /// Shape functions of every facet sampled on a grid and interpolated: exact, for they are polynomials.
    pub fn of(facets: MovingFacets) -> Self {
        Self::weighted(facets, None::<fn(u32, [f64; 2]) -> f64>)
    }

    /// The same for facets whose shape functions are polynomials over the weight function `weight(facet, xi)`.
    pub fn weighted(facets: MovingFacets, weight: Option<impl Fn(u32, [f64; 2]) -> f64>) -> Self {
        let m = facets.degree() + 1;
        let at = |i: usize| -1.0 + 2.0 * i as f64 / (m - 1) as f64;
        let power =
            |xi: [f64; 2], k: usize| xi[0].powi((k % m) as i32) * xi[1].powi((k / m) as i32);
        let grid: Vec<[f64; 2]> = (0..m * m).map(|k| [at(k % m), at(k / m)]).collect();
        let vandermonde = DMatrix::from_fn(m * m, m * m, |i, k| power(grid[i], k));
        let inverse = vandermonde.try_inverse().expect("distinct points");
        let mut rows = ShapeRows::default();
        let coefficients = (0..facets.len() as u32)
            .map(|facet| {
                let n = facets.nodes(facet).len();
                let mut values = DMatrix::zeros(m * m, n);
                for (i, xi) in grid.iter().enumerate() {
                    facets.shape(facet, *xi, &mut rows);
                    let w = weight.as_ref().map_or(1.0, |w| w(facet, *xi));
                    (0..n).for_each(|k| values[(i, k)] = rows.n[k] * w);
                }
                let c = &inverse * values;
                (0..n)
                    .map(|k| c.column(k).iter().copied().collect())
                    .collect()
            })
            .collect();
        Surface::Facets {
            facets: Box::new(facets),
            coefficients,
            rational: weight.is_some(),
        }
    }

    /// Nodes of a facet.
    pub fn nodes(&self, facet: u32) -> Vec<usize> {
        match self {
            Surface::Facets { facets, .. } => {
                (facets.nodes(facet).iter()).map(|&n| n as usize).collect()
            }
            Surface::Patch { .. } => (0..16).collect(),
        }
    }

    /// Shape functions of a facet's nodes: value and derivatives 1, 2, 11, 12, 22.
    pub fn basis<D: DualNum<f64> + Copy>(&self, facet: u32, xi: [D; 2]) -> Vec<[D; 6]> {
        match self {
            Surface::Patch { weights } => {
                let b = support::basis(weights, xi);
                (0..16).map(|k| b.map(|row| row[k])).collect()
            }
            Surface::Facets {
                facets,
                coefficients,
                rational,
            } => {
                let m = facets.degree() + 1;
                let [u, v] = xi.map(powers);
                let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
                let monomials = orders
                    .map(|(a, b)| std::array::from_fn::<D, 16, _>(|k| u[a][k % 4] * v[b][k / 4]));
                let numerators: Vec<[D; 6]> = (coefficients[facet as usize].iter())
                    .map(|c| {
                        std::array::from_fn(|o| {
                            (c.iter().enumerate()).fold(D::zero(), |s, (k, c)| {
                                s + monomials[o][k % m + 4 * (k / m)] * *c
                            })
                        })
                    })
                    .collect();
                match rational {
                    true => quotients(&numerators),
                    false => numerators,
                }
            }
        }
    }

    /// Jet of a facet over all nodes of the surface.
    pub fn jet<D: DualNum<f64> + Copy>(&self, facet: u32, x: &[V<D>], xi: [D; 2]) -> Jet<D> {
        let basis = self.basis(facet, xi);
        let nodes = self.nodes(facet);
        let sum = |o: usize| {
            (nodes.iter().zip(&basis))
                .fold(V::from_element(D::zero()), |s, (&n, b)| s + x[n] * b[o])
        };
        Jet {
            rho: sum(0),
            rho_i: [sum(1), sum(2)],
            rho_ij: [sum(3), sum(4), sum(5)],
        }
    }

    /// The closest point again, from `start`, in the scalar of `x` and `q`: `steps` of Newton's method on what is free.
    pub fn project<D: DualNum<f64> + Copy>(
        &self,
        facet: u32,
        x: &[V<D>],
        q: &V<D>,
        start: [f64; 2],
        held: Held,
        steps: usize,
    ) -> [D; 2] {
        let mut xi = start.map(D::from);
        for _ in 0..steps {
            let j = self.jet(facet, x, xi);
            let d = q - j.rho;
            let g = j.rho_i.map(|r| r.dot(&d));
            let f11 = j.rho_i[0].dot(&j.rho_i[0]) - j.rho_ij[0].dot(&d);
            let f12 = j.rho_i[0].dot(&j.rho_i[1]) - j.rho_ij[1].dot(&d);
            let f22 = j.rho_i[1].dot(&j.rho_i[1]) - j.rho_ij[2].dot(&d);
            match held {
                Held::Face => {
                    let det = f11 * f22 - f12 * f12;
                    xi[0] += (f22 * g[0] - f12 * g[1]) / det;
                    xi[1] += (f11 * g[1] - f12 * g[0]) / det;
                }
                Held::Edge(0) => xi[0] += g[0] / f11,
                Held::Edge(_) => xi[1] += g[1] / f22,
                Held::Vertex => {}
            }
        }
        xi
    }
}

/// Functions over their sum: value and derivatives 1, 2, 11, 12, 22.
fn quotients<D: DualNum<f64> + Copy>(numerators: &[[D; 6]]) -> Vec<[D; 6]> {
    let w: [D; 6] = std::array::from_fn(|o| numerators.iter().fold(D::zero(), |s, n| s + n[o]));
    let quotient = |p: &[D; 6]| {
        let r = p[0] / w[0];
        let [r1, r2] = [1, 2].map(|i| (p[i] - r * w[i]) / w[0]);
        [
            r,
            r1,
            r2,
            (p[3] - r1 * w[1] * 2.0 - r * w[3]) / w[0],
            (p[4] - r1 * w[2] - r2 * w[1] - r * w[4]) / w[0],
            (p[5] - r2 * w[2] * 2.0 - r * w[5]) / w[0],
        ]
    };
    numerators.iter().map(quotient).collect()
}

/// Powers 0 to 3 with first and second derivatives.
fn powers<D: DualNum<f64> + Copy>(t: D) -> [[D; 4]; 3] {
    let (o, l) = (D::zero(), D::one());
    [
        [l, t, t * t, t * t * t],
        [o, l, t * 2.0, t * t * 3.0],
        [o, o, l * 2.0, t * 6.0],
    ]
}
