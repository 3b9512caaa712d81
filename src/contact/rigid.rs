//! Contact of slave points with a rigid surface: NURBS patches or facets, whatever finds closest points.
use super::closest::ClosestPoint;
use super::corner::{self, Steady};
pub use super::fault::{Piece, PointFault};
use super::keep;
use super::kernel::{self, Normal};
use super::kind::TangentForm;
use super::law::NormalLaw;
use super::meeting::Meeting;
pub use super::overhang::Overhang;
use super::overhang::Rounded;
use super::point::PointGeometry;
use super::published::{self, Parts};
use covact_geometry::{EdgeKind, Foot, Frame, Hint, Jet, Location, PatchSet, Status, Vec3};
use nalgebra::{Isometry3, Matrix3, Point3};

/// Which tangent a batch uses: a type, so that the choice is made outside the loop over points.
pub trait RigidTangent: TangentForm {
    /// Tangent at a face point on a rigid master.
    fn face(&self, frame: &Frame, xi3: f64, normal: &Normal) -> Matrix3<f64>;
}

/// The exact tangent.
#[derive(Debug, Clone, Copy)]
pub struct Exact;

impl RigidTangent for Exact {
    #[inline(always)]
    fn face(&self, frame: &Frame, xi3: f64, normal: &Normal) -> Matrix3<f64> {
        kernel::normal_tangent_rigid(frame, xi3, normal)
    }
}

impl RigidTangent for Parts {
    #[inline(always)]
    fn face(&self, frame: &Frame, _xi3: f64, normal: &Normal) -> Matrix3<f64> {
        published::normal_tangent_rigid(frame, normal, *self)
    }
}

/// A rigid surface at its present position.
#[derive(Debug, Clone)]
pub struct RigidMaster<'a, P = PatchSet> {
    /// Patches of one kind, or what stands for a choice among several.
    pub surface: &'a P,
    /// From the surface's own coordinates to space.
    pub pose: Isometry3<f64>,
    /// Points deeper than this below the surface are not in contact (length).
    pub depth: f64,
    /// Points stay on the patch that their hint names, continued a little past its border, where it meets the next one at a small
    /// angle.
    pub keep: bool,
}

/// A foot on an edge or a crease whose distance vector leans along the line by more than this (relative to the size of
/// the surface) is held along the line too.
const HELD: f64 = 1e-9;
/// Distance from an edge or a vertex (relative to the size of the surface) within which a traction that does not vanish
/// there turns into the pseudo-normal. Much less than any gap that is resolved, and much more than rounding.
const STEADY: f64 = 1e-6;

/// Ratio of the lengths of the tangents below which a pole is looked for.
const UNEVEN: f64 = 2e-5;

/// A point in contact, per unit area and in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// The slave point.
    pub x: Vec3,
    /// Residual (the slave is pushed by its negative), force / length^2.
    pub residual: Vec3,
    /// Derivative of the residual with respect to the slave point, force / length^3.
    pub tangent: Matrix3<f64>,
    /// Normal coordinate, negative below the surface.
    pub xi3: f64,
    /// Gap that the law sees: the normal coordinate, less its offset where there is one. Negative, but for a point that a
    /// multiplier holds slightly above.
    pub gap: f64,
    /// Normal traction, negative.
    pub n: f64,
}

