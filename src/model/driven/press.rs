//! A driven surface against bodies that stand still: how hard it presses, when it touches first, where its forces hold
//! it. This is where a step starts from that the surface enters without contact; six unknowns, no system.
mod stiffness;

use super::turn;
use super::{Driven, Model, SurfaceModel};
use crate::contact::carried::{Carried, carried, cross_matrix};
use crate::contact::friction::history::PointHistory;
use crate::contact::law::{Augmented, NormalLaw, PairLaw, Penalty};
use crate::contact::points::SlavePoint;
use crate::contact::rigid::{Exact, Overhang, PointFault, RigidMaster, behind, free};
use crate::model::PairModel;
use crate::model::surface::SurfaceSet;
use crate::scene::ValueError;
use covact_geometry::{Hint, Vec3};
use nalgebra::{Isometry3, Matrix3, Matrix6, Vector6};
use rayon::prelude::*;
use stiffness::{modified_step, resisted};

/// A slave point that could not be evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PressFault {
    #[error("contact `{pair}`, slave point {point}: {fault}")]
    Point {
        pair: String,
        point: usize,
        at: Vec3,
        fault: PointFault,
    },
    #[error(transparent)]
    Value(#[from] ValueError),
}

/// Contact of a driven surface with bodies that stand still, in its six degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Energy stored in the penalties.
    pub energy: f64,
    /// Forces that hold the surface there: its gradient.
    pub residual: Vector6<f64>,
    /// Its second derivative.
    pub tangent: Matrix6<f64>,
    /// Its stiffness against turning if every point were resisted along its way around the center, for a rotation vector.
    pub swept: Matrix3<f64>,
    /// Points in contact.
    pub active: usize,
}

/// How placing a surface under its forces ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placed {
    /// The contact carries the forces, or nearly so: what is left is Newton's.
    Held,
    /// It moved on and on in this direction (six degrees of freedom) without being stopped.
    RunsAway([f64; 6]),
}

/// Slave points of all pairs of a surface, at rest.
pub struct Presser<'m, L = Penalty> {
    surface: &'m SurfaceModel,
    driven: &'m Driven,
    pairs: Vec<PairAtRest<'m, L>>,
    /// Whether any pair has friction, which resists what the normal tractions here do not.
    slides: bool,
    /// Largest step: a fraction of an element and of the depth.
    stride: f64,
}

struct PairAtRest<'m, L> {
    model: &'m PairModel,
    law: L,
    points: Vec<PointAtRest>,
}

struct PointAtRest {
    x: Vec3,
    area: f64,
    overhang: Overhang,
    /// Multiplier of its traction.
    lambda_n: f64,
    hint: Option<Hint>,
}

/// Part of an element, or of the depth, that the surface moves in one step of a search.
const STRIDE: f64 = 0.25;
/// Part of an element by which a search goes on past points that it grazes.
const GRAZE: f64 = 0.01;
/// Steps of a search.
const STEPS: usize = 400;

impl<'m, L: PairLaw> Presser<'m, L> {
    /// The slave points of surface `index` at displacements `u`; penalties per pair of the model, histories of all points
    /// that have one, or none before there are any.
    pub fn new(
        model: &'m Model,
        (index, surface, driven): (usize, &'m SurfaceModel, &'m Driven),
        penalties: &[f64],
        histories: &[PointHistory],
        u: &[f64],
    ) -> Self {
        let mut size = surface.depth;
        let mut slides = false;
        let mut pairs = Vec::new();
        for (pair, &penalty) in model.pairs.iter().zip(penalties) {
            if pair.rigid_master() != Some(index) {
                continue;
            }
            size = size.min(pair.element_size);
            slides |= pair.friction.is_some();
            let points = (pair.points.iter())
                .enumerate()
                .map(|(i, p)| PointAtRest {
                    x: model.point_position(p, u),
                    area: p.area,
                    overhang: p.overhang(false),
                    lambda_n: multiplier(pair, (i, p), histories),
                    hint: None,
                })
                .collect();
            pairs.push(PairAtRest {
                model: pair,
                law: L::of(penalty),
                points,
            });
        }
        Presser {
            surface,
            driven,
            pairs,
            slides,
            stride: STRIDE * size,
        }
    }

    /// Whether any pair has the surface as its master.
    pub fn is_empty(&self) -> bool {
        self.pairs.iter().all(|p| p.points.is_empty())
    }

