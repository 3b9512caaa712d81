//! Contact of slave points with a surface whose nodes move: the faces of a body.
use super::fault::{Piece, PointFault};
use super::hanging::Hanging;
use super::keep;
use super::kernel::{NodeRow, SlotMatrix, Slots};
use super::law::NormalLaw;
use super::meeting::Meeting;
use super::overhang::Overhang;
use super::point::{FaceTangent, PointGeometry};
use covact_geometry::{
    EdgeKind, Frame, Hint, Jet, MovingFacets, MovingFoot, MovingPlace, ShapeRows, Status, Vec3,
};

/// A surface of moving facets at its present position.
#[derive(Debug, Clone, Copy)]
pub struct MovingMaster<'a> {
    /// The facets at their present position.
    pub facets: &'a MovingFacets,
    /// The same, undeformed.
    pub undeformed: &'a MovingFacets,
    /// Points deeper than this below the surface are not in contact (length).
    pub depth: f64,
    /// Points stay on the facet that their hint names, continued a little past its border, where it meets the next one at a small
    /// angle.
    pub keep: bool,
}

/// A foot on an edge or a corner counts as held by it where the distance vector leans by more than this (relative to the
/// size of the surface) against the facet, or along the edge.
const HELD: f64 = 1e-10;

/// A point in contact, per unit area and in space coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingTouch {
    /// The facet that holds the foot; its nodes and their shape functions are the master's rows.
    pub facet: u32,
    /// Parameters of the foot on it.
    pub xi: [f64; 2],
    /// Generalised forces in the nine slots of [`super::kernel`] (the slave is pushed by their negative),
    /// force / length^2.
    pub residual: Slots,
    /// Their derivative, force / length^3.
    pub tangent: SlotMatrix,
    /// Normal coordinate, negative below the surface.
    pub xi3: f64,
    /// Normal traction, negative.
    pub n: f64,
    /// Outward unit vector that the traction acts along: the normal of a face, the direction of the distance at edges
    /// and corners.
    pub normal: Vec3,
}

