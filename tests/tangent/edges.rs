//! Feet on edges and vertices of masters that move: a valley, below which points are nearest to its crease.
use crate::cases::*;
use crate::support::V;
use crate::surface::{Held, Surface};

/// Two creases that cross, bent in the plane and in height, of slopes `a` and `b`.
fn valley(a: f64, b: f64, bend: f64) -> impl Fn(f64, f64) -> V<f64> {
    move |x, y| {
        V::new(
            x + 0.07 * y * y + 0.02 * y,
            y - 0.05 * x * x,
            a * x.abs() + b * y.abs() + bend * (x * y - 0.6 * x * x + 0.4 * y * y),
        )
    }
}

/// A slave face below the crossing: its middle under the vertex, its mid-sides under the creases, its corners under the
/// facets.
pub fn case(name: &str, order: usize, [a, b, bend]: [f64; 3], depth: f64) -> Case {
    let (nodes, facets) = mesh(2, order, valley(a, b, bend));
    let facets = plain(&nodes, &facets, order);
    let (slave, _) = mesh(1, 2, |x, y| {
        let depth = depth * (1.0 + 0.1 * x - 0.2 * x * y);
        below(&facets, 2, 0.8 * x, 0.7 * y, depth)
    });
    Case {
        name: format!("{name}, order {order}"),
        points: slave_points(&slave, Scheme::Lobatto(3)),
        slave,
        master: nodes,
        surface: Surface::of(facets),
    }
}

#[test]
fn edges_and_vertices_of_a_deformable_master() {
    for order in [1, 2] {
        for (name, slopes, depth) in [
            ("steep valley", [0.5, 0.7, 0.1], 0.1),
            // Less than a sharp angle: the facets count as one face, and their edge holds the foot all the same.
            ("all but flat valley", [0.004, 0.005, 0.0], 0.1),
        ] {
            let case = case(name, order, slopes, depth);
            let name = &case.name;
            let at = case.evaluate();
            let of = |held: fn(&Held) -> bool| at.iter().filter(|p| held(&p.held)).count();
            let counts = [
                of(|h| *h == Held::Face),
                of(|h| matches!(h, Held::Edge(_))),
                of(|h| *h == Held::Vertex),
            ];
            assert_eq!(counts, [4, 4, 1], "{name}: faces, edges, vertices");
            for point in &at {
                let rest = point.residual.fixed_rows::<6>(3).norm();
                assert_eq!(rest, 0.0, "{name}: the residual lies in slot 0");
            }
            let (r, k) = case.assemble(&at);
            let (gradient, reference) = case.reference(&at);
            assert!(gradient.norm() > 1e-2, "{name}: nothing to compare");
            let error = (&r - &gradient).norm() / gradient.norm();
            assert!(error < 1e-11, "{name}: residual {error:e}");
            let error = relative(&k, &reference);
            assert!(error < 1e-11, "{name}: tangent {error:e}");
            crate::balance::check(&case, 1e-12);
            // Point by point, so that none hides behind another.
            for i in 0..at.len() {
                let single = Case {
                    name: format!("{name}, point {i} ({:?})", at[i].held),
                    points: vec![case.points[i].clone()],
                    slave: case.slave.clone(),
                    master: case.master.clone(),
                    surface: Surface::of(match &case.surface {
                        Surface::Facets { facets, .. } => (**facets).clone(),
                        Surface::Patch { .. } => unreachable!("facets"),
                    }),
                };
                let at = single.evaluate();
                let (_, k) = single.assemble(&at);
                let (_, reference) = single.reference(&at);
                let error = relative(&k, &reference);
                assert!(error < 1e-11, "{}: {error:e}", single.name);
            }
        }
    }
}