    fn parts(&self, q: &Vector6<f64>) -> (Vec3, Vec3) {
        let part = |i: usize| Vec3::new(q[i], q[i + 1], q[i + 2]);
        (part(0), part(3) / self.driven.lever)
    }

    fn master(
        &self,
        prescribed: &Isometry3<f64>,
        moved: &Vec3,
        theta: &Vec3,
    ) -> RigidMaster<'m, SurfaceSet> {
        RigidMaster {
            surface: &self.surface.set,
            pose: self.driven.pose(prescribed, moved, theta),
            depth: self.surface.depth,
            keep: true,
        }
    }

    /// Energy, forces and stiffness at time `t` and degrees of freedom `q`.
    pub fn press(&mut self, t: f64, q: &Vector6<f64>) -> Result<Press, PressFault> {
        let (moved, theta) = self.parts(q);
        let prescribed = self.surface.motion.pose(t)?;
        let master = self.master(&prescribed, &moved, &theta);
        let center = (prescribed * nalgebra::Point3::from(self.driven.center)).coords + moved;
        let mut out = Press {
            energy: 0.0,
            residual: Vector6::zeros(),
            tangent: Matrix6::zeros(),
            swept: Matrix3::zeros(),
            active: 0,
        };
        for pair in &mut self.pairs {
            let (law, offsets) = (pair.law, pair.model.offsets(t));
            let law_of = |i: usize, p: &PointAtRest| Augmented {
                law,
                z0: offsets.map_or(0.0, |o| o.at(i)),
                lambda_n: p.lambda_n,
                held: false,
            };
            let touches: Vec<_> = (pair.points.par_iter_mut().enumerate())
                .with_min_len(64)
                .map(|(i, p)| {
                    let law = law_of(i, p);
                    master.touch(&p.x, (&mut p.hint, p.overhang), &law, &Exact)
                })
                .collect();
            for (point, (touch, p)) in touches.into_iter().zip(&pair.points).enumerate() {
                let touch = touch.map_err(|fault| PressFault::Point {
                    pair: pair.model.name.clone(),
                    point,
                    at: p.x,
                    fault,
                })?;
                let Some(touch) = touch else { continue };
                let (r, k) = (touch.residual * p.area, touch.tangent * p.area);
                let arm = p.x - center;
                let c = carried(&r, &k, &arm);
                out.swept += -cross_matrix(&arm).pow(2) * k.trace();
                out.active += 1;
                // Its derivative is the traction.
                out.energy += law_of(point, p).energy(touch.xi3) * p.area;
                add(&mut out.residual, &-r, &c.spin);
                add_tangent(&mut out.tangent, &k, &c);
            }
        }
        (out.residual, out.tangent) =
            in_rotation_vector(&out.residual, &out.tangent, &theta, self.driven.lever);
        Ok(out)
    }

    /// Distance of the nearest slave point, and whether any is below the surface.
    fn nearest(&mut self, t: f64, q: &Vector6<f64>) -> Result<(f64, bool), PressFault> {
        let (moved, theta) = self.parts(q);
        let prescribed = self.surface.motion.pose(t)?;
        let master = self.master(&prescribed, &moved, &theta);
        let (mut nearest, mut below) = (f64::INFINITY, false);
        for pair in &mut self.pairs {
            let offsets = pair.model.offsets(t);
            let found = (pair.points.par_iter_mut().enumerate())
                .with_min_len(64)
                .filter_map(|(i, p)| {
                    let foot = master.foot(&p.x, p.hint, f64::INFINITY)?;
                    p.hint = Some(Hint {
                        patch: foot.patch,
                        xi: foot.xi,
                    });
                    let z0 = offsets.map_or(0.0, |o| o.at(i));
                    let gap = foot.signed_distance - z0;
                    // Past a free border or above an overclosure the surface itself is nearer than contact.
                    let distance = match free(&foot) {
                        true => foot.distance - z0.max(0.0),
                        false => gap.min(foot.distance),
                    };
                    let distance = distance.max(0.0);
                    let below = !free(&foot) && gap < 0.0 && !behind(&foot, master.depth);
                    Some((distance, below))
                })
                .reduce(|| (f64::INFINITY, false), |a, b| (a.0.min(b.0), a.1 || b.1));
            nearest = nearest.min(found.0);
            below |= found.1;
        }
        Ok((nearest, below))
    }

    /// Unit direction in which forces drive the surface: along the force, or, where it has none, about the moment.
    /// `None` where both are zero.
    pub fn direction(driving: &[f64; 6]) -> Option<Vector6<f64>> {
        let mut e = Vector6::from_column_slice(driving);
        if e.fixed_rows::<3>(0).norm() > 0.0 {
            e.fixed_rows_mut::<3>(3).fill(0.0);
        }
        (e.norm() > 0.0 && e.norm().is_finite()).then(|| e / e.norm())
    }

    /// How far from `q` the surface goes in direction `e` until its contact first resists; `None` if it never does.
    /// No point is passed over: a step is no longer than the distance of the nearest point, save past points that are
    /// only grazed.
    pub fn advance(
        &mut self,
        t: f64,
        q: &Vector6<f64>,
        e: &Vector6<f64>,
    ) -> Result<Option<f64>, PressFault> {
        let turning = e.fixed_rows::<3>(0).norm() == 0.0;
        let reach = if turning {
            std::f64::consts::PI * self.driven.lever
        } else {
            let center = (self.surface.motion.pose(t)?)
                * nalgebra::Point3::from(self.driven.center)
                + self.parts(q).0;
            let points = self.pairs.iter().flat_map(|p| &p.points);
            let far = points.fold(0.0f64, |a, p| a.max((p.x - center.coords).norm()));
            far + self.driven.lever
        };
        let graze = (GRAZE / STRIDE * self.stride).max(1e-3 * reach / STEPS as f64);
        let (mut before, mut s) = (0.0, 0.0);
        while s <= reach {
            let (distance, below) = self.nearest(t, &(q + e * s))?;
            if below && self.press(t, &(q + e * s))?.residual.dot(e) > 0.0 {
                return self.first(t, q, e, before, s).map(Some);
            }
            before = s;
            s += if below { graze } else { distance.max(graze) };
            if !s.is_finite() {
                break;
            }
        }
        Ok(None)
    }

    /// Bisects for the first resistance between `low` and `high`.
    fn first(
        &mut self,
        t: f64,
        q: &Vector6<f64>,
        e: &Vector6<f64>,
        mut low: f64,
        mut high: f64,
    ) -> Result<f64, PressFault> {
        while high - low > 1e-12 * self.driven.lever {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.press(t, &(q + e * middle))?.residual.dot(e) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(low)
    }

    /// Moves the surface from `q` to where the penalties of bodies that stand still carry its forces: a modified
    /// Newton's method on the potential energy in steps that stay below a fraction of an element, so that no contact
    /// is jumped over. `driving` gives the generalised forces at degrees of freedom.
    pub fn place(
        &mut self,
        t: f64,
        q: &mut Vector6<f64>,
        mut driving: impl FnMut(&Vector6<f64>) -> Result<[f64; 6], ValueError>,
    ) -> Result<Placed, PressFault> {
        let free = self.driven.free();
        let forces = driving(q)?;
        let Some(e) = Self::direction(&forces) else {
            return Ok(Placed::Held);
        };
        if self.press(t, q)?.residual.dot(&e) <= 0.0 {
            match self.advance(t, q, &e)? {
                Some(s) => *q += e * s,
                None => return Ok(Placed::RunsAway(e.into())),
            }
        }
        let mut last = e;
        for _ in 0..STEPS {
            let now = self.press(t, q)?;
            let forces = driving(q)?;
            let force = |c: usize| {
                if free[c] {
                    forces[c] - now.residual[c]
                } else {
                    0.0
                }
            };
            let mut f = Vector6::from_fn(|c, _| force(c));
            if self.slides && now.active > 0 {
                // What is left to friction is Newton's.
                f = resisted(&now.tangent, &free, &f);
            }
            if f.norm() <= 1e-6 * Vector6::from(forces).norm() && now.active > 0 {
                return Ok(Placed::Held);
            }
            let mut step = modified_step(&now.tangent, &free, &f);
            let length = step.norm();
            if length > self.stride {
                step *= self.stride / length;
            }
            last = step;
            // The work of the driving forces along the step stands for their potential.
            let mut s = 1.0;
            let down = loop {
                let there = self.press(t, &(*q + step * s))?;
                let work: f64 = (0..6).map(|c| forces[c] * step[c] * s).sum();
                if there.energy - now.energy - work <= -1e-6 * s * f.dot(&step) {
                    break true;
                }
                s *= 0.5;
                if s < 1e-6 {
                    break false;
                }
            };
            if !down {
                return Ok(Placed::Held);
            }
            *q += step * s;
        }
        Ok(Placed::RunsAway(last.into()))
    }
}

