//! Friction on masters that move: residual and tangent over slave, facet and the facet of the attraction point, against
//! dual numbers through closest point, attraction point, law and all.
use crate::cases::{Case, Scheme, combine};
use crate::pairs::{self, Master};
use crate::support::V;
use crate::surface::{Held, Surface};
use covact::contact::friction::anchor::Anchor;
use covact::contact::friction::history::PointHistory;
use covact::contact::friction::law::{Coulomb, FrictionLaw};
use covact::contact::friction::moving::{Form, Full, Reduced};
use covact::contact::friction::rigid::Friction;
use covact::contact::friction::scatter::PointNodes;
use covact::contact::friction::touch::MovingFrictionTouch;
use covact::contact::law::{Augmented, Penalty};
use covact::contact::moving::MovingMaster;
use covact::contact::rigid::Overhang;
use covact_geometry::{CurvedRows, Frame, Hint, MovingFacets, ShapeRows};
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual64, DualNum};

const EPS_N: f64 = 3.0;
const EPS_T: f64 = 2.0;
const LAMBDA_N: f64 = -0.02;

/// Where the attraction point lies, seen from the facet at the foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Where {
    Same,
    Neighbour,
    Far,
}

/// A pair with the histories of its points.
pub struct Sliding<F> {
    pub case: Case,
    /// The nodes of the master before it was deformed, and its facets there.
    rest: (Vec<V<f64>>, MovingFacets),
    pub held: Vec<Held>,
    histories: Vec<PointHistory>,
    friction: Friction<F>,
    full: bool,
}

pub fn facets(case: &Case) -> &MovingFacets {
    match &case.surface {
        Surface::Facets { facets, .. } => facets,
        Surface::Patch { .. } => unreachable!("facets"),
    }
}

impl<F: FrictionLaw> Sliding<F> {
    /// Attraction points off the slave points by some hundredths, with a traction of their own. `rest` puts the nodes of the
    /// master to where they are undeformed.
    pub fn new(
        case: Case,
        place: Where,
        law: F,
        approach: f64,
        full: bool,
        rest: impl Fn(&V<f64>) -> V<f64>,
    ) -> Self {
        let facets = facets(&case);
        let nodes: Vec<V<f64>> = case.master.iter().map(rest).collect();
        let mut undeformed = facets.clone();
        undeformed.update(|n| nodes[n as usize]);
        let master = MovingMaster {
            facets,
            undeformed: &undeformed,
            depth: 1.0,
            keep: false,
        };
        let mut held = Vec::new();
        let mut histories = Vec::new();
        for (k, (point, at)) in case.points.iter().zip(case.evaluate()).enumerate() {
            let x = combine(&case.slave, &point.shape);
            let near = facets.neighbours(at.facet);
            let patch = match place {
                Where::Same => at.facet,
                Where::Neighbour => near[k % near.len()],
                Where::Far => (0..facets.len() as u32)
                    .find(|f| *f != at.facet && !near.contains(f))
                    .expect("a facet far away"),
            };
            let hint = Hint {
                patch,
                xi: [0.3 - 0.1 * k as f64, 0.2 + 0.05 * k as f64],
            };
            let base = x + V::new(0.02, -0.035, 0.015);
            let lambda = V::new(-0.04, 0.03, 0.02);
            held.push(at.held);
            let mut history = PointHistory {
                base,
                lambda,
                lambda_n: LAMBDA_N,
                approach,
                ..PointHistory::default()
            };
            master.attach(&mut history, Some(hint));
            histories.push(history);
        }
        let friction = Friction { law, eps_t: EPS_T };
        Sliding {
            case,
            rest: (nodes, undeformed),
            held,
            histories,
            friction,
            full,
        }
    }

    fn law() -> Augmented {
        Augmented {
            law: Penalty { eps_n: EPS_N },
            z0: -0.001,
            lambda_n: LAMBDA_N,
            held: false,
        }
    }

    pub fn touches<M: Form>(&self, form: &M) -> Vec<MovingFrictionTouch> {
        let facets = facets(&self.case);
        let master = MovingMaster {
            facets,
            undeformed: &self.rest.1,
            depth: 1.0,
            keep: false,
        };
        (self.case.points.iter().zip(&self.histories))
            .map(|(p, history)| {
                let x = combine(&self.case.slave, &p.shape);
                let (law, friction) = (Self::law(), &self.friction);
                master
                    .touch_with_friction(
                        &x,
                        (&mut None, Overhang::default()),
                        &law,
                        friction,
                        history,
                        form,
                        |_| true,
                    )
                    .unwrap()
                    .expect("contact")
            })
            .collect()
    }

