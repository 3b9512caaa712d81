//! Generated meshes against closed forms: volumes, areas, sets, topology, spacing; and refused input.
use covact::mesh::{
    ElementKind, Face, Mesh, MeshError, block, cylinder_panel, plate, positions, sphere_panel,
};
use covact::scene::{Block, CylinderPanel, Plate, Spacing, SpherePanel};
use std::collections::BTreeSet;
use std::f64::consts::PI;

fn a_plate() -> Plate {
    Plate {
        size: [3.0, 2.0],
        thickness: 0.1,
        elements: [4, 3],
        layers: 2,
        origin: [1.0, -1.0, 0.5],
        spacing: [Spacing::Geometric { ratio: 1.5 }, Spacing::Uniform],
    }
}

fn a_cylinder(n: u32, angles: [f64; 2]) -> CylinderPanel {
    CylinderPanel {
        radius: 10.0,
        thickness: 2.0,
        angles,
        y: [-1.0, 4.0],
        elements: [n, 2],
        layers: 2,
        origin: [1.0, 2.0, 3.0],
    }
}

fn a_sphere(n: u32, longitude: [f64; 2]) -> SpherePanel {
    SpherePanel {
        radius: 10.0,
        thickness: 1.0,
        longitude,
        latitude: [-30.0, 72.0],
        elements: [n, n],
        layers: 1,
        origin: [0.0; 3],
    }
}

fn a_block() -> Block {
    Block {
        min: [0.0, 0.0, -4.0],
        max: [2.0, 3.0, 0.0],
        elements: [4, 5, 6],
        spacing: [
            Spacing::Uniform,
            Spacing::Geometric { ratio: 0.8 },
            Spacing::Fine {
                length: 0.5,
                fine: 2,
                from_end: true,
                from_middle: false,
            },
        ],
    }
}

fn area(mesh: &Mesh, set: &str) -> f64 {
    let faces = mesh.face_set(set).unwrap();
    faces.iter().map(|&f| mesh.face_area_normal(f).0).sum()
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b}");
}

/// The sets are exactly the outer faces, each once; node sets are the nodes of the faces.
fn sets_are_complete(mesh: &Mesh, names: &[&str]) {
    assert_eq!(
        mesh.face_sets
            .keys()
            .map(String::as_str)
            .collect::<BTreeSet<_>>(),
        names.iter().copied().collect()
    );
    let aliases = ["bottom", "top"];
    let block = names.contains(&"z_min");
    let mut all: Vec<Face> = mesh
        .face_sets
        .iter()
        .filter(|(name, _)| !(block && aliases.contains(&name.as_str())))
        .flat_map(|(_, set)| set.iter().copied())
        .collect();
    all.sort();
    assert_eq!(all, mesh.outer_faces());
    for (name, faces) in &mesh.face_sets {
        assert!(!faces.is_empty() && faces.is_sorted());
        assert_eq!(mesh.node_sets[name], mesh.nodes_of(faces), "{name}");
    }
}

/// Divergence theorem: the outer faces, all outward, enclose the volume: V = 1/3 sum of x . n dA (flat faces).
fn enclosed_by_flat_faces(mesh: &Mesh) -> f64 {
    let third = |face: Face| {
        let (area, normal) = mesh.face_area_normal(face);
        mesh.nodes[mesh.face_corners(face)[0] as usize].dot(&normal) * area / 3.0
    };
    mesh.outer_faces().into_iter().map(third).sum()
}

