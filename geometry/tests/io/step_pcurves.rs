//! Faces of STEP files with curves in the parameter plane that contradict their curves in space.

use crate::step_builder::{Step, area, near, set};
use covact_geometry::io::CadFile;

const CORNERS: [[f64; 2]; 4] = [[0., 0.], [10., 0.], [10., 10.], [0., 10.]];

/// A square of size 10 within four edges, each with a curve of the parameter plane from `ends` of its own ends.
fn square(ends: impl Fn(usize) -> [[f64; 2]; 2]) -> CadFile {
    let mut step = Step::default();
    let rows = [0., 10.].map(|x| {
        let row = [0., 10.].map(|y| step.point([x, y, 0.]));
        format!("({})", row.join(","))
    });
    let surface = step.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,({}),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,10.),(0.,10.),.UNSPECIFIED.)",
        rows.join(",")
    ));
    let plane = step.add(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('',''))",
    );
    let corners = CORNERS.map(|[x, y]| step.vertex([x, y, 0.]));
    let edges: Vec<String> = (0..4)
        .map(|k| {
            let [[x, y], to] = [CORNERS[k], CORNERS[(k + 1) % 4]];
            let at = step.point([x, y, 0.]);
            let along = step.direction([to[0] - x, to[1] - y, 0.]);
            let along = step.add(format!("VECTOR('',{along},1.)"));
            let line = step.add(format!("LINE('',{at},{along})"));
            let ends = ends(k).map(|[u, v]| step.add(format!("CARTESIAN_POINT('',({u:?},{v:?}))")));
            let curve = step.add(format!(
                "B_SPLINE_CURVE_WITH_KNOTS('',1,({}),.UNSPECIFIED.,.F.,.F.,(2,2),(0.,10.),.UNSPECIFIED.)",
                ends.join(",")
            ));
            let curve = step.add(format!("DEFINITIONAL_REPRESENTATION('',({curve}),{plane})"));
            let pcurve = step.add(format!("PCURVE('',{surface},{curve})"));
            let curve = step.add(format!("SURFACE_CURVE('',{line},({pcurve}),.PCURVE_S1.)"));
            step.edge([&corners[k], &corners[(k + 1) % 4]], &curve)
        })
        .collect();
    let edges: Vec<&str> = edges.iter().map(String::as_str).collect();
    let bound = step.bound(&edges);
    let face = step.face(&[&bound], &surface, true);
    let sheet = step.sheet(&[&face]);
    step.whole(&[&sheet])
}

/// Curves of the parameter plane that end short of each other, as where they share their parameters with those in space only
/// nearly. The latter meet at the vertices, and neighbours have them in common.
#[test]
fn curves_that_end_short_give_way_to_those_in_space() {
    let file = square(|k| {
        let [a, b] = [CORNERS[k], CORNERS[(k + 1) % 4]];
        let short =
            |from: [f64; 2], to: [f64; 2]| [0, 1].map(|d| from[d] + 3e-4 * (to[d] - from[d]));
        [short(a, b), short(b, a)]
    });
    near(area(&set(&file, None)), 100., 1e-12);
    assert_eq!((file.trims.rejected, file.trims.bridged), (4, 0));
    let told = file
        .notes
        .iter()
        .filter(|n| n.contains("which were projected"));
    assert_eq!(told.count(), 4, "{:?}", file.notes);
}

/// Curves of another place of the plane, and curves of another scale: nobody means them.
#[test]
fn curves_elsewhere_give_way_to_those_in_space() {
    let elsewhere: [fn([f64; 2]) -> [f64; 2]; 3] = [
        |[u, v]| [0.3 * u + 2., 0.3 * v],
        |[u, v]| [25.4 * u, 25.4 * v],
        |[u, v]| [10. - v, u],
    ];
    for map in elsewhere {
        let file = square(|k| [CORNERS[k], CORNERS[(k + 1) % 4]].map(map));
        near(area(&set(&file, None)), 100., 1e-12);
        assert_eq!(file.trims.rejected, 4, "{:?}", file.notes);
        assert!(!file.notes.is_empty());
    }
}
