//! Points and cells that a program gives are what a file of the same content is.
use crate::support::{file, grid, h8};
use covact::mesh::{ElementKind, Mesh, MeshError, MeshReport, build};
use covact::scene::{MeshCells, MeshSource};
use std::path::Path;

/// 4 x 3 quadrilaterals over a part of a cylinder, the first two of them in a set.
fn cells() -> MeshCells {
    let surface = grid(4, 3, |u, v| [u.cos(), u.sin(), v]);
    let corners: Vec<i64> = (surface.facets.iter().flatten())
        .map(|n| *n as i64)
        .collect();
    MeshCells {
        points: surface.points,
        ends: (1..=12).map(|k| 4 * k).collect(),
        types: vec![9; 12],
        connectivity: corners,
        cell_sets: [("first".to_owned(), vec![0, 1])].into(),
        point_sets: [("pin".to_owned(), vec![0])].into(),
        file: file(0.1),
    }
}

fn made(cells: MeshCells) -> Result<(Mesh, MeshReport), MeshError> {
    build(&MeshSource::from(cells), ElementKind::H8, Path::new("."))
}

#[test]
fn cells_in_memory_are_those_of_a_file() {
    let (mesh, report) = made(cells()).unwrap();
    let more = "*ELSET, ELSET=first\n1, 2\n*NSET, NSET=pin\n1\n";
    let text = grid(4, 3, |u, v| [u.cos(), u.sin(), v]).inp() + more;
    let (expected, _) = h8(&text, &file(0.1)).unwrap();
    assert_eq!(mesh.nodes, expected.nodes);
    assert_eq!(mesh.connectivity, expected.connectivity);
    assert_eq!(mesh.face_set("first_top").unwrap().len(), 2);
    assert_eq!(
        mesh.face_set("first_top").unwrap(),
        expected.face_set("first_top").unwrap()
    );
    // Through the thickness.
    assert_eq!(mesh.node_set("pin").unwrap().len(), 2);
    assert_eq!(report.element_tags.len(), 12);
}

#[test]
fn what_cannot_be_cells_is_named() {
    let fails = |change: &dyn Fn(&mut MeshCells), told: &str| {
        let mut cells = cells();
        change(&mut cells);
        let error = made(cells).expect_err("no mesh").to_string();
        assert!(error.contains(told), "{error}");
    };
    fails(&|c| c.connectivity[5] = 99, "points of cell 1 from 0 to 19");
    fails(&|c| c.ends[3] = 2, "the end of cell 3");
    fails(&|c| c.types[0] = 99, "cell type 99");
    fails(&|c| c.types.truncate(5), "12 cell types");
    fails(
        &|c| {
            c.cell_sets.insert("far".to_owned(), vec![12]);
        },
        "`far`",
    );
    fails(
        &|c| {
            c.point_sets.insert("away".to_owned(), vec![20]);
        },
        "`away`",
    );
    fails(&|c| c.file.thickness = None, "thickness");
}