impl<P: ClosestPoint> RigidMaster<'_, P> {
    /// Foot of a point of space within `reach`, in the surface's own coordinates.
    pub fn foot(&self, x: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot> {
        let local = self.pose.inverse_transform_point(&Point3::from(*x)).coords;
        self.surface.project(&local, hint, reach)
    }

    /// Normal coordinate of a point at `x` over the rounding of the free border that its foot lies on, and the normal there in the
    /// surface's own coordinates; none where it is deeper below the border than the rounding, or the surface, reaches.
    pub fn over_border(&self, x: &Vec3, foot: &Foot, overhang: Overhang) -> Option<(f64, Vec3)> {
        let local = self.pose.inverse_transform_point(&Point3::from(*x)).coords;
        let rounded = self.rounded(foot, &(local - foot.jet.rho), overhang)?;
        Some((rounded.xi3, rounded.at.n))
    }

    /// Gap of a point at `x` over its foot, measured from `z0`, and the normal there in the surface's own coordinates: past a free
    /// border that over the rounding.
    pub fn gap(&self, x: &Vec3, foot: &Foot, z0: f64, overhang: Overhang) -> (f64, Vec3) {
        let over = free(foot).then(|| self.over_border(x, foot, overhang));
        let (xi3, normal) = (over.flatten()).unwrap_or((foot.signed_distance, foot.normal));
        (xi3 - z0, normal)
    }

    /// [`Self::over_border`] of a point in contact there, where its gap is measured from `z0`.
    pub fn hanging(
        &self,
        x: &Vec3,
        foot: &Foot,
        z0: f64,
        overhang: Overhang,
    ) -> Option<(f64, Vec3)> {
        let near = free(foot) && foot.distance <= overhang.within(z0);
        let over = near.then(|| self.over_border(x, foot, overhang)).flatten();
        over.filter(|(xi3, _)| *xi3 < z0 && overhang.allows(*xi3 - z0))
    }

    /// Evaluates one slave point; `None` where it is open. For many points make [`Self::placed`] once.
    ///
    /// `hint` is where the search starts, and is set to where it ended; `overhang` says how borders are rounded off for it.
    ///
    /// # Errors
    /// [`PointFault`] where the point has no reliable closest point.
    pub fn touch<L: NormalLaw, T: RigidTangent>(
        &self,
        x: &Vec3,
        (hint, overhang): (&mut Option<Hint>, Overhang),
        law: &L,
        tangent: &T,
    ) -> Result<Option<Touch>, PointFault> {
        self.placed().touch(x, (hint, overhang), law, tangent)
    }

    /// The closest point within `reach` on either side, for what needs more than [`Self::touch`]: a rigid surface with
    /// unknown motion, or an averaged gap. `hint` as there.
    pub fn meet(
        &self,
        x: &Vec3,
        (hint, sunk): (&mut Option<Hint>, f64),
        reach: f64,
    ) -> Result<Option<Meeting>, PointFault> {
        if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
            return Err(PointFault::NotFinite);
        }
        let local = self.pose.inverse_transform_point(&Point3::from(*x)).coords;
        let Some(mut foot) = self.surface.project(&local, *hint, reach) else {
            *hint = None;
            return Ok(None);
        };
        if let Some(on) = hint.filter(|on| self.keep && on.patch != foot.patch)
            && foot.location == Location::Face
            && let Some(kept) = self.surface.project_on(&local, on, keep::BEYOND)
        {
            let then = (kept.signed_distance, &kept.normal);
            if keep::may_stand_in(sunk, then, (foot.signed_distance, &foot.normal)) {
                foot = kept;
            }
        }
        let (patch, xi) = (foot.patch, foot.xi);
        *hint = Some(Hint { patch, xi });
        let piece = Piece::Patch(patch);
        if foot.status == Status::NotConverged {
            return Err(PointFault::ProjectionNotConverged { piece, xi });
        }
        let geometry = self.geometry(&foot, &(local - foot.jet.rho))?;
        Ok(Some(Meeting {
            piece,
            xi,
            rho: (self.pose.transform_point(&Point3::from(foot.jet.rho))).coords,
            geometry: geometry.moved(&self.pose),
            xi3: foot.signed_distance,
            normal: match &geometry {
                PointGeometry::Face { frame, .. } => self.pose.rotation * frame.n,
                _ => self.pose.rotation * foot.normal,
            },
            free: free(&foot),
            hanging: None,
        }))
    }

    /// What the surface looks like at a foot, in its own coordinates; `d` is the distance vector.
    pub(super) fn geometry(&self, foot: &Foot, d: &Vec3) -> Result<PointGeometry, PointFault> {
        let (patch, xi, xi3) = (foot.patch, foot.xi, foot.signed_distance);
        let degenerate = PointFault::DegenerateFrame {
            piece: Piece::Patch(patch),
            xi,
        };
        match foot.location {
            Location::Corner {
                kind: EdgeKind::Sharp,
                ..
            } => Ok(PointGeometry::Vertex { d: *d, xi3 }),
            Location::Edge {
                edge,
                kind: EdgeKind::Sharp,
            } => {
                let line = self.along_edge(foot, edge).ok_or(degenerate)?;
                Ok(self.on_line(foot, line, d))
            }
            Location::Crease { dir } => {
                Ok(self.on_line(foot, along_side(foot, 1 - dir as usize), d))
            }
            // The parametrisation has no metric here; where the surface is smooth, its ways out of the pole tell the rest.
            Location::Pole { .. } => Ok(match self.around_pole(foot, d) {
                Some(frame) => PointGeometry::Face { frame, xi3 },
                None => PointGeometry::Pole {
                    normal: foot.normal,
                    xi3,
                },
            }),
            _ => {
                let near = (next_to_pole(&foot.jet)).then(|| self.around_pole(foot, d));
                let frame = match near.flatten() {
                    Some(frame) => frame,
                    None => Frame::new(&foot.jet, foot.side).ok_or(degenerate)?,
                };
                Ok(PointGeometry::Face { frame, xi3 })
            }
        }
    }

    /// The frame of a foot on a pole, or next to one, where the surface is smooth.
    fn around_pole(&self, foot: &Foot, d: &Vec3) -> Option<Frame> {
        let jet = self.surface.pole_jet(foot, &(foot.jet.rho + d))?;
        Frame::new(&jet, 1.0)
    }

    /// The direction of the traction where it is not that of the distance: next to an edge or a vertex, under a law whose
    /// traction does not vanish there.
    #[inline]
    pub(super) fn steady<L: NormalLaw>(
        &self,
        foot: &Foot,
        geometry: &PointGeometry,
        law: &L,
    ) -> Option<Steady> {
        let (d, xi3, line) = match geometry {
            PointGeometry::Edge {
                d,
                xi3,
                rho_s,
                rho_ss,
                ..
            } => (d, *xi3, Some((rho_s, rho_ss))),
            PointGeometry::Vertex { d, xi3 } => (d, *xi3, None),
            _ => return None,
        };
        let radius = law.steady_radius(STEADY * self.surface.size());
        if xi3.abs() >= radius {
            return None;
        }
        let m_turn = line.map_or_else(Matrix3::zeros, |(rho_s, rho_ss)| {
            let per_parameter = self.surface.normal_along(foot, rho_s);
            per_parameter * rho_s.transpose() / corner::curvature(d, rho_s, rho_ss)
        });
        Some(corner::steady(d, xi3, line, &foot.normal, &m_turn, radius))
    }

    /// First and second derivative along the edge that a foot lies on.
    fn along_edge(&self, foot: &Foot, edge: u32) -> Option<[Vec3; 2]> {
        match edge {
            0..4 => Some(along_side(foot, 1 - edge as usize / 2)),
            _ => self.surface.edge_derivatives(foot.patch, edge, foot.xi),
        }
    }

    /// The rounding of the free border that a foot lies on, next to a point at `d` from there; none where the point is deeper below
    /// it than the surface reaches.
    pub(super) fn rounded(&self, foot: &Foot, d: &Vec3, overhang: Overhang) -> Option<Rounded> {
        let line = match foot.location {
            Location::Edge { edge, .. } => self.along_edge(foot, edge),
            _ => None,
        };
        // Where another line crosses this one, the foot may be held along it too.
        let border = (line.filter(|[rho_s, _]| !self.leans(d, rho_s)))
            .map(|[rho_s, rho_ss]| [rho_s, rho_ss, self.surface.normal_along(foot, &rho_s)]);
        (overhang.rounded(d, &foot.normal, border)).filter(|r| r.xi3 >= -self.depth)
    }

    /// Whether a distance vector leans along a line.
    fn leans(&self, d: &Vec3, rho_s: &Vec3) -> bool {
        d.dot(rho_s).abs() > HELD * self.surface.size() * rho_s.norm()
    }

    fn on_line(&self, foot: &Foot, [rho_s, rho_ss]: [Vec3; 2], d: &Vec3) -> PointGeometry {
        let (d, xi3) = (*d, foot.signed_distance);
        // Where another line crosses this one, the foot may be held along it too.
        if self.leans(&d, &rho_s) {
            PointGeometry::Vertex { d, xi3 }
        } else {
            PointGeometry::Edge {
                d,
                xi3,
                // On a rigid surface only the line's own tangent counts, whatever its direction in the parameters.
                direction: [1.0, 0.0],
                rho_s,
                rho_ss,
            }
        }
    }
}

