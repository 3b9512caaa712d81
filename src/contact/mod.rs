//! The covariant core of contact: slave points, kernel, laws. It knows nothing of shells or files.
pub mod closest;
pub mod corner;
pub mod kernel;
pub mod law;
pub mod points;
pub mod published;
pub mod rigid;
