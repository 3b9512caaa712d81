//! Metals in elements: constant plastic strain on distorted elements.
use super::patch::{POINTS, QUADS};
use super::support::plain;
use covact::mesh::Mesh;
use covact::scene::{HardeningCurve, Material, Metal, SwiftHardening};
use covact::shell::{Formulation, H8Block, H8System, Law};
use covact_geometry::Vec3;
use nalgebra::{DMatrix, DVector};

fn metal(e: f64, hardening: HardeningCurve) -> Law {
    Law::new(&Material::J2(Metal {
        e,
        nu: 0.3,
        density: None,
        hardening,
    }))
    .unwrap()
}

/// Elements of one formulation with their states at the last accepted step and at present.
struct Body {
    block: H8Block,
    committed: Vec<f64>,
    state: Vec<f64>,
    nodes: usize,
}

impl Body {
    fn new(mesh: &Mesh, formulation: Formulation, law: Law) -> Body {
        let block = H8Block::new(mesh, formulation, law).unwrap();
        let state = vec![0.0; block.state_len() * block.elements()];
        Body {
            block,
            committed: state.clone(),
            state,
            nodes: mesh.nodes.len(),
        }
    }

    fn local(&self, e: usize, u: &DVector<f64>) -> [Vec3; 8] {
        (self.block.nodes_of(e)).map(|n| u.fixed_rows::<3>(3 * n as usize).into())
    }

    fn assemble(&mut self, u: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let n = 3 * self.nodes;
        let (mut f, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        let (len, mut out) = (self.block.state_len(), H8System::default());
        for e in 0..self.block.elements() {
            let local = self.local(e, u);
            let state = &mut self.state[e * len..(e + 1) * len];
            self.block.evaluate(e, &local, state, &mut out).unwrap();
            let nodes = self.block.nodes_of(e);
            let dof = |r: usize| 3 * nodes[r / 3] as usize + r % 3;
            for c in 0..24 {
                f[dof(c)] += out.f[c];
                for r in 0..24 {
                    k[(dof(r), dof(c))] += out.k[24 * c + r];
                }
            }
        }
        (f, k)
    }

    fn update_alpha(&mut self, du: &DVector<f64>) {
        let (len, alphas) = (self.block.state_len(), self.block.alpha_len());
        for e in 0..self.block.elements() {
            let local = self.local(e, du);
            let state = &mut self.state[e * len..(e + 1) * len];
            let alpha = state[..alphas].to_vec();
            self.block.update_alpha(state, &local, 1.0, &alpha);
        }
    }

    fn accept(&mut self, u: &DVector<f64>) {
        let len = self.block.state_len();
        for e in 0..self.block.elements() {
            let local = self.local(e, u);
            let state = &mut self.state[e * len..(e + 1) * len];
            self.block.remember(e, &local, state).unwrap();
        }
        self.committed.clone_from(&self.state);
    }

    /// Equivalent plastic strain at all points.
    fn plastic_strains(&self) -> Vec<f64> {
        let (len, history) = (self.block.state_len(), self.block.history_len());
        (self.committed.chunks(len))
            .flat_map(|state| {
                state[len - history..]
                    .chunks_exact(14)
                    .map(|point| point[6])
            })
            .collect()
    }
}

/// MacNeal's distorted plate, its border displaced linearly and its thickness free, in five steps: plastic strains are the
/// same at all points, nothing presses through the thickness, and Newton's method converges quadratically.
#[test]
fn constant_plastic_strain_is_exact() {
    for formulation in [Formulation::Layered, Formulation::Eas7] {
        let nodes: Vec<Vec3> = [-0.01, 0.01]
            .iter()
            .flat_map(|z| POINTS.iter().map(|p| Vec3::new(p[0], p[1], *z)))
            .collect();
        let connectivity = (QUADS.iter())
            .flat_map(|q| (0..8).map(|a| q[a & 3] + 8 * (a as u32 >> 2)))
            .collect();
        let hardening = HardeningCurve::Swift(SwiftHardening {
            strength: 0.5,
            offset: 0.01,
            exponent: 0.2,
        });
        let mut body = Body::new(
            &plain(nodes.clone(), connectivity),
            formulation,
            metal(200.0, hardening),
        );
        let mut u = DVector::zeros(48);
        let mut last = vec![];
        for step in 1..=5 {
            let part = f64::from(step) / 5.0;
            let held = |dof: usize| {
                let (x, bottom) = (nodes[dof / 3], dof / 3 < 8);
                match dof % 3 {
                    0 if dof / 3 % 8 < 4 => Some(part * (0.06 * x.x + 0.03 * x.y)),
                    1 if dof / 3 % 8 < 4 => Some(part * (0.01 * x.x - 0.02 * x.y)),
                    2 if bottom => Some(0.0),
                    _ => None,
                }
            };
            last.clear();
            for _ in 0..9 {
                let (f, mut k) = body.assemble(&u);
                let mut r = -f.clone();
                for dof in 0..48 {
                    if let Some(value) = held(dof) {
                        k.row_mut(dof).fill(0.0);
                        k[(dof, dof)] = 1.0;
                        r[dof] = value - u[dof];
                    }
                }
                let free = (0..48).filter(|dof| held(*dof).is_none());
                last.push(free.map(|dof| f[dof].abs()).fold(0.0, f64::max) / f.amax().max(1e-12));
                let du = k.lu().solve(&r).unwrap();
                body.update_alpha(&du);
                u += du;
            }
            body.accept(&u);
        }
        let p = body.plastic_strains();
        let (low, high) = p
            .iter()
            .fold((f64::MAX, 0f64), |(a, b), p| (a.min(*p), b.max(*p)));
        println!(
            "{formulation:?}: p {high}, spread {:e}, {last:?}",
            high - low
        );
        assert!((high - 0.0616).abs() < 1e-4 && high - low < 1e-9 * high);
        let len = body.block.state_len();
        for e in 0..5 {
            let mut stress = [[0.0; 6]; 8];
            let local = body.local(e, &u);
            let state = &body.committed[e * len..(e + 1) * len];
            body.block.stresses(e, &local, state, &mut stress).unwrap();
            for s in stress {
                assert!(s[2].abs() < 1e-9 * s[0].abs(), "{s:?}");
            }
        }
        // Each residual is the square of the one before, down to rounding.
        for k in [3, 4, 5] {
            assert!(
                last[k] < 2.0 * last[k - 1].powi(2) + 1e-12,
                "{formulation:?} {last:?}"
            );
        }
    }
}
