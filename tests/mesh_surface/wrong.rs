//! Wrong files: where, what was expected, what was found; and no work beyond the file's length.
use crate::support::{file, load};
use covact::mesh::{ElementKind, MeshError};
use std::time::{Duration, Instant};

fn refused(text: &str, extension: &str) -> String {
    let start = Instant::now();
    let error = load(text.as_bytes(), extension, &file(0.1), ElementKind::H8).unwrap_err();
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    let text = error.to_string();
    assert!(text.len() < 600, "{text}");
    text
}

#[track_caller]
fn told(text: &str, extension: &str, message: &str) {
    let found = refused(text, extension);
    assert!(
        found.starts_with(&format!("a.{extension}:{message}")),
        "{found}"
    );
}

#[test]
fn nastran_names_the_field() {
    let grids = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\n";
    let more = |line: &str| format!("{grids}{line}\n");
    for (line, message) in [
        (
            "CTRIA3,1,1,1,2,9",
            "4:16: expected the number of a node of this file, found node 9 in element 1",
        ),
        (
            "CTRIA3,1,1,1,2",
            "4:1: expected 3 nodes of element 1, found nothing",
        ),
        (
            "CTRIA3  1       1       1       x       3",
            "4:33: expected 3 nodes of element 1, found x",
        ),
        (
            "CQUAD4,one,1,1,2,3,3",
            "4:8: expected the number of an element, found one",
        ),
        (
            "CTRIA3,1,1,1,2,3\nCTRIA3,1,1,1,2,3",
            "5:8: expected an element number used once, found 1",
        ),
        (
            "GRID    3",
            "4:9: expected a node number used once, found 3",
        ),
        (
            "GRID,4,,0.,1.x,0.",
            "4:12: expected a coordinate, found 1.x",
        ),
        (
            "GRID,4,7,0.,1.,0.",
            "4:8: a node in the coordinate system 7 is not supported",
        ),
        (
            "GRDSET,,7",
            "4:9: a node in the coordinate system 7 is not supported",
        ),
        ("INCLUDE 'other.bdf'", "4:1: INCLUDE is not supported"),
    ] {
        told(&more(line), "bdf", message);
    }
    let text = refused(&more("CTETRA,1,1,1,2,3,3"), "bdf");
    assert!(
        text.contains("no quadrilaterals or triangles in this file (its elements: 1 CTETRA)"),
        "{text}"
    );
}

#[test]
fn vtk_names_line_and_column() {
    let head = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    for (text, message) in [
        (
            "hello\n".to_string(),
            "1:1: expected `# vtk DataFile Version`, found `hello`",
        ),
        (
            "# vtk DataFile Version 3.0\nt\nTEXT\n".into(),
            "3:1: expected ASCII or BINARY, found `TEXT`",
        ),
        (
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n".into(),
            "4:9: the dataset `STRUCTURED_POINTS` is not supported",
        ),
        (
            format!("{head}POINTS 1 double\n0 0 x\n"),
            "6:5: expected a coordinate, found `x`",
        ),
        (
            format!("{head}POINTS 1 triple\n"),
            "5:10: expected a type such as double or int, found `triple`",
        ),
        (
            format!("{head}POINTS 100000000000 double\n0 0 0\n"),
            "5:27: expected a coordinate, found the end after at most",
        ),
        (
            format!(
                "{head}POINTS 3 double\n0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 5\nCELL_TYPES 1\n5\n"
            ),
            "7:1: expected points of cell 0 from 0 to 2, found 5",
        ),
        (
            format!("{head}POINTS 3 double\n0 0 0 1 0 0 0 1 0\nCELLS 2 4\n3 0 1 2\n"),
            "7:1: expected 2 cells in 4 numbers, found 1 cells",
        ),
        (
            format!(
                "{head}POINTS 3 double\n0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n9\n"
            ),
            "7:1: expected the points of cell 0, one of quadrilaterals, found 3",
        ),
        (
            format!("{head}POINTS 0 double\n\nRUBBISH 3\n"),
            "7:1: expected POINTS, CELLS",
        ),
    ] {
        told(&text, "vtk", message);
    }
    let tetrahedron =
        "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
    let text = refused(&format!("{head}{tetrahedron}"), "vtk");
    assert!(text.contains("(its elements: 1 tetrahedra)"), "{text}");
    // A hole in place of a polygon would be no mesh of the part.
    let polygons = "POINTS 6 double\n0 0 0 1 0 0 0 1 0 1 1 0 .5 2 0 1 2 0\nCELLS 2 10\n3 0 1 2\n5 1 3 5 4 2\nCELL_TYPES 2\n5 7\n";
    let text = refused(&format!("{head}{polygons}"), "vtk");
    assert!(
        text.contains("a polygon of 5 points is not supported"),
        "{text}"
    );
}

