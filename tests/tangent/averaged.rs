//! The averaged gap on two slave faces: residual and tangent against hyper-dual numbers of its energy.
use crate::cases::*;
use crate::support::V;
use crate::surface::{Held, Surface};
use covact::contact::averaged::{GapRow, NodalGap, gap_slots, point, traction};
use covact::contact::kernel::{self, NodeRow, Normal};
use covact::contact::law::Penalty;
use covact::contact::moving::{MovingMaster, master_row};
use covact::contact::rigid::Exact;
use covact_geometry::{Frame, MovingFacets, ShapeRows};
use nalgebra::{DMatrix, DVector};
use num_dual::{DualNum, HyperDual64};

const LAW: Penalty = Penalty { eps_n: EPS_N };

/// Two faces side by side over one facet of a master; the slave side rises through its surface, so that one end of it is
/// open.
struct Pair {
    slave: Vec<V<f64>>,
    /// Shape functions of all slave nodes, and the area.
    points: Vec<Point>,
    master: Vec<V<f64>>,
    surface: Surface,
}

fn pair(slave_order: usize, master_order: usize) -> Pair {
    let warped = |x: f64, y: f64| {
        V::new(
            x + 0.06 * (2.0 * y).sin(),
            y - 0.05 * x * y,
            0.15 * x * x - 0.2 * y * y + 0.12 * x * y,
        )
    };
    let (master, facets) = mesh(1, master_order, warped);
    let surface = Surface::of(plain(&master, &facets, master_order));
    // Nodes of a strip of two faces, x fastest.
    let o = slave_order;
    let wide = 2 * o + 1;
    let slave: Vec<V<f64>> = (0..wide * (o + 1))
        .map(|k| {
            let x = -1.0 + 2.0 * (k % wide) as f64 / (wide - 1) as f64;
            let y = -1.0 + 2.0 * (k / wide) as f64 / o as f64;
            warped(0.7 * x + 0.1 * y, 0.6 * y - 0.1 * x) + V::new(0.0, 0.0, 0.05 * x + 0.01 * y)
        })
        .collect();
    let mut points = Vec::new();
    for face in 0..2 {
        let m = o + 1;
        let nodes: Vec<usize> = (0..m * m)
            .map(|k| face * o + k % m + wide * (k / m))
            .collect();
        let x: Vec<V<f64>> = nodes.iter().map(|&n| slave[n]).collect();
        for local in slave_points(&x, Scheme::Gauss(o + 1)) {
            let mut shape = vec![0.0; slave.len()];
            nodes
                .iter()
                .zip(&local.shape)
                .for_each(|(&n, s)| shape[n] = *s);
            let area = local.area;
            points.push(Point { shape, area });
        }
    }
    Pair {
        slave,
        points,
        master,
        surface,
    }
}

impl Pair {
    fn facets(&self) -> &MovingFacets {
        match &self.surface {
            Surface::Facets { facets, .. } => facets,
            Surface::Patch { .. } => unreachable!("facets"),
        }
    }

    /// Energy `sum_A 1/2 eps m_A g_A^2` over the closed nodes.
    fn energy<D: DualNum<f64> + Copy>(&self, x: &[V<D>], xi: &[[f64; 2]], closed: &[bool]) -> D {
        let (slave, master) = x.split_at(self.slave.len());
        let mut moment = vec![D::zero(); slave.len()];
        let mut area = vec![0.0; slave.len()];
        for (p, xi) in self.points.iter().zip(xi) {
            let q = (slave.iter().zip(&p.shape))
                .fold(V::from_element(D::zero()), |s, (x, n)| s + x * D::from(*n));
            let xi = self.surface.project(0, master, &q, *xi, Held::Face, 3);
            let frame = Frame::new(&self.surface.jet(0, master, xi), 1.0).unwrap();
            let xi3 = (q - frame.rho).dot(&frame.n);
            for (k, n) in p.shape.iter().enumerate() {
                moment[k] += xi3 * (n * p.area);
                area[k] += n * p.area;
            }
        }
        (0..slave.len())
            .filter(|&k| closed[k])
            .fold(D::zero(), |s, k| {
                s + moment[k] * moment[k] * (0.5 * EPS_N / area[k])
            })
    }
}

