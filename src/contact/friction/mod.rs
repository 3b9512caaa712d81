//! Friction: the slip of a slave point measured from its attraction point, the law of slip, traction and tangent.
//!
//! A slave point `r_s` in contact is tied by a tangential penalty to a point of the master, its attraction point
//! ([`history`]). With the normal `n` at the present foot and `P = I - n x n` the trial traction is
//!
//! ```text
//! v    = lambda + eps_T phi (r_s - base)      T_tr = P v
//! ```
//!
//! which a law of friction ([`law`]) returns to its limit. `lambda` is the traction that the point had when its base was
//! last set, or a multiplier: penalty and augmentation are one form. `phi` is the part of a step after the impact. Nothing
//! here refers to parameters of a surface, so that borders of patches, seams and knots do not exist for friction.
//!
//! This is the evolution of the tangential traction of Konyukhov & Schweizerhof, Comput. Mech. 35 (2005), eq. (4), as the
//! return from a finite chord; the slip is the one at the slave point, to which the traction is conjugate at every `xi3`.
//!
//! - [`trial`]: from the position to the traction and its derivative;
//! - [`law`]: Coulomb's law, and what any law has to give; [`orthotropic`]: a law of two coefficients;
//! - [`rigid`]: points on rigid masters; [`steady`]: points whose normals stay, at small displacements;
//! - [`anchor`]: the attraction point on a facet that moves, [`moving`]: the response there in the slots,
//!   [`heading`]: the direction of a law there, [`touch`]: points on faces of bodies, [`scatter`]: from the slots to their nodes;
//! - [`given`]: points whose normal traction is that of the nodes around them;
//! - [`published`], [`evolution`]: the published tangents and the rate law in components, to compare with.
pub mod anchor;
pub mod evolution;
pub mod given;
pub mod heading;
pub mod history;
pub mod law;
pub mod moving;
pub mod orthotropic;
pub mod published;
pub mod rigid;
pub mod scatter;
pub mod shear_limited;
pub mod steady;
pub mod touch;
pub mod trial;
pub mod turning;
