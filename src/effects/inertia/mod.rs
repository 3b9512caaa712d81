//! Inertia: the balance of a step in dynamics,
//!
//! `M [(1 - alpha_m) a_1 + alpha_m a_0] + (1 - alpha_f) R(u_1, v_1) + alpha_f R_0 + f_c(u_1) = 0`,
//!
//! with `R = f_int + C v - f_ext`, and `a_1`, `v_1` by Newmark's formulas from the displacements `u_1`, the only unknowns
//! ([`Scheme`]). Forces are weighted, and nothing is evaluated between the ends of a step, so that what depends on history sees
//! these alone. Contact forces `f_c` are not weighted but act at the end: weighted ones vibrate between two steps under a stiff
//! penalty and gain energy without bound, while these never gained more than half a hundredth of it in any case that was tried.
//! Where the scene asks for it, they are a part of `R`. Viscous stresses of the material act in full, too, at the middle of the step
//! ([`Dashpots`]).
mod dashpots;
mod mass;
mod scheme;

pub use dashpots::Dashpots;
pub use mass::Mass;
pub use scheme::Scheme;

use super::{Contribution, Tangent, Turn};
use crate::model::Model;
use crate::model::dynamics::DynamicsModel;
use crate::model::state::heap;
use crate::scene::{ContactTiming, ValueError};
use covact_geometry::Vec3;

/// Vectors of all degrees of freedom that it holds.
const VECTORS: usize = 7;

/// Inertia of a model, and where its motion is.
#[derive(Debug, Clone)]
pub struct Inertia {
    scheme: Scheme,
    /// Damping force over mass and velocity (1 / time).
    damping: f64,
    timing: ContactTiming,
    mass: Mass,
    /// Where material is viscous.
    dashpots: Option<Box<Dashpots>>,
    /// At the last accepted step.
    motion: Motion,
    /// Displacements there.
    base: Vec<f64>,
    /// Size of the step that is solved; zero where none has begun.
    dt: f64,
    /// `R` at the state evaluated last.
    trial: Vec<f64>,
    /// Room for accelerations, and for forces.
    room: [Vec<f64>; 2],
    /// Norm of the larger of the forces of inertia and of `R` at the state evaluated last.
    norm: f64,
}

/// What a run goes on from, beside the displacements.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Velocities and accelerations, 3 per node.
    pub v: Vec<f64>,
    /// Accelerations, 3 per node (length / time^2).
    pub a: Vec<f64>,
    /// `R`: all forces that are weighted.
    pub forces: Vec<f64>,
    /// Energies at the last accepted step.
    pub energy: MotionEnergy,
    /// Largest displacement so far (length), and largest sum of kinetic and strain energy.
    pub farthest: f64,
    /// Largest sum of kinetic and strain energy so far.
    pub greatest: f64,
    /// Contact opened or closed in the last step: its accelerations say nothing of the next one.
    pub event: bool,
}

/// Energies of motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MotionEnergy {
    /// Kinetic energy, and that at the start.
    pub kinetic: f64,
    /// Kinetic energy at the start.
    pub start: f64,
    /// What damping has taken since the start.
    pub damped: f64,
    /// The part of it that viscous material has taken.
    pub viscous: f64,
}

impl MotionEnergy {
    /// What motion has taken up since the start.
    pub fn taken(&self) -> f64 {
        self.kinetic - self.start + self.damped
    }
}

impl Inertia {
    /// Bytes that a node takes.
    pub const NODE: usize = VECTORS * 3 * size_of::<f64>();

