//! STL surfaces made of exact ones.
use covact::study::Triangles;
use covact_geometry::facet::Refinement;
use covact_geometry::io::{read_stl, write_stl};
use covact_geometry::{PatchSet, Vec3, primitives};

fn sphere(radius: f64) -> PatchSet {
    let center = Vec3::new(1.0, 2.0, 3.0);
    let patches = primitives::sphere_without_poles(radius, center, Vec3::y()).unwrap();
    let mut set = PatchSet::new(Vec::from(patches), None).unwrap();
    set.set_side_as_given(false);
    set
}

/// The distance of a point of a triangle from a sphere through its nodes is the radius less its distance from the centre,
/// largest at the foot of the centre: all triangles are within the chord error, and need not be much finer.
#[test]
fn a_sphere_is_followed_within_the_chord() {
    let (radius, center) = (25.0, Vec3::new(1.0, 2.0, 3.0));
    let exact = sphere(radius);
    for chord in [1.0, 0.1] {
        let made = Triangles::of(&exact, Refinement::Chord(chord)).unwrap();
        let bytes = write_stl(&made.nodes, &made.triangles);
        let stl = read_stl(&bytes, "sphere.stl", None).unwrap();
        assert_eq!(stl.triangles.len(), made.triangles.len());
        assert_eq!(
            (stl.report.free, stl.report.flipped, stl.report.branching),
            (0, 0, 0)
        );
        let mut largest = 0.0f64;
        for triangle in &stl.triangles {
            let [a, b, c] = triangle.map(|n| stl.nodes[n as usize] - center);
            for x in [a, b, c] {
                assert!((x.norm() - radius).abs() < 1e-5, "{x}");
            }
            let normal = (b - a).cross(&(c - a)).normalize();
            let height = normal.dot(&a);
            assert!(height > 0.0, "turned inside");
            largest = largest.max(radius - height);
        }
        // Single precision: 2^-24 of the coordinates.
        assert!(largest < chord + 1e-5, "{largest} for {chord}");
        assert!(
            largest > 0.4 * chord,
            "{largest} for {chord}: finer than asked for"
        );
    }
}

#[test]
fn counts_are_two_triangles_a_facet() {
    let exact = sphere(2.0);
    let made = Triangles::of(&exact, Refinement::PerPatch([5, 3])).unwrap();
    // Neighbouring patches share their nodes, so that some have more than they were asked for.
    assert!(made.triangles.len() >= 6 * 5 * 3 * 2 && made.triangles.len().is_multiple_of(2));
    let distance = made.distance(&exact).unwrap();
    assert!(distance > 0.0 && distance < 0.2, "{distance}");
}

#[test]
fn useless_chords_are_refused() {
    let exact = sphere(2.0);
    let error = Triangles::of(&exact, Refinement::Chord(-1.0)).unwrap_err();
    assert!(
        error.to_string().contains("-1 is not a positive number"),
        "{error}"
    );
}
