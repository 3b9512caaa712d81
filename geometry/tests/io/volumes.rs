//! Volumes and sides of closed bodies, whichever way their faces are parametrised: faces of IGES files that belong to no
//! shell have their normals by chance.

use crate::support::{Entity, GLOBAL, entity, iges};
use covact_geometry::Vec3;
use covact_geometry::io::{CadSurface, read_iges};

/// The corners of the six faces of a box around the origin, each in the order (0,0), (1,0), (0,1), (1,1) of its
/// parameters, with normals that point out of it.
fn faces(half: [f64; 3]) -> [[[f64; 3]; 4]; 6] {
    std::array::from_fn(|k| {
        let (axis, sign) = (k / 2, if k % 2 == 0 { -1.0 } else { 1.0 });
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        std::array::from_fn(|corner| {
            let mut x = [0.0; 3];
            // On the low side the first parameter runs backwards.
            let first = if corner % 2 == 0 { -1.0 } else { 1.0 };
            let second = if corner / 2 == 0 { -1.0 } else { 1.0 };
            x[axis] = sign * half[axis];
            x[a] = sign * first * half[a];
            x[b] = second * half[b];
            x
        })
    })
}

/// A surface 128 between four corners.
fn bilinear(corners: &[[f64; 3]; 4], turned: bool) -> Entity<'static> {
    let order = if turned { [1, 0, 3, 2] } else { [0, 1, 2, 3] };
    let points: Vec<String> = (order.iter().flat_map(|&k| corners[k]))
        .map(|x| format!("{x:?}"))
        .collect();
    let values = format!(
        "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,{},0.,1.,0.,1.",
        points.join(",")
    );
    entity(128, &values)
}

/// Boxes of the half extents given; bit k of `turned` turns face k over, counted through all boxes.
fn boxes(extents: &[[f64; 3]], turned: u32) -> CadSurface {
    let all = extents.iter().flat_map(|&half| faces(half));
    let entities: Vec<Entity> = all
        .enumerate()
        .map(|(k, corners)| bilinear(&corners, turned >> k & 1 == 1))
        .collect();
    let text = iges(GLOBAL, &entities);
    let file = read_iges(text.as_bytes(), "boxes.igs").unwrap();
    assert!(file.skipped.is_empty(), "{:?}", file.skipped);
    file.into_surface().unwrap()
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("a closed part");
    assert!(
        (found - expected).abs() < 1e-12 * expected.abs(),
        "{found} instead of {expected}"
    );
}

#[test]
fn volumes_of_closed_bodies_are_positive_whichever_faces_are_turned() {
    for turned in 0..64 {
        let surface = boxes(&[[1., 1.5, 2.]], turned);
        let set = surface.set();
        assert_eq!(set.volumes().len(), 1, "{turned}");
        near(set.volumes()[0], 24.);
        for face in 0..6 {
            let side = if turned >> face & 1 == 1 { -1. } else { 1. };
            assert_eq!(set.sides()[face], side, "face {face} of {turned}");
        }
        let distance = |x: [f64; 3]| surface.closest(&x.into()).unwrap().signed_distance;
        assert!((distance([0.75, 0.1, 0.2]) + 0.25).abs() < 1e-14);
        assert!((distance([0.1, -2., 0.2]) - 0.5).abs() < 1e-14);
        // Beyond a corner.
        assert!((distance([2., 2.5, 3.]) - 3f64.sqrt()).abs() < 1e-14);
    }
}

#[test]
fn cavities_count_negative_and_lie_outside() {
    let (wide, middle, small) = ([4.; 3], [2.; 3], [1.; 3]);
    let expected = |half: [f64; 3]| match half {
        [4., ..] => 512.,
        [2., ..] => -64.,
        // An island in the cavity.
        _ => 8.,
    };
    for order in [
        [wide, middle, small],
        [small, middle, wide],
        [middle, wide, small],
    ] {
        for turned in [0, 1, 0x3ffff, 0x2a5c3] {
            let surface = boxes(&order, turned);
            let set = surface.set();
            assert_eq!(set.volumes().len(), 3);
            for (&volume, half) in set.volumes().iter().zip(order) {
                near(volume, expected(half));
            }
            let sum: f64 = set.volumes().iter().flatten().sum();
            assert!((sum - 456.).abs() < 1e-9);
            let distance = |x: f64| {
                let q = Vec3::new(x, 0.1, 0.2);
                surface.closest(&q).unwrap().signed_distance
            };
            let found = [0.75, 1.25, 2.25, 3.75, 4.25].map(distance);
            for (found, expected) in found.into_iter().zip([-0.25, 0.25, -0.25, -0.25, 0.25]) {
                assert!((found - expected).abs() < 1e-14, "{found} for {expected}");
            }
        }
    }
}

#[test]
fn volumes_follow_sides() {
    let mut set = boxes(&[[1.; 3]], 0b10110).into_set();
    near(set.volumes()[0], 8.);
    // Its first patch is given with its normal outward.
    set.set_component_side(0, -1.0);
    near(set.volumes()[0], -8.);
    set.set_component_side(0, -1.0);
    near(set.volumes()[0], -8.);
    set.set_sides_outward(false).unwrap();
    near(set.volumes()[0], 8.);
    set.set_side_as_given(true);
    near(set.volumes()[0], -8.);
    let inside = Vec3::new(0.5, 0., 0.);
    assert!(set.closest(&inside).unwrap().signed_distance > 0.);
    set.orient_towards(&[Vec3::new(2., 0., 0.)]).unwrap();
    near(set.volumes()[0], 8.);
    assert!(set.closest(&inside).unwrap().signed_distance < 0.);
}