    /// Residual and tangent through the core and its scatter.
    pub fn assemble(&self) -> (DVector<f64>, DMatrix<f64>) {
        match self.full {
            true => self.assemble_as(&Full),
            false => self.assemble_as(&Reduced),
        }
    }

    fn assemble_as<M: Form>(&self, form: &M) -> (DVector<f64>, DMatrix<f64>) {
        let (facets, first) = (facets(&self.case), self.case.slave.len() as u32);
        let n = 3 * self.case.all_nodes().len();
        let (mut r, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        let mut nodes = PointNodes::default();
        let (mut curved, mut rows) = (CurvedRows::default(), ShapeRows::default());
        let shifted = |f: u32| -> Vec<u32> { facets.nodes(f).iter().map(|n| n + first).collect() };
        let slave: Vec<u32> = (0..first).collect();
        for (point, touch) in self.case.points.iter().zip(self.touches(form)) {
            nodes.start(&slave, &point.shape);
            facets.curved_shape(touch.foot.patch, touch.foot.xi, &mut curved);
            nodes.facet(&shifted(touch.foot.patch), &curved, true);
            let anchor = touch.anchor.expect("a history");
            facets.shape(anchor.patch, anchor.xi, &mut rows);
            nodes.anchor(&shifted(anchor.patch), &rows);
            for (node, f) in nodes.forces(&touch.response, point.area) {
                (0..3).for_each(|c| r[3 * node as usize + c] += f[c]);
            }
            let own = nodes.nodes();
            let size = 3 * own.len();
            let mut ke = vec![f64::NAN; size * size];
            nodes.assemble(&touch.response, point.area, form, &mut ke);
            for j in 0..size {
                for i in 0..size {
                    let (a, b) = (own[i / 3] as usize, own[j / 3] as usize);
                    k[(3 * a + i % 3, 3 * b + j % 3)] += ke[j * size + i];
                }
            }
        }
        (r, k)
    }

    /// The residual in any scalar, the closest points solved again.
    fn residual<D: DualNum<f64> + Copy>(&self, start: &[Hint], x: &[V<D>]) -> Vec<V<D>> {
        let case = &self.case;
        let (slave, master) = x.split_at(case.slave.len());
        let mut forces = vec![V::from_element(D::zero()); x.len()];
        for (i, point) in case.points.iter().enumerate() {
            let q = (slave.iter().zip(&point.shape))
                .fold(V::from_element(D::zero()), |s, (x, n)| s + x * D::from(*n));
            let (facet, held) = (start[i].patch, self.held[i]);
            let xi = (case.surface).project(facet, master, &q, start[i].xi, held, 4);
            let frame = Frame::new(&case.surface.jet(facet, master, xi), 1.0).expect("regular");
            let d = q - frame.rho;
            let (xi3, n) = match held {
                Held::Face => (d.dot(&frame.n), frame.n),
                _ => {
                    let xi3 = -d.dot(&d).sqrt();
                    (xi3, d * xi3.recip())
                }
            };
            let history = &self.histories[i];
            let gap = xi3 + 0.001;
            let pressure = -(gap * EPS_N + LAMBDA_N);
            let phi = match history.approach {
                0.0 => D::one(),
                a => gap / (gap - a),
            };
            let place = history.place.expect("a history");
            let at = case.surface.jet(place.patch, master, place.xi.map(D::from));
            let anchor = Anchor::new(&at).expect("regular");
            let [b, l] = [history.base, history.lambda].map(|c| {
                let c = c.map(D::from);
                anchor.rho_i[0] * c.x + anchor.rho_i[1] * c.y + anchor.n * c.z
            });
            let v = l + (q - anchor.rho - b) * (phi * EPS_T);
            let trial = v - n * v.dot(&n);
            let t = match self.friction.law.direction() {
                None => self.friction.law.slip(&trial, &n, pressure).t,
                Some(direction) => {
                    let rest: Vec<V<D>> = self.rest.0.iter().map(|x| x.map(D::from)).collect();
                    let rest = Frame::new(&case.surface.jet(facet, &rest, xi), 1.0);
                    let rest = rest.expect("regular");
                    let given = direction.map(D::from);
                    let [c1, c2] = rest.rho_up().map(|up| up.dot(&given));
                    let along = frame.rho_i[0] * c1 + frame.rho_i[1] * c2;
                    let along = along + frame.n * rest.n.dot(&given);
                    let along = along * along.dot(&along).sqrt().recip();
                    let (slip, _) = self.friction.law.slip_along(&trial, &n, pressure, &along);
                    slip.t
                }
            };
            let first = (t - n * pressure) * D::from(point.area);
            let lever = match held {
                Held::Face if self.full => {
                    let [r1, r2] = &frame.rho_i;
                    let up = [
                        r1 * frame.a_inv[0] + r2 * frame.a_inv[1],
                        r1 * frame.a_inv[1] + r2 * frame.a_inv[2],
                    ];
                    up.map(|up| n * (xi3 * up.dot(&t) * point.area))
                }
                // The slip along the line that the foot moves on.
                Held::Edge(free) if self.full => {
                    let line = &frame.rho_i[free];
                    let lever = n * (xi3 * line.dot(&t) / line.dot(line) * point.area);
                    let mut levers = [V::from_element(D::zero()); 2];
                    levers[free] = lever;
                    levers
                }
                _ => [V::from_element(D::zero()); 2],
            };
            for (k, n) in point.shape.iter().enumerate() {
                forces[k] += first * D::from(*n);
            }
            let basis = case.surface.basis(facet, xi);
            for (node, b) in case.surface.nodes(facet).into_iter().zip(basis) {
                forces[slave.len() + node] += lever[0] * b[1] + lever[1] * b[2] - first * b[0];
            }
        }
        forces
    }

    /// Residual and its derivative by dual numbers.
    pub fn reference(&self) -> (DVector<f64>, DMatrix<f64>) {
        let start: Vec<Hint> = self.touches(&Full).iter().map(|t| t.foot).collect();
        let x = self.case.all_nodes();
        let n = 3 * x.len();
        let (mut r, mut k) = (DVector::zeros(n), DMatrix::zeros(n, n));
        for (i, f) in self.residual(&start, &x).iter().enumerate() {
            (0..3).for_each(|c| r[3 * i + c] = f[c]);
        }
        for dof in 0..n {
            let seeded: Vec<V<Dual64>> = (x.iter().enumerate())
                .map(|(i, x)| {
                    V::from_fn(|c, _| Dual64::new(x[c], f64::from(u8::from(3 * i + c == dof))))
                })
                .collect();
            for (i, f) in self.residual(&start, &seeded).iter().enumerate() {
                (0..3).for_each(|c| k[(3 * i + c, dof)] = f[c].eps);
            }
        }
        (r, k)
    }

    /// Holds residual and tangent, relative to their norms, against dual numbers; returns the moment that the two sides leave.
    pub fn check(&self, name: &str, slides: bool) -> f64 {
        for touch in self.touches(&Full) {
            let t = touch.response.slip.t.norm();
            assert!(t > 1e-3, "{name}: no traction");
            assert_eq!(touch.response.slip.slides, slides, "{name}");
        }
        let (r, k) = self.assemble();
        let (r_dual, k_dual) = self.reference();
        assert!(r_dual.norm() > 1e-2 && k_dual.norm() > 1e-2, "{name}");
        let error = (&r - &r_dual).norm() / r_dual.norm();
        assert!(error < 1e-13, "{name}: residual {error:e}");
        let error = (&k - &k_dual).norm() / k_dual.norm();
        assert!(error < 1e-11, "{name}: tangent {error:e}");

        let x = self.case.all_nodes();
        let at = |v: &DVector<f64>, i: usize| V::new(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
        let total: V<f64> = (0..x.len()).map(|i| at(&r, i)).sum();
        assert!(total.norm() < 1e-14, "{name}: force {:e}", total.norm());
        let moment: V<f64> = (0..x.len()).map(|i| x[i].cross(&at(&r, i))).sum();
        let motion = |f: &dyn Fn(&V<f64>) -> V<f64>| {
            let v: Vec<f64> = (x.iter()).flat_map(|x| <[f64; 3]>::from(f(x))).collect();
            &k * DVector::from_vec(v)
        };
        let omega = V::new(0.3, -0.7, 0.5);
        let moved = motion(&|_| omega).norm();
        assert!(moved < 1e-13 * k.norm(), "{name}: translation {moved:e}");
        let turned = motion(&|x| omega.cross(x));
        for i in 0..x.len() {
            let error = (at(&turned, i) - omega.cross(&at(&r, i))).norm();
            assert!(error < 1e-13 * k.norm(), "{name}: turning {error:e}");
        }
        moment.norm()
    }
}

/// A pair under Coulomb's law.
fn coulomb(case: Case, place: Where, mu: f64, approach: f64, full: bool) -> Sliding<Coulomb> {
    Sliding::new(case, place, Coulomb { mu }, approach, full, |x| *x)
}

impl Sliding<Coulomb> {
    fn check_limit(&self, name: &str) -> f64 {
        let mu = self.friction.law.mu;
        for touch in self.touches(&Full).iter().filter(|_| mu < 1.0) {
            let t = touch.response.slip.t.norm();
            assert!((t + mu * touch.n).abs() < 1e-14, "{name}");
        }
        self.check(name, mu < 1.0)
    }
}

#[test]
fn friction_on_faces_that_move() {
    let mut worst_reduced = 0.0f64;
    for master in [
        Master::Bilinear,
        Master::Biquadratic,
        Master::Smooth,
        Master::Rational,
    ] {
        for place in [Where::Same, Where::Neighbour, Where::Far] {
            for (mu, approach) in [(0.1, 0.0), (0.1, 0.02), (50.0, 0.0), (50.0, 0.02)] {
                for full in [true, false] {
                    let case = pairs::case(1, Scheme::Gauss(2), master);
                    let name = format!("{master:?}, {place:?}, mu {mu}, {approach}, full {full}");
                    let sliding = coulomb(case, place, mu, approach, full);
                    let moment = sliding.check_limit(&name);
                    match full {
                        true => assert!(moment < 1e-14, "{name}: moment {moment:e}"),
                        false => worst_reduced = worst_reduced.max(moment),
                    }
                }
            }
        }
    }
    // What the reduced form leaves, |xi3| |T| per area.
    assert!(worst_reduced > 1e-4, "{worst_reduced:e}");
}

#[test]
fn friction_on_edges_and_vertices_that_move() {
    for order in [1, 2] {
        for (mu, approach) in [(0.1, 0.0), (50.0, 0.0), (50.0, 0.02)] {
            for place in [Where::Same, Where::Neighbour] {
                let case = crate::edges::case("valley", order, [0.5, 0.7, 0.1], 0.1);
                let name = format!("valley, order {order}, mu {mu}, {approach}, {place:?}");
                let sliding = coulomb(case, place, mu, approach, true);
                let of = |held: fn(&Held) -> bool| sliding.held.iter().filter(|h| held(h)).count();
                let counts = [
                    of(|h| *h == Held::Face),
                    of(|h| matches!(h, Held::Edge(_))),
                    of(|h| *h == Held::Vertex),
                ];
                assert_eq!(counts, [4, 4, 1], "{name}");
                sliding.check_limit(&name);
            }
        }
    }
}

/// A point at the border of a face does the same work on either side of it where it is drawn along the border: faces of two bodies
/// that end in one plane have all their points there.
#[test]
fn friction_along_a_border_is_the_same_on_either_side_of_it() {
    let forces = |beyond: f64| {
        let (nodes, faces) = crate::cases::mesh(2, 1, |x, y| V::new(x, y, 0.05 * x * x));
        let surface = Surface::of(crate::cases::plain(&nodes, &faces, 1));
        let (slave, _) = crate::cases::mesh(1, 1, |x, y| {
            V::new(0.4 + 0.05 * x, 1.0 + beyond + 0.05 * (y - 1.0), -0.02)
        });
        // The last of the face's nodes lies at the border, or a little beyond it.
        let points = crate::cases::slave_points(&slave, Scheme::Lobatto(2));
        let case = Case {
            name: "border".to_owned(),
            points: points.into_iter().skip(3).collect(),
            slave,
            master: nodes,
            surface,
        };
        let x = combine(&case.slave, &case.points[0].shape);
        let mut sliding = coulomb(case, Where::Same, 0.1, 0.0, true);
        let place = sliding.histories[0].place;
        let mut history = PointHistory {
            base: x + V::new(0.02, 0.0, 0.015),
            lambda: V::new(-0.04, 0.0, 0.02),
            lambda_n: LAMBDA_N,
            ..PointHistory::default()
        };
        let master = MovingMaster {
            facets: facets(&sliding.case),
            undeformed: facets(&sliding.case),
            depth: 1.0,
            keep: false,
        };
        master.attach(&mut history, place);
        sliding.histories[0] = history;
        let touch = &sliding.touches(&Full)[0];
        let edge = matches!(sliding.held[0], Held::Edge(_));
        (
            sliding.assemble().0,
            edge,
            touch.gap * touch.response.slip.t,
        )
    };
    for step in [1e-6, 1e-8] {
        let ((inside, on_face, _), (outside, on_edge, moment)) = (forces(-step), forces(step));
        assert!(!on_face && on_edge, "{on_face} {on_edge}");
        assert!(moment.x.abs() > 1e-4, "no moment to lose: {moment:?}");
        let jump = (&inside - &outside).norm() / inside.norm();
        // The direction of the distance turns by the step over the penetration.
        assert!(jump < 2.0 * step / 0.02, "{step:e}: {jump:e}");
    }
}