    /// Where the model starts, but for the accelerations that its forces cause: [`Self::set_start`].
    pub fn new(model: &Model) -> Option<Inertia> {
        let own = model.dynamics.as_ref()?;
        let zero = vec![0.0; 3 * model.nodes.len()];
        Some(Inertia {
            scheme: Scheme::new(own.settings.rho_inf),
            damping: own.settings.damping.mass,
            timing: own.settings.contact,
            mass: Mass::new(model, &own.densities),
            dashpots: Dashpots::new(model).map(Box::new),
            motion: Motion {
                v: zero.clone(),
                a: zero.clone(),
                forces: zero.clone(),
                ..Motion::default()
            },
            base: zero.clone(),
            dt: 0.0,
            trial: zero.clone(),
            room: [zero.clone(), zero],
            norm: 0.0,
        })
    }

    /// Bytes of heap that viscous material takes.
    pub fn dashpots(&self) -> usize {
        self.dashpots.as_ref().map_or(0, |d| d.bytes())
    }

    /// What a checkpoint keeps.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Goes on from a checkpoint at the displacements `u`.
    pub fn go_on(&mut self, motion: Motion, u: &[f64]) {
        self.motion = motion;
        self.base.copy_from_slice(u);
        self.dt = 0.0;
    }

    /// Sets velocities and prescribed accelerations of the start.
    ///
    /// # Errors
    /// A prescribed value that cannot be evaluated.
    pub fn set_velocities(&mut self, model: &Model, own: &DynamicsModel) -> Result<(), ValueError> {
        [self.motion.v, self.motion.a] = own.start(model)?;
        let kinetic = self.kinetic(model, &self.motion.v.clone());
        self.motion.energy.kinetic = kinetic;
        self.motion.energy.start = kinetic;
        self.motion.greatest = kinetic;
        Ok(())
    }

    /// The tangent `M`, and a right-hand side that gives the accelerations of the start at the displacements `u`: `rhs` holds the forces that act on the
    /// nodes, without inertia, and prescribed accelerations are taken from it.
    pub fn start_system(&mut self, model: &Model, u: &[f64], to: &mut Tangent<'_>) {
        let [accelerations, forces] = &mut self.room;
        if let (Some(dashpots), Some(own)) = (&mut self.dashpots, &model.dynamics) {
            let dt = own.instant;
            let soon = u.iter().zip(&self.motion.v).map(|(u, v)| u + dt * v);
            let soon: Vec<f64> = soon.collect();
            forces.fill(0.0);
            dashpots.begin(model, u);
            dashpots.add(model, (&soon, dt), forces, None);
            for (b, f) in to.rhs.iter_mut().zip(forces.iter()) {
                *b -= *f;
            }
        }
        accelerations.fill(0.0);
        (self.mass).add_product(model, &self.motion.a, accelerations);
        for (b, f) in to.rhs.iter_mut().zip(accelerations.iter()) {
            *b -= *f;
        }
        self.mass.add_tangent(model, 1.0, to);
    }

    /// Adds the accelerations that the system of the start has given.
    pub fn set_start(&mut self, accelerations: &[f64]) {
        for (a, more) in self.motion.a.iter_mut().zip(accelerations) {
            *a += more;
        }
        self.motion.forces.copy_from_slice(&self.trial);
    }

    /// Acceleration and velocity of a degree of freedom at the displacement `u`.
    #[inline]
    fn now(&self, dof: usize, u: f64) -> [f64; 2] {
        let was = [self.motion.v[dof], self.motion.a[dof]];
        if self.dt == 0.0 {
            return [was[1], was[0]];
        }
        let a = (self.scheme).acceleration(u - self.base[dof], was, self.dt);
        [a, self.scheme.velocity(was, a, self.dt)]
    }

    /// Velocities at the displacements `u`, 3 per node.
    pub fn velocities(&self, u: &[f64]) -> Vec<f64> {
        (u.iter().enumerate())
            .map(|(dof, u)| self.now(dof, *u)[1])
            .collect()
    }

    /// Forces of inertia and damping at the end of the step, `M a_1 + C v_1`.
    pub fn forces(&self, model: &Model, u: &[f64]) -> Vec<f64> {
        let a: Vec<f64> = (u.iter().enumerate())
            .map(|(dof, u)| {
                let [a, v] = self.now(dof, *u);
                a + self.damping * v
            })
            .collect();
        let mut out = vec![0.0; u.len()];
        self.mass.add_product(model, &a, &mut out);
        self.add_viscous(&mut out);
        out
    }

