//! Orientation flags of shells (514) and solids (186): which way the normals of their faces point.

use crate::support::assets;
use covact_geometry::io::{CadFile, read_iges, read_path};
use covact_geometry::{PatchSet, Vec3};

/// The faces of `box_brep.igs`, a box of 10 x 20 x 30, with their flags.
const SHELL: &str = "514,6,5,0,45,1,57,0,69,1,81,0,93,1;";

fn changed(from: &str, to: &str) -> CadFile {
    let text = std::fs::read_to_string(assets().join("cad/box_brep.igs")).unwrap();
    assert!(text.contains(from) && from.len() == to.len());
    read_iges(text.replace(from, to).as_bytes(), "box.igs").unwrap()
}

/// Whether the normal of each face points away from the middle of the box.
fn outward(file: &CadFile) -> Vec<bool> {
    let middle = Vec3::new(5., 10., 15.);
    let out = file.patches.iter().map(|p| {
        let [[a, b], [c, d]] = p.patch.domain();
        let jet = p.patch.jet([0.5 * (a + b), 0.5 * (c + d)]);
        jet.rho_i[0].cross(&jet.rho_i[1]).dot(&(jet.rho - middle)) > 0.0
    });
    out.collect()
}

#[test]
fn flags_of_faces_and_shells_turn_normals() {
    assert_eq!(outward(&changed(SHELL, SHELL)), [true; 6]);
    // Every flag, one flag, the flag of the shell in its solid, and that with all of the others.
    let inside = SHELL
        .replace(",0", ",2")
        .replace(",1", ",0")
        .replace(",2", ",1");
    assert_eq!(outward(&changed(SHELL, &inside)), [false; 6]);
    let one = SHELL.replace("45,1", "45,0");
    assert_eq!(
        outward(&changed(SHELL, &one)),
        [true, false, true, true, true, true]
    );
    assert_eq!(outward(&changed("186,3,1,0;", "186,3,0,0;")), [false; 6]);
    // A flag that is left out agrees.
    assert_eq!(outward(&changed("186,3,1,0;", "186,3,,0; ")), [true; 6]);
}

/// What is open has the sides that its flags say.
#[test]
fn an_open_box_has_the_sides_of_its_flags() {
    for (from, to, sign) in [(SHELL, SHELL, 1.0), ("186,3,1,0;", "186,3,0,0;", -1.0)] {
        let mut file = changed(from, to);
        file.patches.pop();
        let surface = file.into_surface().unwrap();
        assert_eq!(surface.set().volumes(), [None]);
        for (x, distance) in [(-1., 1.), (1., -1.)] {
            let foot = surface.closest(&Vec3::new(x, 10., 15.)).unwrap();
            let off = foot.signed_distance - sign * distance;
            assert!(off.abs() < 1e-12, "{x}: {}", foot.signed_distance);
        }
    }
}

/// Nothing has to be turned in the solids that Open CASCADE writes.
#[test]
fn solids_agree_with_their_flags() {
    for name in ["box", "cone", "cylinder", "sphere", "sphere_nurbs", "torus"] {
        let file = read_path(&assets().join(format!("cad/{name}_brep.igs"))).unwrap();
        let patches = file.patches.into_iter().map(|p| p.patch).collect();
        let set = PatchSet::new(patches, None).unwrap();
        assert!(
            set.sides().iter().all(|&s| s == 1.0),
            "{name}: {:?}",
            set.sides()
        );
        assert!(set.volumes()[0].is_some_and(|v| v > 1.0), "{name}");
    }
}
