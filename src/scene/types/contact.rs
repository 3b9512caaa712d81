//! Contact pairs.
use super::{SetNames, Surface};
use crate::scene::value::Value;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A contact pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Face set of a body, `body.set`, a list of face sets of one body, or a body, `body`: all its outer faces.
    pub slave: SetNames,
    /// Name of a rigid surface, or faces of a deformable body: `body.set`, a list of face sets, or `body`.
    pub master: SetNames,
    /// What surface the faces of a body make; only for masters that are bodies. Default: `faces`.
    #[serde(default)]
    pub master_surface: Option<MasterSurface>,
    /// A point deeper than this below the faces of a body is not in contact (length); only for masters that are bodies
    /// (a rigid surface has a depth of its own). Default: the depth of the elements below the faces.
    #[serde(default)]
    pub depth: Option<f64>,
    /// Where contact is sampled on the slave faces.
    #[serde(default)]
    pub points: Points,
    /// Whether every slave point has a gap of its own, or every slave node the mean of those around it.
    #[serde(default)]
    pub gap: Gap,
    /// Which side of a contact is the slave; `two_half` only for masters that are bodies.
    #[serde(default)]
    pub passes: Passes,
    /// Normal penalty: traction per penetration (force / length^3).
    #[serde(default)]
    pub penalty: Penalty,
    /// Relative error of forces that the automatic penalty aims at; default: 4e-3, and 1e-4 where a stage releases the contact,
    /// until its penalty is rigid beside the thickness of the body. Only where no penalty is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
    /// Tangent matrix of contact.
    #[serde(default)]
    pub tangent: Tangent,
    /// What becomes of slave points that start below the master.
    #[serde(default)]
    pub initial_overclosure: InitialOverclosure,
    /// Law of friction; default: none.
    #[serde(default)]
    pub friction: Option<Friction>,
    /// Tangential penalty: traction per elastic slip (force / length^3); only with friction.
    #[serde(default)]
    pub tangential_penalty: Penalty,
    /// Multipliers beside the penalties; default: none.
    #[serde(default)]
    pub augmentation: Option<Augmentation>,
    /// Contact begins at this distance in front of the master (length), for a thickness that is not modelled.
    #[serde(default)]
    pub offset: f64,
}

impl Contact {
    /// The rigid surface that is the master; none: the master is a body.
    pub fn surface<'s>(&self, surfaces: &'s BTreeMap<String, Surface>) -> Option<&'s Surface> {
        surfaces.get(self.master.single())
    }

    /// Whether slave and master belong to one body.
    pub fn is_own(&self, surfaces: &BTreeMap<String, Surface>) -> bool {
        self.surface(surfaces).is_none() && self.slave.body() == self.master.body()
    }
}

/// Augmentation: within every step the tractions become multipliers, until neither gaps nor elastic slip are left beyond
/// the tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Augmentation {
    /// Largest gap of a point in contact, as a part of the slave's element size.
    pub gap: f64,
    /// Largest elastic slip of a point that sticks, as a part of the slave's element size; only with friction.
    pub slip: f64,
    /// Augmentations of a step after which it is cut.
    pub max: u32,
}

impl Default for Augmentation {
    fn default() -> Self {
        Augmentation {
            gap: 1e-4,
            slip: 1e-4,
            max: 25,
        }
    }
}

/// Law of friction, written `0.2` or `{"coulomb": {"mu": 0.2}}` (Coulomb's), or `{"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0, 0]}}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Friction {
    /// The traction is at most `mu` times the pressure. `mu` may vary in time.
    Coulomb {
        /// Coefficient of friction.
        mu: Value,
    },
    /// Coulomb's law with two coefficients, along a direction of the master and across it: the traction stays within an
    /// ellipse. The direction is given in the coordinates in which the master is given, and is projected on its tangent plane. It
    /// turns with a rigid surface; on faces of a body it turns and stretches with these, as a line drawn on the undeformed
    /// body. Both coefficients may vary in time.
    Orthotropic {
        /// Coefficients along the direction and across it.
        mu: [Value; 2],
        /// Direction of the first coefficient, of any length.
        direction: [f64; 3],
    },
    /// Coulomb's law up to a largest traction, which the softer surface bears: at most `mu` times the pressure, and at most
    /// `limit`. Both may vary in time.
    ShearLimited {
        /// Coefficient of friction.
        mu: Value,
        /// Largest traction (force / length^2).
        limit: Value,
    },
}

