//! CAD surfaces for computation: NURBS patches read from CAD files, evaluated with their derivatives, and the closest
//! point on any number of them to a point of space.
//!
//! - **Read** ([`io`]): STEP, IGES, and JSON of Kratos, geomdl and our own. Trimmed faces are trimmed; what could not be read
//!   is named.
//! - **Evaluate** ([`NurbsPatch`], [`Surface`]): point, tangents and second derivatives in one [`Jet`]; normal, metric,
//!   curvature and Christoffel symbols in a [`Frame`]. No allocation.
//! - **Project** ([`PatchSet`]): the closest point over all patches, found by a global search, not from a guess. A
//!   [`Foot`] says where it lies (face, edge, corner, crease, pole), how sure it is, and on which side the point is.
//! - **Rays and distances** ([`PatchSet::first_hit`], [`PatchSet::separation`]): where a line meets the trimmed surfaces, and
//!   how far two sets are apart.
//! - **Triangles** (`PatchSet::tessellate`): to a tolerance, with trims, closed where the surface is.
//! - **Facets** ([`Bilinear`], [`Biquadratic`]): cut from patches, read from STL, or the faces of finite elements. They are
//!   surfaces as well, so all of the above holds for them.
//! - **Moving facets** ([`MovingFacets`]): facets whose nodes move from step to step, as they are or as one smooth surface,
//!   with the shape functions of the nodes and a search tree that is refitted.
//!
//! ```
//! use covact_geometry::{Location, NurbsPatch, PatchSet, Status, Vec3};
//!
//! // A quarter of a cylinder of radius 2 and height 3: exact, as its weights say.
//! let points = [[2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [2., 0., 3.], [2., 2., 3.], [0., 2., 3.]].map(Vec3::from);
//! let (w, knots) = (0.5f64.sqrt(), [vec![0., 0., 0., 1., 1., 1.], vec![0., 0., 1., 1.]]);
//! let patch = NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&[1., w, 1., 1., w, 1.]))?;
//! let surface = PatchSet::new(vec![patch], None)?;
//!
//! let foot = surface.project(&Vec3::new(3.0, 4.0, 1.0), None, f64::INFINITY).expect("a finite point");
//! assert_eq!((foot.location, foot.status), (Location::Face, Status::Unique));
//! assert!((foot.signed_distance - 3.0).abs() < 1e-12);
//! assert!((foot.jet.rho - Vec3::new(1.2, 1.6, 1.0)).norm() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! From a file it is `io::read_path(path)?` and the `patch` of each of its `patches`;
//! `examples/project_points.rs` projects a million points so. Queries take `&self`: share a
//! set between threads. Only the first query that ends in a part of a surface allocates and may wait for another one that is
//! the first there, too.
//!
//! Points above a bumpy patch and their closest points, coloured by where these lie (`examples/picture.rs`):
#![doc = include_str!("../assets/projection.svg")]
//!
//! # Conventions
//!
//! Parameters are `xi = [xi1, xi2]`; control points are numbered with xi1 fastest. The normal `rho_1 x rho_2` points
//! outwards, times `side` where a set had to turn a patch over to orient all alike; distances are positive outside.
//! Lengths are in the unit of the file ([`io::CadFile::convert_to`] changes it). Library code does not panic on what
//! it is given, and prints nothing.

// The one exception is the evaluation kernel for AVX2.
#![deny(unsafe_code)]
// Public items are documented: what is not to be seen from outside is `pub(crate)`.
#![deny(missing_docs)]

/// The examples of README.md, which are compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod basis;
pub mod bezier;
pub mod curve;
pub mod facet;
pub mod frame;
#[cfg(feature = "io")]
pub mod io;
pub mod memory;
pub mod moving;
mod parallel;
pub mod patch;
pub mod primitives;
pub mod project;
pub mod surface;
#[cfg(feature = "tessellate")]
pub mod tessellate;
pub mod trim;

pub use bezier::{BezierPiece, bezier_pieces};
pub use curve::NurbsCurve;
pub use facet::{Bilinear, Biquadratic, FacetMesh};
pub use frame::Frame;
pub use moving::{
    CurvedRows, MovingError, MovingFacets, MovingFoot, MovingPlace, PatchSpans, ShapeRows,
};
/// Vectors, points and poses are those of nalgebra.
pub use nalgebra;
pub use patch::{NurbsPatch, PatchError, PatchShape};
pub use project::{EdgeKind, Foot, Hint, Location, PatchSet, Status};
pub use surface::{Jet, Jet3, Surface, Vec3};
pub use trim::{CurvePart, RulePoint, Trim, TrimCurve, TrimLoop};