/// Residual and tangent of normal contact on a rigid master: the first 3 x 3 block of [`super::point::respond`], without the
/// work for the rest.
pub(super) fn respond_rigid<T: RigidTangent>(
    geometry: &PointGeometry,
    normal: &Normal,
    tangent: &T,
) -> (Vec3, Matrix3<f64>) {
    match geometry {
        PointGeometry::Face { frame, xi3 } => {
            (frame.n * normal.n, tangent.face(frame, *xi3, normal))
        }
        PointGeometry::Edge {
            d,
            xi3,
            rho_s,
            rho_ss,
            ..
        } => {
            let eps = normal.n / xi3;
            let k = corner::edge_tangent(d, rho_s, rho_ss, eps) + corner::law_part(d, *xi3, normal);
            (corner::residual(d, eps), k)
        }
        PointGeometry::Vertex { d, xi3 } => {
            let eps = normal.n / xi3;
            let k = corner::vertex_tangent(eps) + corner::law_part(d, *xi3, normal);
            (corner::residual(d, eps), k)
        }
        PointGeometry::Pole { normal: n, .. } => (n * normal.n, n * n.transpose() * normal.dn),
    }
}

/// Residual and tangent of normal contact whose direction is not that of the distance.
pub(super) fn respond_steady(steady: &Steady, normal: &Normal) -> (Vec3, Matrix3<f64>) {
    let k = steady.n * steady.gradient.transpose() * normal.dn + steady.turn * normal.n;
    (steady.n * normal.n, k)
}

