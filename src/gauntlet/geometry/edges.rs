//! Creases, edges and corners.
use super::super::scenes::{alone, block_under, solution};
use super::{Case, CaseError, Trial, difference, tool};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};

pub const CREASE: Case = Case {
    name: "crease",
    what: "a ridge, and a valley, that are a crease inside of one patch",
    right: "as two patches that meet at an edge, to 1e-9",
    run: crease,
};

pub const CONVEX_EDGE: Case = Case {
    name: "convex_edge",
    what: "a sharp ridge pressed into a block, between slave points and right on them",
    right: "as a ridge rounded off where no point sees it, to 1e-9; a larger fillet takes force away",
    run: convex_edge,
};

pub const CONCAVE_EDGE: Case = Case {
    name: "concave_edge",
    what: "a block pressed into the sharp edge of a groove that holds two of its faces",
    right: "even compression in closed form, to 1e-8; with points on the edge the same on both faces",
    run: concave_edge,
};

pub const CORNER: Case = Case {
    name: "corner",
    what: "a block pressed into a corner of three faces; the corner of a cube pressed into a block",
    right: "even compression in closed form, to 1e-8; the cube by other descriptions, to 1e-9",
    run: corner,
};

pub const THIN_TOOL: Case = Case {
    name: "thin_tool",
    what: "a plate thinner than a step's way pressed into a block: both of its sides are near",
    right: "as a tool without a back, to 1e-9: no point comes out at the back",
    run: thin_tool,
};

const DOWN: [&str; 3] = ["0", "0", "-0.1*t"];

/// A patch through points, bilinear between them.
fn bilinear(counts: [usize; 2], points: &[Vec3]) -> Result<NurbsPatch, CaseError> {
    let knots = counts.map(|n| {
        let last = (n - 1) as f64;
        let inner = (0..n).map(|i| i as f64);
        [0.0].into_iter().chain(inner).chain([last]).collect()
    });
    Ok(NurbsPatch::new([1, 1], knots, counts, points, None)?)
}

fn face(corners: [[f64; 3]; 4]) -> Result<NurbsPatch, CaseError> {
    bilinear([2, 2], &corners.map(Vec3::from))
}

/// `z = 0.5 + height + slope |x|` for x from -1 to 1 in one patch with a crease.
fn creased(height: f64, slope: f64) -> Result<NurbsPatch, CaseError> {
    let mut points = Vec::new();
    for y in [-1.0, 1.0] {
        points.extend([-1.0f64, 0.0, 1.0].map(|x| Vec3::new(x, y, 0.5 + height + slope * x.abs())));
    }
    bilinear([3, 2], &points)
}

fn crease(trial: &mut Trial) -> Result<(), CaseError> {
    for (name, height, slope, points) in [
        ("ridge", 0.0, 1.0, json!({ "gauss": 2 })),
        ("valley", 0.15, -0.3, json!({ "gauss": 2 })),
        ("valley on nodes", 0.15, -0.3, json!("nodes")),
    ] {
        let one = creased(height, slope)?;
        let two = one.split(0, 1.0)?.to_vec();
        let mut run = |name: &str, patches: Vec<NurbsPatch>| {
            let tool = tool(trial, name, patches, DOWN)?;
            let mut scene = block_under(tool, 6, 4);
            scene["contacts"]["press"]["points"] = points.clone();
            alone(&mut scene);
            trial.done(&scene)
        };
        let (one, two) = (run("one", vec![one])?, run("two", two)?);
        trial.holds("contact", one.last("force.tool.z")? < -0.1);
        trial.within(format!("difference, {name}"), difference(&two, &one)?, 1e-9);
        let side = one.last("force.tool.x")? / one.last("force.tool.z")?;
        trial.within(format!("force to the side, {name}"), side, 1e-9);
    }
    trial.iterations(110);
    Ok(())
}

/// The ridge of slope 1 with a fillet of radius `r`.
fn rounded(r: f64) -> Result<Vec<NurbsPatch>, CaseError> {
    let [left, right] = creased(0.0, 1.0)?.split(0, 1.0)?;
    if r == 0.0 {
        return Ok(vec![left, right]);
    }
    // The fillet touches both flanks at x = r / sqrt 2.
    let x = r * 0.5f64.sqrt();
    let [left, _] = left.split(0, 1.0 - x)?;
    let [_, right] = right.split(0, 1.0 + x)?;
    let mut points = Vec::new();
    for y in [-1.0, 1.0] {
        points.extend([(-x, x), (0.0, 0.0), (x, x)].map(|(x, z)| Vec3::new(x, y, 0.5 + z)));
    }
    let weight = 0.5f64.sqrt();
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let weights = [1.0, weight, 1.0, 1.0, weight, 1.0];
    let fillet = NurbsPatch::new([2, 1], knots, [3, 2], &points, Some(&weights))?;
    Ok(vec![left, fillet, right])
}

