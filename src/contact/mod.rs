//! The covariant core of contact: slave points, kernel, laws. It knows nothing of shells or files.
//!
//! - [`kernel`]: face points in nine slots, [`corner`]: edges and vertices, [`published`]: the published tangent;
//! - [`point`]: one response for all of them, [`law`]: what the traction is;
//! - [`rigid`], [`moving`]: closest points on masters that do not move or whose nodes do, [`meeting`]: what both give,
//!   [`placed`]: many points on a rigid one;
//! - [`kind`]: what a batch of points is compiled for;
//! - [`friction`]: slip, its laws and its history;
//! - [`spin`]: a rigid body's translation and spin in the slots, [`averaged`]: the gap in the mean of slave nodes.
pub mod averaged;
pub mod carried;
pub mod clip;
pub mod closest;
pub mod corner;
pub mod fault;
pub mod friction;
pub mod kernel;
pub mod kind;
pub mod law;
pub mod meeting;
pub mod moving;
pub mod placed;
pub mod point;
pub mod points;
pub mod published;
pub mod rigid;
pub mod scatter;
pub mod spin;