    fn add_viscous(&self, out: &mut [f64]) {
        if let Some(dashpots) = &self.dashpots {
            for (out, f) in out.iter_mut().zip(dashpots.forces()) {
                *out += f;
            }
        }
    }

    /// The balance of all forces at the end of the step, of which `contact` are those of contact: what supports exert, and zero
    /// (to the order of the method) at what is free.
    pub fn balance(&self, model: &Model, u: &[f64], contact: &[f64], out: &mut [f64]) {
        let a: Vec<f64> = (u.iter().enumerate())
            .map(|(dof, u)| self.now(dof, *u)[0])
            .collect();
        out.copy_from_slice(&self.trial);
        self.mass.add_product(model, &a, out);
        self.add_viscous(out);
        if self.timing == ContactTiming::Implicit {
            for (out, f) in out.iter_mut().zip(contact) {
                *out += f;
            }
        }
    }

    /// Moves `u` on to where the present step would end if nothing acted anew.
    pub fn predict(&self, u: &mut [f64]) {
        let dt = self.dt;
        let curved = if self.motion.event {
            0.0
        } else {
            0.5 * dt * dt
        };
        for (dof, u) in u.iter_mut().enumerate() {
            *u = self.base[dof] + dt * self.motion.v[dof] + curved * self.motion.a[dof];
        }
    }

    /// Largest error of a displacement that the step to `u` adds, and the largest displacement so far.
    pub fn local_error(&self, u: &[f64]) -> [f64; 2] {
        let factor = self.scheme.error(self.dt);
        let (mut error, mut farthest) = (0.0f64, self.motion.farthest);
        for (n, u) in u.chunks_exact(3).enumerate() {
            let (mut e, mut way) = (0.0, 0.0);
            for (c, u) in u.iter().enumerate() {
                let dof = 3 * n + c;
                e += (factor * (self.now(dof, *u)[0] - self.motion.a[dof])).powi(2);
                way += u * u;
            }
            error = error.max(e.sqrt());
            farthest = farthest.max(way.sqrt());
        }
        [error, farthest]
    }

    fn kinetic(&self, model: &Model, v: &[f64]) -> f64 {
        let mut momentum = vec![0.0; v.len()];
        self.mass.add_product(model, v, &mut momentum);
        0.5 * v.iter().zip(&momentum).map(|(v, p)| v * p).sum::<f64>()
    }

    /// Energies at the end of the step to `u`, the state evaluated last. Damping by mass takes the mean of its forces at both ends along the way.
    pub fn energy(&self, model: &Model, u: &[f64]) -> MotionEnergy {
        let v = self.velocities(u);
        let mut damped = self.motion.energy.damped;
        if self.damping > 0.0 {
            let mean: Vec<f64> = (v.iter().zip(&self.motion.v))
                .map(|(a, b)| 0.5 * self.damping * (a + b))
                .collect();
            let mut force = vec![0.0; u.len()];
            self.mass.add_product(model, &mean, &mut force);
            let way = u.iter().zip(&self.base).map(|(u, base)| u - base);
            damped += force.iter().zip(way).map(|(f, way)| f * way).sum::<f64>();
        }
        let taken = self.dashpots.as_ref().map_or(0.0, |d| d.taken());
        MotionEnergy {
            kinetic: self.kinetic(model, &v),
            damped: damped + taken,
            viscous: self.motion.energy.viscous + taken,
            ..self.motion.energy
        }
    }

