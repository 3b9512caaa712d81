//! From patch to patch through a common edge.

use super::search::ROUGH;
use super::set::PatchSet;
use super::topology::{Edge, EdgePoint, nearest_on_edge};
use super::{Foot, Hint};
use crate::frame::Frame;
use crate::surface::{Surface, Vec3};

/// Most borders that [`PatchSet::track`] follows a point over.
const HOPS: usize = 64;

/// The same point of space on the other side of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Number of the other patch (of the same one at a seam).
    pub patch: u32,
    /// Number of the edge there.
    pub edge: u32,
    /// Parameters there.
    pub xi: [f64; 2],
    /// Distance of the two points.
    pub gap: f64,
    /// +1 where `rho_1 x rho_2` points to the same side on both patches, else -1.
    pub relation: f64,
    /// Angle between the two tangent planes (radians), 0 where the surface runs on smoothly.
    pub angle: f64,
    /// Takes contravariant components of a tangent vector here, `v = v^j rho_j`, to those there, `w^i = map[i][j] v^j`.
    /// The vector is unfolded over the edge: its part along the edge stays, and what points out of this patch points into
    /// the other one; so lengths and angles stay too, and at a smooth joint the vector itself.
    pub map: [[f64; 2]; 2],
}

impl<S: Surface> PatchSet<S> {
    /// The point on the other side of edge `edge` (numbered as in [`Location`](super::Location)) for the point of that edge
    /// that is nearest to the surface point of `xi`. `None` where nothing is joined there, or a patch has no tangent
    /// plane there.
    pub fn neighbour(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<Neighbour> {
        let surface = self.patches.get(patch as usize)?;
        let own = &self.topology.edges[self.topology.index(patch, edge)?];
        own.kind?;
        if !xi.iter().all(|x| x.is_finite()) {
            return None;
        }
        let here = nearest_on_edge(self, &surface.point(xi), own);
        let candidates = own.links_at(here.t).map(|link| {
            let other = &self.topology.edges[link.edge];
            let there = nearest_on_edge(self, &here.jet.rho, other);
            let gap = (there.jet.rho - here.jet.rho).norm();
            (link, other, there, gap)
        });
        let (link, other, there, gap) = candidates
            .filter(|c| c.3 <= c.0.reach)
            .min_by(|a, b| a.3.total_cmp(&b.3))?;
        let [mine, theirs] = [(&here, own), (&there, other)].map(|(at, edge)| Axes::new(at, edge));
        let (mine, theirs) = (mine?, theirs?);
        let along = theirs.along * mine.along.dot(&theirs.along).signum();
        let up = theirs.frame.rho_up();
        let map = [0, 1].map(|i| {
            [0, 1].map(|j| {
                let v = mine.frame.rho_i[j];
                let w = along * v.dot(&mine.along) - theirs.inward * v.dot(&mine.inward);
                up[i].dot(&w)
            })
        });
        let (n, m) = (mine.frame.n, theirs.frame.n * link.relation);
        Some(Neighbour {
            patch: other.patch,
            edge: other.number,
            xi: there.xi,
            gap,
            relation: link.relation,
            angle: n.cross(&m).norm().atan2(n.dot(&m)),
            map,
        })
    }

    /// First and second derivatives `d rho / d t`, `d^2 rho / d t^2` of the edge's curve in space at the point of edge `edge`
    /// (numbered as in [`Location`](super::Location)) nearest to the surface point of `xi`, by the curve's own parameter:
    /// what contact with an edge needs of it. `None` for an edge that does not exist.
    pub fn edge_derivatives(&self, patch: u32, edge: u32, xi: [f64; 2]) -> Option<[Vec3; 2]> {
        let surface = self.patches.get(patch as usize)?;
        let own = &self.topology.edges[self.topology.index(patch, edge)?];
        let here = nearest_on_edge(self, &surface.point(xi), own);
        Some([here.d1, here.d2])
    }

    /// Follows a foot: the stationary point that is reached from `hint` downhill, over common edges where it leaves a patch,
    /// without any global search. It is as near as any other point *around* it; whether another part of the surface is
    /// nearer only [`project`](Self::project) tells. `None` where the hint or `q` is no use.
    pub fn track(&self, q: &Vec3, hint: Hint) -> Option<Foot> {
        let patch = self.patches.get(hint.patch as usize)?;
        if !(q.iter().all(|x| x.is_finite()) && hint.xi.iter().all(|x| x.is_finite())) {
            return None;
        }
        let span = patch.find_span(hint.xi);
        let region = self.region(hint.patch, span);
        let local = self.descend(q, &region, hint.xi, span, ROUGH);
        let local = self.settled_foot(q, local, HOPS);
        Some(self.as_foot(q, &local, true, false))
    }
}

/// Unit vectors at a point of an edge.
struct Axes {
    frame: Frame,
    along: Vec3,
    /// In the tangent plane, across the edge into the patch.
    inward: Vec3,
}

impl Axes {
    fn new(at: &EdgePoint, edge: &Edge) -> Option<Self> {
        let frame = Frame::new(&at.jet, 1.0)?;
        let along = at.d1.try_normalize(0.0)?;
        let inward = frame.n.cross(&along) * edge.sense;
        Some(Self {
            frame,
            along,
            inward,
        })
    }
}