/// Adds translation and spin parts.
pub fn add(out: &mut Vector6<f64>, translation: &Vec3, spin: &Vec3) {
    let mut part = out.fixed_rows_mut::<3>(0);
    part += translation;
    let mut part = out.fixed_rows_mut::<3>(3);
    part += spin;
}

/// Adds the blocks of translation and spin of a point with tangent `k`.
pub fn add_tangent(out: &mut Matrix6<f64>, k: &nalgebra::Matrix3<f64>, c: &Carried) {
    let mut block = out.fixed_view_mut::<3, 3>(0, 0);
    block += k;
    let mut block = out.fixed_view_mut::<3, 3>(0, 3);
    block -= c.point_spin;
    let mut block = out.fixed_view_mut::<3, 3>(3, 0);
    block -= c.spin_point;
    let mut block = out.fixed_view_mut::<3, 3>(3, 3);
    block += c.spin_spin;
}

/// Residual and symmetric tangent of translation and spin, as those of the degrees of freedom: the rotation vector times
/// the lever. The moments of `residual` must be all that the tangent belongs to.
pub fn in_rotation_vector(
    residual: &Vector6<f64>,
    tangent: &Matrix6<f64>,
    theta: &Vec3,
    lever: f64,
) -> (Vector6<f64>, Matrix6<f64>) {
    let spin = turn::spin_of(theta) / lever;
    let moment: Vec3 = residual.fixed_rows::<3>(3).into();
    let mut r = *residual;
    r.fixed_rows_mut::<3>(3).copy_from(&spin.tr_mul(&moment));
    let mut k = *tangent;
    let mixed = tangent.fixed_view::<3, 3>(0, 3) * spin;
    k.fixed_view_mut::<3, 3>(0, 3).copy_from(&mixed);
    k.fixed_view_mut::<3, 3>(3, 0).copy_from(&mixed.transpose());
    k.fixed_view_mut::<3, 3>(3, 3).copy_from(&spin_block(
        &tangent.fixed_view::<3, 3>(3, 3).into(),
        &moment,
        theta,
        lever,
    ));
    (r, k)
}

