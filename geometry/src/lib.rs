//! NURBS surfaces from CAD files: exact jets, local frames and closest points.
//!
//! A [`NurbsPatch`] gives the surface point with its derivatives (a [`Jet`]), a [`Frame`] turns a jet into normal,
//! metric, curvature and Christoffel symbols, and a [`PatchSet`] finds the closest point on many patches. Facets
//! ([`Bilinear`], [`Biquadratic`]) are surfaces as well: cut from patches, read from STL, or the faces of finite elements.

// The one exception is the evaluation kernel for AVX2.
#![deny(unsafe_code)]

pub mod basis;
pub mod bezier;
pub mod curve;
pub mod facet;
pub mod frame;
pub mod io;
pub mod patch;
pub mod primitives;
pub mod project;
pub mod surface;
pub mod trim;

pub use bezier::{BezierPiece, bezier_pieces};
pub use curve::NurbsCurve;
pub use facet::{Bilinear, Biquadratic, FacetMesh};
pub use frame::Frame;
pub use patch::{NurbsPatch, PatchError, PatchShape};
pub use project::{EdgeKind, Foot, Hint, Location, PatchSet, Status};
pub use surface::{Jet, Jet3, Surface, Vec3};
pub use trim::{Trim, TrimCurve, TrimLoop};