/// What becomes of slave points that start below the master.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum InitialOverclosure {
    /// The first step resolves it with strain.
    #[default]
    Strain,
    /// It counts as touching: the gap of every point is measured from where it starts, and nothing is stressed.
    StressFree,
    /// Stress-free at the start and resolved evenly until the time `until`: an interference fit.
    Shrink {
        /// Time at which nothing of it is left.
        until: f64,
    },
    /// An error that names the place and the amount.
    Refuse,
}

impl InitialOverclosure {
    /// Whether overclosures at the start become strain, at once or in the course of the run.
    pub fn is_resolved(self) -> bool {
        matches!(self, Self::Strain | Self::Shrink { .. })
    }
}

/// The surface that a deformable body offers to its slaves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MasterSurface {
    /// The faces as they are: bilinear or biquadratic, with edges between them.
    #[default]
    Faces,
    /// One smooth surface through the nodes of the faces.
    Smooth,
}

/// Where contact is sampled on the slave faces.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Points {
    /// Nodes, or Gauss points where the master is another body: as many as see its faces, where those of the slave are coarser and the
    /// nodes of both sides do not meet.
    #[default]
    Auto,
    /// Nodes, each with its tributary area.
    Nodes,
    /// Gauss points, this many along each direction of a face (1 to 10).
    Gauss(u8),
    /// Lobatto points, this many along each direction of a face (2 to 10).
    Lobatto(u8),
    /// The faces cut by the facets of the master at the start of every step, with a rule of this degree on the triangles of
    /// every piece (1 to 5): exact where faces do not match. Only for masters that are other bodies.
    Segments(u8),
}

/// Which side of a contact is the slave; `two_half` only for masters that are bodies.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Passes {
    /// `one`, and where a run stops while an edge of the master lies on the slave, between its points, it is repeated with `edges`.
    #[default]
    Auto,
    /// The slave: its traction acts on the master with the opposite sign, and forces and moments balance.
    One,
    /// Each side in turn, and the traction of a pass acts on its slave alone: no side is preferred, forces balance as far as
    /// both sides find the same gaps (`imbalance` in the history), and the system is unsymmetric.
    TwoHalf,
    /// The slave, and with it the sharp convex edges of the master and, of a rigid one, its tips and free borders: nodes on them are slave
    /// points too, on the faces of the slave, into which such an edge otherwise sinks between two points.
    Edges,
}

/// What must not be negative.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gap {
    /// The gap of every slave point.
    #[default]
    Pointwise,
    /// The gap of every slave node, averaged with its shape function over the points of the faces around it: many points
    /// at a stiff penalty do not ask more of the faces than their nodes can give. For Gauss and Lobatto points.
    Averaged,
}

/// Penalty: traction per penetration or elastic slip (force / length^3).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Penalty {
    /// The normal one starts soft and is ruled by the error of forces that it makes (`accuracy`); the tangential one keeps the
    /// elastic slip small. Where tractions are augmented: from the stiffness of the elements.
    #[default]
    Auto,
    /// Given value.
    Value(f64),
    /// This multiple of what the stiffness of the elements suggests.
    Scaled(f64),
}

/// Tangent matrix of contact.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Tangent {
    /// Consistent at every penetration.
    #[default]
    Exact,
    /// The published form, whose parts beyond the main one can be left out.
    Published {
        /// With the part of turning normals.
        #[serde(default = "yes")]
        rotational: bool,
        /// With the part of the master's curvature.
        #[serde(default = "yes")]
        curvature: bool,
    },
}

fn yes() -> bool {
    true
}
