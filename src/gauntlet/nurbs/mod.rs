//! CAD surfaces that bend: thin shells on NURBS patches.
mod benchmarks;
mod faces;
mod touch;

use super::{Case, CaseError, Group, Trial};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "nurbs",
    cases: &[
        Case {
            name: "rolled_up",
            what: "a strip rolled up to a full circle by a couple at its end, two meshes",
            right: "M = 2 pi EI / L: the end meets the start to 1e-3 of L; its energy to .1 %",
            run: benchmarks::rolled,
        },
        Case {
            name: "frame",
            what: "two strips at a right angle, one clamped, the other under a small force at its end",
            right: "a frame of two beams: both displacements to .05 %; the angle stays",
            run: benchmarks::frame,
        },
        Case {
            name: "blown_tube",
            what: "a thin tube of rubber blown up by 30 % by pressure that follows",
            right: "mu t / R (1 - s^-4) of an incompressible membrane, to .1 %",
            run: benchmarks::tube,
        },
        Case {
            name: "as_other_elements",
            what: "a clamped square plate bent by a ball: NURBS and q18, two thicknesses, and h8",
            right: "energies agree to 1 %; the thin shell's difference falls with the square of the thickness",
            run: touch::elements,
        },
        Case {
            name: "mirror_images",
            what: "two equal panels pressed on each other at their crowns",
            right: "one of them on a rigid plane half way: force and energy to 1e-6",
            run: touch::images,
        },
        Case {
            name: "described_otherwise",
            what: "a curved panel under a ball with friction: reversed once and twice, degrees elevated",
            right: "the same, to 1e-8",
            run: touch::described,
        },
        Case {
            name: "joined",
            what: "a clamped plate under a ball: one face, two faces, and three that meet in a T",
            right: "the same to .1 %, though their knots do not match",
            run: faces::joined,
        },
        Case {
            name: "trimmed",
            what: "a plate under a ball that ends at a cut askew, by a trim and by its border",
            right: "the same to .1 %",
            run: faces::trimmed,
        },
    ],
};

/// A plane face with a corner at `origin` and two edges.
fn face(origin: Vec3, a: Vec3, b: Vec3) -> Result<NurbsPatch, CaseError> {
    let points = [origin, origin + a, origin + b, origin + a + b];
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &points, None).map_err(CaseError::from)
}

/// A body on the patches of a file.
fn body(
    trial: &Trial,
    name: &str,
    patches: Vec<NurbsPatch>,
    keys: Value,
) -> Result<Value, CaseError> {
    let mut nurbs = keys;
    nurbs["file"] = trial.cad(name, patches)?.into();
    Ok(json!({ "nurbs": nurbs, "material": "m" }))
}
