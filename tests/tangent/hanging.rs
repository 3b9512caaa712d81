//! Points that hang over a free border of a body, which is rounded off for them.
use crate::cases::{mesh, plain};
use crate::support::V;
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::law::Coulomb;
use covact::contact::friction::moving::Full;
use covact::contact::friction::rigid::Friction;
use covact::contact::kernel::{assemble_block, assemble_force};
use covact::contact::law::{NormalLaw, Penalty};
use covact::contact::moving::{MovingMaster, MovingTouch, master_row};
use covact::contact::rigid::{Exact, Overhang};
use covact_geometry::{Hint, MovingFacets, ShapeRows};
use nalgebra::Matrix3;

const LAW: Penalty = Penalty { eps_n: 50.0 };
const RADIUS: f64 = 0.2;
const MAY: Overhang = Overhang {
    rounding: RADIUS,
    closed: true,
};

/// Facets between -1 and 1 that bend and twist, and points past x = 1, past y = 1 and past the corner of both: on the flat part
/// of the rounding, and on its curved part.
#[allow(clippy::type_complexity)]
fn facets(order: usize) -> (Vec<V<f64>>, Vec<Vec<u32>>, Vec<V<f64>>) {
    let height = |x: f64, y: f64| 0.1 * x * x - 0.05 * x * y + 0.02 * y;
    let (nodes, list) = mesh(2, order, |x, y| V::new(x, y, height(x, y)));
    let over = [
        [1.005, 0.3, -0.02],
        [1.1, 0.3, -0.06],
        [0.4, 1.12, -0.07],
        [1.08, 1.07, -0.08],
    ];
    let points =
        over.map(|[x, y, below]: [f64; 3]| V::new(x, y, height(x.min(1.0), y.min(1.0)) + below));
    (nodes, list, points.to_vec())
}

fn touch(
    now: &MovingFacets,
    undeformed: &MovingFacets,
    x: &V<f64>,
    over: Overhang,
) -> Option<MovingTouch> {
    let master = MovingMaster {
        facets: now,
        undeformed,
        depth: 0.5,
        keep: true,
    };
    let touch = master.touch(x, (&mut None, over), &LAW, &Exact, |_| true);
    touch.expect("a regular point")
}

/// The point and all nodes: positions in a row.
fn row(x: &V<f64>, nodes: &[V<f64>]) -> Vec<V<f64>> {
    [&[*x], nodes].concat()
}

#[test]
fn forces_past_a_border_are_those_of_an_energy_and_balance() {
    for order in [1, 2] {
        let (nodes, list, points) = facets(order);
        let undeformed = plain(&nodes, &list, order);
        let evaluate = |at: &[V<f64>]| {
            let now = plain(&at[1..], &list, order);
            let touch = touch(&now, &undeformed, &at[0], MAY).expect("in contact");
            (now, touch)
        };
        let forces = |at: &[V<f64>]| {
            let (now, touch) = evaluate(at);
            let mut all = vec![V::zeros(); at.len()];
            all[0] = assemble_force(&touch.residual, &[1.0, 0.0, 0.0]);
            let mut shape = ShapeRows::default();
            now.shape(touch.facet, touch.xi, &mut shape);
            for (k, &node) in list[touch.facet as usize].iter().enumerate() {
                all[1 + node as usize] += assemble_force(&touch.residual, &master_row(&shape, k));
            }
            all
        };
        for x in &points {
            let at = row(x, &nodes);
            let found = forces(&at);
            assert!(found[0].norm() > 0.5);
            let sum: V<f64> = found.iter().sum();
            let moment: V<f64> = at.iter().zip(&found).map(|(x, f)| x.cross(f)).sum();
            assert!(
                sum.norm() < 1e-13 && moment.norm() < 1e-13,
                "{sum} {moment}"
            );

            let (now, point) = evaluate(&at);
            let mut shape = ShapeRows::default();
            now.shape(point.facet, point.xi, &mut shape);
            let own = &list[point.facet as usize];
            let rows: Vec<_> = (own.iter().enumerate())
                .map(|(k, &node)| (1 + node as usize, master_row(&shape, k)))
                .chain([(0, [1.0, 0.0, 0.0])])
                .collect();
            let (mut error, mut size) = (0.0f64, 0.0f64);
            for (i, column) in &rows {
                for c in 0..3 {
                    let ends = [-1e-6, 1e-6].map(|step| {
                        let mut moved = at.clone();
                        moved[*i][c] += step;
                        let energy = LAW.energy(evaluate(&moved).1.xi3);
                        (energy, forces(&moved))
                    });
                    let slope = (ends[1].0 - ends[0].0) / 2e-6;
                    assert!((slope - found[*i][c]).abs() < 1e-6, "{order} {x} {i} {c}");
                    for (j, row) in &rows {
                        let change = (ends[1].1[*j] - ends[0].1[*j]) / 2e-6;
                        let block: Matrix3<f64> = assemble_block(&point.tangent, row, column);
                        error = error.max((block.column(c) - change).norm());
                        size = size.max(change.norm());
                    }
                }
            }
            // What is left out is of the size of the penetration over the half width of a facet, twice that where the facet bends.
            println!("{order} {x}: {error} of {size}");
            let left = 3.0 * -point.xi3 / 0.5;
            assert!(
                size > 1.0 && error < left * size,
                "{order} {x}: {error} of {size}"
            );
            assert!((point.tangent - point.tangent.transpose()).norm() < 1e-12 * size);
        }
    }
}