/// [`in_rotation_vector`] for a tangent without symmetry.
pub fn in_rotation_vector_with_friction(
    residual: &Vector6<f64>,
    tangent: &Matrix6<f64>,
    theta: &Vec3,
    lever: f64,
) -> (Vector6<f64>, Matrix6<f64>) {
    let (r, mut k) = in_rotation_vector(residual, tangent, theta, lever);
    let spin = turn::spin_of(theta);
    let moment: Vec3 = residual.fixed_rows::<3>(3).into();
    let mixed = spin.tr_mul(&tangent.fixed_view::<3, 3>(3, 0)) / lever;
    k.fixed_view_mut::<3, 3>(3, 0).copy_from(&mixed);
    let spin_spin = tangent.fixed_view::<3, 3>(3, 3).into();
    (k.fixed_view_mut::<3, 3>(3, 3))
        .copy_from(&whole_spin_block(&spin_spin, &moment, theta, lever));
    (r, k)
}

/// The block of the rotation alone: the second derivative by spins on top of the present rotation is that by rotation
/// vectors but for half of the moment's cross product (two turns do not commute) and the change of `T`.
pub fn spin_block(
    spin_spin: &nalgebra::Matrix3<f64>,
    moment: &Vec3,
    theta: &Vec3,
    lever: f64,
) -> nalgebra::Matrix3<f64> {
    let k = whole_spin_block(spin_spin, moment, theta, lever);
    (k + k.transpose()) * 0.5
}

/// [`spin_block`] before rounding is taken out of what is symmetric, or without symmetry.
fn whole_spin_block(
    spin_spin: &nalgebra::Matrix3<f64>,
    moment: &Vec3,
    theta: &Vec3,
    lever: f64,
) -> nalgebra::Matrix3<f64> {
    let spin = turn::spin_of(theta);
    let by_spin = spin_spin - cross_matrix(moment) * 0.5;
    (spin.transpose() * by_spin * spin + turn::moment_slope(theta, moment)) / (lever * lever)
}

/// Multiplier of a slave point, from those of its nodes where gaps are averaged.
fn multiplier(pair: &PairModel, (i, p): (usize, &SlavePoint), histories: &[PointHistory]) -> f64 {
    let Some(first) = pair.first_history else {
        return 0.0;
    };
    let of = |at: usize| histories.get(first + at).map_or(0.0, |h| h.lambda_n);
    match (&pair.averaged, &pair.friction) {
        (Some(nodes), None) => nodes.terms(i, p).map(|(at, w)| w * of(at)).sum(),
        _ => of(i),
    }
}
