//! Field files read back with vtkio, and the tags that ParaView needs.
use covact::mesh::{self, ElementKind, Mesh};
use covact::output::{
    BezierError, BodyFields, CLOSED, ContactFields, Field, MAX_DEGREE, NOT_A_SLAVE, OPEN,
    OutputError, Place, Precision, SurfaceOutput, SurfacePiece, inlined, von_mises,
};
use covact::scene::Block;
use covact_geometry::{NurbsPatch, Vec3};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use std::collections::BTreeMap;
use vtkio::model::{
    Attribute, CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers, Vtk,
};

/// `n` elements in a row along x, each a unit cube.
fn row(n: u32) -> Mesh {
    let mut nodes = Vec::new();
    for k in 0..2 {
        for j in 0..2 {
            for i in 0..=n {
                nodes.push(Vec3::new(f64::from(i), f64::from(j), f64::from(k)));
            }
        }
    }
    let at = |i: u32, j: u32, k: u32| i + (n + 1) * (j + 2 * k);
    let mut connectivity = Vec::new();
    for e in 0..n {
        for (k, j, i) in (0..8).map(|c| (c >> 2, (c >> 1) & 1, c & 1)) {
            connectivity.push(at(e + i, j, k));
        }
    }
    Mesh {
        kind: ElementKind::H8,
        nodes,
        connectivity,
        node_sets: BTreeMap::new(),
        face_sets: BTreeMap::new(),
    }
}

fn read(bytes: &[u8]) -> UnstructuredGridPiece {
    let vtk = Vtk::parse_xml(&inlined(bytes).unwrap()[..]).unwrap();
    let DataSet::UnstructuredGrid { mut pieces, .. } = vtk.data else {
        panic!("not an unstructured grid");
    };
    assert_eq!(pieces.len(), 1);
    match pieces.remove(0) {
        Piece::Inline(piece) => *piece,
        other => panic!("{other:?}"),
    }
}

fn array(attributes: &[Attribute], name: &str) -> (usize, Vec<f64>) {
    let found = attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(a) if a.name == name => Some(a),
        _ => None,
    });
    let array = found.expect(name);
    (array.num_comp(), array.data.cast_into::<f64>().unwrap())
}

fn tag<'a>(text: &'a str, start: &str) -> &'a str {
    let at = text.find(start).unwrap_or_else(|| panic!("no {start}"));
    &text[at..at + text[at..].find('>').unwrap() + 1]
}

/// A quarter of the unit circle in the plane z = 0 swept along z to 2: exact cylinder.
fn quarter_cylinder(reversed: bool) -> SurfacePiece {
    let w = 0.5f64.sqrt();
    let arc = [[1.0, 0.0, 1.0], [1.0, 1.0, w], [0.0, 1.0, 1.0]];
    let points = [0.0, 2.0]
        .iter()
        .flat_map(|&z| arc.map(|[x, y, w]| [w * x, w * y, w * z, w]))
        .collect();
    SurfacePiece {
        degree: [2, 1],
        points,
        patch: 3,
        entity: 17,
        reversed,
        divisions: None,
    }
}

/// A number as it is written of fields that are in single precision.
fn single(v: f64) -> f64 {
    f64::from(v as f32)
}

/// A number with `bits` binary digits behind the leading one.
fn rounded(v: f64, bits: i32) -> f64 {
    let unit = v.abs().log2().floor().exp2() * (-f64::from(bits)).exp2();
    match v == 0.0 || !v.is_finite() {
        true => v,
        false => (v / unit).round_ties_even() * unit,
    }
}

/// Every number of a body with all of its digits, and with those that are written by default: displacements with 32 binary digits
/// behind the leading one, all else with 15, in single precision unless a number is too large for it.
#[test]
fn a_body_reads_back_as_it_was() {
    for precision in [Precision::Full, Precision::Rounded] {
        reads_back(precision);
    }
}

