//! Facets whose nodes move: the faces of finite elements as a contact surface.
//!
//! Every facet is one tensor-product Bezier piece over `xi in [-1, 1]^2`, of one degree for the whole set, and its control
//! points are fixed linear combinations of nodes (*extraction*): `rho = sum_c B_c(xi) p_c`, `p_c = sum_k E_ck x_k`. So
//! bilinear and biquadratic facets and the smooth surface over a mesh are the same code, and the shape functions
//! `N_k = sum_c E_ck B_c` of the nodes are constant in time: a contact tangent needs no term for how the surface is made.
//!
//! - [`MovingFacets::new`]: the facets as they are, degree 1 where all have 2 x 2 nodes, else degree 2 (a direction with
//!   two nodes is raised).
//! - [`MovingFacets::smooth`]: one bicubic surface over the mesh.
//! - [`MovingFacets::of_patches`]: the spans of bicubic NURBS patches whose control points move. Their weights are constant,
//!   `w_c p_c = sum_k E_ck w_k x_k` with `w_c = sum_k E_ck w_k`, so that shape functions are rational but constant in time, too.
//!
//! [`update`](MovingFacets::update) moves the control points and refits the search tree, [`project`](MovingFacets::project)
//! gives the closest point, proved to be the closest as for [`PatchSet`](crate::PatchSet). Neither allocates once the
//! first update has built the tree.

mod build;
mod extraction;
mod keep;
mod local;
mod net;
mod patch;
mod place;
mod prove;
#[cfg(test)]
mod rational;
mod search;
mod smooth;
mod topology;
mod trimmed;

use crate::project::tree::Tree;
use crate::project::{EdgeKind, Hint, Status};
use crate::surface::{Jet, Vec3};
use extraction::Operator;
use topology::Topology;
use trimmed::Trims;

pub use patch::PatchSpans;
pub use smooth::CREASE;

/// Most nodes that a facet may depend on.
pub const MAX: usize = 32;

/// Facets whose nodes move. Every facet is one tensor-product Bezier piece (degree 1, 2 or 3 for the whole set, rational where
/// it comes from a patch with weights) whose control points are fixed linear combinations of nodes. Parameters are `xi in [-1, 1]^2`; `rho_1 x rho_2` points
/// outwards.
#[derive(Debug, Clone)]
pub struct MovingFacets {
    degree: usize,
    /// Distinct node numbers, and where the nodes are.
    numbers: Vec<u32>,
    positions: Vec<Vec3>,
    /// Start of each facet's nodes in `nodes` and `places`, and one past the last.
    first: Vec<u32>,
    /// Nodes that the facets depend on, by number and by place in `positions`.
    nodes: Vec<u32>,
    places: Vec<u32>,
    operators: Vec<Operator>,
    operator_of: Vec<u32>,
    /// Number of the facet given, where one was cut into several.
    source: Vec<u32>,
    topology: Topology,
    /// Whether facets have weights.
    rational: bool,
    /// What is cut away of them.
    trims: Trims,
    /// Control points (homogeneous), `(degree + 1)^2` of each facet, xi1 fastest.
    nets: Vec<[f64; 4]>,
    boxes: Vec<[Vec3; 2]>,
    /// None before the first update.
    tree: Option<Tree>,
    /// Diagonal of the box around everything, no less than what rounding makes of the coordinates.
    size: f64,
}

/// Bytes of heap that a vector holds itself.
fn heap<T>(of: &Vec<T>) -> usize {
    of.capacity() * size_of::<T>()
}

/// Where a foot lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MovingPlace {
    /// On a facet, or where the surface runs on smoothly from one to the next.
    Face,
    /// On an edge that holds the foot.
    Edge {
        /// Direction of the edge in the facet's `xi`.
        direction: [f64; 2],
        /// Sharp, or the free border of the set.
        kind: EdgeKind,
    },
    /// At a node that holds the foot.
    Corner {
        /// Sharp, or on the free border of the set.
        kind: EdgeKind,
    },
}

/// The closest point of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingFoot {
    /// Number of the facet.
    pub facet: u32,
    /// Parameters of the foot, in `[-1, 1]^2`.
    pub xi: [f64; 2],
    /// Jet of the facet there.
    pub jet: Jet,
    /// Outward unit normal; on sharp edges and corners the angle-weighted pseudo-normal.
    pub normal: Vec3,
    /// Distance with sign: positive outside.
    pub signed_distance: f64,
    /// Euclidean distance, >= 0.
    pub distance: f64,
    /// Face, edge or corner.
    pub place: MovingPlace,
    /// How sure it is.
    pub status: Status,
}