fn convex_edge(trial: &mut Trial) -> Result<(), CaseError> {
    let mut run = |r: f64, points: Value, shift: &str| {
        let mut tool = tool(trial, "ridge", rounded(r)?, DOWN)?;
        tool["motion"]["translation"][0] = shift.into();
        let mut scene = block_under(tool, 6, 4);
        scene["contacts"]["press"]["points"] = points;
        alone(&mut scene);
        trial.done(&scene)
    };
    let gauss = json!({ "gauss": 2 });
    let sharp = run(0.0, gauss.clone(), "0")?;
    let hidden = run(0.01, gauss.clone(), "0")?;
    let seen = run(0.2, gauss, "0")?;
    // A point right on the ridge goes to the side that it lies on by however little.
    let left = run(0.0, json!("nodes"), "1e-9")?;
    let right = run(0.0, json!("nodes"), "-1e-9")?;
    let force = sharp.last("force.tool.z")?;
    trial.holds("contact", force < -1.0 && left.last("force.tool.z")? < -1.0);
    trial.within("the hidden fillet", difference(&sharp, &hidden)?, 1e-9);
    let less = seen.last("force.tool.z")? > 0.5 * force;
    trial.holds("a fillet that points see takes force away", less);
    trial.within(
        "force to the side",
        sharp.last("force.tool.x")? / force,
        1e-9,
    );
    let [x, z] = ["x", "z"].map(|axis| format!("force.tool.{axis}"));
    trial.equal("mirrored, x", -left.last(&x)?, right.last(&x)?, 1e-9);
    trial.equal("mirrored, z", left.last(&z)?, right.last(&z)?, 1e-9);
    trial.iterations(80);
    Ok(())
}

/// The stretch of a block of edge 1 pressed by `press` at its far ends along `axes` of its axes between rigid faces of penalty
/// `penalty`, and the force on one face. St. Venant-Kirchhoff, held in the other axes.
fn compressed(axes: f64, press: f64, penalty: f64, e: f64, nu: f64) -> (f64, f64) {
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let mu = e / (2.0 * (1.0 + nu));
    let nominal = |stretch: f64| {
        let strain = 0.5 * (stretch * stretch - 1.0);
        stretch * strain * (axes * lambda + 2.0 * mu)
    };
    // Pressure of the block and of the penalty, which sinks in by what the block is not shortened.
    let excess = |stretch: f64| -nominal(stretch) - penalty * (press - (1.0 - stretch));
    let (mut low, mut high) = (1.0 - press, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low, -nominal(low))
}