fn reads_back(precision: Precision) {
    let mesh = row(3);
    let n = mesh.nodes.len();
    let u: Vec<Vec3> = (0..n)
        .map(|i| Vec3::new(0.1, -0.2, 1.0 / (i as f64 + 3.0)))
        .collect();
    let stress: Vec<[f64; 6]> = (0..n)
        .map(|i| std::array::from_fn(|k| (i * 6 + k) as f64 * std::f64::consts::PI))
        .collect();
    let pressure: Vec<f64> = (0..n).map(|i| (i as f64).sqrt()).collect();
    let gap: Vec<f64> = (0..n)
        .map(|i| if i < 5 { f64::NAN } else { -1e-7 * i as f64 })
        .collect();
    let status: Vec<u8> = (0..n).map(|i| [NOT_A_SLAVE, OPEN, CLOSED][i % 3]).collect();
    let hot: Vec<f64> = pressure.iter().map(|p| p * 1e39 / 3.0).collect();
    let plastic = [0.5, 0.25, 0.125];
    let fields = BodyFields {
        name: "sheet",
        mesh: &mesh,
        displacement: &u,
        stress: Some(&stress),
        contact: Some(ContactFields {
            pressure: &pressure,
            gap: &gap,
            status: &status,
        }),
        fields: vec![
            Field::point("temperature", &hot),
            Field {
                name: "plastic_strain",
                components: 1,
                component_names: &[],
                data: &plastic,
                place: Place::Cell,
            },
        ],
        precision,
    };
    let digits = |bits: i32| {
        move |v: f64| match precision {
            Precision::Full => v,
            Precision::Rounded => rounded(v, bits),
        }
    };
    let (displacement, field) = (digits(32), digits(15));
    let bytes = fields.to_vtu(4).unwrap();
    let piece = read(&bytes);
    let flat: Vec<f64> = mesh.nodes.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    assert_eq!(piece.points.cast_into::<f64>().unwrap(), flat);
    assert_eq!(piece.cells.types, [CellType::Hexahedron; 3]);
    let VertexNumbers::XML {
        connectivity,
        offsets,
    } = &piece.cells.cell_verts
    else {
        panic!();
    };
    assert_eq!(*offsets, [8, 16, 24]);
    // VTK counts around each face: (0,0) (1,0) (1,1) (0,1).
    assert_eq!(connectivity[..8], [0, 1, 5, 4, 8, 9, 13, 12]);

    let point = &piece.data.point;
    let flat: Vec<f64> = u
        .iter()
        .flat_map(|x| [x.x, x.y, x.z])
        .map(displacement)
        .collect();
    assert_eq!(array(point, "displacement"), (3, flat));
    let flat: Vec<f64> = stress.iter().flatten().copied().map(field).collect();
    assert_eq!(array(point, "cauchy_stress"), (6, flat));
    let mises = field(von_mises(&stress[2]));
    assert_eq!(array(point, "von_mises").1[2], mises);
    let all = |data: &[f64]| (1, data.iter().copied().map(field).collect::<Vec<_>>());
    assert_eq!(array(point, "contact_pressure"), all(&pressure));
    // Too large for single precision.
    assert_eq!(array(point, "temperature"), all(&hot));
    let back = array(point, "contact_gap").1;
    let same = |(a, b): (&f64, &f64)| a.to_bits() == field(*b).to_bits();
    assert!(back.iter().zip(&gap).all(same));
    assert!(back[4].is_nan() && !back[5].is_nan());
    let status: Vec<f64> = status.iter().map(|&s| f64::from(s)).collect();
    assert_eq!(array(point, "contact_status"), (1, status));
    let cell = &piece.data.cell;
    assert_eq!(array(cell, "element"), (1, vec![0.0, 1.0, 2.0]));
    assert_eq!(array(cell, "body"), (1, vec![4.0; 3]));
    assert_eq!(array(cell, "plastic_strain"), (1, plastic.to_vec()));

    let text = &String::from_utf8_lossy(&bytes);
    let file = tag(text, "<VTKFile");
    assert!(
        file.contains("version=\"1.0\"") && file.contains("LittleEndian"),
        "{file}"
    );
    assert!(tag(text, "<PointData").contains("Vectors=\"displacement\""));
    let width = match precision {
        Precision::Full => "Float64",
        Precision::Rounded => "Float32",
    };
    let stress = tag(
        text,
        &format!("<DataArray type=\"{width}\" Name=\"cauchy_stress\""),
    );
    for (i, name) in ["XX", "YY", "ZZ", "XY", "YZ", "XZ"].iter().enumerate() {
        assert!(
            stress.contains(&format!("ComponentName{i}=\"{name}\"")),
            "{stress}"
        );
    }
    assert_eq!(text.matches("ComponentName0").count(), 1);
    assert!(!text.contains("Range") && !text.contains("NaN"));
}

