//! Evaluation of many slave points on a rigid surface at one place.
use super::clearance::Clearance;
use super::closest::ClosestPoint;
use super::keep;
use super::kernel::Normal;
use super::law::NormalLaw;
use super::overhang::{Overhang, Rounded};
use super::point::PointGeometry;
use super::rigid::{
    Piece, PointFault, RigidMaster, RigidTangent, Touch, free, respond_rigid, respond_steady,
    uneven,
};
use covact_geometry::{EdgeKind, Foot, Frame, Hint, Location, Status, Vec3};
use nalgebra::{Matrix3, Rotation3};

/// A rigid surface at its present position, with what all points share: made once, outside the loop over points.
#[derive(Debug, Clone)]
pub struct Placed<'a, P> {
    pub(super) master: &'a RigidMaster<'a, P>,
    /// Columns of the rotation from the surface's own coordinates to those of space.
    columns: [Vec3; 3],
}

impl<P> RigidMaster<'_, P> {
    /// The surface with what all points share.
    pub fn placed(&self) -> Placed<'_, P> {
        let turn = Rotation3::from(self.pose.rotation).into_inner();
        Placed {
            master: self,
            columns: [0, 1, 2].map(|c| turn.column(c).into_owned()),
        }
    }
}

impl<P> Placed<'_, P> {
    /// A point of space in the surface's own coordinates.
    #[inline(always)]
    fn local(&self, x: &Vec3) -> Vec3 {
        let d = x - self.master.pose.translation.vector;
        let [a, b, c] = &self.columns;
        Vec3::new(a.dot(&d), b.dot(&d), c.dot(&d))
    }

    /// A vector of the surface's own coordinates in space.
    #[inline(always)]
    pub(super) fn turned(&self, v: &Vec3) -> Vec3 {
        let [a, b, c] = &self.columns;
        a * v.x + b * v.y + c * v.z
    }

    /// A tangent of the surface's own coordinates in space.
    fn turned_tangent(&self, k: &Matrix3<f64>) -> Matrix3<f64> {
        let r = Matrix3::from_columns(&self.columns);
        r * k * r.transpose()
    }
}