#[test]
fn averaged_gap_of_two_faces() {
    for (slave_order, master_order) in [(1, 1), (1, 2), (2, 1)] {
        let name = format!("slave order {slave_order}, master order {master_order}");
        let pair = pair(slave_order, master_order);
        let facets = pair.facets();
        let master = MovingMaster {
            facets,
            undeformed: facets,
            depth: 1.0,
            keep: false,
        };
        let x: Vec<V<f64>> = pair.slave.iter().chain(&pair.master).copied().collect();
        let first = pair.slave.len();

        // Gaps of nodes, then tractions of points.
        let mut gaps = vec![NodalGap::default(); first];
        let met: Vec<_> = (pair.points.iter())
            .map(|p| {
                let q = combine(&pair.slave, &p.shape);
                let at = (master.meet(&q, (&mut None, 0.0), 1.0, |_| true))
                    .unwrap()
                    .expect("a foot");
                assert!(!at.free, "{name}: past the border");
                for (gap, n) in gaps.iter_mut().zip(&p.shape) {
                    if *n != 0.0 {
                        gap.add(*n, p.area, at.xi3);
                    }
                }
                at
            })
            .collect();
        let normals: Vec<Normal> = gaps.iter().map(|g| g.normal(&LAW)).collect();
        let closed: Vec<bool> = normals.iter().map(|n| n.n < 0.0).collect();
        let count = closed.iter().filter(|c| **c).count();
        assert!(
            0 < count && count < first,
            "{name}: {count} of {first} nodes closed"
        );

        let n = 3 * x.len();
        let (mut r, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        let mut gap_rows = vec![GapRow::default(); first];
        let mut open_and_loaded = 0;
        for (p, at) in pair.points.iter().zip(&met) {
            let lambda = traction(p.shape.iter().zip(&normals).map(|(s, n)| (*s, n.n)));
            open_and_loaded += usize::from(at.xi3 > 0.0 && lambda != 0.0);
            let (residual, tangent) = point(&at.geometry, lambda, &Exact);
            let g3 = gap_slots(&at.geometry);
            let mut shape = ShapeRows::default();
            facets.shape(0, at.xi, &mut shape);
            let slave = (p.shape.iter().enumerate()).map(|(k, n)| (k, [*n, 0.0, 0.0]));
            let masters = (facets.nodes(0).iter().enumerate())
                .map(|(k, n)| (first + *n as usize, master_row(&shape, k)));
            let rows: Vec<(usize, NodeRow)> = slave.chain(masters).collect();
            for (i, row) in &rows {
                let f = kernel::assemble_force(&residual, row) * p.area;
                (0..3).for_each(|c| r[3 * i + c] += f[c]);
                for (j, column) in &rows {
                    let block = kernel::assemble_block(&tangent, row, column) * p.area;
                    let mut view = k.fixed_view_mut::<3, 3>(3 * i, 3 * j);
                    view += block;
                }
            }
            for (a, s) in p.shape.iter().enumerate().filter(|s| *s.1 != 0.0) {
                for (i, row) in &rows {
                    gap_rows[a].add_node(*i as u32, &g3, row, s * p.area);
                }
            }
        }
        assert!(
            open_and_loaded > 0,
            "{name}: no open point carries traction"
        );
        let geometric = k.norm();
        assert!(geometric > 1e-3, "{name}: no geometric part");
        for (a, row) in gap_rows.iter_mut().enumerate().filter(|a| closed[a.0]) {
            row.finish();
            for i in 0..row.entries().len() {
                for j in 0..row.entries().len() {
                    let block = row.block(i, j, &normals[a], &gaps[a]);
                    let at = [i, j].map(|i| 3 * row.entries()[i].0 as usize);
                    let mut view = k.fixed_view_mut::<3, 3>(at[0], at[1]);
                    view += block;
                }
            }
        }

        let xi: Vec<[f64; 2]> = met.iter().map(|m| m.xi).collect();
        let (mut g, mut h) = (DVector::zeros(n), DMatrix::zeros(n, n));
        for i in 0..n {
            for j in 0..=i {
                let seeded: Vec<V<HyperDual64>> = (x.iter().enumerate())
                    .map(|(node, x)| {
                        V::from_fn(|c, _| {
                            let is = |dof: usize| f64::from(u8::from(3 * node + c == dof));
                            HyperDual64::new(x[c], is(i), is(j), 0.0)
                        })
                    })
                    .collect();
                let e = pair.energy(&seeded, &xi, &closed);
                g[i] = e.eps1;
                h[(i, j)] = e.eps1eps2;
                h[(j, i)] = e.eps1eps2;
            }
        }
        assert!(g.norm() > 1e-3, "{name}: nothing to compare");
        let error = (&r - &g).norm() / g.norm();
        assert!(error < 1e-11, "{name}: residual {error:e}");
        let error = relative(&k, &h);
        assert!(error < 1e-11, "{name}: tangent {error:e}");
        assert!(
            (&k - k.transpose()).norm() < 1e-13 * k.norm(),
            "{name}: symmetry"
        );
    }
}
