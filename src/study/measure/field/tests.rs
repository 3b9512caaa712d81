//! Places found in cells and among them, against what they were made of and against looking everywhere.
use super::cell::{Cell, Kind};
use super::tree::Tree;
use crate::fem::FaceNodes;
use crate::mesh::{ElementKind, Mesh, block};
use crate::scene::Block;
use covact_geometry::Vec3;

/// Numbers that fill [-1, 1]^3 evenly (additive recurrence of the plastic number's powers).
fn spread(i: usize) -> [f64; 3] {
    [0.819_172_513, 0.671_043_607, 0.549_700_478]
        .map(|a| 2.0 * ((i as f64 + 0.5) * a).fract() - 1.0)
}

/// A block of bent elements: straight lines become arcs.
fn bent(kind: ElementKind) -> Mesh {
    let shape = Block {
        min: [0.0, 0.0, 0.0],
        max: [1.0, 1.0, 0.2],
        elements: [3, 4, 2],
        spacing: Default::default(),
    };
    let mut mesh = block(&shape, kind).expect("a mesh");
    for x in &mut mesh.nodes {
        let (sin, cos) = (1.5 * x.x).sin_cos();
        let r = 1.0 + x.z + 0.2 * (3.0 * x.y).sin();
        *x = Vec3::new(r * sin, x.y + 0.1 * x.x * x.x, r * cos);
    }
    mesh
}

/// A block of slanted elements: the way along one direction leaves them by another.
fn slanted() -> Mesh {
    let mut mesh = bent(ElementKind::H8);
    for x in &mut mesh.nodes {
        x.x += 2.0 * x.y;
        x.y += 6.0 * x.z;
    }
    mesh
}

fn bricks(mesh: &Mesh) -> Vec<Cell> {
    (0..mesh.elements())
        .map(|e| Cell::brick(mesh.kind, mesh.element(e)))
        .collect()
}

fn faces(mesh: &Mesh) -> Vec<Cell> {
    (0..mesh.elements() as u32)
        .flat_map(|element| [2, 4, 5].map(|face| crate::mesh::Face { element, face }))
        .map(|face| {
            let nodes: FaceNodes = mesh.face_nodes(face);
            Cell::face(&nodes)
        })
        .collect()
}

/// Natural coordinates in a cell; a face has no third one.
fn natural(kind: Kind, i: usize) -> [f64; 3] {
    let [r, s, t] = spread(i);
    [r, s, if kind.layers == 1 { 0.0 } else { t }]
}

#[test]
fn natural_coordinates_are_found_again() {
    for kind in [ElementKind::H8, ElementKind::Q18] {
        let mesh = bent(kind);
        for cell in bricks(&mesh).into_iter().chain(faces(&mesh)) {
            let placed = cell.placed(&mesh.nodes);
            for i in 0..20 {
                let xi = natural(cell.kind, i);
                let p = placed.position(&cell.kind.at(xi));
                let (found, distance) = placed.nearest(&p, 1e-12);
                assert!(distance < 1e-13, "{xi:?} {distance}");
                for (a, b) in found.iter().zip(xi) {
                    assert!((a - b).abs() < 1e-10, "{found:?} {xi:?}");
                }
            }
        }
    }
}

/// The box of a cell holds all of it, also where it bulges beyond its nodes.
#[test]
fn boxes_hold_their_cells() {
    for kind in [ElementKind::H8, ElementKind::Q18] {
        let mut mesh = bent(kind);
        for (i, x) in mesh.nodes.iter_mut().enumerate() {
            *x += Vec3::from(spread(i)) * 0.04;
        }
        let mut beyond = 0;
        for cell in bricks(&mesh).iter().chain(&faces(&mesh)) {
            let placed = cell.placed(&mesh.nodes);
            let [low, high] = placed.bounds();
            let nodes = || cell.nodes().iter().map(|n| mesh.nodes[*n as usize]);
            let top = nodes().fold(low, |a, b| a.sup(&b));
            for i in 0..100 {
                let p = placed.position(&cell.kind.at(natural(cell.kind, i)));
                assert!(p.inf(&low) == low && p.sup(&high) == high);
                beyond += usize::from(p.sup(&top) != top);
            }
        }
        // Only quadratic cells bulge.
        assert_eq!(beyond > 0, kind == ElementKind::Q18, "{beyond}");
    }
}

