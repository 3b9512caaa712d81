//! Residual and tangent of a model, from elements and contact to one sparse system ([`crate::system`]).
mod assembler;

pub(crate) use assembler::sizes;
pub use assembler::{
    Assembler, AssemblerMemory, CouplingMemory, Drag, Factored, Fault, Line, Linearization,
    MemoryError, Needed, PairForce, PointAnswer, Quadratic, RubbedPoints, StartError, SurfaceForce,
    Totals,
};
