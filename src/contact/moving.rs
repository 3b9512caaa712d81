//! Contact of slave points with facets whose nodes move.
use super::kernel::{SlotMatrix, Slots};
use super::law::NormalLaw;
use super::point::{FaceTangent, PointGeometry, respond};
use super::rigid::PointFault;
use covact_geometry::{EdgeKind, Frame, Hint, MovingFacets, MovingPlace, Status, Vec3};

/// Moving facets at their present position.
#[derive(Debug, Clone, Copy)]
pub struct MovingMaster<'a> {
    pub facets: &'a MovingFacets,
    /// Points deeper than this below the surface are not in contact (length).
    pub depth: f64,
}

/// A point in contact, per unit area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingTouch {
    pub facet: u32,
    pub xi: [f64; 2],
    /// Generalised forces in the nine slots, force / length^2.
    pub residual: Slots,
    pub tangent: SlotMatrix,
    /// Normal coordinate, negative.
    pub xi3: f64,
    /// Normal traction, negative.
    pub n: f64,
    pub normal: Vec3,
}

impl MovingMaster<'_> {
    /// Evaluates one slave point; `None` where it is open. Facets that `accept` refuses do not exist for it.
    pub fn touch<L: NormalLaw, T: FaceTangent>(
        &self,
        x: &Vec3,
        hint: &mut Option<Hint>,
        law: &L,
        tangent: &T,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<MovingTouch>, PointFault> {
        if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
            return Err(PointFault::NotFinite);
        }
        let Some(foot) = self.facets.project(x, *hint, self.depth, accept) else {
            *hint = None;
            return Ok(None);
        };
        *hint = Some(foot.hint());
        let (patch, xi, xi3) = (foot.facet, foot.xi, foot.signed_distance);
        if foot.status == Status::NotConverged {
            return Err(PointFault::ProjectionNotConverged { patch, xi });
        }
        if xi3 >= 0.0 {
            return Ok(None);
        }
        let d = x - foot.jet.rho;
        let geometry = match foot.place {
            MovingPlace::Edge {
                kind: EdgeKind::Free,
                ..
            }
            | MovingPlace::Corner {
                kind: EdgeKind::Free,
            } => return Ok(None),
            MovingPlace::Face => PointGeometry::Face {
                frame: Frame::new(&foot.jet, 1.0)
                    .ok_or(PointFault::DegenerateFrame { patch, xi })?,
                xi3,
            },
            MovingPlace::Edge { direction, .. } => {
                PointGeometry::edge(&foot.jet, direction, d, xi3)
            }
            MovingPlace::Corner { .. } => PointGeometry::Vertex { d, xi3 },
        };
        if !geometry.is_minimum() {
            return Err(PointFault::BeyondFocalSurface { patch, xi, xi3 });
        }
        let normal = law.normal(xi3);
        let (residual, tangent) = respond(&geometry, &normal, tangent);
        Ok(Some(MovingTouch {
            facet: foot.facet,
            xi,
            residual,
            tangent,
            xi3,
            n: normal.n,
            normal: foot.normal,
        }))
    }
}
