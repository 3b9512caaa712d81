//! Facets of trimmed patches: what a trim cuts away holds no feet.

use crate::Trim;

/// How far beyond a curve of the trim there still are feet, as a part of the facet: no foot is lost between two patches that are
/// joined along it.
const BEYOND: f64 = 1e-3;

/// The trims of facets.
#[derive(Debug, Clone, Default)]
pub(super) struct Trims {
    trims: Vec<Trim>,
    /// By facet; empty where nothing is trimmed.
    facets: Vec<Option<Placed>>,
}

/// A facet in the parameters of its trim.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    /// Number of its trim.
    pub trim: u32,
    /// Ranges of both parameters of the patch.
    pub range: [[f64; 2]; 2],
    /// The parameters of the facet are exchanged.
    pub exchanged: bool,
}

impl Trims {
    /// Adds a trim; returns its number.
    pub fn push(&mut self, trim: &Trim) -> u32 {
        self.trims.push(trim.clone());
        self.trims.len() as u32 - 1
    }

    /// Says where a facet lies, after all that come before it.
    pub fn place(&mut self, facet: usize, placed: Placed) {
        self.facets.resize(facet, None);
        self.facets.push(Some(placed));
    }

    /// Whether any facet is trimmed.
    pub fn any(&self) -> bool {
        !self.facets.is_empty()
    }

    /// Whether there are feet at parameters of a facet.
    #[inline]
    pub fn holds(&self, facet: u32, xi: [f64; 2]) -> bool {
        match self.facets.get(facet as usize) {
            Some(Some(placed)) => self.within(placed, xi),
            _ => true,
        }
    }

    #[inline(never)]
    fn within(&self, placed: &Placed, xi: [f64; 2]) -> bool {
        let own = match placed.exchanged {
            true => [xi[1], xi[0]],
            false => xi,
        };
        let at = [0, 1].map(|d| {
            let [a, b] = placed.range[d];
            0.5 * (a + b) + 0.5 * own[d] * (b - a)
        });
        let trim = &self.trims[placed.trim as usize];
        trim.contains(at) || {
            let scale = placed.range.map(|[a, b]| b - a);
            trim.nearest_border(at, scale, BEYOND).is_some()
        }
    }

    /// Bytes of heap that it holds itself, trims aside.
    pub fn bytes(&self) -> usize {
        super::heap(&self.trims) + super::heap(&self.facets)
    }
}
