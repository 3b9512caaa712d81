//! Supports as constraints on single degrees of freedom.
use crate::scene::TimeFunction;

/// What a support says of one degree of freedom `3 node + component`.
#[derive(Debug, Clone)]
pub struct Prescribed {
    pub dof: u32,
    /// Index of the support in the model.
    pub support: u32,
    /// Displacement over time; `None` is zero.
    pub value: Option<TimeFunction>,
}

/// A degree of freedom that goes with others, one of which it is tied to: what the tie exerts on it belongs to a support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tied {
    pub dof: u32,
    /// What it is tied to; itself, where the others are tied to it.
    pub to: u32,
    /// Index of the support in the model.
    pub support: u32,
}

/// A mid-surface support: the mean of two degrees of freedom is prescribed, `u_tied = 2 mean - u_free`. Both feel half
/// of its reaction.
#[derive(Debug, Clone)]
pub struct MeanPrescribed {
    pub free: u32,
    pub tied: u32,
    pub support: u32,
    /// A second support that prescribes `free` itself; the mean then only moves `tied`.
    pub held_by: Option<u32>,
    /// Displacement of the mid-surface over time; `None` is zero.
    pub mean: Option<TimeFunction>,
}
