//! Faces on surfaces, whatever the format: boundaries become loops of curves in the parameter plane, space curves are
//! projected, and the patch is trimmed by the loops. Readers of IGES and STEP stand on it.
//!
//! A reader hands over a [`BasePatch`] and a [`Face`] of [`Boundary`]s. `curves` brings the curves of each to the patch's
//! parameters: those of the file by a [`ParameterMap`] each way, those in space by projection onto the `host`. `unroll` chains
//! them across seams and poles, and `loops` closes them; `fit` makes splines of what has no exact form, and `spikes` cuts off
//! ends that run back along each other. `extent` continues a patch that its boundary leaves, and `areas` compares what
//! contradicting curves bound. [`Grant`] bounds work and memory by the length of the file.

mod areas;
mod base;
mod chain;
mod curves;
mod enclosed;
mod extent;
mod face;
mod fit;
mod grant;
mod host;
mod knots;
mod loops;
mod metered;
mod offset_fit;
mod parameter_map;
mod poles;
mod reparametrise;
mod revolve;
mod sides;
mod spikes;
mod unroll;

pub use areas::{by_parameters, disagreement};
pub use base::BasePatch;
pub(in crate::io) use base::approximation;
pub use curves::{Tally, add};
pub use enclosed::bounds_outside;
pub use extent::grown;
pub use face::{Boundary, Face, Part, Preference, Stretch, reversed, without_parameters};
pub use grant::Grant;
pub use host::Host;
pub use knots::{merge_close, pieces};
pub use loops::{GAP, loops, widest_gap};
pub use metered::{Metered, NoSet, STEPS, bytes_of_edges, set_of};
pub use offset_fit::{normal, offset};
pub use parameter_map::ParameterMap;
pub use reparametrise::Reparametrise;
pub use revolve::revolved;