impl MovingFoot {
    /// Where to start when the query or the facets have moved a little.
    pub fn hint(&self) -> Hint {
        Hint {
            patch: self.facet,
            xi: self.xi,
        }
    }
}

/// Shape functions of the nodes of a facet: a buffer that the caller owns. Entry `k` belongs to node `k` of
/// [`MovingFacets::nodes`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeRows {
    /// Number of nodes.
    pub count: usize,
    /// `N_k`.
    pub n: [f64; MAX],
    /// `N_k,1`.
    pub n_1: [f64; MAX],
    /// `N_k,2`.
    pub n_2: [f64; MAX],
}

impl Default for ShapeRows {
    fn default() -> Self {
        Self {
            count: 0,
            n: [0.0; MAX],
            n_1: [0.0; MAX],
            n_2: [0.0; MAX],
        }
    }
}

/// [`ShapeRows`] with second derivatives, for what acts on the slopes of a surface (friction at a distance from it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvedRows {
    /// `N_k` and first derivatives.
    pub rows: ShapeRows,
    /// `N_k,11`.
    pub n_11: [f64; MAX],
    /// `N_k,12`.
    pub n_12: [f64; MAX],
    /// `N_k,22`.
    pub n_22: [f64; MAX],
}

impl Default for CurvedRows {
    fn default() -> Self {
        Self {
            rows: ShapeRows::default(),
            n_11: [0.0; MAX],
            n_12: [0.0; MAX],
            n_22: [0.0; MAX],
        }
    }
}

/// Why moving facets could not be made. Facets are numbered as given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MovingError {
    /// No facets.
    #[error("there are no facets")]
    Empty,
    /// More facets than can be numbered.
    #[error("{0} facets are too many")]
    TooMany(usize),
    /// Node counts other than 2 or 3.
    #[error("facet {facet} has {} x {} nodes; 2 or 3 in each direction are possible", count[0], count[1])]
    Count {
        /// Number of the facet.
        facet: usize,
        /// Its node counts.
        count: [u8; 2],
    },
    /// A list of nodes that does not fit the counts.
    #[error("facet {facet} of {} x {} nodes has a list of {found}", count[0], count[1])]
    Nodes {
        /// Number of the facet.
        facet: usize,
        /// Its node counts.
        count: [u8; 2],
        /// Length of its list.
        found: usize,
    },
    /// Two facets that share an edge and whose normals point to different sides.
    #[error("the normals of facets {0} and {1}, which share an edge, point to different sides")]
    Flipped(usize, usize),
    /// A reference position that is infinite or not a number.
    #[error("node {0} is not at a finite position")]
    Position(u32),
    /// A patch whose spans are no bicubic facets.
    #[error("the patch is not bicubic, or has no such span")]
    Patch,
    /// Too many elements meet around a facet.
    #[error(
        "the smooth surface on facet {facet} depends on {count} nodes, more than {MAX}: too many elements meet at one of \
         its nodes"
    )]
    Stencil {
        /// Number of the facet.
        facet: usize,
        /// Nodes that it depends on.
        count: usize,
    },
}

impl MovingFacets {
    /// Bytes of heap that the surface holds.
    pub fn bytes(&self) -> usize {
        let MovingFacets {
            degree: _,
            numbers,
            positions,
            first,
            nodes,
            places,
            operators,
            operator_of,
            source,
            topology,
            rational: _,
            trims,
            nets,
            boxes,
            tree,
            size: _,
        } = self;
        let counts = [numbers, first, nodes, places, operator_of, source].map(heap);
        counts.iter().sum::<usize>()
            + heap(positions)
            + heap(operators)
            + operators.iter().map(|o| o.bytes()).sum::<usize>()
            + topology.bytes()
            + trims.bytes()
            + heap(nets)
            + heap(boxes)
            + tree.as_ref().map_or(0, |t| t.bytes())
    }

    /// Number of facets.
    pub fn len(&self) -> usize {
        self.operator_of.len()
    }

    /// Whether there are none (never so for a set that was made).
    pub fn is_empty(&self) -> bool {
        self.operator_of.is_empty()
    }

    /// Polynomial degree of all facets in each direction: 1, 2 or 3.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of the facet given that a facet comes from: the same, but for [`smooth`](Self::smooth) facets of nodes 3 x
    /// 3, 3 x 2 or 2 x 3, which are cut at their middle nodes. Facets past the last one come from none; `u32::MAX`.
    pub fn source(&self, facet: u32) -> u32 {
        self.source.get(facet as usize).copied().unwrap_or(u32::MAX)
    }

