//! Where a slave point meets a master surface, before any law is asked.
use super::fault::{Piece, PointFault};
use super::hanging::Hanging;
use super::kernel::{Normal, SlotMatrix, Slots};
use super::law::NormalLaw;
use super::point::{FaceTangent, PointGeometry, respond};
use covact_geometry::Vec3;

/// The closest point of a slave point and what the surface looks like there, in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// The patch, edge or vertex that the foot lies on.
    pub piece: Piece,
    /// Parameters of the foot.
    pub xi: [f64; 2],
    /// The foot `rho`.
    pub rho: Vec3,
    /// What the surface looks like at the foot.
    pub geometry: PointGeometry,
    /// Normal coordinate (length), negative below the surface; past a border that is rounded off that over the rounding.
    pub xi3: f64,
    /// Outward unit normal; the pseudo-normal on edges and vertices.
    pub normal: Vec3,
    /// The foot lies on a free border: the point hangs past it, and nothing of the surface stands in its way.
    pub free: bool,
    /// It hangs over a free border of a body that is rounded off, beyond which the geometry is that of the continued facet.
    pub hanging: Option<Hanging>,
}

/// A contact point that presses, per unit area and in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlotTouch {
    /// Generalised forces in the nine slots of [`super::kernel`] (the slave is pushed by their negative),
    /// force / length^2.
    pub residual: Slots,
    /// Their derivative, force / length^3.
    pub tangent: SlotMatrix,
    /// Normal coordinate, negative below the surface.
    pub xi3: f64,
    /// Normal traction, negative.
    pub n: f64,
}

impl Meeting {
    /// Refuses a point at or beyond a focal surface of the master, where the closest point is not unique and the
    /// tangent not finite. For points that carry traction; far on the outside of a hollow master such a point is none of
    /// contact's business.
    pub fn check(&self) -> Result<(), PointFault> {
        if self.geometry.is_minimum() {
            Ok(())
        } else {
            Err(PointFault::BeyondFocalSurface {
                piece: self.piece,
                xi: self.xi,
                xi3: self.xi3,
            })
        }
    }

    /// The geometry for a traction that does not vanish with the distance (an averaged gap, a multiplier). On an edge or a
    /// vertex nearer than `small` (length) the direction of the distance is lost, and the tangent with it; there the
    /// pseudo-normal stands in for it.
    pub fn steady(&self, small: f64) -> PointGeometry {
        match self.geometry {
            PointGeometry::Edge { xi3, .. } | PointGeometry::Vertex { xi3, .. }
                if xi3.abs() < small =>
            {
                PointGeometry::Pole {
                    normal: self.normal,
                    xi3,
                }
            }
            geometry => geometry,
        }
    }

    /// Normal traction of a point in contact under a law.
    ///
    /// # Errors
    /// [`PointFault`] as for [`Self::check`], and where the traction has no direction.
    #[inline]
    pub(super) fn pressed<L: NormalLaw>(&self, law: &L) -> Result<Normal, PointFault> {
        self.check()?;
        let normal = law.response(self.xi3);
        match self.geometry.directs(&normal) {
            true => Ok(normal),
            false => Err(PointFault::NoDirection {
                piece: self.piece,
                xi: self.xi,
                xi3: self.xi3,
            }),
        }
    }

    /// Residual and tangent under a law; `None` where the point is open.
    #[inline]
    pub fn respond<L: NormalLaw, T: FaceTangent>(
        &self,
        law: &L,
        tangent: &T,
    ) -> Result<Option<SlotTouch>, PointFault> {
        if self.free || !law.closes(self.xi3) {
            return Ok(None);
        }
        let normal = self.pressed(law)?;
        let (residual, tangent) = match (&self.hanging, &self.geometry) {
            (Some(hanging), PointGeometry::Face { frame, xi3 }) => {
                let along = hanging.along_normal(&normal);
                let (mut residual, mut k) = respond(&self.geometry, &along, tangent);
                hanging.add_along_facet((frame, *xi3), &normal, &mut residual, &mut k);
                (residual, k)
            }
            _ => respond(&self.geometry, &normal, tangent),
        };
        Ok(Some(SlotTouch {
            residual,
            tangent,
            xi3: self.xi3,
            n: normal.n,
        }))
    }
}