    /// Linear momentum, and angular momentum about the origin, of all bodies at the displacements `u`.
    pub fn momentum(&self, model: &Model, u: &[f64]) -> [Vec3; 2] {
        let v = self.velocities(u);
        let mut p = vec![0.0; v.len()];
        self.mass.add_product(model, &v, &mut p);
        let mut out = [Vec3::zeros(); 2];
        for (n, p) in p.chunks_exact(3).enumerate() {
            let p = Vec3::from_column_slice(p);
            out[0] += p;
            out[1] += model.position(n, u).cross(&p);
        }
        out
    }

    /// Takes over the end of a step to `u`, whose energies are these; `internal` is the strain energy there, and `event` says
    /// that contact opened or closed.
    pub fn commit(&mut self, u: &[f64], energy: MotionEnergy, internal: f64, event: bool) {
        let [_, farthest] = self.local_error(u);
        for (dof, u) in u.iter().enumerate() {
            let [a, v] = self.now(dof, *u);
            (self.motion.a[dof], self.motion.v[dof]) = (a, v);
        }
        self.motion.forces.copy_from_slice(&self.trial);
        self.base.copy_from_slice(u);
        self.dt = 0.0;
        let greatest = self.motion.greatest.max(energy.kinetic + internal);
        self.motion.energy = energy;
        self.motion.farthest = farthest;
        self.motion.greatest = greatest;
        self.motion.event = event;
    }
}

impl Contribution for Inertia {
    fn begin(&mut self, model: &Model, u: &[f64], [start, end]: [f64; 2]) {
        self.base.copy_from_slice(u);
        self.dt = end - start;
        if let Some(dashpots) = &mut self.dashpots {
            dashpots.begin(model, u);
        }
    }

    /// Weights what is in the residual and in the tangent, and adds inertia and damping.
    fn add(
        &mut self,
        model: &Model,
        u: &[f64],
        residual: &mut [f64],
        mut to: Option<&mut Tangent>,
    ) {
        let mut room = std::mem::take(&mut self.room);
        let [a, forces] = &mut room;
        if self.damping > 0.0 {
            for (dof, (a, u)) in a.iter_mut().zip(u).enumerate() {
                *a = self.damping * self.now(dof, *u)[1];
            }
            self.mass.add_product(model, a, residual);
        }
        self.trial.copy_from_slice(residual);
        let Scheme {
            alpha_m, alpha_f, ..
        } = self.scheme;
        if self.dt > 0.0 {
            for (dof, (a, u)) in a.iter_mut().zip(u).enumerate() {
                *a = (1.0 - alpha_m) * self.now(dof, *u)[0] + alpha_m * self.motion.a[dof];
            }
            forces.fill(0.0);
            self.mass.add_product(model, a, forces);
            let norm = |f: &[f64]| f.iter().map(|f| f * f).sum::<f64>().sqrt();
            self.norm = norm(forces).max(norm(residual));
            let sums = residual
                .iter_mut()
                .zip(forces.iter())
                .zip(&self.motion.forces);
            for ((r, inertia), before) in sums {
                *r = (1.0 - alpha_f) * *r + alpha_f * before + inertia;
            }
            if let Some(to) = to.as_deref_mut() {
                to.matrix.scale(1.0 - alpha_f);
                to.rhs.iter_mut().for_each(|b| *b *= 1.0 - alpha_f);
                let [inertia, damping] = self.scheme.tangent(self.dt);
                let factor = inertia + damping * self.damping;
                self.mass.add_tangent(model, factor, to);
            }
            if let Some(dashpots) = &mut self.dashpots {
                dashpots.add(model, (u, self.dt), residual, to);
            }
        }
        self.room = room;
    }

    fn turn(&self) -> Turn {
        match self.timing {
            ContactTiming::Implicit => Turn::BeforeContact,
            ContactTiming::Weighted => Turn::AfterContact,
        }
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    fn bytes(&self) -> usize {
        let Motion { v, a, forces, .. } = &self.motion;
        let own = [v, a, forces, &self.base, &self.trial];
        own.into_iter().chain(&self.room).map(heap).sum::<usize>() + self.mass.bytes()
    }
}