    /// Nodes that a facet depends on, by the numbers given; its own corner nodes are the first four of a smooth facet, and
    /// all nodes in the order given of any other. Empty past the last facet.
    pub fn nodes(&self, facet: u32) -> &[u32] {
        match self.range(facet) {
            Some(range) => &self.nodes[range],
            None => &[],
        }
    }

    /// Facets that share a node with a facet (one of its own, not one of its neighbours'), in ascending order without
    /// itself.
    pub fn neighbours(&self, facet: u32) -> &[u32] {
        self.topology.neighbours(facet)
    }

    /// Diagonal of the box around all control points at the last update: the length that tolerances are relative to.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Jet of a facet at the last update. Zero past the last facet.
    pub fn jet(&self, facet: u32, xi: [f64; 2]) -> Jet {
        match self.degree {
            1 => self.jet_of::<2>(facet, xi),
            2 => self.jet_of::<3>(facet, xi),
            _ => self.jet_of::<4>(facet, xi),
        }
    }

    fn jet_of<const M: usize>(&self, facet: u32, xi: [f64; 2]) -> Jet {
        match self.nets.get(facet as usize * M * M..) {
            Some(net) if net.len() >= M * M => net::jet::<M>(&net[..M * M], xi, self.rational),
            _ => Jet {
                rho: Vec3::zeros(),
                rho_i: [Vec3::zeros(); 2],
                rho_ij: [Vec3::zeros(); 3],
            },
        }
    }

    /// Shape functions `N_k` of [`nodes`](Self::nodes) with their derivatives `N_k,1`, `N_k,2` by `xi`. No nodes past the last
    /// facet.
    pub fn shape(&self, facet: u32, xi: [f64; 2], out: &mut ShapeRows) {
        let Some(range) = self.range(facet) else {
            out.count = 0;
            return;
        };
        out.count = range.len();
        let operator = &self.operators[self.operator_of[facet as usize] as usize];
        match self.degree {
            1 => operator.shape::<2>(xi, out),
            2 => operator.shape::<3>(xi, out),
            _ => operator.shape::<4>(xi, out),
        }
    }

    /// [`shape`](Self::shape) with the second derivatives `N_k,11`, `N_k,12`, `N_k,22`.
    pub fn curved_shape(&self, facet: u32, xi: [f64; 2], out: &mut CurvedRows) {
        self.shape(facet, xi, &mut out.rows);
        if out.rows.count == 0 {
            return;
        }
        let operator = &self.operators[self.operator_of[facet as usize] as usize];
        match self.degree {
            1 => operator.second::<2>(xi, out),
            2 => operator.second::<3>(xi, out),
            _ => operator.second::<4>(xi, out),
        }
    }

    fn range(&self, facet: u32) -> Option<std::ops::Range<usize>> {
        let k = facet as usize;
        (k < self.len()).then(|| self.first[k] as usize..self.first[k + 1] as usize)
    }

    /// Moves the facets to where their nodes are: control points, and the boxes of the search tree, which the first update
    /// builds. Runs on the calling thread. Positions that are not finite leave their facets out of every search. No
    /// allocation but in the first call.
    pub fn update(&mut self, position: impl Fn(u32) -> Vec3 + Sync) {
        for (x, &number) in self.positions.iter_mut().zip(&self.numbers) {
            *x = position(number);
        }
        match self.degree {
            1 => self.move_nets::<2>(),
            2 => self.move_nets::<3>(),
            _ => self.move_nets::<4>(),
        }
        match &mut self.tree {
            Some(tree) => tree.refit(&self.boxes),
            None => self.tree = Some(Tree::with_all(&self.boxes)),
        }
        let finite = self.boxes.iter().filter(|b| b[0].x <= b[1].x);
        let [low, high] = finite.fold(EMPTY_BOX, |[low, high], b| {
            [low.inf(&b[0]), high.sup(&b[1])]
        });
        let far = low.amax().max(high.amax());
        self.size = if far.is_finite() {
            // Coordinates far from the origin carry their rounding into every length.
            (high - low).norm().max(1e-2 * far).max(f64::MIN_POSITIVE)
        } else {
            f64::MIN_POSITIVE
        };
    }

    fn move_nets<const M: usize>(&mut self) {
        let nets = self.nets.chunks_exact_mut(M * M).zip(&mut self.boxes);
        for (facet, (net, bounds)) in nets.enumerate() {
            let range = self.first[facet] as usize..self.first[facet + 1] as usize;
            let operator = &self.operators[self.operator_of[facet] as usize];
            operator.apply(&self.places[range], &self.positions, net);
            *bounds = net::bounds(net, self.rational);
        }
    }
}

/// A box that nothing is in.
const EMPTY_BOX: [Vec3; 2] = [
    Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
];
