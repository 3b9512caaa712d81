//! CAD and mesh files that are missing, damaged or hold something else.
use crate::support::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("assets")
        .join(name)
}

/// A folder with this file.
fn folder_with(name: &str, content: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    folder
}

fn text_of(name: &str) -> String {
    std::fs::read_to_string(asset(name)).unwrap()
}

fn cad(file: &str) -> [(&'static str, Value); 1] {
    [("/surfaces/ball", json!({ "cad": { "file": file } }))]
}

const FILE: &str = "/surfaces/ball/cad/file";

#[test]
fn a_missing_cad_file() {
    let folder = folder_with("punch.igs", "");
    plate_refused_in(
        folder.path(),
        &cad("punsh.igs"),
        FILE,
        &[
            "there is no file `./punsh.igs`",
            "help: did you mean `punch.igs`?",
        ],
    );
}

#[test]
fn a_truncated_iges_file() {
    let whole = text_of("punch.igs");
    // In the middle of a line: the place is the file's own.
    let part = &whole[..9000];
    let folder = folder_with("punch.igs", part);
    let line = part.lines().count();
    plate_refused_in(
        folder.path(),
        &cad("punch.igs"),
        FILE,
        &[
            &format!("punch.igs:{line}:"),
            "expected an IGES record of 80 columns, found a line of",
            "help: line and column are those of the CAD file: it is damaged or cut off",
        ],
    );
    // Between two lines.
    let lines: Vec<&str> = whole.lines().take(60).collect();
    let folder = folder_with("punch.igs", &(lines.join("\n") + "\n"));
    plate_refused_in(
        folder.path(),
        &cad("punch.igs"),
        FILE,
        &[
            "punch.igs:6",
            "the file is cut off",
            "found the end of the file",
        ],
    );
    let folder = folder_with("punch.igs", "");
    plate_refused_in(
        folder.path(),
        &cad("punch.igs"),
        FILE,
        &[
            "punch.igs: expected a STEP or IGES file",
            "found an empty file",
        ],
    );
}

#[test]
fn skipped_surfaces_are_refused() {
    // A face whose boundary curves are gone.
    let whole = text_of("cad/trimmed_patch_faces.igs");
    let lines = whole.lines().map(|line| match line.starts_with("142,") {
        true => format!("{:<64}{}\n", "142,0,3,0,0,3;", &line[64..]),
        false => format!("{line}\n"),
    });
    let folder = folder_with("tool.igs", &lines.collect::<String>());
    plate_refused_in(
        folder.path(),
        &cad("tool.igs"),
        FILE,
        &[
            "tool.igs: 1 of 1 surface(s) cannot be used: entity 1 (144 Trimmed (Parametric) Surface): entity ",
            "has neither a curve in the parameter plane nor one in space",
            "`allow_skipped`",
        ],
    );
    // Nothing is left when they may be skipped.
    let mut change = cad("tool.igs");
    change[0].1["cad"]["allow_skipped"] = json!(true);
    plate_refused_in(
        folder.path(),
        &change,
        FILE,
        &["holds no surface that can be used: entity 1", "neither"],
    );
}

#[test]
fn bodies_are_chosen_by_name() {
    // The box is one body, which has the name of its product.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/tests/data/step/box.step");
    let whole = std::fs::read_to_string(path).unwrap();
    let name = "Open CASCADE STEP translator 7.9 6";
    let folder = folder_with("tool.step", &whole);
    let mut change = cad("tool.step");
    change[0].1["placement"] = json!({ "translation": [0, 0, 8] });
    change[0].1["cad"]["bodies"] = json!(["Open CASCADE STEP translator 7.9 7"]);
    plate_refused_in(
        folder.path(),
        &change,
        "/surfaces/ball/cad/bodies",
        &["tool.step has no body or product", "did you mean", name],
    );
    change[0].1["cad"]["bodies"] = json!([name]);
    write_plate(folder.path(), &change);
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_parts(&stdout(&output), &["patches         6, all connected"]);
}

#[test]
fn a_surface_with_one_side_takes_no_contact() {
    let folder = folder_with("band.json", &moebius_band());
    let mut change = cad("band.json");
    change[0].1["placement"] = json!({ "translation": [0, 0, 8] });
    plate_refused_in(
        folder.path(),
        &change,
        "/surfaces/ball",
        &[
            "surface `ball` has one side only",
            "entity 4 and entity 5 cannot be given the same outside",
            "contact needs an outside",
        ],
    );
}

#[test]
fn skipped_surfaces_can_be_left_out() {
    // A quarter of a cylinder, entity 2, and a trimmed plane, entity 3.
    let folder = folder_with("tool.cad.json", &text_of("cad/quarter_cylinder.cad.json"));
    let mut change = cad("tool.cad.json");
    change[0].1["placement"] = json!({ "translation": [0, 0, 8] });
    plate_refused_in(
        folder.path(),
        &change,
        FILE,
        &["1 of 2 surface(s) cannot be used: entity 3", "trimmed"],
    );
    for (key, value, warnings) in [
        ("allow_skipped", json!(true), 1),
        // Naming what is wanted leaves the rest out without a word.
        ("entities", json!([2]), 0),
    ] {
        let mut change = change.clone();
        change[0].1["cad"][key] = value;
        write_plate(folder.path(), &change);
        let output = covact(folder.path(), &["check", "scene.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert_parts(&stdout(&output), &["patches         1, all connected"]);
        let told = stderr(&output);
        assert_eq!(told.matches("left out").count(), warnings, "{told}");
        if warnings > 0 {
            assert_parts(
                &told,
                &["warning: surface `ball`: 1 surface(s) of tool.cad.json left out: entity 3"],
            );
        }
    }
}

#[test]
fn an_entity_that_is_not_there() {
    let folder = folder_with("punch.igs", &text_of("punch.igs"));
    let mut change = cad("punch.igs");
    change[0].1["cad"]["entities"] = json!([1, 2]);
    plate_refused_in(
        folder.path(),
        &change,
        "/surfaces/ball/cad/entities",
        &[
            "punch.igs has no surface entity 2",
            "help: surface entities of this file: 1, 3, 5, 7, 9,",
        ],
    );
}

/// Two hexahedra side by side in gmsh's format, with the surfaces `top` and `bottom`.
const TWO: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 \"top\"
2 2 \"bottom\"
$EndPhysicalNames
$Entities
0 0 2 1
1 0 0 1 2 1 1 1 1 0
2 0 0 0 2 1 0 1 2 0
1 0 0 0 2 1 1 0 2 1 2
$EndEntities
$Nodes
1 12 1 12
3 1 0 12
1
2
3
4
5
6
7
8
9
10
11
12
0 0 0
1 0 0
2 0 0
0 1 0
1 1 0
2 1 0
0 0 1
1 0 1
2 0 1
0 1 1
1 1 1
2 1 1
$EndNodes
$Elements
3 6 1 6
2 1 3 2
1 7 8 11 10
2 8 9 12 11
2 2 3 2
3 1 2 5 4
4 2 3 6 5
3 1 5 2
5 1 2 5 4 7 8 11 10
6 2 3 6 5 8 9 12 11
$EndElements
";

/// The plate's mesh from a file, held at its bottom.
fn from_file() -> [(&'static str, Value); 3] {
    [
        (
            "/bodies/plate/mesh",
            json!({ "file": { "path": "two.msh" } }),
        ),
        (
            "/supports",
            json!({ "held": { "on": "plate.bottom", "fixed": true } }),
        ),
        (
            "/surfaces/ball/sphere",
            json!({ "radius": 5, "center": [1, 0.5, 6] }),
        ),
    ]
}

const PATH: &str = "/bodies/plate/mesh/file/path";

#[test]
fn a_mesh_file_that_is_right() {
    let folder = folder_with("two.msh", TWO);
    write_plate(folder.path(), &from_file());
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_parts(&stdout(&output), &["2 elements, 12 nodes"]);
}

#[test]
fn a_missing_mesh_file() {
    let folder = folder_with("too.msh", TWO);
    plate_refused_in(
        folder.path(),
        &from_file(),
        PATH,
        &["there is no file `./two.msh`", "did you mean `too.msh`?"],
    );
}

#[test]
fn a_mesh_with_inverted_elements() {
    // A node of the top, shared by both elements, lies below the bottom.
    let folder = folder_with("two.msh", &TWO.replace("\n1 1 1\n", "\n1 1 -0.5\n"));
    plate_refused_in(
        folder.path(),
        &from_file(),
        PATH,
        &[
            "two.msh: element 0 (number 5 in the file) at (0.500000, 0.500000, 0.312500) is inverted or degenerate",
            "2 element(s) in all",
            "help: look at these elements in the mesher",
        ],
    );
}

#[test]
fn a_damaged_mesh_file() {
    let cut = &TWO[..TWO.find("0 1 1\n").unwrap()];
    let folder = folder_with("two.msh", cut);
    let message = plate_refused_in(folder.path(), &from_file(), PATH, &["two.msh:", "expected"]);
    // The file's own line.
    let at = message.find("two.msh:").unwrap() + "two.msh:".len();
    let line: usize = message[at..].split(':').next().unwrap().parse().unwrap();
    assert!((16..=cut.lines().count() + 1).contains(&line), "{message}");
    let old = text_of("mesh/plate_version_2.msh").replacen("2.2 0 8", "4 0 8", 1);
    let folder = folder_with("two.msh", &old);
    plate_refused_in(
        folder.path(),
        &from_file(),
        PATH,
        &["two.msh:2:1: gmsh format version 4 is not supported: write the mesh with"],
    );
    let folder = folder_with("two.msh", &text_of("mesh/tetrahedra.msh"));
    plate_refused_in(
        folder.path(),
        &from_file(),
        PATH,
        &[
            "two.msh:",
            "tetrahedra",
            "is not supported: elements are hexahedra",
        ],
    );
}

#[test]
fn sets_of_a_mesh_file() {
    let folder = folder_with("two.msh", TWO);
    let mut changes = from_file().to_vec();
    changes.push((
        "/supports/held",
        json!({ "on": "plate.botom", "fixed": true }),
    ));
    plate_refused_in(
        folder.path(),
        &changes,
        "/supports/held/on",
        &["no node set `botom` (did you mean `bottom`?); node sets: bottom, top"],
    );
    let mut changes = from_file().to_vec();
    changes.push(("/contacts/press/slave", json!("plate.tops")));
    plate_refused_in(
        folder.path(),
        &changes,
        "/contacts/press/slave",
        &["no face set `tops` (did you mean `top`?)"],
    );
}

#[test]
fn facets_that_cannot_be() {
    let folder = folder_with(
        "tool.stl",
        "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 9\nvertex 9 0 9\nvertex 0 9 9\nendloop\nendfacet\nendsolid t\n",
    );
    for (file, facets, pointer, parts) in [
        (
            asset("die.igs"),
            json!({ "kind": "bilinear", "size": 1 }),
            "/surfaces/ball/facets",
            [
                "is trimmed, and trimmed patches cannot be cut into facets",
                "help: leave out `facets`",
            ],
        ),
        (
            "tool.stl".into(),
            json!({ "kind": "smooth", "chord": 0.1 }),
            "/surfaces/ball/facets",
            [
                "a smooth surface needs quadrilaterals",
                "help: leave out `facets`, or take the CAD file",
            ],
        ),
        (
            "tool.stl".into(),
            json!({ "kind": "biquadratic", "count": [2, 2] }),
            "/surfaces/ball/facets",
            [
                "whose triangles are facets already",
                "help: leave out `facets`",
            ],
        ),
        (
            asset("sphere.igs"),
            json!({ "kind": "bilinear", "size": 1e-6 }),
            "/surfaces/ball/facets/size",
            ["facets would be needed", "help: ask for coarser facets"],
        ),
    ] {
        let ball = json!({ "cad": { "file": file }, "facets": facets });
        plate_refused_in(folder.path(), &[("/surfaces/ball", ball)], pointer, &parts);
    }
}

const SHEET: &str = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 2, 0, 0\n4, 0, 1, 0\n5, 1, 1, 0\n6, 2, 1, 0\n\
                     *ELEMENT, TYPE=S4, ELSET=left\n1, 1, 2, 5, 4\n*ELEMENT, TYPE=S4, ELSET=right\n2, 2, 3, 6, 5\n";

/// A surface that is right with its thickness, and every field of it wrong in turn, told at its place.
#[test]
fn surfaces_of_a_mesh_file() {
    let folder = folder_with("two.inp", SHEET);
    let with = |fields: Value| {
        let mut file = json!({ "path": "two.inp" });
        let object = file.as_object_mut().unwrap();
        object.extend(fields.as_object().unwrap().clone());
        let mut changes = from_file();
        changes[0].1 = json!({ "file": file });
        changes
    };
    for (thickness, layers) in [
        (json!(0.5), "layers 0.5 thick"),
        (
            json!({ "left": 0.5, "right": 0.7 }),
            "layers 0.5 to 0.7 thick",
        ),
        (json!("0.4 + x/5"), "layers 0.4 to 0.8 thick"),
    ] {
        write_plate(folder.path(), &with(json!({ "thickness": thickness })));
        let output = covact(folder.path(), &["check", "scene.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert_parts(&stdout(&output), &["2 elements, 12 nodes", layers]);
    }
    for (fields, field, message) in [
        (json!({}), "path", "give it a thickness"),
        (json!({ "thickness": 0 }), "thickness", "the thickness is 0"),
        (
            json!({ "thickness": {} }),
            "thickness",
            "the thickness names no set",
        ),
        (
            json!({ "thickness": { "left": 1, "right": -1 } }),
            "thickness/right",
            "the thickness is -1",
        ),
        (
            json!({ "thickness": { "left": 1 } }),
            "thickness",
            "1 element(s) are in no set of `thickness`, the first is element 2",
        ),
        (
            json!({ "thickness": { "left": 1, "rigth": 1 } }),
            "thickness",
            "no element set `rigth` (did you mean `right`?)",
        ),
        (
            json!({ "thickness": "x - 1" }),
            "thickness",
            "the thickness is -1 at (0.000000, 0.000000, 0.000000) (node 1), where it must be positive",
        ),
        (
            json!({ "layers": 2 }),
            "layers",
            "`layers` is for surfaces with a `thickness`",
        ),
        (json!({ "thickness": 1, "layers": 0 }), "layers", "is 0"),
        (
            json!({ "thickness": 1, "only": "middle" }),
            "only",
            "no element set `middle`",
        ),
    ] {
        let pointer = format!("/bodies/plate/mesh/file/{field}");
        plate_refused_in(folder.path(), &with(fields), &pointer, &[message]);
    }
    // An expression that is wrong is told within itself.
    write_plate(folder.path(), &with(json!({ "thickness": "1 + t" })));
    let output = covact(folder.path(), &["check", "scene.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert_parts(&stderr(&output), &["`t`", "x"]);
}
