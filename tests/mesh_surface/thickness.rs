//! Extruded surfaces against generated bodies and closed forms.
use crate::support::{Surface, close, file, grid, h8, load};
use covact::mesh::{ElementKind, Mesh, ThicknessRule, plate, sphere_panel};
use covact::scene::{MeshFile, Offset, Plate, SpherePanel, Thickness};
use covact_geometry::Vec3;
use std::f64::consts::PI;

fn a_plate(layers: u32) -> Plate {
    Plate {
        size: [3.0, 2.0],
        thickness: 0.3,
        elements: [6, 4],
        layers,
        origin: [1.0, -1.0, 0.5],
        spacing: Default::default(),
    }
}

fn its_surface() -> Surface {
    grid(6, 4, |u, v| [1.0 + 3.0 * u, -1.0 + 2.0 * v, 0.5])
}

/// The extruded surface of a plate is the generated plate: nodes, elements and sets, so that every result is the same.
#[test]
fn a_flat_surface_is_the_plate() {
    for (kind, layers) in [(ElementKind::H8, 1), (ElementKind::H8, 3)] {
        let expected = plate(&a_plate(layers), kind).unwrap();
        let wanted = MeshFile {
            layers: Some(layers),
            ..file(0.3)
        };
        let (mesh, report) = load(its_surface().inp().as_bytes(), "inp", &wanted, kind).unwrap();
        assert_eq!(report.thickness, ThicknessRule::Extruded);
        assert_eq!(mesh.connectivity, expected.connectivity);
        for (a, b) in mesh.nodes.iter().zip(&expected.nodes) {
            assert!((a - b).norm() < 1e-15, "{a} {b}");
        }
        for (name, faces) in &expected.face_sets {
            assert_eq!(mesh.face_set(name).unwrap(), faces, "{name}");
            assert_eq!(
                mesh.node_set(name).unwrap(),
                expected.node_set(name).unwrap()
            );
        }
        assert_eq!(report.element_tags.len(), mesh.elements());
        assert_eq!(report.node_tags.len(), mesh.nodes.len());
    }
}

/// The plate of quadratic elements too, whatever the order of its nodes.
#[test]
fn quadratic_elements_fill_the_same_plate() {
    let expected = plate(&a_plate(2), ElementKind::Q18).unwrap();
    let wanted = MeshFile {
        layers: Some(2),
        ..file(0.3)
    };
    let text = its_surface().inp();
    let (mesh, report) = load(text.as_bytes(), "inp", &wanted, ElementKind::Q18).unwrap();
    assert!(
        report.notes.iter().any(|n| n.contains("on straight edges")),
        "{:?}",
        report.notes
    );
    assert_eq!(mesh.elements(), expected.elements());
    assert_eq!(mesh.nodes.len(), expected.nodes.len());
    for e in 0..mesh.elements() {
        let positions = |mesh: &Mesh| -> Vec<Vec3> {
            mesh.element(e)
                .iter()
                .map(|&n| mesh.nodes[n as usize])
                .collect()
        };
        for (a, b) in positions(&mesh).iter().zip(positions(&expected)) {
            assert!((a - b).norm() < 1e-14, "{a} {b}");
        }
    }
    for name in ["top", "bottom", "x_min", "x_max", "y_min", "y_max"] {
        assert_eq!(
            mesh.face_set(name).unwrap(),
            expected.face_set(name).unwrap(),
            "{name}"
        );
        let [a, b] = [&mesh, &expected].map(|m| m.node_set(name).unwrap().len());
        assert_eq!(a, b, "{name}");
    }
}

/// A part of a floor and of a wall upon its edge, at a right angle.
fn angle(n: usize) -> Surface {
    let mut surface = grid(2 * n, n, |u, v| match u <= 0.5 {
        true => [2.0 * u, v, 0.0],
        false => [1.0, v, 2.0 * u - 1.0],
    });
    // Not in the order of the file only.
    surface.facets.reverse();
    surface
}

/// Distance of a point from the planes z = 0 and x = 1.
fn from_planes(x: &Vec3) -> [f64; 2] {
    [x.z, 1.0 - x.x]
}

