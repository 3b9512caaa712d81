//! The covariant core of contact: slave points, kernel, laws. It knows nothing of shells or files.
pub mod averaged;
pub mod carried;
pub mod closest;
pub mod corner;
pub mod fault;
pub mod kernel;
pub mod law;
pub mod meeting;
pub mod moving;
pub mod point;
pub mod points;
pub mod published;
pub mod rigid;
pub mod scatter;
pub mod spin;