#[test]
fn plate_has_its_volume_areas_and_sets() {
    let mesh = plate(&a_plate(), ElementKind::H8).unwrap();
    mesh.check().unwrap();
    assert_eq!((mesh.nodes.len(), mesh.elements()), (5 * 4 * 3, 4 * 3 * 2));
    close(mesh.volume(), 3.0 * 2.0 * 0.1, 1e-13);
    close(enclosed_by_flat_faces(&mesh), 0.6, 1e-12);
    close(area(&mesh, "top"), 6.0, 1e-13);
    close(area(&mesh, "x_min"), 0.2, 1e-12);
    sets_are_complete(
        &mesh,
        &["bottom", "top", "x_min", "x_max", "y_min", "y_max"],
    );
    let [low, high] = mesh.bounds();
    assert!((low - covact_geometry::Vec3::new(1.0, -1.0, 0.45)).norm() < 1e-14);
    assert!((high - covact_geometry::Vec3::new(4.0, 1.0, 0.55)).norm() < 1e-14);
    for (set, axis, sign) in [
        ("top", 2, 1.0),
        ("bottom", 2, -1.0),
        ("x_min", 0, -1.0),
        ("y_max", 1, 1.0),
    ] {
        for &face in mesh.face_set(set).unwrap() {
            close(mesh.face_area_normal(face).1[axis], sign, 1e-14);
        }
    }
}

#[test]
fn block_has_its_volume_and_both_names_for_z() {
    let mesh = block(&a_block(), ElementKind::H8).unwrap();
    mesh.check().unwrap();
    close(mesh.volume(), 24.0, 1e-13);
    close(enclosed_by_flat_faces(&mesh), 24.0, 1e-12);
    sets_are_complete(
        &mesh,
        &[
            "bottom", "top", "x_min", "x_max", "y_min", "y_max", "z_min", "z_max",
        ],
    );
    assert_eq!(mesh.face_sets["top"], mesh.face_sets["z_max"]);
    assert_eq!(mesh.face_sets["bottom"], mesh.face_sets["z_min"]);
    for &n in mesh.node_set("top").unwrap() {
        assert_eq!(mesh.nodes[n as usize].z, 0.0);
    }
}

/// A ring of chords has the exact volume reduced by sin(a)/a, a the angle of an element: error a^2/6, rate 2.
#[test]
fn cylinder_converges_to_its_volume_and_areas() {
    let exact = (70f64.to_radians() / 2.0) * (11.0f64.powi(2) - 9.0f64.powi(2)) * 5.0;
    let mut errors = Vec::new();
    for n in [4, 8, 16] {
        let mesh = cylinder_panel(&a_cylinder(n, [-20.0, 50.0]), ElementKind::H8).unwrap();
        mesh.check().unwrap();
        let a = 70f64.to_radians() / f64::from(n);
        close(mesh.volume(), exact * a.sin() / a, 1e-12);
        close(
            area(&mesh, "outer"),
            2.0 * 11.0 * f64::from(n) * (a / 2.0).sin() * 5.0,
            1e-12,
        );
        errors.push((mesh.volume() - exact).abs());
        sets_are_complete(
            &mesh,
            &["inner", "outer", "phi_min", "phi_max", "y_min", "y_max"],
        );
        for &face in mesh.face_set("outer").unwrap() {
            let center = mesh
                .face_corners(face)
                .iter()
                .map(|&n| mesh.nodes[n as usize])
                .sum::<covact_geometry::Vec3>()
                / 4.0;
            let radial =
                covact_geometry::Vec3::new(center.x - 1.0, 0.0, center.z - 3.0).normalize();
            assert!(mesh.face_area_normal(face).1.dot(&radial) > 0.999);
        }
    }
    for pair in errors.windows(2) {
        let rate = (pair[0] / pair[1]).log2();
        assert!((rate - 2.0).abs() < 0.02, "rate {rate}");
    }
}

#[test]
fn cylinder_starts_at_z_and_turns_towards_x() {
    let mut panel = a_cylinder(3, [0.0, 90.0]);
    panel.origin = [0.0; 3];
    let mesh = cylinder_panel(&panel, ElementKind::H8).unwrap();
    for &n in mesh.node_set("phi_min").unwrap() {
        assert!(mesh.nodes[n as usize].x == 0.0 && mesh.nodes[n as usize].z >= 9.0 - 1e-14);
    }
    for &n in mesh.node_set("phi_max").unwrap() {
        assert!(mesh.nodes[n as usize].z == 0.0 && mesh.nodes[n as usize].x >= 9.0 - 1e-14);
    }
}