/// Up to the distance at which fields are not compared any more, nothing along or into the cell comes nearer to a point than
/// the place that is found, and no place of a fine grid in a brick does. (Bent faces have several such places.)
#[test]
fn the_nearest_place_of_a_cell() {
    for mesh in [bent(ElementKind::H8), bent(ElementKind::Q18), slanted()] {
        let mut outside = 0;
        for cell in bricks(&mesh).iter().chain(&faces(&mesh)) {
            let placed = cell.placed(&mesh.nodes);
            let centre = placed.position(&cell.kind.at([0.0; 3]));
            let grid: Vec<Vec3> = (0..11usize.pow(3))
                .map(|k| [k % 11, k / 11 % 11, k / 121].map(|i| 0.2 * i as f64 - 1.0))
                .map(|xi| placed.position(&cell.kind.at(xi)))
                .collect();
            for i in 0..30 {
                let p = centre + Vec3::from(spread(i)) * 0.4;
                let (xi, distance) = placed.nearest(&p, 1e-12);
                assert!(xi.iter().all(|x| (-1.0..=1.0).contains(x)));
                let there = placed.position(&cell.kind.at(xi));
                assert!(((p - there).norm() - distance).abs() < 1e-14);
                let [low, high] = placed.bounds();
                if distance > 0.25 * (high - low).norm() {
                    continue;
                }
                let shape = cell.kind.at(xi);
                for i in 0..cell.kind.dimension() {
                    let nodes = cell.nodes().iter().zip(shape.d[i]);
                    let tangent: Vec3 = nodes.map(|(n, d)| mesh.nodes[*n as usize] * d).sum();
                    // Positive where the way along the tangent comes nearer; the distance is off by its square.
                    let pull = tangent.normalize().dot(&(p - there));
                    assert!(pull < 1e-4 || xi[i] == 1.0, "{xi:?} {pull}");
                    assert!(pull > -1e-4 || xi[i] == -1.0, "{xi:?} {pull}");
                }
                if cell.kind.layers == 2 {
                    let least = (grid.iter().map(|x| (p - x).norm())).fold(f64::MAX, f64::min);
                    assert!(distance < least + 1e-9, "{distance} {least}");
                }
                outside += usize::from(distance > 1e-3);
            }
        }
        assert!(outside > 100, "{outside}");
    }
}

/// The tree finds what looking at all cells finds; points of cells whose faces bulge beyond their nodes are found inside.
#[test]
fn the_nearest_of_all_cells() {
    for kind in [ElementKind::H8, ElementKind::Q18] {
        let mesh = bent(kind);
        for cells in [bricks(&mesh), faces(&mesh)] {
            let tree = Tree::new(&cells, &mesh.nodes);
            for (number, cell) in cells.iter().enumerate() {
                let placed = cell.placed(&mesh.nodes);
                for i in 0..10 {
                    // To the very faces, edges and corners.
                    let xi = natural(cell.kind, i).map(|x| (1.3 * x).clamp(-1.0, 1.0));
                    let xi = [
                        xi[0],
                        xi[1],
                        if cell.kind.layers == 1 { 0.0 } else { xi[2] },
                    ];
                    let p = placed.position(&cell.kind.at(xi));
                    let found = tree.nearest(&p, (7 * number + i) % cells.len());
                    assert!(found.distance < 1e-11, "{}", found.distance);
                    let there = cells[found.cell].placed(&mesh.nodes);
                    let there = there.position(&cells[found.cell].kind.at(found.xi));
                    assert!((there - p).norm() < 1e-11);
                }
            }
            for i in 0..60 {
                let p = Vec3::new(0.5, 0.5, 0.8) + Vec3::from(spread(i));
                let found = tree.nearest(&p, i % cells.len());
                let least = (cells.iter())
                    .map(|cell| cell.placed(&mesh.nodes).nearest(&p, 1e-12).1)
                    .fold(f64::MAX, f64::min);
                assert!(
                    (found.distance - least).abs() < 1e-9,
                    "{} {least}",
                    found.distance
                );
            }
        }
    }
}