impl<P: ClosestPoint> Placed<'_, P> {
    /// Evaluates one slave point; `None` where it is open.
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
        let mut out = Ok(None);
        let known = (hint, &mut Clearance::default(), overhang);
        self.touch_into(x, known, law, tangent, &mut out);
        out
    }

    /// Whether a slave point at `x` is open by what is known of it.
    #[cfg(test)]
    pub(super) fn proves_open<L: NormalLaw>(&self, x: &Vec3, clear: &Clearance, law: &L) -> bool {
        clear.proves_open(&self.local(x), law, self.master.depth)
    }

    /// [`Self::touch`] for loops over points: the result is written where it stays. A point that is open by its clearance is
    /// not searched for, and keeps its hint; else the clearance is set to what the search says.
    #[inline(always)]
    pub fn touch_into<L: NormalLaw, T: RigidTangent>(
        &self,
        x: &Vec3,
        (hint, clear, overhang): (&mut Option<Hint>, &mut Clearance, Overhang),
        law: &L,
        tangent: &T,
        out: &mut Result<Option<Touch>, PointFault>,
    ) {
        if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
            *out = Err(PointFault::NotFinite);
            return;
        }
        let local = self.local(x);
        if clear.proves_open(&local, law, self.master.depth) {
            *out = Ok(None);
            return;
        }
        *clear = Clearance::default();
        let before = *hint;
        let mut found = self.search(&local, before, law, overhang);
        let Some(foot) = &mut found else {
            *hint = None;
            *out = Ok(None);
            return;
        };
        *hint = Some(foot.hint());
        match self.closes(foot, law, overhang) {
            Ok(true) => {}
            Ok(false) => {
                *clear = Clearance::of(&local, foot);
                *out = Ok(None);
                return;
            }
            Err(fault) => {
                *out = Err(fault);
                return;
            }
        }
        if let Some(on) = before.filter(|on| self.master.keep && leaves(foot, on)) {
            self.keep(&local, on, law, foot, hint);
        }
        if free(foot) {
            *out = Ok(self.past_border(x, &local, foot, law, overhang));
            return;
        }
        let xi3 = foot.signed_distance;
        let frame = match face(foot) {
            Some(frame) if frame_is_minimum(&frame, xi3) => frame,
            _ => {
                *out = self.off_face(x, &local, foot, law, tangent).map(Some);
                return;
            }
        };
        let normal = law.response(xi3);
        // Turned before the tangent is formed: three vectors are less than a matrix from both sides.
        let frame = Frame {
            rho_i: [self.turned(&frame.rho_i[0]), self.turned(&frame.rho_i[1])],
            n: self.turned(&frame.n),
            ..frame
        };
        *out = Ok(Some(Touch {
            x: *x,
            residual: frame.n * normal.n,
            tangent: tangent.face(&frame, xi3, &normal),
            xi3,
            gap: law.gap(xi3),
            n: normal.n,
        }));
    }

    /// The foot of a point at `local`. Outside, beyond the reach of the law, it need not be certain: such a point is open.
    #[inline(always)]
    fn search<L: NormalLaw>(
        &self,
        local: &Vec3,
        hint: Option<Hint>,
        law: &L,
        overhang: Overhang,
    ) -> Option<Foot> {
        let reach = self.master.depth.max(overhang.within(law.reach()));
        let above = match law.closes(reach) {
            true => reach,
            // Where contact begins in front of the surface it goes around borders as well.
            false if law.reach() > 0.0 => overhang.within(law.reach()),
            false => 0.0,
        };
        (self.master.surface).project_above(local, hint, reach, above)
    }

    /// Whether a foot may mean contact.
    #[inline(always)]
    fn closes<L: NormalLaw>(
        &self,
        foot: &Foot,
        law: &L,
        overhang: Overhang,
    ) -> Result<bool, PointFault> {
        // On either side: an uncertain foot must not pass for an open point. Beyond the reach of the law the search says
        // so only where it has not even proved that.
        if foot.status == Status::NotConverged {
            return Err(PointFault::ProjectionNotConverged {
                piece: Piece::Patch(foot.patch),
                xi: foot.xi,
            });
        }
        let xi3 = foot.signed_distance;
        Ok(match free(foot) {
            // The rounding of the border says more.
            true => foot.distance <= overhang.within(law.reach()),
            false => law.closes(xi3) && xi3 >= -self.master.depth,
        })
    }

    /// Puts the foot on the patch `on` in the place of the closest point, where it may stand for it across a fold.
    #[cold]
    #[inline(never)]
    fn keep<L: NormalLaw>(
        &self,
        local: &Vec3,
        on: Hint,
        law: &L,
        foot: &mut Foot,
        hint: &mut Option<Hint>,
    ) {
        let Some(kept) = self.master.surface.project_on(local, on, keep::BEYOND) else {
            return;
        };
        let xi3 = foot.signed_distance;
        // Below the surface the force acts along the distance.
        let towards = (foot.jet.rho - local) * -xi3.signum();
        let towards = towards.try_normalize(0.0).unwrap_or(foot.normal);
        if keep::may_stand(law, (kept.signed_distance, &kept.normal), (xi3, &towards)) {
            *foot = kept;
            *hint = Some(kept.hint());
        }
    }

    /// [`Self::touch`] of a foot that is not, or not safely, one of a face.
    #[cold]
    #[inline(never)]
    fn off_face<L: NormalLaw, T: RigidTangent>(
        &self,
        x: &Vec3,
        local: &Vec3,
        foot: &Foot,
        law: &L,
        tangent: &T,
    ) -> Result<Touch, PointFault> {
        let geometry = self.geometry(local, foot)?;
        let normal = law.response(geometry.xi3());
        let (residual, k) = match self.master.steady(foot, &geometry, law) {
            None => respond_rigid(&geometry, &normal, tangent),
            Some(steady) => respond_steady(&steady, &normal),
        };
        Ok(self.in_space(x, geometry.xi3(), law, &normal, residual, k))
    }

    /// [`Self::touch`] of a point whose foot lies on a free border; `None` where it is open.
    #[cold]
    #[inline(never)]
    fn past_border<L: NormalLaw>(
        &self,
        x: &Vec3,
        local: &Vec3,
        foot: &Foot,
        law: &L,
        overhang: Overhang,
    ) -> Option<Touch> {
        let rounded = self.rounded(local, foot, law, overhang)?;
        let normal = law.response(rounded.xi3);
        let (residual, k) = respond_steady(&rounded.at, &normal);
        // A border that twists leaves a little that no energy has.
        let k = (k + k.transpose()) * 0.5;
        Some(self.in_space(x, rounded.xi3, law, &normal, residual, k))
    }

    /// The rounding of the free border at the foot of a point at `local`; none where the point is open.
    pub(super) fn rounded<L: NormalLaw>(
        &self,
        local: &Vec3,
        foot: &Foot,
        law: &L,
        overhang: Overhang,
    ) -> Option<Rounded> {
        let rounded = (self.master).rounded(foot, &(local - foot.jet.rho), overhang)?;
        (law.closes(rounded.xi3) && overhang.allows(law.gap(rounded.xi3))).then_some(rounded)
    }

    /// Searches for the foot of a slave point at `x`, and gives the point in the surface's own coordinates and its foot to
    /// `then` where the point is closed; `None` where it is open. Hint and clearance as for [`Self::touch_into`].
    #[inline(always)]
    pub(super) fn at_foot<L: NormalLaw, R>(
        &self,
        x: &Vec3,
        (hint, clear, overhang): (&mut Option<Hint>, &mut Clearance, Overhang),
        law: &L,
        then: impl FnOnce(&Vec3, &Foot) -> Result<Option<R>, PointFault>,
    ) -> Result<Option<R>, PointFault> {
        if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
            return Err(PointFault::NotFinite);
        }
        let local = self.local(x);
        if clear.proves_open(&local, law, self.master.depth) {
            return Ok(None);
        }
        *clear = Clearance::default();
        let before = *hint;
        let mut found = self.search(&local, before, law, overhang);
        let Some(foot) = &mut found else {
            *hint = None;
            return Ok(None);
        };
        *hint = Some(foot.hint());
        if !self.closes(foot, law, overhang)? {
            *clear = Clearance::of(&local, foot);
            return Ok(None);
        }
        if let Some(on) = before.filter(|on| self.master.keep && leaves(foot, on)) {
            self.keep(&local, on, law, foot, hint);
        }
        then(&local, foot)
    }

    /// What the surface looks like at the foot of a point at `local`, which must be the closest.
    pub(super) fn geometry(&self, local: &Vec3, foot: &Foot) -> Result<PointGeometry, PointFault> {
        let geometry = self.master.geometry(foot, &(local - foot.jet.rho))?;
        match geometry.is_minimum() {
            true => Ok(geometry),
            false => Err(beyond(foot)),
        }
    }

    /// A touch of a slave point at `x` from residual and tangent in the surface's own coordinates.
    pub(super) fn in_space<L: NormalLaw>(
        &self,
        x: &Vec3,
        xi3: f64,
        law: &L,
        normal: &Normal,
        residual: Vec3,
        tangent: Matrix3<f64>,
    ) -> Touch {
        Touch {
            x: *x,
            residual: self.turned(&residual),
            tangent: self.turned_tangent(&tangent),
            xi3,
            gap: law.gap(xi3),
            n: normal.n,
        }
    }
}

