//! Facets that share nodes.

use super::{Bilinear, Biquadratic, FacetError};
use crate::surface::Vec3;

/// Facets of `N` nodes each (4 bilinear, 9 biquadratic) over shared nodes: neighbours name the same nodes along their
/// common edge, so they stay together when the nodes move.
///
/// ```
/// use covact_geometry::{FacetMesh, PatchSet, Vec3};
/// // Two squares side by side.
/// let nodes = (0..6).map(|k| Vec3::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
/// let mesh = FacetMesh { nodes, facets: vec![[0, 1, 3, 4], [1, 2, 4, 5]] };
/// let set = PatchSet::new(mesh.surfaces()?, None)?;
/// let foot = set.project(&Vec3::new(1.0, 0.5, 2.0), None, f64::INFINITY).expect("a finite point");
/// assert!((foot.signed_distance - 2.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FacetMesh<const N: usize> {
    /// Node positions.
    pub nodes: Vec<Vec3>,
    /// Node numbers of every facet, xi1 fastest.
    pub facets: Vec<[u32; N]>,
}

impl<const N: usize> FacetMesh<N> {
    /// Positions of the nodes of every facet, in the order of the facets.
    fn gather(&self) -> impl Iterator<Item = Result<[Vec3; N], FacetError>> + '_ {
        self.facets.iter().enumerate().map(|(facet, numbers)| {
            let mut x = [Vec3::zeros(); N];
            for (x, &node) in x.iter_mut().zip(numbers) {
                *x = *self.nodes.get(node as usize).ok_or(FacetError::NoNode {
                    facet,
                    node,
                    count: self.nodes.len(),
                })?;
            }
            Ok(x)
        })
    }
}

impl FacetMesh<4> {
    /// The facets as surfaces.
    ///
    /// # Errors
    /// Nodes that are not finite or not there.
    pub fn surfaces(&self) -> Result<Vec<Bilinear>, FacetError> {
        finite(&self.nodes)?;
        self.gather().map(|x| Bilinear::new(x?)).collect()
    }
}

impl FacetMesh<9> {
    /// The facets as surfaces.
    ///
    /// # Errors
    /// Nodes that are not finite or not there.
    pub fn surfaces(&self) -> Result<Vec<Biquadratic>, FacetError> {
        finite(&self.nodes)?;
        self.gather().map(|x| Biquadratic::new(x?)).collect()
    }
}

/// [`FacetError::Node`] with the first point that is not finite.
pub(super) fn finite(points: &[Vec3]) -> Result<(), FacetError> {
    match points.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
        Some(node) => Err(FacetError::Node(node)),
        None => Ok(()),
    }
}