/// At a right-angled fold both faces keep their distance: the corners lie at (t/2, t/2) from the edge on either side.
#[test]
fn a_right_angle_keeps_its_thickness() {
    let t = 0.2;
    for (offset, low, high) in [
        (Offset::Mid, -0.5, 0.5),
        (Offset::Top, -1.0, 0.0),
        (Offset::Bottom, 0.0, 1.0),
    ] {
        let wanted = MeshFile {
            offset: Some(offset),
            ..file(t)
        };
        let (mesh, _) = h8(&angle(4).inp(), &wanted).unwrap();
        for (set, at) in [("bottom", low), ("top", high)] {
            for &node in mesh.node_set(set).unwrap() {
                let x = mesh.nodes[node as usize];
                let [floor, wall] = from_planes(&x);
                let on = |d: f64| (d - at * t).abs() < 1e-14;
                assert!(on(floor) || on(wall), "{set}: {x}");
            }
        }
        // Plane areas of 1 x 1 on both legs, with mitred ends.
        let mean = 0.5 * (low + high) * t;
        close(mesh.volume(), 2.0 * t * (1.0 - mean), 1e-13);
    }
}

/// Legs of different thickness meet in the corner of their faces too.
#[test]
fn legs_of_different_thickness() {
    let surface = angle(3);
    let mut text = surface.inp();
    for (name, is) in [("floor", true), ("wall", false)] {
        text += &format!("*ELSET, ELSET={name}\n");
        for (k, facet) in surface.facets.iter().enumerate() {
            let flat = facet.iter().all(|&n| surface.points[n][2] == 0.0);
            if flat == is {
                text += &format!("{}\n", k + 1);
            }
        }
    }
    let sets = [("floor".to_string(), 0.1), ("wall".to_string(), 0.3)];
    let wanted = MeshFile {
        thickness: Some(Thickness::BySet(sets.into_iter().collect())),
        ..MeshFile::new("a")
    };
    let (mesh, _) = h8(&text, &wanted).unwrap();
    for (set, sign) in [("top", 1.0), ("bottom", -1.0)] {
        for &node in mesh.node_set(set).unwrap() {
            let [floor, wall] = from_planes(&mesh.nodes[node as usize]);
            let on = (floor - sign * 0.05).abs() < 1e-12 || (wall - sign * 0.15).abs() < 1e-12;
            assert!(on, "{floor} {wall}");
        }
    }
    close(mesh.volume(), 0.1 + 0.3, 1e-12);
}

/// Three faces of a cube: the corner lies at t/2 from all of them.
#[test]
fn the_corner_of_a_cube() {
    let mut surface = Surface::default();
    let n = 3;
    let mut at = std::collections::BTreeMap::new();
    for face in 0..3 {
        for j in 0..n {
            for i in 0..n {
                let corner = |i: usize, j: usize| {
                    let mut x = [0; 3];
                    x[face] = 0;
                    x[(face + 1) % 3] = i;
                    x[(face + 2) % 3] = j;
                    x
                };
                let corners = [
                    corner(i, j),
                    corner(i + 1, j),
                    corner(i + 1, j + 1),
                    corner(i, j + 1),
                ];
                let nodes = corners.map(|x| {
                    *at.entry(x).or_insert_with(|| {
                        surface.points.push(x.map(|c| c as f64));
                        surface.points.len() - 1
                    })
                });
                surface.facets.push(nodes.to_vec());
            }
        }
    }
    let t = 0.25;
    let (mesh, report) = h8(&surface.inp(), &file(t)).unwrap();
    assert!(
        !report.notes.iter().any(|n| n.contains("planes meet")),
        "{:?}",
        report.notes
    );
    for &node in mesh.node_set("top").unwrap() {
        let x = mesh.nodes[node as usize];
        let least = x.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((least - 0.5 * t).abs() < 1e-12, "{x}");
    }
    // The faces at the distance d have the area (3 - d)^2.
    let expected = (3.0 + 0.5 * t).powi(3) - (3.0 - 0.5 * t).powi(3);
    close(mesh.volume(), expected, 1e-12);
}

/// A ring of n plane facets: each is a trapezium of the true thickness, mitred with its neighbours.
#[test]
fn a_polygonal_ring_has_its_closed_volume() {
    let (n, m, r, t, length) = (24, 3, 10.0, 0.8, 6.0);
    let mut surface = Surface::default();
    for j in 0..=m {
        for i in 0..n {
            let phi = 2.0 * PI * i as f64 / n as f64;
            surface
                .points
                .push([r * phi.sin(), length * j as f64 / m as f64, r * phi.cos()]);
        }
    }
    for j in 0..m {
        for i in 0..n {
            let a = |i: usize, j: usize| i % n + n * j;
            surface
                .facets
                .push(vec![a(i, j), a(i + 1, j), a(i + 1, j + 1), a(i, j + 1)]);
        }
    }
    let (mesh, _) = h8(&surface.inp(), &file(t)).unwrap();
    let edge = 2.0 * r * (PI / n as f64).sin();
    close(mesh.volume(), n as f64 * edge * t * length, 1e-11);
    // No border along the seam.
    assert_eq!(mesh.face_set("border").unwrap().len(), 2 * n);
    assert_eq!(mesh.face_set("y_min").unwrap().len(), n);
    assert!(mesh.face_set("border_3").is_err());
}

