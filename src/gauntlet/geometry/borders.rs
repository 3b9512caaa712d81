//! Where a surface ends: gaps between patches, trims, free edges.
use super::super::scenes::{alone, block_under};
use super::{Case, CaseError, Trial, difference, tool};
use covact_geometry::curve::NurbsCurve;
use covact_geometry::primitives::{cylinder, plane};
use covact_geometry::{NurbsPatch, TrimCurve, TrimLoop, Vec3};
use nalgebra::Vector2;

pub const GAPS: Case = Case {
    name: "gaps",
    what: "a plane of two patches with a gap or an overlap of 1e-7 to 1e-4 of the size under slave points",
    right: "as the plane of one patch, to 1e-9; a gap too wide to be joined is told",
    run: gaps,
};

pub const TRIM: Case = Case {
    name: "trim",
    what: "a plane trimmed askew through the contact, and one with a round hole",
    right: "as patches that end there, to 1e-9",
    run: trim,
};

pub const FREE_EDGE: Case = Case {
    name: "free_edge",
    what: "an open face that ends over the block, sunk in so that the block swells up beside it",
    right: "no force beyond the edge: as a closed tool with a side, to 1e-9",
    run: free_edge,
};

const DOWN: [&str; 3] = ["0", "0", "-0.05*t"];

fn face(corners: [[f64; 3]; 4]) -> Result<NurbsPatch, CaseError> {
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    let corners = corners.map(Vec3::from);
    Ok(NurbsPatch::new(
        [1, 1],
        [knots(), knots()],
        [2, 2],
        &corners,
        None,
    )?)
}

/// The plane z = 0.5 between x = a and b.
fn part(a: f64, b: f64) -> Result<NurbsPatch, CaseError> {
    face([[a, -1.0, 0.5], [a, 1.0, 0.5], [b, -1.0, 0.5], [b, 1.0, 0.5]])
}

fn gaps(trial: &mut Trial) -> Result<(), CaseError> {
    let size = 8f64.sqrt();
    let mut run = |name: &str, patches: Vec<NurbsPatch>| {
        let tool = tool(trial, name, patches, DOWN)?;
        let mut scene = block_under(tool, 4, 2);
        scene["contacts"]["press"]["points"] = "nodes".into();
        trial.done(&scene)
    };
    let whole = run("whole", vec![part(-1.0, 1.0)?])?;
    let mut found = Vec::new();
    // Gaps, and overlaps.
    for share in [1e-7, 1e-6, 1e-5, 1e-4, -1e-7, -1e-6, -1e-5, -1e-4, -1e-3] {
        let half = 0.5 * share * size;
        let two = run("two", vec![part(-1.0, -half)?, part(half, 1.0)?])?;
        found.push((share, two));
    }
    let half = 0.5 * 3e-4 * size;
    let open = run("open", vec![part(-1.0, -half)?, part(half, 1.0)?])?;
    trial.holds("contact", whole.last("force.tool.z")? < -1.0);
    for (share, two) in &found {
        let what = format!("difference at {share:e}");
        trial.within(what, difference(&whole, two)?, 1e-9);
        let more = two.summary.newton_iterations as f64 - whole.summary.newton_iterations as f64;
        trial.within("iterations more", more.max(0.0), 0.0);
    }
    // The five slave points on the line of the gap stand for more than its width.
    trial.within(
        "difference over the open gap",
        difference(&whole, &open)?,
        1e-9,
    );
    let told = open.warnings("too far apart to be joined").join(" ");
    trial.says(
        &told,
        &[
            "`tool`",
            "0.000848528",
            ", 0.5) between entity 1 and entity 2",
            "`cad.tolerance`",
        ],
    );
    trial.iterations(90);
    Ok(())
}

