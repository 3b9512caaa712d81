//! The master of a contact pair: a rigid surface, or faces of a deformable body.
use super::self_contact::{Accept, Opposing, OwnFacets};
use super::state::heap;
use super::surface::SurfaceSet;
use super::{Model, PairModel};
use crate::contact::moving::{self, MovingMaster};
use crate::contact::rigid::{self, Overhang, RigidMaster};
use crate::mesh::{Face, Mesh};
use crate::scene::ValueError;
use covact_geometry::{Foot, Hint, MovingError, MovingFacets, Vec3};

/// What the slave points of a pair meet. Chosen once, when the model is built.
#[derive(Debug)]
pub enum Master {
    /// Rigid surface, by its number in the model.
    Rigid(usize),
    /// Faces of a body of the model.
    Body(Box<BodyMaster>),
}

/// Faces of a deformable body as a contact surface.
#[derive(Debug)]
pub struct BodyMaster {
    /// The faces, `body.set`.
    pub name: String,
    /// Number of the body.
    pub body: usize,
    /// Faces of the body's mesh that the surface is made of.
    pub faces: Vec<Face>,
    /// The surface over nodes of the model, at their undeformed positions.
    pub facets: MovingFacets,
    /// The surface is smooth across the edges of the faces.
    pub smooth: bool,
    /// Depth below which a point does not count (length).
    pub depth: f64,
    /// Mean edge length of the faces.
    pub element_size: f64,
    /// What the slave points do not touch, where they belong to the same body.
    pub own: Option<OwnFacets>,
    /// Distance of the face from the surface that the facets are, half of the thickness of a sheet; else 0. The offset of the
    /// pair has it.
    pub height: f64,
}

/// Faces of a body whose first node has this number in the model, as facets that move with it, or one smooth surface through
/// their nodes; `position` gives the places of nodes by their numbers in the model.
///
/// # Errors
/// [`MovingError`]: faces that make no surface.
pub fn moving_facets(
    mesh: &Mesh,
    first_node: u32,
    faces: &[Face],
    smooth: bool,
    position: impl Fn(u32) -> Vec3 + Copy + Sync,
) -> Result<MovingFacets, MovingError> {
    let nodes: Vec<_> = (faces.iter())
        .map(|&f| mesh.face_nodes(f).shifted(first_node))
        .collect();
    let facets: Vec<_> = nodes.iter().map(|f| (f.nodes(), f.count)).collect();
    let mut facets = match smooth {
        false => MovingFacets::new(&facets),
        true => MovingFacets::smooth(&facets, position),
    }?;
    facets.update(position);
    Ok(facets)
}

/// A surface of a body, where a state puts it.
#[derive(Debug, Clone)]
pub struct BodySurface {
    pub facets: MovingFacets,
    /// Normals of the facets at their middles; none but for self contact.
    pub normals: Vec<Vec3>,
}

impl BodySurface {
    /// The surface of a master at the undeformed positions.
    pub fn new(master: &BodyMaster) -> Self {
        let mut out = BodySurface {
            facets: master.facets.clone(),
            normals: vec![Vec3::zeros(); master.own.as_ref().map_or(0, |_| master.facets.len())],
        };
        out.turn();
        out
    }

    fn turn(&mut self) {
        for (facet, normal) in self.normals.iter_mut().enumerate() {
            let [a, b] = self.facets.jet(facet as u32, [0.0; 2]).rho_i;
            *normal = a.cross(&b);
        }
    }

    fn update(&mut self, model: &Model, u: &[f64]) {
        self.facets.update(|node| model.position(node as usize, u));
        self.turn();
    }
}

/// The surfaces of all masters that are bodies, where a state puts them.
#[derive(Debug)]
pub struct Masters {
    /// Per pair; empty where no master is a body.
    surfaces: Vec<Option<BodySurface>>,
}

impl Masters {
    /// At the undeformed positions.
    pub fn new(model: &Model) -> Self {
        let surface = |p: &PairModel| p.body_master().map(BodySurface::new);
        Masters {
            surfaces: match model.pairs.iter().any(|p| p.body_master().is_some()) {
                true => model.pairs.iter().map(surface).collect(),
                false => Vec::new(),
            },
        }
    }

    /// Moves every surface with the displacements `u` (three per node).
    pub fn update(&mut self, model: &Model, u: &[f64]) {
        for surface in self.surfaces.iter_mut().flatten() {
            surface.update(model, u);
        }
    }