/// Uniaxial stress, pure shear (sqrt(3) tau) and pressure.
#[test]
fn von_mises_of_simple_states() {
    assert_eq!(von_mises(&[-7.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 7.0);
    for k in 3..6 {
        let mut s = [0.0; 6];
        s[k] = 2.0;
        assert!((von_mises(&s) - 2.0 * 3f64.sqrt()).abs() < 1e-15);
    }
    assert_eq!(von_mises(&[5.0, 5.0, 5.0, 0.0, 0.0, 0.0]), 0.0);
}

/// A body with nothing but its displacement.
fn bare<'a>(mesh: &'a Mesh, displacement: &'a [Vec3]) -> BodyFields<'a> {
    BodyFields {
        name: "b",
        mesh,
        displacement,
        stress: None,
        contact: None,
        fields: Vec::new(),
        precision: Precision::Rounded,
    }
}

#[test]
fn fields_that_do_not_fit_are_refused() {
    let mesh = row(2);
    let u = vec![Vec3::zeros(); mesh.nodes.len()];
    let plain = bare(&mesh, &u);
    plain.to_vtu(0).unwrap();

    let short = BodyFields {
        displacement: &u[1..],
        ..plain.clone()
    };
    let text = short.to_vtu(0).unwrap_err().to_string();
    assert_eq!(
        text,
        "field `displacement` of `b` has 11 numbers where 12 are needed"
    );

    let data = vec![0.0; 24];
    let wide = Field {
        components: 2,
        ..Field::point("flux", &data)
    };
    let twice = BodyFields {
        fields: vec![wide, wide],
        ..plain.clone()
    };
    let error = twice.to_vtu(0).unwrap_err();
    assert!(
        matches!(error, OutputError::DuplicateField { .. }),
        "{error}"
    );

    let mut broken = mesh.clone();
    broken.connectivity[9] = 99;
    let broken = BodyFields {
        mesh: &broken,
        ..plain
    };
    let text = broken.to_vtu(0).unwrap_err().to_string();
    assert_eq!(
        text,
        "element 1 of `b` names node 99, but there are 12 nodes"
    );
}

#[test]
fn a_cylinder_is_exact_bezier_with_weights() {
    let surface = SurfaceOutput::new("tool", vec![quarter_cylinder(false)], 4).unwrap();
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5);
    let at = Isometry3::from_parts(Translation3::new(0.0, 0.0, 7.0), turn);
    let bytes = surface.to_vtu([&at, &at]).unwrap();
    let text = &String::from_utf8_lossy(&bytes);
    let point = tag(text, "<PointData");
    assert!(
        point.contains("RationalWeights=\"RationalWeights\""),
        "{point}"
    );
    let cell = tag(text, "<CellData");
    assert!(
        cell.contains("HigherOrderDegrees=\"HigherOrderDegrees\""),
        "{cell}"
    );
    assert!(!text.contains("Scalars="));

    let piece = read(&bytes);
    assert_eq!(piece.cells.types, [CellType::BezierQuadrilateral]);
    assert_eq!(
        array(&piece.data.cell, "HigherOrderDegrees"),
        (3, vec![2.0, 1.0, 0.0])
    );
    assert_eq!(array(&piece.data.cell, "patch"), (1, vec![3.0]));
    assert_eq!(array(&piece.data.cell, "entity"), (1, vec![17.0]));
    let w = 0.5f64.sqrt();
    assert_eq!(
        array(&piece.data.point, "RationalWeights"),
        (1, vec![1.0, 1.0, 1.0, 1.0, w, w])
    );
    // Corners first, then the middle points of the arcs, turned by 0.5 and lifted by 7.
    let x = piece.points.cast_into::<f64>().unwrap();
    let corner = [0.5f64.cos(), 0.5f64.sin(), 7.0];
    let middle = [2f64.sqrt(), std::f64::consts::FRAC_PI_4 + 0.5, 9.0];
    for k in 0..3 {
        assert!((x[k] - corner[k]).abs() < 1e-15);
    }
    assert!((x[15].hypot(x[16]) - middle[0]).abs() < 1e-15);
    assert!((x[16].atan2(x[15]) - middle[1]).abs() < 1e-15);
    assert_eq!(x[17], middle[2]);
}

/// Warped by its displacement a surface is where it is, as bodies are.
#[test]
fn a_surface_starts_at_its_first_place_and_has_its_displacement() {
    let surface = SurfaceOutput::new("tool", vec![quarter_cylinder(false)], 4).unwrap();
    let start = Isometry3::translation(0.0, 0.0, 7.0);
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5);
    let at = Isometry3::from_parts(Translation3::new(1.0, 0.0, 3.0), turn);
    let points = |grid: &UnstructuredGridPiece| grid.points.clone().cast_into::<f64>().unwrap();
    for flat in [false, true] {
        let write = |poses: [&Isometry3<f64>; 2]| {
            read(&match flat {
                false => surface.to_vtu(poses).unwrap(),
                true => surface.to_tessellated_vtu(poses).unwrap(),
            })
        };
        let moving = write([&start, &at]);
        let (there, here) = (write([&at, &at]), write([&start, &start]));
        assert_eq!(points(&moving), points(&here));
        let (components, way) = array(&moving.data.point, "displacement");
        assert_eq!(components, 3);
        for ((from, way), to) in points(&here).iter().zip(&way).zip(points(&there)) {
            assert!((single(to - from) - way).abs() < 1e-14);
        }
        assert!(way.iter().any(|w| w.abs() > 0.1));
    }
}

