//! Closest points with reasons where there are none, and of surfaces that were moved as a whole.

use super::{Foot, PatchSet};
use crate::surface::{Surface, Vec3};
use nalgebra::Isometry3;

/// Why a query has no answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// A coordinate of the point or of the pose is infinite or not a number, or the reach is not a number.
    #[error("the point or its reach is not finite")]
    NotFinite,
    /// No point of the surface is within reach.
    #[error("no point of the surface lies within {reach}")]
    BeyondReach {
        /// The distance asked for.
        reach: f64,
    },
}

impl<S: Surface> PatchSet<S> {
    /// Closest point of the set to `q`: [`project`](Self::project) without a hint and a limit.
    ///
    /// # Errors
    /// [`QueryError::NotFinite`].
    pub fn closest(&self, q: &Vec3) -> Result<Foot, QueryError> {
        self.closest_within(q, f64::INFINITY)
    }

    /// Closest point of the set to `q` within the distance `reach`.
    ///
    /// # Errors
    /// [`QueryError::NotFinite`], and [`QueryError::BeyondReach`] where the set is farther away than that.
    pub fn closest_within(&self, q: &Vec3, reach: f64) -> Result<Foot, QueryError> {
        if !q.iter().all(|x| x.is_finite()) || reach.is_nan() {
            return Err(QueryError::NotFinite);
        }
        let found = self.project(q, None, reach);
        found.ok_or(QueryError::BeyondReach { reach })
    }

    /// Closest point to `q` of the set where `pose` puts it, within the distance `reach`. The foot is given in the
    /// coordinates of `q`; its parameters are those of the patches, which nothing moves.
    ///
    /// # Errors
    /// As [`closest_within`](Self::closest_within).
    pub fn closest_at(
        &self,
        pose: &Isometry3<f64>,
        q: &Vec3,
        reach: f64,
    ) -> Result<Foot, QueryError> {
        let turn = pose.rotation;
        let own = turn.inverse() * (q - pose.translation.vector);
        let mut foot = self.closest_within(&own, reach)?;
        foot.jet.rho = turn * foot.jet.rho + pose.translation.vector;
        foot.jet.rho_i = foot.jet.rho_i.map(|t| turn * t);
        foot.jet.rho_ij = foot.jet.rho_ij.map(|t| turn * t);
        foot.normal = turn * foot.normal;
        Ok(foot)
    }
}