/// Volume and outer area of a zone of a spherical shell; both converge at rate 2.
#[test]
fn sphere_converges_to_its_volume_and_areas() {
    let turn = 90f64.to_radians();
    let rise = 72f64.to_radians().sin() - (-30f64).to_radians().sin();
    let volume = turn * rise * (10.5f64.powi(3) - 9.5f64.powi(3)) / 3.0;
    let outer = turn * rise * 10.5f64.powi(2);
    let mut errors = Vec::new();
    for n in [8, 16, 32] {
        let mesh = sphere_panel(&a_sphere(n, [0.0, 90.0]), ElementKind::H8).unwrap();
        mesh.check().unwrap();
        errors.push([mesh.volume() - volume, area(&mesh, "outer") - outer].map(f64::abs));
        let names = [
            "inner",
            "outer",
            "longitude_min",
            "longitude_max",
            "latitude_min",
            "latitude_max",
        ];
        sets_are_complete(&mesh, &names);
        for &face in mesh.face_set("inner").unwrap() {
            let node = mesh.nodes[mesh.face_corners(face)[0] as usize].normalize();
            assert!(mesh.face_area_normal(face).1.dot(&node) < -0.9);
        }
        for &node in mesh.node_set("outer").unwrap() {
            close(mesh.nodes[node as usize].norm(), 10.5, 1e-14);
        }
    }
    for pair in errors.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(&pair[1]) {
            let rate = (coarse / fine).log2();
            assert!((rate - 2.0).abs() < 0.03, "rate {rate}");
        }
    }
}

/// The outer surface of a closed tube with thickness is a torus: V - E + F = 0; of a panel, a sphere: 2.
#[test]
fn full_turn_is_closed() {
    let euler = |mesh: &Mesh| {
        let faces = mesh.outer_faces();
        let mut edges = BTreeSet::new();
        for &face in &faces {
            let n = mesh.face_corners(face);
            for (a, b) in [(0, 1), (1, 3), (3, 2), (2, 0)] {
                edges.insert((n[a].min(n[b]), n[a].max(n[b])));
            }
        }
        mesh.nodes_of(&faces).len() as i64 - edges.len() as i64 + faces.len() as i64
    };
    let tube = cylinder_panel(&a_cylinder(12, [-180.0, 180.0]), ElementKind::H8).unwrap();
    tube.check().unwrap();
    assert_eq!(tube.nodes.len(), 12 * 3 * 3);
    assert_eq!(euler(&tube), 0);
    sets_are_complete(&tube, &["inner", "outer", "y_min", "y_max"]);
    let a = PI / 6.0;
    close(
        tube.volume(),
        PI * (121.0 - 81.0) * 5.0 * a.sin() / a,
        1e-12,
    );

    let open = cylinder_panel(&a_cylinder(12, [0.0, 359.0]), ElementKind::H8).unwrap();
    open.check().unwrap();
    assert_eq!(euler(&open), 2);

    let zone = sphere_panel(&a_sphere(9, [0.0, 360.0]), ElementKind::H8).unwrap();
    zone.check().unwrap();
    assert_eq!(euler(&zone), 0);
    sets_are_complete(&zone, &["inner", "outer", "latitude_min", "latitude_max"]);
    assert_eq!(zone.components(), 1);
}

#[test]
fn coarsest_curved_meshes_are_still_valid() {
    for n in [3, 4, 5] {
        cylinder_panel(&a_cylinder(n, [0.0, 360.0]), ElementKind::H8)
            .unwrap()
            .check()
            .unwrap();
        let mut sphere = a_sphere(n, [0.0, 360.0]);
        sphere.latitude = [-80.0, 80.0];
        sphere.elements = [n, 2];
        sphere_panel(&sphere, ElementKind::H8)
            .unwrap()
            .check()
            .unwrap();
    }
}

