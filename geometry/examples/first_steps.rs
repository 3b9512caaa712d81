//! From a CAD file to closest points, without a file: `cargo run -p covact-geometry --example first_steps`.
//!
//! The file is the wall of a cup, half a cylinder written as IGES by the crate itself; read it back with
//! `io::read_path(path)` from the disk.

use covact_geometry::io::{self, CadFile, LengthUnit};
use covact_geometry::nalgebra::{Isometry3, Vector3};
use covact_geometry::project::QueryError;
use covact_geometry::{Frame, Location, NurbsPatch, Status, Vec3};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Half a circle of radius 2, by two quarters, swept over a height of 3.
    let ring = [[2., 0.], [2., 2.], [0., 2.], [-2., 2.], [-2., 0.]];
    let points = [0., 3.]
        .map(|z| ring.map(|[x, y]| Vec3::new(x, y, z)))
        .concat();
    let w = 0.5f64.sqrt();
    let weights = [1., w, 1., w, 1.].repeat(2);
    let knots = [vec![0., 0., 0., 1., 1., 2., 2., 2.], vec![0., 0., 1., 1.]];
    let wall = NurbsPatch::new([2, 1], knots, [5, 2], &points, Some(&weights))?;
    let mm = LengthUnit::from_name("mm").ok_or("a unit")?;
    let text = io::write_iges(&CadFile::of(vec![wall], mm))?;

    // What is not read is named, never dropped.
    let file = io::read_iges(text.as_bytes(), "cup.igs")?;
    assert!(file.skipped.is_empty() && file.notes.is_empty());
    let surface = file.into_surface()?;

    // The closest point, on which side of the wall, and the local frame there.
    let q = Vec3::new(0.6, 0.8, 1.0);
    let foot = surface.closest(&q)?;
    println!(
        "entity {} at {:.6?}: signed distance {:.6}",
        surface.entity(foot.patch),
        foot.xi,
        foot.signed_distance
    );
    assert_eq!(
        (foot.location, foot.status),
        (Location::Face, Status::Unique)
    );
    assert!((foot.signed_distance + 1.0).abs() < 1e-12);
    let frame = Frame::new(&foot.jet, foot.side).ok_or("tangents that span a plane")?;
    assert!((frame.n - Vec3::new(0.6, 0.8, 0.0)).norm() < 1e-12);

    // The same wall, moved: poses are arguments.
    let pose = Isometry3::new(Vector3::new(10., 0., 0.), Vector3::zeros());
    let moved = (surface.set()).closest_at(&pose, &Vec3::new(10., 5., 1.), f64::INFINITY)?;
    assert!((moved.signed_distance - 3.0).abs() < 1e-12);

    // No answer, and why.
    let far = surface.closest_within(&Vec3::new(100., 0., 0.), 1.0);
    assert_eq!(far, Err(QueryError::BeyondReach { reach: 1.0 }));

    // A ray from the axis meets the wall at its radius; another such wall, turned to face it, is a length of 1 away.
    let hit = (surface.set()).first_hit(&Vec3::new(0., 0., 1.), &Vec3::new(1., 2., 0.), 10.0)?;
    assert!((hit.ok_or("a wall")?.distance - 2.0).abs() < 1e-12);
    let facing = Isometry3::new(
        Vector3::new(0., 5., 0.),
        Vector3::z() * std::f64::consts::PI,
    );
    let apart = (surface.set()).separation(surface.set(), &facing, 1e-6)?;
    assert!((apart.distance - 1.0).abs() < 1e-9 && apart.at_least > 1.0 - 2e-6);

    // Triangles within a thousandth of the radius.
    let triangles = surface.set().tessellate(2e-3)?;
    let area = 2.0 * std::f64::consts::PI * 3.0;
    assert!(triangles.deviation() <= 2e-3 && (triangles.area() / area - 1.0).abs() < 2e-3);
    println!("{} triangles", triangles.triangles().len());
    Ok(())
}
