//! How long Newton's method goes on.

/// Residual, relative to the forces, of a state that another solve starts from: its own first one is as large as its forces, so that
/// more digits are lost again.
pub const ROUGH: f64 = 1e-2;

/// How long Newton's method goes on without getting nearer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Patience {
    /// Another start is at hand: give up after a few iterations without headway.
    Short,
    /// Use all iterations.
    Long,
    /// The same, and stop where another solve takes over: at a hundredth of the forces, whichever points still switch.
    Rough,
}