    /// The surface of a pair; none where its master is rigid.
    pub fn surface(&self, pair: usize) -> Option<&BodySurface> {
        self.surfaces.get(pair)?.as_ref()
    }

    /// Bytes of heap that they hold.
    pub fn bytes(&self) -> usize {
        let inner = |s: &BodySurface| s.facets.bytes() + heap(&s.normals);
        heap(&self.surfaces) + self.surfaces.iter().flatten().map(inner).sum::<usize>()
    }

    /// The master of a pair at `time`; a body's where the last [`Masters::update`] put it.
    ///
    /// # Errors
    /// A motion of a rigid surface without a value at that time.
    pub fn at<'a>(
        &'a self,
        model: &'a Model,
        pair: usize,
        u: &'a [f64],
        time: f64,
    ) -> Result<MasterNow<'a>, ValueError> {
        Ok(match (&model.pairs[pair].master, self.surface(pair)) {
            (Master::Rigid(surface), _) => MasterNow::Rigid(model.surfaces[*surface].at(time, u)?),
            (Master::Body(body), surface) => MasterNow::Body {
                model,
                u,
                body,
                surface,
            },
        })
    }
}

/// A master at one time.
pub enum MasterNow<'a> {
    Rigid(RigidMaster<'a, SurfaceSet>),
    Body {
        model: &'a Model,
        /// Displacements that the surface was put to.
        u: &'a [f64],
        body: &'a BodyMaster,
        surface: Option<&'a BodySurface>,
    },
}

/// What a point sees of its master, wherever it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Where a next search starts.
    pub hint: Hint,
    /// Distance to the closest point.
    pub distance: f64,
    /// The same, negative below the surface.
    pub signed_distance: f64,
    /// Outward unit normal there, in space.
    pub normal: Vec3,
    /// The foot lies on a free border, whose rounding does not reach the point.
    pub free: bool,
    /// Below the surface and deeper than its depth: not in contact, though not outside either.
    pub behind: bool,
}

impl Master {
    /// Whether these are faces of the slave's own body.
    pub fn is_own(&self) -> bool {
        matches!(self, Master::Body(body) if body.own.is_some())
    }

    /// Depth below which a point does not count (length).
    pub fn depth(&self, model: &Model) -> f64 {
        match self {
            Master::Rigid(surface) => model.surfaces[*surface].depth,
            Master::Body(body) => body.depth,
        }
    }
}

impl Seen {
    fn rigid(master: &RigidMaster<'_, SurfaceSet>, foot: &Foot) -> Self {
        Seen {
            hint: foot.hint(),
            distance: foot.distance,
            signed_distance: foot.signed_distance,
            normal: master.pose.rotation * foot.normal,
            free: rigid::free(foot),
            behind: rigid::behind(foot, master.depth),
        }
    }

    /// Whether the point faces the surface from the front, or from no deeper below it than its depth.
    pub fn counts(&self) -> bool {
        !self.free && !self.behind
    }

    /// Whether the point is in contact that begins at the normal coordinate `z0`.
    pub fn closed(&self, z0: f64) -> bool {
        self.counts() && self.signed_distance < z0
    }

    /// Whether the point would pass through the surface if it were found deep below it next. Of its `own` body a point may see the
    /// other side of a fold, from behind, without having passed anything: there it counts from contact only.
    pub fn in_front(&self, own: bool) -> bool {
        self.closed(0.0) || !own && self.signed_distance >= 0.0
    }

    /// Distance of a point as it is told, from the normal coordinate `z0`: negative in contact only.
    pub fn gap(&self, z0: f64) -> f64 {
        if self.counts() {
            self.signed_distance - z0
        } else {
            self.distance
        }
    }
}