#[test]
fn spacings_fill_the_axis() {
    let lengths = |s: &[f64]| s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>();
    for ratio in [0.2, 0.999_999_9, 1.0, 1.000_000_1, 1.3, 4.0] {
        let s = positions(&Spacing::Geometric { ratio }, 7.0, 6, "x").unwrap();
        assert_eq!((s[0], s[6]), (0.0, 7.0));
        for pair in lengths(&s).windows(2) {
            close(pair[1] / pair[0], ratio, 1e-9);
        }
    }
    for from_end in [false, true] {
        let fine = Spacing::Fine {
            length: 1.0,
            fine: 5,
            from_end,
            from_middle: false,
        };
        let s = positions(&fine, 10.0, 12, "x").unwrap();
        assert_eq!((s[0], s[12]), (0.0, 10.0));
        let mut h = lengths(&s);
        if from_end {
            h.reverse();
        }
        for first in &h[..5] {
            close(*first, 0.2, 1e-12);
        }
        let growth = h[5] / h[4];
        assert!(growth > 1.3, "the rest must grow: {growth}");
        for pair in h[4..].windows(2) {
            close(pair[1] / pair[0], growth, 1e-9);
        }
        close(h.iter().sum(), 10.0, 1e-13);
    }
    // Exactly even: no growth needed; all elements fine.
    let even = Spacing::Fine {
        length: 2.0,
        fine: 2,
        from_end: false,
        from_middle: false,
    };
    close(positions(&even, 5.0, 5, "x").unwrap()[3], 3.0, 1e-9);
    let all = Spacing::Fine {
        length: 5.0,
        fine: 5,
        from_end: false,
        from_middle: false,
    };
    close(positions(&all, 5.0, 5, "x").unwrap()[3], 3.0, 1e-13);
}