/// Past the border a point lets go along a circle, as over a border of a rigid surface, and deep down beside it it is open.
#[test]
fn a_border_of_a_body_is_rounded_off() {
    let (nodes, list) = mesh(2, 1, |x, y| V::new(x, y, 0.0));
    let plane = plain(&nodes, &list, 1);
    let at = |over: f64, height: f64, overhang| {
        touch(&plane, &plane, &V::new(1.0 + over, 0.2, height), overhang)
    };
    let center = V::new(1.0 + 0.05 * RADIUS, 0.2, -RADIUS);
    for over in [-1e-9, 0.0, 1e-9, 0.009] {
        let t = at(over, -0.01, MAY).expect("in contact");
        let force: V<f64> = t.residual.fixed_rows::<3>(0).into();
        assert!(
            (force - V::new(0.0, 0.0, -0.5)).norm() < 1e-12,
            "{over}: {force}"
        );
    }
    for (over, height) in [(0.02, -0.01), (0.1, -0.1), (0.2, -0.18)] {
        let t = at(over, height, MAY).expect("in contact");
        let arm = V::new(1.0 + over, 0.2, height) - center;
        let force: V<f64> = t.residual.fixed_rows::<3>(0).into();
        let expected = arm.normalize() * (50.0 * (arm.norm() - RADIUS));
        assert!(
            expected.norm() > 1e-2 && (force - expected).norm() < 1e-11,
            "{over}"
        );
    }
    assert!(at(0.1, -0.02, MAY).is_none() && at(0.22, -0.1, MAY).is_none());
    assert!(at(0.01, -0.21, MAY).is_none());
    let open = Overhang {
        closed: false,
        ..MAY
    };
    assert!(at(0.005, -0.09, open).is_some() && at(0.005, -0.11, open).is_none());
    // Sharp, it holds a point that hangs over by much less than it lies below, and none beside it.
    assert!(at(0.01, -0.01, Overhang::default()).is_none());
}

/// The forces of a sliding point by its own place.
#[test]
fn friction_past_a_border_of_a_body_has_its_derivative() {
    let (nodes, list, points) = facets(1);
    let now = plain(&nodes, &list, 1);
    let master = MovingMaster {
        facets: &now,
        undeformed: &now,
        depth: 0.5,
        keep: true,
    };
    for (mu, slides) in [(0.2, true), (5.0, false)] {
        let friction = Friction {
            law: Coulomb { mu },
            eps_t: 20.0,
        };
        for x in &points {
            let mut history = PointHistory {
                base: x + V::new(0.02, 0.05, 0.0),
                ..PointHistory::default()
            };
            let place = Hint {
                patch: 3,
                xi: [0.9, 0.2],
            };
            master.attach(&mut history, Some(place));
            let law = history.law(LAW, 0.0);
            let at = |x: &V<f64>| {
                let touch = master.touch_with_friction(
                    x,
                    (&mut None, MAY),
                    &law,
                    &friction,
                    &history,
                    &Full,
                    |_| true,
                );
                touch.expect("regular").expect("in contact").response
            };
            let here = at(x);
            assert_eq!(here.slip.slides, slides);
            assert!(here.slip.t.norm() > 0.05);
            let (mut error, mut size) = (0.0f64, 0.0f64);
            for c in 0..3 {
                let ends = [-1e-6, 1e-6].map(|step| {
                    let mut moved = *x;
                    moved[c] += step;
                    at(&moved).residual
                });
                let change = (ends[1] - ends[0]) / 2e-6;
                // The attraction point stands still, so that what moves against it is the point.
                let by = here.tangent.column(c) + here.anchor.column(c);
                let off = by.fixed_rows::<3>(0) - change.fixed_rows::<3>(0);
                error = error.max(off.norm());
                size = size.max(change.fixed_rows::<3>(0).norm());
            }
            println!("{mu} {x}: {error} of {size}");
            assert!(
                size > 1.0 && error < 0.1 * size,
                "{mu} {x}: {error} of {size}"
            );
        }
    }
}
