//! Faces whose curves in the parameter plane and in space contradict each other: what their neighbours say of them.

use super::support::{Entity, GLOBAL, area, child, entity, flat, iges, line};
use covact_geometry::io::{CadFile, read_iges};
use std::f64::consts::{FRAC_PI_2, PI};

fn read(entities: &[Entity]) -> CadFile {
    let text = iges(GLOBAL, entities);
    let file = read_iges(text.as_bytes(), "hand.igs").unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(file.skipped, [], "{:?}", file.notes);
    file
}

/// Adds an entity and returns its number.
fn add(entities: &mut Vec<Entity<'static>>, one: Entity<'static>) -> usize {
    entities.push(one);
    2 * entities.len() - 1
}

/// Adds the composite of lines around a rectangle of the plane z = 0.
fn rectangle(entities: &mut Vec<Entity<'static>>, [a, b]: [f64; 2]) -> usize {
    let corners = [[a, 0.0], [b, 0.0], [b, 1.0], [a, 1.0]];
    let members: Vec<String> = (0..4)
        .map(|k| add(entities, line(corners[k], corners[(k + 1) % 4])).to_string())
        .collect();
    add(entities, child(102, &format!("4,{}", members.join(","))))
}

/// Faces on the plane [0, 4] x [0, 1], of width 1, each between a first x in the parameter plane and one in space.
fn strips(faces: &[[f64; 2]], preference: u32) -> CadFile {
    let mut entities = Vec::new();
    for &[plane, space] in faces {
        let surface = add(&mut entities, child(128, &flat(4.0, 1.0)));
        let plane = rectangle(&mut entities, [plane, plane + 1.0]);
        let space = rectangle(&mut entities, [space, space + 1.0]);
        let boundary = format!("0,{surface},{plane},{space},{preference}");
        let boundary = add(&mut entities, child(142, &boundary));
        add(
            &mut entities,
            entity(144, &format!("{surface},1,0,{boundary}")),
        );
    }
    read(&entities)
}

/// Where the face of number `k` begins.
fn begins(file: &CadFile, k: usize) -> f64 {
    let patch = &file.patches[k].patch;
    let [[a, b], [c, d]] = patch.domain();
    let [low, high] = [patch.point([a, c]), patch.point([b, d])];
    assert!((high.x - low.x - 1.0).abs() < 1e-12 && (high.y - low.y - 1.0).abs() < 1e-12);
    low.x
}

fn notes(file: &CadFile, part: &str) -> usize {
    file.notes.iter().filter(|n| n.contains(part)).count()
}

/// Which curves count is told by the neighbour, whatever the writer prefers.
#[test]
fn neighbours_tell_which_curves_are_meant() {
    for preference in 0..4 {
        // Nobody beside it: those in space.
        let alone = strips(&[[1.0, 2.0]], preference);
        assert!((begins(&alone, 0) - 2.0).abs() < 1e-12);
        assert_eq!((alone.trims.rejected, alone.trims.projected), (1, 4));
        assert_eq!(notes(&alone, "contradict"), 0, "{:?}", alone.notes);
        let preferred = usize::from(preference == 1);
        assert_eq!(
            notes(&alone, "although the file prefers the former"),
            preferred
        );
        // A neighbour at the end of what the curves in the parameter plane bound.
        let left = strips(&[[0.0, 0.0], [1.0, 2.0]], preference);
        assert!((begins(&left, 1) - 1.0).abs() < 1e-12, "{:?}", left.notes);
        assert_eq!((left.trims.rejected, left.trims.projected), (0, 0));
        assert_eq!(left.trims.curves, 8);
        let told = "with those in space 100 % of their edges have no neighbour that goes on from there, with \
                    those in the parameter plane 75 %; those in the parameter plane were taken";
        assert_eq!(notes(&left, told), 1, "{:?}", left.notes);
        assert_eq!(notes(&left, "were projected"), 0);
        let set = left.into_surface().unwrap().into_set();
        assert_eq!((set.edges().joints.len(), set.edges().free.len()), (1, 6));
        // One at the end of what those in space bound.
        let right = strips(&[[1.0, 2.0], [3.0, 3.0]], preference);
        assert!((begins(&right, 0) - 2.0).abs() < 1e-12);
        assert_eq!((right.trims.rejected, right.trims.projected), (1, 4));
        assert_eq!(notes(&right, "; those in space were taken"), 1);
        // One at either end says nothing.
        let both = strips(&[[0.0, 0.0], [1.0, 2.0], [3.0, 3.0]], preference);
        assert!((begins(&both, 1) - 2.0).abs() < 1e-12);
        assert_eq!(notes(&both, "contradict"), 0);
    }
}