/// A block of edge 1 in the corner of planes at x = 0, z = 0 and, where `axes` is 3, y = 0, pressed by `press` from the other
/// sides.
fn cornered(tool: Value, axes: usize, points: &Value, press: f64) -> Value {
    let mut contacts = json!({});
    let mut supports = json!({});
    for (axis, low, high) in [
        ("x", "x_min", "x_max"),
        ("z", "bottom", "top"),
        ("y", "y_min", "y_max"),
    ]
    .into_iter()
    .take(axes)
    {
        contacts[low] = json!({
            "slave": format!("block.{low}"), "master": "tool", "points": points, "penalty": { "value": 2e4 }
        });
        supports[high] = json!({
            "on": format!("block.{high}"), "displacement": { axis: format!("-{press}*t") }
        });
    }
    if axes == 2 {
        for low in ["y_min", "y_max"] {
            supports[low] = json!({ "on": format!("block.{low}"), "symmetry": "y" });
        }
    }
    json!({
        "covact": 1,
        "materials": { "rubber": { "st_venant_kirchhoff": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 1, 1], "elements": [3, 3, 3] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": { "tool": tool },
        "contacts": contacts,
        "supports": supports,
        "solution": solution(2),
        "output": { "every": 0 }
    })
}

/// Planes x = 0, z = 0 and y = 0 that meet in the origin.
fn planes() -> Result<[NurbsPatch; 3], CaseError> {
    let (a, b) = (-1.0, 2.0);
    Ok([
        face([[0.0, a, 0.0], [0.0, b, 0.0], [0.0, a, b], [0.0, b, b]])?,
        face([[0.0, a, 0.0], [b, a, 0.0], [0.0, b, 0.0], [b, b, 0.0]])?,
        face([[0.0, 0.0, 0.0], [b, 0.0, 0.0], [0.0, 0.0, b], [b, 0.0, b]])?,
    ])
}

/// Faces of the corner of a cube, its edges along `e`.
fn trihedron(at: Vec3, e: [Vec3; 3]) -> Result<Vec<NurbsPatch>, CaseError> {
    let faces = [[0, 1], [1, 2], [2, 0]]
        .map(|[i, j]| bilinear([2, 2], &[at, at + e[i], at + e[j], at + e[i] + e[j]]));
    faces.into_iter().collect()
}

fn concave_edge(trial: &mut Trial) -> Result<(), CaseError> {
    let [x, z, _] = planes()?;
    let (_, pressure) = compressed(2.0, 0.05, 2e4, 100.0, 0.3);
    let still = ["0", "0", "0"];
    let groove = tool(trial, "groove", vec![x, z], still)?;
    let outcome = trial.done(&cornered(groove.clone(), 2, &json!({ "gauss": 2 }), 0.05))?;
    for axis in ["x", "z"] {
        let found = outcome.last(&format!("force.tool.{axis}"))?;
        trial.equal(format!("force along {axis}"), found, pressure, 1e-8);
    }
    let nodes = trial.done(&cornered(groove, 2, &json!("nodes"), 0.05))?;
    let [x, z] = [nodes.last("force.tool.x")?, nodes.last("force.tool.z")?];
    trial.equal("with points on the edge", x, z, 1e-9);
    trial.equal("their force", x, pressure, 2e-3);
    trial.iterations(25);
    Ok(())
}

fn corner(trial: &mut Trial) -> Result<(), CaseError> {
    let still = ["0", "0", "0"];
    let (_, pressure) = compressed(3.0, 0.05, 2e4, 100.0, 0.3);
    let s = 2.0;
    let hollow = trihedron(Vec3::zeros(), [Vec3::x() * s, Vec3::y() * s, Vec3::z() * s])?;
    let hollow = tool(trial, "hollow", hollow, still)?;
    let outcome = trial.done(&cornered(hollow.clone(), 3, &json!({ "gauss": 2 }), 0.05))?;
    let nodes = trial.done(&cornered(hollow, 3, &json!("nodes"), 0.05))?;
    for axis in ["x", "y", "z"] {
        let column = format!("force.tool.{axis}");
        trial.equal(
            format!("force along {axis}"),
            outcome.last(&column)?,
            pressure,
            1e-8,
        );
        trial.equal(
            "the same on all faces",
            nodes.last(&column)?,
            nodes.last("force.tool.x")?,
            1e-9,
        );
        trial.equal(
            "with points on the corner",
            nodes.last(&column)?,
            pressure,
            2e-3,
        );
    }
    // A cube on its corner, one of its edges in the plane y = 0.
    let (up, out) = (3.0f64.recip().sqrt(), (2.0f64 / 3.0).sqrt());
    let edge = |angle: f64| Vec3::new(out * angle.cos(), out * angle.sin(), up) * 2.0;
    let third = std::f64::consts::TAU / 3.0;
    let faces = trihedron(Vec3::new(0.0, 0.0, 0.5), [0.0, third, -third].map(edge))?;
    let mut other: Vec<NurbsPatch> = faces.iter().rev().cloned().collect();
    other[0] = other[0].elevated(0, 2)?.swapped()?;
    other[1] = other[1].insert_knots(1, &[0.01, 0.5])?;
    other[2] = other[2].reversed(0)?;
    let mut run = |name: &str, faces: Vec<NurbsPatch>| {
        let tool = tool(trial, name, faces, DOWN)?;
        trial.done(&block_under(tool, 6, 4))
    };
    let (one, other) = (run("cube", faces)?, run("other", other)?);
    let force = one.last("force.tool.z")?;
    trial.holds("contact", force < -0.5);
    trial.within("difference", difference(&one, &other)?, 1e-9);
    trial.within("force to the side", one.last("force.tool.y")? / force, 1e-9);
    trial.iterations(50);
    Ok(())
}

fn thin_tool(trial: &mut Trial) -> Result<(), CaseError> {
    // A plate 0.04 thick that covers a part of the block, taken down by a little less than half of that in a step.
    let (a, b, low, high) = (-0.25, 2.0, 0.5, 0.54);
    let lower = face([[a, -1.0, low], [a, 1.0, low], [b, -1.0, low], [b, 1.0, low]])?;
    let upper = face([
        [a, -1.0, high],
        [b, -1.0, high],
        [a, 1.0, high],
        [b, 1.0, high],
    ])?;
    let front = face([
        [a, -1.0, low],
        [a, -1.0, high],
        [a, 1.0, low],
        [a, 1.0, high],
    ])?;
    let mut run = |name: &str, patches: Vec<NurbsPatch>| {
        let mut scene = block_under(tool(trial, name, patches, DOWN)?, 6, 6);
        // Which are as far from the edge as can be: an open one is rounded off for points, a closed one is sharp.
        scene["contacts"]["press"]["points"] = "nodes".into();
        trial.done(&scene)
    };
    let open = run("open", vec![lower.clone()])?;
    let thin = run("thin", vec![lower, front, upper])?;
    trial.holds("contact", open.last("force.tool.z")? < -1.0);
    trial.within("difference", difference(&open, &thin)?, 1e-9);
    let more = thin.summary.newton_iterations as f64 - open.summary.newton_iterations as f64;
    trial.within("iterations more", more.max(0.0), 0.0);
    trial.iterations(60);
    Ok(())
}
