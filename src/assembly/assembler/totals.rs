//! Sums over the bodies and contacts of a state.
use super::driven::UnresistedMotion;
use crate::effects::inertia::MotionEnergy;
use covact_geometry::Vec3;

/// What acts on one side of a contact: that of a rigid surface on the bodies, or of one body on the other.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SurfaceForce {
    /// Force on the bodies.
    pub force: Vec3,
    /// Moment of that force about the origin.
    pub moment: Vec3,
}

impl SurfaceForce {
    pub(super) fn join(&mut self, more: &SurfaceForce) {
        self.force += more.force;
        self.moment += more.moment;
    }
}

/// What a contact pair does to its two bodies, summed over the nodes of each.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PairForce {
    /// What acts on the slave body.
    pub slave: SurfaceForce,
    /// What acts on the master body.
    pub master: SurfaceForce,
}

impl PairForce {
    pub(super) fn sides(&mut self) -> [&mut SurfaceForce; 2] {
        [&mut self.slave, &mut self.master]
    }
}

/// Totals of one evaluation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Totals {
    /// Strain energy; of a step that is not accepted yet it contains what plastic flow takes.
    pub internal_energy: f64,
    /// Work that plastic flow has taken up to the last accepted step.
    pub plastic_work: f64,
    /// What motion has taken, of an accepted step.
    pub motion: MotionEnergy,
    /// Energy stored in the penalty.
    pub contact_energy: f64,
    /// Per surface of the model.
    pub surfaces: Vec<SurfaceForce>,
    /// Per pair; zero where its master is rigid.
    pub pairs: Vec<PairForce>,
    /// Points in contact, or nodes where gaps are averaged.
    pub active: usize,
    /// Points or nodes whose status differs from the one in the state when the evaluation began.
    pub changed: usize,
    /// Number of points on rigid masters that opened during this evaluation; not of averaged gaps.
    pub opened: usize,
    /// The same of points on bodies.
    pub opened_on_bodies: usize,
    /// Deepest penetration, >= 0, per pair.
    pub penetration: Vec<f64>,
    /// Whether any point or node is in contact, per pair.
    pub touching: Vec<bool>,
    /// Norm of the contact forces on nodes.
    pub contact_norm: f64,
    /// Largest norm of the forces of effects that the residual has to be small beside; zero without them.
    pub effects_norm: f64,
    /// What rounding of the positions leaves of them: the norm of penalty times area times the rounding of a position, over
    /// the points in contact.
    pub contact_rounding: f64,
    /// Motions of driven surfaces that the contact does not resist, found with the tangent.
    pub loose: Vec<UnresistedMotion>,
}
