//! Transformation matrices, entity 124.

use super::super::error::Fail;
use super::Model;
use super::directory::Entry;
use crate::Vec3;
use nalgebra::Matrix3;

/// x -> R x + t, the map from an entity's own space to model space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    pub linear: Matrix3<f64>,
    pub shift: Vec3,
}

impl Affine {
    pub fn identity() -> Self {
        Self {
            linear: Matrix3::identity(),
            shift: Vec3::zeros(),
        }
    }

    pub fn apply(&self, point: Vec3) -> Vec3 {
        self.linear * point + self.shift
    }

    /// The map back, if there is one.
    pub fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        Some(Self {
            linear,
            shift: -(linear * self.shift),
        })
    }

    /// First `self`, then `outer`.
    fn then(&self, outer: &Self) -> Self {
        Self {
            linear: outer.linear * self.linear,
            shift: outer.apply(self.shift),
        }
    }

    /// First `inner`, then `self`.
    pub fn after(&self, inner: &Self) -> Self {
        inner.then(self)
    }
}

/// The matrix of an entity, together with the matrices of that matrix (124 entities may be chained).
pub fn matrix_of(model: &Model, entry: &Entry, notes: &mut Vec<String>) -> Result<Affine, Fail> {
    let mut total = Affine::identity();
    let mut current = entry;
    // A chain without a cycle is no longer than the directory.
    for _ in 0..=model.entries.len() {
        if current.matrix == 0 {
            return Ok(total);
        }
        let place = (current.line, 49);
        let next = model.entry(current.matrix, place, "a transformation matrix (124)")?;
        if next.type_number != 124 {
            let found = format!("entity {} of type {}", next.number, next.type_number);
            return Err(Fail::new(place, "a transformation matrix (124)", found));
        }
        total = total.then(&read(model, next, notes)?);
        current = next;
    }
    Err(Fail::new(
        (current.line, 49),
        "a chain of transformation matrices that ends",
        format!("entity {}, which leads back to itself", current.number),
    ))
}

fn read(model: &Model, entry: &Entry, notes: &mut Vec<String>) -> Result<Affine, Fail> {
    let params = model.params(entry)?;
    let v = params.reals(1, 12, "a 3 x 4 matrix by rows")?;
    let linear = Matrix3::new(v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]);
    let shift = Vec3::new(v[3], v[7], v[11]);
    if linear.determinant().abs() < 1e-12 * linear.norm().powi(3) || linear.norm() == 0.0 {
        return Err(params.fail(1, "a transformation matrix that is not singular"));
    }
    // Writers print 6 to 17 digits.
    let deviation = (linear.transpose() * linear - Matrix3::identity())
        .abs()
        .max();
    if deviation > 1e-5 {
        let note = format!(
            "entity {} (124): the matrix is no rotation (R^T R differs from 1 by {deviation:.1e}); applied as it is",
            entry.number
        );
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    Ok(Affine { linear, shift })
}
