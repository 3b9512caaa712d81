//! Facets by count and by size, and the smooth surface over them.

use covact_geometry::facet::{
    FacetError, Refinement, bilinear_facets, biquadratic_facets, distance_from, smooth_patches,
};
use covact_geometry::primitives::{cylinder, sphere_without_poles};
use covact_geometry::{PatchSet, Vec3};

fn tube() -> PatchSet {
    let tube = cylinder(2.0, 3.0, Vec3::zeros(), Vec3::z()).unwrap();
    PatchSet::new(vec![tube], None).unwrap()
}

fn ball() -> PatchSet {
    let six = sphere_without_poles(2.0, Vec3::zeros(), Vec3::z()).unwrap();
    PatchSet::new(six.to_vec(), None).unwrap()
}

/// A cylinder is four quarters of a circle times a straight line.
#[test]
fn counts_are_those_of_the_patch_and_sizes_are_kept() {
    let tube = tube();
    let count = |r| bilinear_facets(&tube, r).unwrap().mesh.facets.len();
    assert_eq!(count(Refinement::PerPatch([12, 5])), 12 * 5);
    assert_eq!(count(Refinement::PerPatch([1, 1])), 4);
    // A quarter is pi long: four facets of no more than 0.8; the height of 3 needs four, too.
    assert_eq!(count(Refinement::Size(0.8)), 4 * 4 * 4);
    assert_eq!(count(Refinement::Size(1e3)), 4);
    let fine = biquadratic_facets(&ball(), Refinement::PerPatch([6, 6])).unwrap();
    assert_eq!(fine.mesh.facets.len(), 6 * 36);
    assert!(fine.cracks.is_empty());
    for useless in [Refinement::PerPatch([0, 3]), Refinement::PerPatch([3, 0])] {
        assert_eq!(bilinear_facets(&tube, useless), Err(FacetError::Count));
    }
    for length in [0.0, -1.0, f64::INFINITY] {
        let error = bilinear_facets(&tube, Refinement::Size(length));
        assert_eq!(error, Err(FacetError::Tolerance(length)));
    }
    let error = bilinear_facets(&tube, Refinement::Size(1e-9));
    assert!(matches!(error, Err(FacetError::TooMany { .. })));
}

/// The smooth surface over a closed mesh of a ball goes through its nodes, has no free edges and is far nearer to the ball
/// than the facets. Across the seams of the six patches the lines of the mesh have a kink that refinement does not take
/// away, and at the corners of the cube three facets meet: there the surface is of second order only, as the largest
/// distance shows. It falls by 3.3 and 1.7 orders from mesh to mesh, 2.5 on average, and is 48, 126 and 103 times smaller
/// than that of the facets.
#[test]
fn the_smooth_surface_is_nearer_to_a_ball_than_its_facets() {
    let ball = ball();
    let mut distances = Vec::new();
    for n in [6, 12, 24] {
        let made = bilinear_facets(&ball, Refinement::PerPatch([n, n])).unwrap();
        let patches = smooth_patches(&made.mesh).unwrap();
        assert_eq!(patches.len(), made.mesh.facets.len());
        for (patch, nodes) in patches.iter().zip(&made.mesh.facets) {
            for (corner, node) in nodes.iter().enumerate() {
                let xi = [corner % 2, corner / 2].map(|k| 2.0 * k as f64 - 1.0);
                let off = patch.point(xi) - made.mesh.nodes[*node as usize];
                assert!(off.norm() < 1e-14);
            }
        }
        let smooth = distance_from(&ball, &patches);
        let set = PatchSet::new(patches, None).unwrap();
        // Three facets meet at each corner of the cube that the ball is made from; the normals turn there a little.
        println!("{n}: {} sharp edges", set.edges().sharp);
        assert!(set.edges().free.is_empty() && set.edges().sharp <= 24);
        distances.push([made.deviation, smooth]);
    }
    println!("{distances:?}");
    for [facets, smooth] in &distances {
        assert!(*smooth > 0.0 && smooth * 30.0 < *facets);
    }
    // Over both refinements, as the two causes take turns at being the larger one.
    assert!(0.5 * (distances[0][1] / distances[2][1]).log2() > 2.0);
}

/// On a tube four facets meet everywhere: the distance of the facets falls with the square of their size, that of the
/// smooth surface with more than the third power.
#[test]
fn the_smooth_surface_of_a_tube_converges_faster() {
    let tube = tube();
    let distances = [16, 32, 64].map(|n| {
        let made = bilinear_facets(&tube, Refinement::PerPatch([n, 2])).unwrap();
        let patches = smooth_patches(&made.mesh).unwrap();
        [made.deviation, distance_from(&tube, &patches)]
    });
    println!("{distances:?}");
    for pair in distances.windows(2) {
        let rate = |kind: usize| (pair[0][kind] / pair[1][kind]).log2();
        println!("rates {:.2} {:.2}", rate(0), rate(1));
        assert!((1.8..2.2).contains(&rate(0)));
        assert!(rate(1) > 2.7);
    }
}
