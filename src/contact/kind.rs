//! What a batch of slave points is compiled for, told by the types that it is compiled with: so that what was run can be
//! compared with what was planned.
use super::published::Parts;

/// What the normal traction of the points follows from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawKind {
    /// The penalty times the normal coordinate.
    Penalty,
    /// The penalty times a gap that is measured from elsewhere: an offset, or an overclosure that is not resolved.
    Offset,
    /// A multiplier beside the penalty.
    Multipliers,
    /// Points that a first linearisation keeps in contact wherever they are.
    Held,
}

/// Form of the tangent at face points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TangentKind {
    /// Consistent at every penetration.
    Exact,
    /// The published form with some of its parts.
    Published(Parts),
}

/// Law of friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionKind {
    /// No friction: no histories, and no slots for them.
    None,
    /// One coefficient.
    Coulomb,
    /// Two coefficients.
    Orthotropic,
    /// One coefficient, and a largest traction.
    ShearLimited,
}

/// What closest points are looked for on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MasterKind {
    /// Rigid NURBS patches.
    RigidNurbs,
    /// Rigid bilinear facets.
    RigidBilinear,
    /// Rigid biquadratic facets.
    RigidBiquadratic,
    /// Faces of another body.
    Faces,
    /// Faces of the slave's own body, of which some do not exist for a point.
    OwnFaces,
}

/// The form of a tangent, told by its type and what of it is on.
pub trait TangentForm: Sync {
    /// Which one it is.
    fn kind(&self) -> TangentKind;
}

impl TangentForm for super::rigid::Exact {
    fn kind(&self) -> TangentKind {
        TangentKind::Exact
    }
}

impl TangentForm for Parts {
    fn kind(&self) -> TangentKind {
        TangentKind::Published(*self)
    }
}

impl LawKind {
    /// The name in plans.
    pub const fn name(self) -> &'static str {
        match self {
            LawKind::Penalty => "penalty",
            LawKind::Offset => "offset",
            LawKind::Multipliers => "multipliers",
            LawKind::Held => "held",
        }
    }
}

impl TangentKind {
    /// The name in plans.
    pub const fn name(self) -> &'static str {
        match self {
            TangentKind::Exact => "exact",
            TangentKind::Published(parts) => match (parts.rotational, parts.curvature) {
                (true, true) => "published",
                (false, true) => "published_without_rotational",
                (true, false) => "published_without_curvature",
                (false, false) => "published_main_part",
            },
        }
    }
}

impl FrictionKind {
    /// The laws.
    pub const LAWS: [FrictionKind; 3] = [
        FrictionKind::Coulomb,
        FrictionKind::Orthotropic,
        FrictionKind::ShearLimited,
    ];

    /// The name in plans.
    pub const fn name(self) -> &'static str {
        match self {
            FrictionKind::None => "frictionless",
            FrictionKind::Coulomb => "coulomb",
            FrictionKind::Orthotropic => "orthotropic",
            FrictionKind::ShearLimited => "shear_limited",
        }
    }
}

impl MasterKind {
    /// The name in plans.
    pub const fn name(self) -> &'static str {
        match self {
            MasterKind::RigidNurbs => "rigid_nurbs",
            MasterKind::RigidBilinear => "rigid_bilinear",
            MasterKind::RigidBiquadratic => "rigid_biquadratic",
            MasterKind::Faces => "faces",
            MasterKind::OwnFaces => "own_faces",
        }
    }
}