/// What is written of a surface a second time is what one would write that was never written before: at another place, from another
/// start, and where the way is too long for single precision.
#[test]
fn a_surface_written_again_is_as_if_written_first() {
    let new = || SurfaceOutput::new("tool", vec![quarter_cylinder(false)], 4).unwrap();
    let surface = new();
    let at = |z: f64, angle: f64| {
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, angle);
        Isometry3::from_parts(Translation3::new(1.0, 0.0, z), turn)
    };
    let [start, other] = [at(0.0, 0.0), at(2.0, 0.3)];
    let ways = [
        [start, start],
        [start, at(3.0, 0.5)],
        [start, at(1e300, 0.0)],
        [start, at(4.0, 0.5)],
        [other, at(4.0, 0.7)],
        [other, at(5.0, 0.7)],
    ];
    for [from, to] in &ways {
        let poses = [from, to];
        assert!(surface.to_vtu(poses).unwrap() == new().to_vtu(poses).unwrap());
        let flat = [&surface, &new()].map(|s| s.to_tessellated_vtu(poses).unwrap());
        assert!(flat[0] == flat[1], "{to}");
    }
    let [first, second] = [1, 3].map(|k| surface.to_vtu([&ways[k][0], &ways[k][1]]).unwrap());
    assert!(first != second);
}

/// Programs that know version 1.0 only read all bodies, those of quadratic bricks included, and tessellated surfaces. Where cells end
/// in the list of their nodes is told in signed numbers, without which meshio 5.3 stops at cells of a degree of their own.
#[test]
fn only_bezier_cells_need_a_later_version() {
    let quadratic = Block {
        min: [0.0; 3],
        max: [2.0, 1.0, 0.1],
        elements: [2, 1, 1],
        spacing: Default::default(),
    };
    let mesh = mesh::block(&quadratic, ElementKind::Q18).unwrap();
    let u = vec![Vec3::zeros(); mesh.nodes.len()];
    let body = bare(&mesh, &u);
    let surface = SurfaceOutput::new("tool", vec![quarter_cylinder(false)], 4).unwrap();
    let identity = Isometry3::identity();
    let version = |bytes: Vec<u8>, version: &str| {
        let text = String::from_utf8_lossy(&bytes);
        let file = tag(&text, "<VTKFile").to_owned();
        assert!(file.contains(&format!(" version=\"{version}\"")), "{file}");
    };
    version(body.to_vtu(0).unwrap(), "1.0");
    let bytes = body.to_vtu(0).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for name in ["connectivity", "offsets"] {
        let array = tag(&text, &format!("<DataArray type=\"Int64\" Name=\"{name}\""));
        assert!(array.contains("appended"), "{array}");
    }
    let cells = read(&bytes).cells;
    assert_eq!(cells.types, [CellType::LagrangeHexahedron; 2]);
    version(surface.to_vtu([&identity; 2]).unwrap(), "2.2");
    version(surface.to_tessellated_vtu([&identity; 2]).unwrap(), "1.0");
}