/// The same on both sides of the middle, with an element there where their number is odd.
#[test]
fn spacings_grow_from_the_middle() {
    let lengths = |s: &[f64]| s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>();
    for (ratio, n) in [
        (1.3, 7u32),
        (1.3, 8),
        (0.7, 7),
        (1.0, 6),
        (1.5, 1),
        (4.0, 9),
    ] {
        let spacing = Spacing::FromMiddle { ratio };
        let h = lengths(&positions(&spacing, 7.0, n, "x").unwrap());
        close(h.iter().sum(), 7.0, 1e-13);
        let half = n as usize / 2;
        for k in 0..half {
            assert!((h[k] - h[n as usize - 1 - k]).abs() < 1e-14, "{h:?}");
        }
        let first = if n % 2 == 1 { half } else { half.max(1) };
        for pair in h[first..].windows(2) {
            close(pair[1] / pair[0], ratio, 1e-9);
        }
    }
    let fine = |length, fine, from_end| Spacing::Fine {
        length,
        fine,
        from_end,
        from_middle: true,
    };
    let s = positions(&fine(2.0, 5, false), 10.0, 11, "x").unwrap();
    let h = lengths(&s);
    close(s[3], 4.0, 1e-12);
    close(s[8], 6.0, 1e-12);
    for k in 0..3 {
        close(h[k], h[10 - k], 1e-12);
    }
    let growth = h[8] / h[7];
    assert!(growth > 1.3, "the rest must grow: {growth}");
    close(h[9] / h[8], growth, 1e-9);
    close(h[10] / h[9], growth, 1e-9);
    for (spacing, elements, part) in [
        (fine(2.0, 5, false), 12, "cannot be shared"),
        (fine(2.0, 5, true), 11, "at one place"),
    ] {
        let error = positions(&spacing, 10.0, elements, "x").unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn spacings_that_cannot_fill_are_refused() {
    let fine = |length, fine| Spacing::Fine {
        length,
        fine,
        from_end: false,
        from_middle: false,
    };
    for (spacing, elements, part) in [
        (fine(1.0, 5), 5, "unfilled"),
        (fine(10.0, 5), 6, "fill the axis"),
        (fine(9.0, 3), 20, "shorter"),
        (fine(0.001, 10), 11, "grow by more than"),
        (fine(11.0, 5), 6, "fine length is 11"),
        (fine(-1.0, 5), 6, "fine length is -1"),
        (fine(1.0, 0), 6, "0 fine elements"),
        (fine(1.0, 7), 6, "7 fine elements"),
        (fine(f64::NAN, 2), 6, "NaN"),
        (Spacing::Geometric { ratio: 0.0 }, 6, "ratio is 0"),
        (Spacing::Geometric { ratio: f64::NAN }, 6, "NaN"),
        (Spacing::Geometric { ratio: 1e9 }, 6, "no length left"),
        (Spacing::Geometric { ratio: 1e-9 }, 6, "no length left"),
    ] {
        let error = positions(&spacing, 10.0, elements, "x").unwrap_err();
        assert!(matches!(error, MeshError::Spacing { .. }));
        let text = error.to_string();
        assert!(
            text.starts_with("spacing along x: ") && text.contains(part),
            "{text}"
        );
    }
}

#[test]
fn absurd_input_is_refused_by_field() {
    let refused = |result: Result<Mesh, MeshError>, parts: &[&str]| {
        let text = result.unwrap_err().to_string();
        for part in parts {
            assert!(text.contains(part), "{text}: {part} is missing");
        }
    };
    let with = |f: &dyn Fn(&mut Plate)| {
        let mut p = a_plate();
        f(&mut p);
        plate(&p, ElementKind::H8)
    };
    refused(with(&|p| p.elements[1] = 0), &["plate", "elements[1] is 0"]);
    refused(with(&|p| p.layers = 0), &["layers is 0"]);
    refused(with(&|p| p.size[0] = -1.0), &["size[0] is -1"]);
    refused(with(&|p| p.thickness = 0.0), &["thickness is 0"]);
    refused(with(&|p| p.thickness = f64::NAN), &["thickness is NaN"]);
    refused(with(&|p| p.origin[2] = f64::INFINITY), &["origin[2]"]);
    refused(
        with(&|p| p.elements = [u32::MAX; 2]),
        &["nodes are more than the limit of 50000000"],
    );
    refused(with(&|p| p.elements = [10_000, 10_000]), &["limit"]);

    let with = |f: &dyn Fn(&mut CylinderPanel)| {
        let mut p = a_cylinder(8, [0.0, 90.0]);
        f(&mut p);
        cylinder_panel(&p, ElementKind::H8)
    };
    refused(
        with(&|p| p.thickness = 20.0),
        &["thickness is 20", "twice the radius"],
    );
    refused(with(&|p| p.angles = [0.0, 361.0]), &["angles", "360"]);
    refused(with(&|p| p.angles = [90.0, 0.0]), &["angles is [90, 0]"]);
    refused(with(&|p| p.y = [1.0, 1.0]), &["y is [1, 1]"]);
    refused(
        with(&|p| (p.angles, p.elements[0]) = ([0.0, 360.0], 2)),
        &["elements[0] is 2", "at least 3"],
    );
    refused(with(&|p| p.elements = [0, 1]), &["elements[0] is 0"]);

    let with = |f: &dyn Fn(&mut SpherePanel)| {
        let mut p = a_sphere(8, [0.0, 90.0]);
        f(&mut p);
        sphere_panel(&p, ElementKind::H8)
    };
    refused(
        with(&|p| p.latitude[1] = 90.0),
        &["latitude[1] is 90", "pole"],
    );
    refused(
        with(&|p| p.latitude[0] = -95.0),
        &["latitude[0] is -95", "pole"],
    );
    refused(with(&|p| p.radius = -3.0), &["radius is -3"]);
    refused(with(&|p| p.thickness = 21.0), &["thickness is 21"]);

    let mut b = a_block();
    b.max[1] = b.min[1];
    refused(block(&b, ElementKind::H8), &["along y"]);
    b = a_block();
    b.elements = [1 << 31, 1 << 31, 1 << 31];
    refused(block(&b, ElementKind::H8), &["limit"]);
}