/// The panel of a sphere from its mid-surface: volumes differ from the generated panel's by the second power of the
/// element size.
#[test]
fn a_sphere_panel_converges_to_the_generated_one() {
    let difference = |n: u32| {
        let panel = SpherePanel {
            radius: 10.0,
            thickness: 1.0,
            longitude: [-40.0, 40.0],
            latitude: [-30.0, 30.0],
            elements: [n, n],
            layers: 1,
            origin: [0.0; 3],
        };
        let expected = sphere_panel(&panel, ElementKind::H8).unwrap().volume();
        let surface = grid(n as usize, n as usize, |u, v| {
            let (lon, lat) = (
                (80.0 * u - 40.0).to_radians(),
                (60.0 * v - 30.0).to_radians(),
            );
            [
                10.0 * lat.cos() * lon.sin(),
                10.0 * lat.sin(),
                10.0 * lat.cos() * lon.cos(),
            ]
        });
        let (mesh, _) = h8(&surface.inp(), &file(1.0)).unwrap();
        for &node in mesh.node_set("top").unwrap() {
            assert!((mesh.nodes[node as usize].norm() - 10.5).abs() < 8.0 / f64::from(n * n));
        }
        (mesh.volume() - expected) / expected
    };
    let [coarse, middle, fine] = [6, 12, 24].map(difference);
    println!("{coarse:.3e} {middle:.3e} {fine:.3e}");
    assert!(fine.abs() < 2e-3);
    for rate in [coarse / middle, middle / fine] {
        assert!((3.6..4.4).contains(&rate), "{rate}");
    }
}

/// Noise of single precision in the nodes of a cylinder tilts no director, although along its axis only noise tells the
/// normals apart.
#[test]
fn noise_does_not_tilt_the_thickness() {
    let (r, t) = (10.0f64, 1.0);
    let surface = grid(12, 8, |u, v| {
        let phi = 2.0 * (u - 0.5);
        let noisy = r + 1e-6 * (7300.0 * u + 3100.0 * v).sin();
        [noisy * phi.sin(), 8.0 * v, noisy * phi.cos()]
    });
    let (mesh, _) = h8(&surface.inp(), &file(t)).unwrap();
    let count = surface.points.len();
    for k in 0..count {
        let through = mesh.nodes[k + count] - mesh.nodes[k];
        assert!(through.y.abs() < 5e-4, "{through}");
    }
}

/// A thickness that changes with the place is the true one at every node, in a plane and on a cylinder.
#[test]
fn a_field_of_thickness() {
    let field = |text: &str| MeshFile {
        thickness: Some(Thickness::Field(text.to_string())),
        ..MeshFile::new("a")
    };
    for kind in [ElementKind::H8, ElementKind::Q18] {
        let wedge = field("0.1*(x + y/2)");
        let (mesh, _) = load(its_surface().inp().as_bytes(), "inp", &wedge, kind).unwrap();
        // The integral of x/10 + y/20 over [1, 4] x [-1, 1].
        close(mesh.volume(), 1.5, 1e-13);
        for &node in mesh.node_set("top").unwrap() {
            let x = mesh.nodes[node as usize];
            close(x.z - 0.5, 0.05 * (x.x + 0.5 * x.y), 1e-14);
        }
    }
    let r = 10.0;
    let panel = grid(40, 2, |u, v| {
        let phi = 2.0 * (u - 0.5);
        [r * phi.sin(), 8.0 * v, r * phi.cos()]
    });
    let (mesh, _) = h8(&panel.inp(), &field("1 + y/8")).unwrap();
    let count = panel.points.len();
    // The two ends see one element only, whose normal is off by half its angle.
    let inner = (0..count).filter(|k| k % 41 != 0 && k % 41 != 40);
    for k in inner {
        let through = mesh.nodes[k + count] - mesh.nodes[k];
        let expected = 1.0 + panel.points[k][1] / 8.0;
        // Between two facets, each at the true distance.
        close(through.norm() * 0.025f64.cos(), expected, 1e-10);
    }

    let refused = |text: &str| {
        h8(&its_surface().inp(), &field(text))
            .unwrap_err()
            .to_string()
    };
    let text = refused("x - 1");
    assert!(
        text.contains("the thickness is 0 at (1.000000, -1.000000, 0.500000) (node 1)"),
        "{text}"
    );
    assert!(refused("sqrt(y)").contains("`sqrt(y)`"));
    assert!(refused("t").contains('t'));
}
