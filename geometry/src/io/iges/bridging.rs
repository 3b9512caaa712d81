//! Gaps between boundary curves that are small beside the whole part: what a first pass over a file learns for a second one.

use super::super::report::{SkipKind, Skipped};
use super::directory::Entry;
use super::groups::Placement;
use super::names::entity_name;
use crate::Vec3;

/// Gaps between boundary curves up to this share of the size of all surfaces are closed: what whole edges of neighbours may
/// be apart to be joined.
const BRIDGED: f64 = 1e-4;

/// A surface that was not read.
pub struct Skip<'a> {
    pub entry: &'a Entry,
    pub placed: Vec<Placement>,
    pub name: Option<String>,
    pub refused: (SkipKind, String),
}

impl Skip<'_> {
    /// Whether a boundary was refused for a gap between its curves: what else is wrong with it a wider gap does not mend.
    pub fn is_open(&self) -> bool {
        self.refused.0 == SkipKind::Boundary && self.refused.1.contains("is open")
    }

    pub fn told(self) -> Skipped {
        let entry = self.entry;
        let label = || (!entry.label.is_empty()).then(|| entry.label.clone());
        let name = self.name.or_else(label);
        Skipped {
            entity: entry.number,
            type_number: entry.type_number,
            name: name.unwrap_or_else(|| entity_name(entry.type_number, entry.form).to_owned()),
            kind: self.refused.0,
            reason: self.refused.1,
        }
    }
}

/// The size of the part, as far as it is known, and the faces that wait for it.
pub struct Bridging<'a> {
    /// Box around everything that was read or should have been.
    extent: [Vec3; 2],
    /// Gaps up to this length are closed.
    pub length: f64,
    /// Faces whose boundaries gave no trim, to be read again when the size is known.
    pub open: Vec<Skip<'a>>,
}

impl Bridging<'_> {
    pub fn new() -> Self {
        Self {
            extent: [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)],
            length: 0.0,
            open: Vec::new(),
        }
    }

    pub fn extend(&mut self, points: impl IntoIterator<Item = Vec3>) {
        for x in points {
            self.extent = [self.extent[0].inf(&x), self.extent[1].sup(&x)];
        }
    }

    /// From now on gaps are closed by the size found.
    pub fn begin(&mut self) {
        let size = (self.extent[1] - self.extent[0]).norm();
        self.length = if size.is_finite() {
            BRIDGED * size
        } else {
            0.0
        };
    }
}
