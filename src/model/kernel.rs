//! Which of the compiled loops over slave points a pair runs in. Chosen once, from the model.
use crate::contact::kind::{FrictionKind, LawKind, MasterKind, TangentKind};
use crate::contact::published::Parts;
use crate::model::master::Master;
use crate::model::surface::{SurfaceModel, SurfaceSet};
use crate::model::{Model, PairModel};
use crate::scene::Tangent;
use std::fmt;

/// Of what the gaps are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapKind {
    /// Of every slave point.
    Pointwise,
    /// Of every slave node, in the mean of the points around it.
    Averaged,
    /// Of every slave point, with the normal and the foot that it has at the start: displacements are small.
    Linearised,
}

/// Whose rows the points of a pair have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SideKind {
    /// Those of the slave and of what moves of the master.
    Both,
    /// Those of the slave alone: one of two half passes.
    Slave,
}

/// A loop over the slave points of a pair: all that is a type or a constant there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kernel {
    pub gap: GapKind,
    pub master: MasterKind,
    pub law: LawKind,
    pub friction: FrictionKind,
    pub tangent: TangentKind,
    pub sides: SideKind,
}

impl Model {
    /// The kernel of a pair.
    #[inline]
    pub fn kernel(&self, pair: usize) -> Kernel {
        Kernel::of(self, &self.pairs[pair])
    }
}

impl Kernel {
    /// The kernel of a pair of a model.
    pub fn of(model: &Model, pair: &PairModel) -> Kernel {
        Kernel {
            gap: match (&model.small, &pair.averaged) {
                (Some(_), _) => GapKind::Linearised,
                (None, None) => GapKind::Pointwise,
                (None, Some(_)) => GapKind::Averaged,
            },
            master: match &pair.master {
                Master::Rigid(surface) => model.surfaces[*surface].kind(),
                own if own.is_own() => MasterKind::OwnFaces,
                Master::Body(_) => MasterKind::Faces,
            },
            law: match pair.augmentation {
                Some(_) => LawKind::Multipliers,
                None if pair.shifts() => LawKind::Offset,
                None => LawKind::Penalty,
            },
            friction: match pair.friction.as_ref().map(|f| &f.law) {
                None => FrictionKind::None,
                Some(law) => law.kind(),
            },
            tangent: match pair.tangent {
                Tangent::Exact => TangentKind::Exact,
                Tangent::Published {
                    rotational,
                    curvature,
                } => TangentKind::Published(Parts {
                    rotational,
                    curvature,
                }),
            },
            sides: match pair.half {
                None => SideKind::Both,
                Some(_) => SideKind::Slave,
            },
        }
    }

    /// Whether the master is a rigid surface.
    pub fn rigid(&self) -> bool {
        match self.master {
            MasterKind::RigidNurbs | MasterKind::RigidBilinear | MasterKind::RigidBiquadratic => {
                true
            }
            MasterKind::Faces | MasterKind::OwnFaces => false,
        }
    }
}

/// E.g. `rigid_nurbs.penalty.coulomb.exact`.
impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.gap {
            GapKind::Pointwise => {}
            GapKind::Averaged => f.write_str("averaged.")?,
            GapKind::Linearised => f.write_str("linearised.")?,
        }
        let (master, law) = (self.master.name(), self.law.name());
        let (friction, tangent) = (self.friction.name(), self.tangent.name());
        write!(f, "{master}.{law}.{friction}.{tangent}")?;
        match self.sides {
            SideKind::Both => Ok(()),
            SideKind::Slave => f.write_str(".slave_rows"),
        }
    }
}

impl SurfaceModel {
    /// What its closest points are looked for on; `with_patches` compiles loops for each.
    pub fn kind(&self) -> MasterKind {
        match self.set {
            SurfaceSet::Nurbs(_) => MasterKind::RigidNurbs,
            SurfaceSet::Bilinear(_) => MasterKind::RigidBilinear,
            SurfaceSet::Biquadratic(_) => MasterKind::RigidBiquadratic,
        }
    }
}

impl PairModel {
    /// Whether gaps are measured from elsewhere than the master: always or never over a run.
    pub fn shifts(&self) -> bool {
        self.overclosure.is_some() || self.offset != 0.0 || !self.bow.is_empty()
    }
}