impl MasterNow<'_> {
    /// Depth below which a point does not count (length).
    pub fn depth(&self) -> f64 {
        match self {
            MasterNow::Rigid(master) => master.depth,
            MasterNow::Body { body, .. } => body.depth,
        }
    }

    /// The closest point of the master to slave point `point` at `x`; none where nothing is found.
    pub fn see(&self, point: usize, x: &Vec3, hint: Option<Hint>) -> Option<Seen> {
        self.see_within(point, x, hint, f64::INFINITY)
    }

    /// [`MasterNow::see_within`] of a point that may hang over a free border of a rigid surface, where its gap is measured from
    /// `z0`: such a one counts.
    pub fn see_hanging(
        &self,
        (point, x): (usize, &Vec3),
        hint: Option<Hint>,
        reach: f64,
        (z0, overhang): (f64, Overhang),
    ) -> Option<Seen> {
        let master = match self {
            MasterNow::Rigid(master) => master,
            MasterNow::Body { .. } => {
                let seen = self.see_within(point, x, hint, reach)?;
                return Some(self.over_border(x, seen, (z0, overhang)).unwrap_or(seen));
            }
        };
        let foot = master.foot(x, hint, reach)?;
        let seen = Seen::rigid(master, &foot);
        let over = master.hanging(x, &foot, z0, overhang);
        Some(over.map_or(seen, |(signed_distance, normal)| Seen {
            signed_distance,
            normal: master.pose.rotation * normal,
            free: false,
            ..seen
        }))
    }

    /// How far a point hangs over the rounding of a free border of a body, as a part of its radius.
    pub fn past(&self, x: &Vec3, hint: Option<Hint>, overhang: Overhang) -> f64 {
        let Some(master) = self.moving() else {
            return 0.0;
        };
        let foot = master.facets.project(x, hint, f64::INFINITY, |_| true);
        let over = foot.and_then(|foot| master.over_border(x, &foot, overhang, 0.0)?);
        over.map_or(0.0, |(_, over)| over.past)
    }

    /// The faces of a body.
    fn moving(&self) -> Option<MovingMaster<'_>> {
        let MasterNow::Body { body, surface, .. } = self else {
            return None;
        };
        Some(MovingMaster {
            facets: &(*surface)?.facets,
            undeformed: &body.facets,
            depth: body.depth,
            keep: false,
        })
    }

    /// What is seen of a body by a point over the rounding of a free border of it; none where it does not hang there in contact.
    fn over_border(&self, x: &Vec3, seen: Seen, (z0, overhang): (f64, Overhang)) -> Option<Seen> {
        let master = self.moving()?;
        let foot = master
            .facets
            .project(x, Some(seen.hint), f64::INFINITY, |f| f == seen.hint.patch)?;
        let gap = master.hanging(x, &foot, z0, overhang)?;
        Some(Seen {
            signed_distance: gap,
            free: false,
            behind: false,
            ..seen
        })
    }

    /// [`MasterNow::see`] up to a distance.
    pub fn see_within(
        &self,
        point: usize,
        x: &Vec3,
        hint: Option<Hint>,
        reach: f64,
    ) -> Option<Seen> {
        match self {
            MasterNow::Rigid(master) => {
                let foot = master.foot(x, hint, reach)?;
                Some(Seen::rigid(master, &foot))
            }
            MasterNow::Body {
                model,
                u,
                body,
                surface,
            } => {
                let surface = (*surface)?;
                let facets = &surface.facets;
                let foot = match &body.own {
                    None => facets.project(x, hint, reach, |_| true),
                    Some(own) => {
                        let accept = Opposing {
                            own,
                            normals: &surface.normals,
                            position: |n: u32| model.position(n as usize, u),
                        };
                        let at = accept.point(point);
                        facets.project(x, hint, reach, |f| accept.facet(at, f))
                    }
                }?;
                let behind = moving::behind(&foot, x, body.depth);
                Some(Seen {
                    hint: foot.hint(),
                    distance: foot.distance,
                    signed_distance: foot.signed_distance,
                    normal: foot.normal,
                    free: moving::free(&foot, x),
                    behind,
                })
            }
        }
    }
}

impl PairModel {
    /// Name of the master: that of the rigid surface, or `body.set`.
    pub fn master_name<'a>(&'a self, model: &'a Model) -> &'a str {
        match &self.master {
            Master::Rigid(surface) => &model.surfaces[*surface].name,
            Master::Body(body) => &body.name,
        }
    }

    /// The master in words: `surface `die`` or `faces `block.top``.
    pub fn master_words(&self, model: &Model) -> String {
        match &self.master {
            Master::Rigid(surface) => format!("surface `{}`", model.surfaces[*surface].name),
            Master::Body(body) => format!("faces `{}`", body.name),
        }
    }

    /// The master where it is faces of a body.
    pub fn body_master(&self) -> Option<&BodyMaster> {
        match &self.master {
            Master::Rigid(_) => None,
            Master::Body(body) => Some(body),
        }
    }

    /// Number of the master in the model where it is a rigid surface.
    pub fn rigid_master(&self) -> Option<usize> {
        match self.master {
            Master::Rigid(surface) => Some(surface),
            Master::Body(_) => None,
        }
    }
}