impl MovingMaster<'_> {
    /// Evaluates one slave point; `None` where it is open. Facets that `accept` refuses do not exist for this point.
    ///
    /// `hint` is where the search starts, and is set to where it ended; `overhang` says how borders are rounded off for the point.
    ///
    /// # Errors
    /// [`PointFault`] where the point has no reliable closest point.
    pub fn touch<L: NormalLaw, T: FaceTangent>(
        &self,
        x: &Vec3,
        (hint, overhang): (&mut Option<Hint>, Overhang),
        law: &L,
        tangent: &T,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<MovingTouch>, PointFault> {
        let Some((foot, meeting)) = self.contact_at(x, (hint, overhang), law, accept)? else {
            return Ok(None);
        };
        let touch = meeting.respond(law, tangent)?;
        Ok(touch.map(|t| MovingTouch {
            facet: foot.facet,
            xi: foot.xi,
            residual: t.residual,
            tangent: t.tangent,
            xi3: t.xi3,
            n: t.n,
            normal: meeting.geometry.normal(),
        }))
    }

    /// The foot of a slave point and what the surface looks like there; `None` where the point is open. `hint` and `accept`
    /// as for [`Self::touch`].
    #[inline]
    pub(super) fn contact_at<L: NormalLaw>(
        &self,
        x: &Vec3,
        (hint, overhang): (&mut Option<Hint>, Overhang),
        law: &L,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<(MovingFoot, Meeting)>, PointFault> {
        let reach = self.depth.max(law.reach());
        let before = *hint;
        let Some(foot) = self.search(x, hint, reach, &accept)? else {
            return Ok(None);
        };
        if let Some(over) = self.over_border(x, &foot, overhang, law.reach()) {
            let closes = |h: &Hanging| law.closes(h.gap) && overhang.allows(h.gap - law.reach());
            let Some((foot, hanging)) = over.filter(|(_, h)| closes(h)) else {
                return Ok(None);
            };
            let meeting = Meeting {
                xi3: hanging.gap,
                hanging: Some(hanging),
                ..self.at(x, &foot)?
            };
            return Ok(Some((foot, meeting)));
        }
        let xi3 = foot.signed_distance;
        if xi3 < -self.depth || !law.closes(xi3) {
            return Ok(None);
        }
        let kept = match before.filter(|on| self.keep && leaves(&foot, on)) {
            Some(on) => self.kept(x, &foot, on, law, accept),
            None => None,
        };
        let foot = match kept {
            Some(foot) => {
                *hint = Some(foot.hint());
                foot
            }
            None if free(&foot, x) => return Ok(None),
            None => {
                *hint = hint.map(|hint| if self.keep { keep::held(hint) } else { hint });
                foot
            }
        };
        let meeting = self.at(x, &foot)?;
        Ok(Some((foot, meeting)))
    }

    /// What a point at `x` hangs over whose foot lies on a free border, near enough to be in contact that begins at `reach`: its foot
    /// on the continued facet and the rounding there, nothing where it lies deeper than that or the surface reaches. None where its foot
    /// lies elsewhere, borders are sharp for it, or the facet cannot be continued.
    pub fn over_border(
        &self,
        x: &Vec3,
        foot: &MovingFoot,
        overhang: Overhang,
        reach: f64,
    ) -> Option<Option<(MovingFoot, Hanging)>> {
        if !on_border(foot) || overhang.rounding == 0.0 || foot.distance > overhang.within(reach) {
            return None;
        }
        let free = match foot.place {
            MovingPlace::Edge { direction, .. } => direction.map(|along| along == 0.0),
            _ => [true; 2],
        };
        // Of the facet's middle, so that they are numbers of the facet.
        let width = (self.undeformed.jet(foot.facet, [0.0; 2]).rho_i).map(|t| t.norm());
        let least = width[0].min(width[1]);
        let beyond = 0.5 * overhang.within(reach) / least;
        let on = foot.hint();
        let kept = (self.facets).project_on(x, on, beyond.max(keep::BEYOND))?;
        let hanging = Hanging::new(&overhang, kept.signed_distance, kept.xi, width, free);
        Some(hanging.filter(|h| h.gap >= -self.depth).map(|h| (kept, h)))
    }

    /// Normal coordinate of a point that is in contact over the rounding of a free border, where its gap is measured from `z0`.
    pub fn hanging(&self, x: &Vec3, foot: &MovingFoot, z0: f64, overhang: Overhang) -> Option<f64> {
        let (_, over) = self.over_border(x, foot, overhang, z0)??;
        (over.gap < z0 && overhang.allows(over.gap - z0)).then_some(over.gap)
    }

    /// The foot of a point on the facet `on`, where it may stand for its closest point: across a fold, and at a free border that
    /// the point has not left yet. A foot on a fold is none that hops.
    #[cold]
    #[inline(never)]
    fn kept<L: NormalLaw>(
        &self,
        x: &Vec3,
        foot: &MovingFoot,
        on: Hint,
        law: &L,
        accept: impl Fn(u32) -> bool,
    ) -> Option<MovingFoot> {
        let border = on_border(foot);
        let [outside, hangs] =
            [f64::eq, f64::gt].map(|is| on.xi.iter().any(|xi| is(&xi.abs(), &1.0)));
        // Beyond a border one stays outside that was outside; what the border holds need not hang over it.
        if border && if free(foot, x) { outside } else { !hangs } {
            return None;
        }
        // In a valley the edge itself holds the point.
        if !border && foot.place != MovingPlace::Face || !accept(on.patch) {
            return None;
        }
        let xi3 = foot.signed_distance;
        let kept = self.facets.project_on(x, on, keep::BEYOND)?;
        if border {
            return law.closes(kept.signed_distance).then_some(kept);
        }
        // Below the surface the force acts along the distance.
        let towards = (foot.jet.rho - x) * -xi3.signum();
        let towards = towards.try_normalize(0.0).unwrap_or(foot.normal);
        let [now, then] = [(xi3, &towards), (kept.signed_distance, &kept.normal)];
        keep::may_stand(law, then, now).then_some(kept)
    }

    /// The closest point within `reach` on either side, for what needs more than [`Self::touch`], such as an averaged
    /// gap. `hint` and `accept` as there; the traction of the point stands for a penetration of `sunk` (length).
    ///
    /// # Errors
    /// [`PointFault`] as for [`Self::touch`].
    pub fn meet(
        &self,
        x: &Vec3,
        (hint, sunk): (&mut Option<Hint>, f64),
        reach: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<Meeting>, PointFault> {
        let before = *hint;
        let Some(mut foot) = self.search(x, hint, reach, &accept)? else {
            return Ok(None);
        };
        if let Some(on) = before.filter(|on| self.keep && leaves(&foot, on) && accept(on.patch))
            && foot.place == MovingPlace::Face
            && let Some(kept) = self.facets.project_on(x, on, keep::BEYOND)
        {
            let then = (kept.signed_distance, &kept.normal);
            if keep::may_stand_in(sunk, then, (foot.signed_distance, &foot.normal)) {
                foot = kept;
                *hint = Some(foot.hint());
            }
        }
        self.at(x, &foot).map(Some)
    }

    fn search(
        &self,
        x: &Vec3,
        hint: &mut Option<Hint>,
        reach: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Result<Option<MovingFoot>, PointFault> {
        if !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite()) {
            return Err(PointFault::NotFinite);
        }
        let foot = self.facets.project(x, *hint, reach, accept);
        *hint = foot.as_ref().map(MovingFoot::hint);
        match foot {
            // On either side: an uncertain foot must not pass for an open point.
            Some(foot) if foot.status == Status::NotConverged => {
                Err(PointFault::ProjectionNotConverged {
                    piece: Piece::Facet(foot.facet),
                    xi: foot.xi,
                })
            }
            foot => Ok(foot),
        }
    }

    fn at(&self, x: &Vec3, foot: &MovingFoot) -> Result<Meeting, PointFault> {
        Ok(Meeting {
            piece: Piece::Facet(foot.facet),
            xi: foot.xi,
            rho: foot.jet.rho,
            geometry: self.geometry(x, foot)?,
            xi3: foot.signed_distance,
            normal: foot.normal,
            free: free(foot, x),
            hanging: None,
        })
    }

    fn geometry(&self, x: &Vec3, foot: &MovingFoot) -> Result<PointGeometry, PointFault> {
        let (d, xi3) = (x - foot.jet.rho, foot.signed_distance);
        let leans = |t: &Vec3| d.dot(t).abs() > HELD * self.facets.size() * t.norm();
        let edge = |direction: [f64; 2]| {
            let edge = PointGeometry::edge(&foot.jet, direction, d, xi3);
            match &edge {
                // Where another edge crosses this one, the foot may be held along it too.
                PointGeometry::Edge { rho_s, .. } if leans(rho_s) => {
                    PointGeometry::Vertex { d, xi3 }
                }
                _ => edge,
            }
        };
        match foot.place {
            MovingPlace::Corner { .. } => Ok(PointGeometry::Vertex { d, xi3 }),
            MovingPlace::Edge { direction, .. } => Ok(edge(direction)),
            MovingPlace::Face => {
                // Facets that meet at less than a sharp angle count as one face, yet their common edge may hold the foot;
                // then the force must act along the distance all the same, or the two sides would not balance in moment.
                let held = |k: usize| foot.xi[k].abs() == 1.0 && leans(&foot.jet.rho_i[k]);
                match [held(0), held(1)] {
                    [true, true] => Ok(PointGeometry::Vertex { d, xi3 }),
                    [true, false] => Ok(edge([0.0, 1.0])),
                    [false, true] => Ok(edge([1.0, 0.0])),
                    [false, false] => self.face(&foot.jet, xi3, foot),
                }
            }
        }
    }

    fn face(&self, jet: &Jet, xi3: f64, foot: &MovingFoot) -> Result<PointGeometry, PointFault> {
        let frame = Frame::new(jet, 1.0).ok_or(PointFault::DegenerateFrame {
            piece: Piece::Facet(foot.facet),
            xi: foot.xi,
        })?;
        Ok(PointGeometry::Face { frame, xi3 })
    }
}

/// Whether a foot is no longer within the facet that it was on.
#[inline]
fn leaves(foot: &MovingFoot, on: &Hint) -> bool {
    foot.facet != on.patch || foot.xi.iter().any(|xi| xi.abs() >= 1.0)
}

/// The slots row of node `k` of a facet, from the facet's shape functions at the foot.
#[inline]
pub fn master_row(shape: &ShapeRows, k: usize) -> NodeRow {
    [-shape.n[k], shape.n_1[k], shape.n_2[k]]
}

/// Whether the foot of `x` means contact: below the surface and not past a free border, where nothing stands in the way.
fn presses(foot: &MovingFoot, x: &Vec3) -> bool {
    foot.signed_distance < 0.0 && !free(foot, x)
}

/// Whether the point `x` lies below the surface, deeper than it is searched: not in contact, though not outside either.
pub fn behind(foot: &MovingFoot, x: &Vec3, depth: f64) -> bool {
    presses(foot, x) && foot.distance > depth
}

/// A point past a free border by less than a quarter of what it lies below the surface is still held by the border.
/// Penetrations are small, and so is this overhang; without it points on a plane of symmetry would lose the facets that
/// rise from it, whose normals lean across the plane. This is the cosine, `4 / sqrt(17)`.
const OVERHANG: f64 = 0.970_142_5;

/// Whether a foot lies on a free border that does not hold the point `x`.
pub fn free(foot: &MovingFoot, x: &Vec3) -> bool {
    on_border(foot) && (foot.jet.rho - x).dot(&foot.normal).abs() < OVERHANG * foot.distance
}

/// Whether a foot lies on a free border.
fn on_border(foot: &MovingFoot) -> bool {
    matches!(
        foot.place,
        MovingPlace::Edge {
            kind: EdgeKind::Free,
            ..
        } | MovingPlace::Corner {
            kind: EdgeKind::Free
        }
    )
}