#[test]
fn the_tessellation_lies_on_the_surface_with_outward_normals() {
    for reversed in [false, true] {
        let piece = quarter_cylinder(reversed);
        let surface = SurfaceOutput::new("tool", vec![piece], 5).unwrap();
        let at = Isometry3::rotation(nalgebra::Vector3::z() * 0.3);
        let bytes = surface.to_tessellated_vtu([&at, &at]).unwrap();
        let grid = read(&bytes);
        assert_eq!(grid.cells.types, [CellType::Quad; 25]);
        assert_eq!(array(&grid.data.cell, "patch").1, [3.0; 25]);
        let x = grid.points.cast_into::<f64>().unwrap();
        let (components, n) = array(&grid.data.point, "normal");
        assert_eq!((components, x.len(), n.len()), (3, 108, 108));
        // rho_1 x rho_2 points away from the axis.
        let sign = if reversed { -1.0 } else { 1.0 };
        for (x, n) in x.chunks_exact(3).zip(n.chunks_exact(3)) {
            assert!((x[0].hypot(x[1]) - 1.0).abs() < 1e-15);
            let half = 0.5 * f64::from(f32::EPSILON);
            assert!((n[0] - sign * x[0]).abs() < half);
            assert!((n[1] - sign * x[1]).abs() < half);
            assert!(n[2].abs() < 1e-15);
        }
        // The cells' own orientation is the normals'.
        let VertexNumbers::XML { connectivity, .. } = &grid.cells.cell_verts else {
            panic!();
        };
        for quad in connectivity.chunks_exact(4) {
            let p = |k: usize| Vec3::from_column_slice(&x[3 * quad[k] as usize..][..3]);
            let normal = (p(1) - p(0)).cross(&(p(3) - p(0)));
            let first = 3 * quad[0] as usize;
            assert!(normal.dot(&Vec3::from_column_slice(&n[first..first + 3])) > 0.0);
        }
    }
}

/// An octant of the unit sphere whose side u = 1 is drawn together to the pole.
#[test]
fn the_normal_at_a_pole_is_that_of_the_sphere() {
    let w = 0.5f64.sqrt();
    let arc = [(1.0, 0.0, 1.0), (1.0, 1.0, w), (0.0, 1.0, 1.0)];
    let points = arc
        .iter()
        .flat_map(|&(x, y, wv)| {
            arc.map(|(r, z, wu)| [r * x * wu * wv, r * y * wu * wv, z * wu * wv, wu * wv])
        })
        .collect();
    let piece = SurfacePiece {
        degree: [2, 2],
        points,
        patch: 0,
        entity: 0,
        reversed: true,
        divisions: None,
    };
    let surface = SurfaceOutput::new("ball", vec![piece], 6).unwrap();
    let identity = Isometry3::identity();
    let grid = read(&surface.to_tessellated_vtu([&identity; 2]).unwrap());
    let x = grid.points.cast_into::<f64>().unwrap();
    let n = array(&grid.data.point, "normal").1;
    let mut poles = 0;
    for (x, n) in x.chunks_exact(3).zip(n.chunks_exact(3)) {
        // Beside the pole the normal is taken 5e-8 (in parameters) away.
        let pole = x[2] > 1.0 - 1e-12;
        let tolerance = if pole {
            2e-7
        } else {
            0.5 * f64::from(f32::EPSILON)
        };
        poles += usize::from(pole);
        for k in 0..3 {
            assert!((x[k] - n[k]).abs() < tolerance, "{x:?} {n:?}");
        }
    }
    assert_eq!(poles, 7);
}