#[test]
fn vtu_names_line_and_column() {
    let file = |kind: &str, points: &str, cells: &str| {
        format!(
            "<VTKFile type=\"{kind}\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"3\" NumberOfCells=\"1\">\n<Points>\n\
             <DataArray type=\"Float64\" NumberOfComponents=\"3\" {points}</DataArray>\n</Points>\n<Cells>\n{cells}</Cells>\n\
             </Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
        )
    };
    let grid = "UnstructuredGrid";
    let points = "format=\"ascii\">0 0 0\n1 0 0\n0 1 0";
    let cells = "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\n\
                 <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>\n\
                 <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5</DataArray>\n";
    let whole = file(grid, points, cells);
    assert!(
        load(
            whole.as_bytes(),
            "vtu",
            &crate::support::file(0.1),
            ElementKind::H8
        )
        .is_ok()
    );
    for (text, message) in [
        (
            file("PolyData", points, cells),
            "1:1: VTK data of the type `PolyData` is not supported",
        ),
        (
            file(grid, "format=\"ascii\">0 0 0\n1 0 x\n0 1 0", cells),
            "6:5: expected 9 numbers of the array ``, found `x`",
        ),
        (
            file(grid, "format=\"ascii\">0 0 0\n1 0 0", cells),
            "5:65: expected 9 numbers of the array ``, found the end after at most 6 of 9 numbers",
        ),
        (
            file(grid, points, &cells.replace("types", "kinds")),
            "3:1: expected an array `types`, found none",
        ),
        (
            file(grid, points, &cells.replace(">0 1 2", ">0 1 7")),
            "1:1: expected points of cell 0 from 0 to 2, found 7",
        ),
        (
            file(grid, "format=\"binary\">!!!!", cells),
            "5:1: expected base64 data with their length",
        ),
        (
            file(grid, "format=\"appended\" offset=\"3\">", cells),
            "5:1: expected appended data, found none",
        ),
        (
            "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkLZ4DataCompressor\">".into(),
            "1:1: the compressor",
        ),
        ("<a><b></a>".into(), "1:7: expected XML"),
        (
            whole.replace("NumberOfPoints=\"3\"", "NumberOfPoints=\"300000000\""),
            "5:65: expected 900000000 numbers of the array ``, found the end after at most 9 of 900000000",
        ),
    ] {
        told(&text, "vtu", message);
    }
    assert!(matches!(
        load(
            b"nothing",
            "vtu",
            &crate::support::file(0.1),
            ElementKind::H8
        ),
        Err(MeshError::Syntax { .. })
    ));
}

#[test]
fn gmsh_2_names_line_and_column() {
    let head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    let nodes = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
    for (text, message) in [
        (
            format!("{head}$Nodes\n1000000000\n1 0 0 0\n"),
            "5:1: expected a number of nodes that the rest of the file can hold",
        ),
        (
            format!("{head}$Nodes\n1\n-1 0 0 0\n$EndNodes\n"),
            "6:1: expected a node number, found -1",
        ),
        (
            format!("{head}$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n"),
            "7:1: expected a node number used once, found 1 again",
        ),
        (
            format!("{head}{nodes}$Elements\n1\n1 2 2 0 1 1 2 4\n"),
            "12:15: expected the number of a node in $Nodes, found 4",
        ),
        (
            format!("{head}{nodes}$Elements\n1\n1 99 0\n"),
            "12:3: gmsh element type 99 is not supported",
        ),
        (
            format!("{head}{nodes}$Elements\n1\n1 2 1000000\n"),
            "12:5: expected a number of tags, found 1000000",
        ),
        (
            format!("{head}$Elements\n0\n$EndElements\n"),
            "4:1: expected a section $Nodes before $Elements",
        ),
    ] {
        told(&text, "msh", message);
    }
}

#[test]
fn stl_names_the_line() {
    told(
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n",
        "stl",
        "4:1: expected a number, found",
    );
}

/// Instances and sets of sets make long meshes of short files only up to a bound.
#[test]
fn instances_do_not_explode() {
    let mut part = "*PART, NAME=P\n*NODE\n".to_string();
    for k in 0..2000 {
        part += &format!("{k}, {k}, 0, 0\n");
    }
    part += "*ELEMENT, TYPE=S3\n1, 0, 1, 2\n*END PART\n*ASSEMBLY, NAME=A\n";
    for k in 0..1000 {
        part += &format!("*INSTANCE, NAME=I{k}, PART=P\n*END INSTANCE\n");
    }
    let text = refused(&part, "inp");
    assert!(text.contains("64 for each node and element"), "{text}");
}

/// Many layers need the memory of a large mesh, which is asked for before it is taken.
#[test]
fn layers_are_bounded() {
    let grid = crate::support::grid(300, 300, |u, v| [u, v, 0.0]);
    let mut wanted = file(0.1);
    wanted.layers = Some(1000);
    let error = crate::support::h8(&grid.inp(), &wanted).unwrap_err();
    assert!(matches!(error, MeshError::TooManyNodes { .. }), "{error}");
}