/// Whether a foot has left the patch that it was on, or lies on its border or a crease, and not on a free one.
#[inline(always)]
fn leaves(foot: &Foot, on: &Hint) -> bool {
    (foot.patch != on.patch || !matches!(foot.location, Location::Face)) && !free(foot)
}

/// The frame of a foot on a face that no pole is next to.
#[inline(always)]
fn face(foot: &Foot) -> Option<Frame> {
    let on_face = match foot.location {
        Location::Face => true,
        Location::Edge { kind, .. } | Location::Corner { kind, .. } => kind == EdgeKind::Smooth,
        Location::Crease { .. } | Location::Pole { .. } => false,
    };
    if !on_face {
        return None;
    }
    Frame::new(&foot.jet, foot.side).filter(|frame| !uneven([frame.a[0], frame.a[2]]))
}

/// [`PointGeometry::is_minimum`] of a face.
#[inline(always)]
fn frame_is_minimum(frame: &Frame, xi3: f64) -> bool {
    let at = |i: usize| frame.a[i] - xi3 * frame.h[i];
    let [i11, i12, i22] = [at(0), at(1), at(2)];
    i11 > 0.0 && i11 * i22 - i12 * i12 > 0.0
}

#[cold]
fn beyond(foot: &Foot) -> PointFault {
    PointFault::BeyondFocalSurface {
        piece: Piece::Patch(foot.patch),
        xi: foot.xi,
        xi3: foot.signed_distance,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::law::Penalty;
    use crate::contact::rigid::Exact;
    use covact_geometry::PatchSet;
    use covact_geometry::primitives::torus;
    use nalgebra::Isometry3;

    #[test]
    fn points_on_the_axis_of_a_die_are_open() {
        // The shoulder of a drawing die: a circle of feet for every point of its axis, far within the depth.
        let die = torus(28.0, 5.0, Vec3::zeros(), Vec3::z()).unwrap();
        let set = PatchSet::new(vec![die], None).unwrap();
        let master = RigidMaster {
            surface: &set,
            pose: Isometry3::translation(0.3, -0.2, -0.5),
            depth: 40.0,
            keep: false,
        };
        let law = Penalty { eps_n: 5.0 };
        for z in [-8.0, -0.5, 0.0, 0.7, 4.0, 11.0] {
            let x = Vec3::new(0.3, -0.2, z);
            let foot = master.foot(&x, None, 40.0).unwrap();
            assert_eq!(foot.status, Status::NonUnique, "{z}");
            let mut hint = None;
            for _ in 0..2 {
                assert_eq!(
                    master.touch(&x, (&mut hint, Overhang::default()), &law, &Exact),
                    Ok(None),
                    "{z}"
                );
                assert!(hint.is_some());
            }
        }
    }
}