/// The full sphere of nine by five control points (Piegl and Tiller 1997, "The NURBS Book", section 8.3): four by two
/// spans, exact.
#[test]
fn a_patch_of_several_spans_becomes_pieces_of_the_same_sphere() {
    let w = 0.5f64.sqrt();
    let circle = [1, 1, 0, -1, -1, -1, 0, 1, 1].map(f64::from);
    let half = [(0.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (j, (r, z)) in half.into_iter().enumerate() {
        for i in 0..9 {
            // The y coordinates are the x coordinates a quarter turn on.
            let (x, y) = (circle[i], circle[if i < 8 { (i + 6) % 8 } else { 6 }]);
            points.push(Vec3::new(r * x, r * y, z));
            weights.push([1.0, w][i % 2] * [1.0, w][j % 2]);
        }
    }
    let knots = [
        vec![0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.],
        vec![0., 0., 0., 1., 1., 2., 2., 2.],
    ];
    let patch = NurbsPatch::new([2, 2], knots, [9, 5], &points, Some(&weights)).unwrap();
    let pieces = SurfacePiece::of_patch(&patch, 5, 31, false);
    assert_eq!(pieces.len(), 8);
    let surface = SurfaceOutput::new("ball", pieces, 6).unwrap();
    let identity = Isometry3::identity();
    let exact = read(&surface.to_vtu([&identity; 2]).unwrap());
    assert_eq!(exact.cells.types, [CellType::BezierQuadrilateral; 8]);
    assert_eq!(array(&exact.data.cell, "entity").1, [31.0; 8]);
    let flat = read(&surface.to_tessellated_vtu([&identity; 2]).unwrap());
    assert_eq!(flat.cells.num_cells(), 8 * 36);
    let x = flat.points.cast_into::<f64>().unwrap();
    let n = array(&flat.data.point, "normal").1;
    for (x, n) in x.chunks_exact(3).zip(n.chunks_exact(3)) {
        let (x, n) = (Vec3::from_column_slice(x), Vec3::from_column_slice(n));
        assert!((x.norm() - 1.0).abs() < 1e-14);
        assert!((x - n).norm() < 2e-7, "{x} {n}");
    }
}

#[test]
fn pieces_that_vtk_cannot_hold_are_named() {
    let flat = |degree: [usize; 2]| SurfacePiece {
        degree,
        points: (0..=degree[1])
            .flat_map(|j| (0..=degree[0]).map(move |i| [i as f64, j as f64, 0.0, 1.0]))
            .collect(),
        patch: 0,
        entity: 0,
        reversed: false,
        divisions: None,
    };
    let pieces = vec![
        flat([1, 1]),
        flat([2, MAX_DEGREE + 1]),
        flat([MAX_DEGREE, 3]),
    ];
    let surface = SurfaceOutput::new("s", pieces, 1).unwrap();
    assert_eq!(surface.left_out(), [1]);
    let identity = Isometry3::identity();
    assert_eq!(
        read(&surface.to_vtu([&identity; 2]).unwrap())
            .cells
            .num_cells(),
        2
    );
    let copy = read(&surface.to_tessellated_vtu([&identity; 2]).unwrap());
    assert_eq!(copy.cells.num_cells(), 3);

    let mut bad = flat([2, 2]);
    bad.points[4][3] = 0.0;
    let error = SurfaceOutput::new("s", vec![flat([1, 1]), bad], 1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "piece 1 of surface `s`: control point 4 has weight 0, which is not positive"
    );
    let mut bad = flat([2, 2]);
    bad.points.pop();
    let error = SurfaceOutput::new("s", vec![bad], 1).unwrap_err();
    let OutputError::Piece { reason, .. } = error else {
        panic!("{error:?}");
    };
    assert!(matches!(
        reason,
        BezierError::PointCount {
            expected: 9,
            found: 8,
            ..
        }
    ));
}