/// A tube of radius 1 from z = 0 to 2 with a flat end at z = 2 and half a ball at z < 0 of two quarters, whose curves in the
/// parameter plane bound the half at z > 0 (as SolidWorks 2010 writes them, with PREF 1).
fn capsule() -> CadFile {
    let mut entities = Vec::new();
    let axis = add(&mut entities, child(110, "0.,0.,1.,0.,0.,0."));
    // Planes through the axis: z = y of their own, and z = -y.
    let upright = "1.,0.,0.,0.,0.,0.,-1.,0.,0.,1.,0.,0.";
    let hanging = "1.,0.,0.,0.,0.,0.,1.,0.,0.,-1.,0.,0.";
    let [upright, hanging] = [upright, hanging].map(|values| {
        let number = add(&mut entities, entity(124, values));
        u32::try_from(number).unwrap()
    });
    let meridian = Entity {
        matrix: upright,
        ..child(100, "0.,0.,0.,0.,1.,0.,-1.")
    };
    let meridian = add(&mut entities, meridian);
    let ball = format!("{axis},{meridian},0.,{:?}", 2.0 * PI);
    // Half a circle, from (from, 0) counterclockwise.
    let half = |from: f64, matrix: u32| Entity {
        matrix,
        ..child(100, &format!("0.,0.,0.,{from:?},0.,{:?},0.", -from))
    };
    for side in [0, 1] {
        let surface = add(&mut entities, child(120, &ball));
        // About -z, the direction of the axis: y > 0 first.
        let [a, b] = [0.0, PI].map(|v| v + PI * f64::from(side));
        let corners = [[FRAC_PI_2, a], [PI, a], [PI, b], [FRAC_PI_2, b]];
        let members: Vec<String> = (0..4)
            .map(|k| add(&mut entities, line(corners[k], corners[(k + 1) % 4])).to_string())
            .collect();
        let plane = add(
            &mut entities,
            child(102, &format!("4,{}", members.join(","))),
        );
        // In space: along the equator, and back through the lower pole.
        let (equator, below) = match side {
            0 => (half(1.0, 0), half(-1.0, upright)),
            _ => (half(-1.0, 0), half(1.0, hanging)),
        };
        let equator = add(&mut entities, equator);
        let below = add(&mut entities, below);
        let space = add(&mut entities, child(102, &format!("2,{equator},{below}")));
        let boundary = format!("1,{surface},{plane},{space},1");
        let boundary = add(&mut entities, child(142, &boundary));
        add(
            &mut entities,
            entity(144, &format!("{surface},1,0,{boundary}")),
        );
    }
    // The tube, and the disc.
    let circle = add(&mut entities, child(100, "0.,0.,0.,1.,0.,1.,0."));
    add(&mut entities, entity(122, &format!("{circle},1.,0.,2.")));
    let rim = add(&mut entities, child(100, "2.,0.,0.,1.,0.,1.,0."));
    let plane = add(&mut entities, child(128, &disc_plane()));
    let boundary = add(&mut entities, child(142, &format!("0,{plane},0,{rim},2")));
    add(
        &mut entities,
        entity(144, &format!("{plane},1,0,{boundary}")),
    );
    read(&entities)
}

/// A 128 over the square of side 4 about the axis, at z = 2.
fn disc_plane() -> String {
    "1,1,1,1,0,0,1,0,0,0.,0.,4.,4.,0.,0.,4.,4.,1.,1.,1.,1.,\
     -2.,-2.,2.,2.,-2.,2.,-2.,2.,2.,2.,2.,2.,0.,4.,0.,4."
        .to_owned()
}

/// The halves of a ball that bulge out of their tube are meant, not those that would stand in it, with either preference.
#[test]
fn caps_of_a_tube_bulge_out_of_it() {
    let file = capsule();
    assert_eq!(file.trims.rejected, 2, "{:?}", file.notes);
    assert_eq!(notes(&file, "although the file prefers the former"), 2);
    assert_eq!(
        notes(&file, "; those in space were taken"),
        1,
        "{:?}",
        file.notes
    );
    let surface = file.into_surface().unwrap();
    let volumes: Vec<f64> = surface.set().volumes().iter().flatten().copied().collect();
    let [volume] = volumes[..] else {
        panic!("{:?}", surface.set().edges());
    };
    assert!(
        (volume / (2.0 * PI + 2.0 / 3.0 * PI) - 1.0).abs() < 1e-3,
        "{volume}"
    );
    let distance = |x: [f64; 3]| surface.closest(&x.into()).unwrap().signed_distance;
    assert!((distance([0.3, 0.0, -1.4]) - (0.09f64 + 1.96).sqrt() + 1.0).abs() < 1e-6);
    assert!((distance([0.3, 0.4, 0.2]) + 0.5).abs() < 1e-6);
    assert!((distance([0.0, 0.5, -0.5]) + 1.0 - 0.5f64.sqrt()).abs() < 1e-6);
}

/// Curves of the parameter plane that are preferred and end short of each other bound nothing: those in space do.
#[test]
fn curves_that_do_not_meet_give_way_to_those_in_space() {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
    let mut entities = Vec::new();
    let surface = add(&mut entities, child(128, &flat(4.0, 1.0)));
    let chain = |entities: &mut Vec<Entity<'static>>, share: f64| {
        let members: Vec<String> = (0..4)
            .map(|k| {
                let [a, b] = [corners[k], corners[(k + 1) % 4]];
                let short = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|d| a[d] + share * (b[d] - a[d]));
                add(entities, line(short(a, b), short(b, a))).to_string()
            })
            .collect();
        add(entities, child(102, &format!("4,{}", members.join(","))))
    };
    let [plane, space] = [3e-4, 0.0].map(|share| chain(&mut entities, share));
    let boundary = add(
        &mut entities,
        child(142, &format!("0,{surface},{plane},{space},1")),
    );
    add(
        &mut entities,
        entity(144, &format!("{surface},1,0,{boundary}")),
    );
    let file = read(&entities);
    assert!(
        (area(&file.patches[0].patch) - 4.0).abs() < 1e-12,
        "{:?}",
        file.notes
    );
    assert_eq!(
        notes(&file, "bound no part of the surface"),
        1,
        "{:?}",
        file.notes
    );
}