/// Whether one tangent is so much shorter than the other that a pole may be next to the point.
#[inline]
fn next_to_pole(jet: &Jet) -> bool {
    uneven([0, 1].map(|k| jet.rho_i[k].norm_squared()))
}

/// [`next_to_pole`] of the squared lengths.
#[inline]
pub(super) fn uneven([a, b]: [f64; 2]) -> bool {
    a.min(b) < UNEVEN * UNEVEN * a.max(b)
}

/// First and second derivatives along a line of parameter `along`.
fn along_side(foot: &Foot, along: usize) -> [Vec3; 2] {
    [foot.jet.rho_i[along], foot.jet.rho_ij[2 * along]]
}

/// Whether a point lies below the surface, deeper than it is searched: not in contact, though not outside either.
pub fn behind(foot: &Foot, depth: f64) -> bool {
    presses(foot) && foot.distance > depth
}

/// Whether a foot means contact. A foot on a free border does not by itself: what is there is the rounding of the border.
fn presses(foot: &Foot) -> bool {
    foot.signed_distance < 0.0 && !free(foot)
}

/// Whether a foot lies on a free border.
pub fn free(foot: &Foot) -> bool {
    matches!(
        foot.location,
        Location::Edge {
            kind: EdgeKind::Free,
            ..
        } | Location::Corner {
            kind: EdgeKind::Free,
            ..
        }
    )
}

#[cfg(test)]
mod tests;
