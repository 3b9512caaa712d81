//! The covariant core of contact: slave points, kernel, laws. It knows nothing of shells or files.
//!
//! - [`kernel`]: face points in nine slots, [`corner`]: edges and vertices, [`published`]: the published tangent;
//! - [`point`]: one response for all of them, [`law`]: what the traction is;
//! - [`rigid`], [`moving`]: closest points on masters that do not move or whose nodes do, [`meeting`]: what both give,
//!   [`placed`]: many points on a rigid one, [`clearance`]: those that are open without a search, `overhang` and [`hanging`]:
//!   those past a free border of a rigid surface and of a body;
//! - [`kind`]: what a batch of points is compiled for;
//! - [`friction`]: slip, its laws and its history;
//! - [`spin`]: a rigid body's translation and spin in the slots, [`averaged`]: the gap in the mean of slave nodes.
//!
//! # Where the equations are
//!
//! The numbers are those of the chapters in `docs/theory`, which follow Konyukhov & Schweizerhof, Comput. Mech. 35 (2005).
//!
//! | | equation | evaluated by |
//! |---|---|---|
//! | (1) | `r_s = rho + xi3 n`, local coordinates of a slave point | [`point::PointGeometry`], from a [`Frame`](covact_geometry::Frame) |
//! | (2) | `dxi3 = g3 . slots`, `dxi^j = X^j . slots` | [`kernel`]; `A^ij` is [`kernel::inverse_at_point`] |
//! | (3) | `dW = N dxi3 + t_j dxi^j` | [`kernel::normal_residual`], [`friction::moving::respond_with_friction`] |
//! | (4) | evolution of the tangential traction | [`friction::evolution::CovariantTraction`] as a rate, [`friction::trial::Attraction`] as a return |
//! | (5) | trial traction, return to the limit | [`friction::trial::Attraction::traction`], [`friction::law::FrictionLaw::slip`] |
//! | (6) | main part of the normal tangent | [`published::normal_tangent`] |
//! | (6a) | rotational part | [`published::Parts::rotational`] |
//! | (6b) | curvature part | [`published::Parts::curvature`] |
//! | (6) to (6b), exact | at every `xi3` | [`kernel::normal_tangent`], [`kernel::normal_tangent_rigid`] |
//! | (7) | `dr_s - drho = A du` | slot 0 of [`kernel::Slots`], by a [`kernel::NodeRow`] |
//! | (8) | `drho_,j = B_j du` | slots 1 and 2 of [`kernel::Slots`], by a [`kernel::NodeRow`] |
//! | (9) | residual and tangent of nodes | [`kernel::assemble_force`], [`kernel::assemble_block`] |
//! | sticking | published | [`friction::published::stick_tangent`] |
//! | sliding | published | [`friction::published::slip_tangent`] |
//! | sticking, sliding, exact | at every `xi3` | [`friction::trial::Attraction::traction_towards`], [`friction::moving::respond_with_friction`] |
pub mod averaged;
pub mod carried;
pub mod clearance;
pub mod clip;
pub mod closest;
pub mod corner;
pub mod fault;
pub mod friction;
pub mod hanging;
mod keep;
pub mod kernel;
pub mod kind;
pub mod law;
pub mod lever;
pub mod meeting;
pub mod moving;
mod overhang;
pub mod placed;
pub mod point;
pub mod points;
pub mod published;
pub mod rigid;
pub mod scatter;
pub mod spin;
