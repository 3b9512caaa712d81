//! The averaged gap: contact asked of slave nodes in the mean instead of at every slave point.
//!
//! Many points at a stiff penalty ask more of a slave face than its nodes can give (the surfaces would have to coincide at
//! every point). Projected on the shape functions `N_A` of the slave side, the gap has one value per node,
//!
//! ```text
//! g_A = int N_A xi3 dS / m_A,    m_A = int N_A dS        lambda_A = N(g_A) where g_A < 0, else 0
//! ```
//!
//! (with a multiplier of the node in the law: where `N(g_A) < 0`).
//!
//! With `dg_A = c_A / m_A`, `c_A = int N_A g3 dS` the virtual work `sum_A m_A lambda_A dg_A` is that of the traction
//! `lambda(q) = sum_A N_A(q) lambda_A` at the points, and the tangent has a rank-one part per node and the geometric part
//! of every point:
//!
//! ```text
//! R = sum_q w_q lambda(q) g3(q)
//! K = sum_A N'(g_A) / m_A c_A x c_A + sum_q w_q lambda(q) D dxi3(q)
//! ```
//!
//! The second is [`respond`] with `N = lambda(q)` and `N' = 0`, so any master that gives a [`PointGeometry`] will do. An
//! open point of a closed node counts with its positive gap and may carry traction; because this does not vanish with
//! the distance, use [`Meeting::steady`](super::meeting::Meeting::steady) at edges. The projection is that of the mortar
//! method with a lumped mass (e.g. Popp, Gitterle, Gee & Wall, IJNME 83 (2010)); its tangential counterpart is not used
//! here: friction is that of points under `lambda(q)` ([`super::friction::given`]).
use super::kernel::{self, NodeRow, Normal, SlotMatrix, Slots};
use super::law::NormalLaw;
use super::point::{FaceTangent, PointGeometry, respond};
use nalgebra::{Matrix3, Vector3};

/// Sums of one slave node over the points of the faces around it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NodalGap {
    /// `int N_A xi3 dS` (length^3).
    pub moment: f64,
    /// `m_A = int N_A dS` (length^2).
    pub area: f64,
    /// `int |N_A| dS` (length^2): shape functions of quadratic faces are negative in parts.
    pub spread: f64,
}

/// A node of which less than this part of `int |N_A| dS` is left in `m_A` has no mean: what counts of its faces are the
/// parts in which its shape function is negative. In a whole square face of nine nodes it is 4/9 for a corner.
const LEAST: f64 = 0.05;

impl NodalGap {
    /// Adds a point with the node's shape function, the point's area and its gap. A point whose foot lies on a free border
    /// of the master is not to be added: the node's mean is over what faces the master. One that found no foot within
    /// reach is to be added with the reach, lest an open point pass for one that is not there.
    pub fn add(&mut self, shape: f64, area: f64, xi3: f64) {
        self.moment += shape * area * xi3;
        self.area += shape * area;
        self.spread += shape.abs() * area;
    }

    /// The mean `g_A`; `None` where nothing of the node's faces counts.
    pub fn gap(&self) -> Option<f64> {
        (self.area > LEAST * self.spread).then(|| self.moment / self.area)
    }

    /// Traction `lambda_A` and stiffness of the node; zero where it is open.
    pub fn normal<L: NormalLaw>(&self, law: &L) -> Normal {
        match self.gap() {
            Some(gap) if law.closes(gap) => law.response(gap),
            _ => Normal { n: 0.0, dn: 0.0 },
        }
    }
}

/// Traction of a point: `sum_A N_A lambda_A` over its nodes' shape functions and tractions.
pub fn traction(terms: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    terms
        .into_iter()
        .map(|(shape, lambda)| shape * lambda)
        .sum()
}

/// Residual `lambda g3` and geometric part of a point of unit weight in the nine slots.
#[inline]
pub fn point<T: FaceTangent>(
    geometry: &PointGeometry,
    lambda: f64,
    tangent: &T,
) -> (Slots, SlotMatrix) {
    let normal = Normal { n: lambda, dn: 0.0 };
    respond(geometry, &normal, tangent)
}

/// `g3` of a point: the derivative of its gap in the nine slots.
pub fn gap_slots(geometry: &PointGeometry) -> Slots {
    kernel::in_slot(0, &geometry.normal())
}

/// The derivative `c_A` of a node's `int N_A xi3 dS`, a sparse row over 3-vectors of degrees of freedom (nodes, and the
/// translation and the spin of rigid bodies). Owned by the caller and used again.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GapRow {
    entries: Vec<(u32, Vector3<f64>)>,
}

impl GapRow {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<(u32, Vector3<f64>)>()
    }

    /// Empties the row and keeps its memory.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Adds a point's [`gap_slots`] with `weight = N_A w_q` for a node of either side, by its row in the slots.
    pub fn add_node(&mut self, node: u32, g3: &Slots, row: &NodeRow, weight: f64) {
        self.add(node, kernel::assemble_force(g3, row) * weight);
    }

    /// Adds a vector to entry `key`.
    pub fn add(&mut self, key: u32, v: Vector3<f64>) {
        self.entries.push((key, v));
    }

    /// Merges what was added, in ascending order of the keys; to be called before reading.
    pub fn finish(&mut self) {
        // Stable, so that the sums do not depend on anything but the order of adding.
        self.entries.sort_by_key(|e| e.0);
        self.entries.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
    }

    /// Keys and vectors.
    pub fn entries(&self) -> &[(u32, Vector3<f64>)] {
        &self.entries
    }

    /// 3 x 3 block of entries `i` and `j` of the node's rank-one part `N' / m_A c_A x c_A`.
    pub fn block(&self, i: usize, j: usize, normal: &Normal, gap: &NodalGap) -> Matrix3<f64> {
        let scale = normal.dn / gap.area;
        self.entries[i].1 * self.entries[j].1.transpose() * scale
    }
}