fn trim(trial: &mut Trial) -> Result<(), CaseError> {
    // The parameters of this plane are x + 2 and 2 - y.
    let whole = plane(Vec3::new(0.0, 0.0, 0.5), -Vec3::z(), [4.0, 4.0])?;
    let corners = [[0.0, 0.0], [2.1, 0.0], [2.3, 4.0], [0.0, 4.0]].map(Vector2::from);
    let line = |k: usize| -> Result<TrimCurve, CaseError> {
        let parameter = NurbsCurve::line(corners[k], corners[(k + 1) % 4]);
        Ok(TrimCurve {
            parameter: parameter.map_err(|e| CaseError(e.to_string()))?,
            space: None,
            entity: 0,
        })
    };
    let curves = (0..4).map(line).collect::<Result<_, _>>()?;
    let trimmed = whole
        .trimmed_by(vec![TrimLoop { curves }], true, 1e-9)?
        .patch;
    let at = |p: Vector2<f64>| whole_point(&whole, p);
    let cut = face([
        at(corners[0]),
        at(corners[1]),
        at(corners[3]),
        at(corners[2]),
    ])?;
    // A round hole of radius .3, and a ring around it.
    let circle = |k: usize| -> Result<TrimCurve, CaseError> {
        let turn = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        let (a, b) = (
            k as f64 * std::f64::consts::FRAC_PI_2,
            (k + 1) as f64 * std::f64::consts::FRAC_PI_2,
        );
        let center = Vector2::new(2.05, 2.0);
        let points = [turn(a), turn(a) + turn(b), turn(b)].map(|p| center + p * 0.3);
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let parameter = NurbsCurve::new(2, knots, &points, Some(&[1.0, 0.5f64.sqrt(), 1.0]));
        Ok(TrimCurve {
            parameter: parameter.map_err(|e| CaseError(e.to_string()))?,
            space: None,
            entity: 0,
        })
    };
    let curves = (0..4).map(circle).collect::<Result<_, _>>()?;
    let hole = whole
        .trimmed_by(vec![TrimLoop { curves }], false, 1e-9)?
        .patch;
    let ring = {
        let round = cylinder(1.0, 1.0, Vec3::zeros(), Vec3::z())?;
        round.transformed(&|x| {
            let r = if x.z < 0.0 { 0.3 } else { 2.0 };
            Vec3::new(0.05 + x.x * r, x.y * r, 0.5)
        })?
    };
    for (name, trimmed, cut) in [("askew", trimmed, cut), ("hole", hole, ring)] {
        trial.holds("trimmed", trimmed.trim().is_some());
        let mut run = |name: &str, patch: NurbsPatch| {
            let tool = tool(trial, name, vec![patch], DOWN)?;
            let mut scene = block_under(tool, 6, 2);
            alone(&mut scene);
            trial.done(&scene)
        };
        let (trimmed, cut) = (run("trimmed", trimmed)?, run("cut", cut)?);
        let (points, area) = (
            trimmed.last("points.active")?,
            trimmed.last("area.contact")?,
        );
        trial.holds("contact in a part", points > 20.0 && area < 0.9);
        trial.within(
            format!("difference, {name}"),
            difference(&cut, &trimmed)?,
            1e-9,
        );
    }
    trial.iterations(90);
    Ok(())
}

fn whole_point(patch: &NurbsPatch, p: Vector2<f64>) -> [f64; 3] {
    patch.point([p.x, p.y]).into()
}

fn free_edge(trial: &mut Trial) -> Result<(), CaseError> {
    let a = 0.1;
    let lower = part(a, 2.0)?;
    let side = face([[a, -1.0, 0.5], [a, -1.0, 1.5], [a, 1.0, 0.5], [a, 1.0, 1.5]])?;
    let mut run = |name: &str, patches: Vec<NurbsPatch>| {
        let tool = tool(trial, name, patches, DOWN)?;
        let mut scene = block_under(tool, 6, 3);
        alone(&mut scene);
        trial.done(&scene)
    };
    let open = run("open", vec![lower.clone()])?;
    let closed = run("closed", vec![lower, side])?;
    trial.holds("contact", open.last("force.tool.z")? < -1.0);
    trial.within("difference", difference(&open, &closed)?, 1e-9);
    trial.within("force along x", open.last("force.tool.x")?, 1e-9);
    trial.iterations(30);
    Ok(())
}
