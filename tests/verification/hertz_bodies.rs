//! Hertz between two elastic bodies, and between an elastic body and a rigid sphere moved or driven by force: contact radius,
//! largest pressure and approach, each within 1 %, with linear and quadratic elements.
//!
//! H. Hertz (1882), as in K. L. Johnson, Contact Mechanics (1985), section 4.2: with `1/E* = sum (1 - nu^2)/E` and the
//! relative radius R, an approach delta gives `a = sqrt(R delta)`, `F = 4/3 E* a^3 / R`, `p0 = 2 E* a / (pi R)`. R = 1000
//! and delta = .001, so a = 1 and p0 / E = .07 %: large strains, in which St. Venant-Kirchhoff is not Hertz's material,
//! move the pressure by as little. (At ten times that strain they take 1 % of the peak.) Both bodies are quarters of blocks
//! whose far faces carry the displacement of a point load on a half space (Boussinesq 1885; Johnson, section 3.2), so no
//! size of a body enters: what is left of Hertz's field beside it is of the order (a / 6)^2 of 7 % of the approach. The
//! upper body ends in the paraboloid `r^2 / (2 R)`.
//!
//! ```text
//!        |   upper    |
//!         \          /
//!   z=0 ---\___.____/-----+   a quarter, symmetry at x = 0 and y = 0
//!          |    lower     |
//! ```
//!
//! Contact at nodes: the pressures at nodes times the areas of that rule are the forces that act, so moments of the
//! pressure are sums over nodes.
use crate::support::{Outcome, solve_in};
use serde_json::{Value, json};
use std::path::Path;

const RADIUS: f64 = 1000.0;
const APPROACH: f64 = 0.001;
/// Side of the blocks, and the part of it near the contact that has equal elements.
const SIDE: f64 = 6.0;
const FINE: f64 = 1.2;
/// Faces up to here are slaves and masters, and the upper body is a paraboloid.
const ZONE: f64 = 2.5;
/// The penetration at the largest pressure is .14 % of the approach.
const PENALTY: f64 = 1e5;

const SOFT: Elastic = Elastic { e: 200.0, nu: 0.3 };
const HARD: Elastic = Elastic { e: 400.0, nu: 0.2 };

#[derive(Debug, Clone, Copy)]
struct Elastic {
    e: f64,
    nu: f64,
}

impl Elastic {
    fn shear(self) -> f64 {
        0.5 * self.e / (1.0 + self.nu)
    }
    fn compliance(self) -> f64 {
        (1.0 - self.nu * self.nu) / self.e
    }
}

/// What Hertz's theory gives.
struct Hertz {
    a: f64,
    force: f64,
    p0: f64,
}

fn hertz(bodies: &[Elastic]) -> Hertz {
    let stiffness = 1.0 / bodies.iter().map(|b| b.compliance()).sum::<f64>();
    let a = (RADIUS * APPROACH).sqrt();
    Hertz {
        a,
        force: 4.0 / 3.0 * stiffness * a.powi(3) / RADIUS,
        p0: 2.0 * stiffness * a / (std::f64::consts::PI * RADIUS),
    }
}

/// What is run.
#[derive(Debug, Clone, Copy)]
struct Case {
    element: &'static str,
    /// Along x and y, and down the depth: equal elements on [0, FINE] and growing ones beyond.
    cells: [u32; 4],
    /// The lower body, and the upper one unless that is a rigid sphere.
    bodies: &'static [Elastic],
    /// The sphere is driven by Hertz's force instead of moved by his approach.
    driven: bool,
}

impl Case {
    fn quadratic(&self) -> bool {
        self.element == "q18"
    }
}

/// Displacements at the far faces of a body that lies at `side * z < 0` of the plane z = 0 and is pressed by `force`,
/// growing with the force `t^1.5`; `moved` is added along z.
fn far_field(body: Elastic, force: f64, side: f64, moved: f64) -> Value {
    let c = force / (4.0 * std::f64::consts::PI * body.shear());
    let k = 1.0 - 2.0 * body.nu;
    let rho = "sqrt(x^2+y^2+z^2)";
    // Depth below the surface, positive.
    let depth = format!("({}*z)", -side);
    let along = |x: &str| format!("{c}*t^1.5*{x}*({depth}/{rho}^3-{k}/({rho}*({rho}+{depth})))");
    let down = format!(
        "{}*t^1.5*(z^2/{rho}^3+{}/{rho})+{moved}*t",
        -side * c,
        2.0 * (1.0 - body.nu)
    );
    json!({ "x": along("x"), "y": along("y"), "z": down })
}

/// Corner positions along an axis from 0 to [`SIDE`]: `fine` equal elements on [0, FINE], `coarse` growing beyond.
fn positions(fine: u32, coarse: u32) -> Vec<f64> {
    let spacing = covact::scene::Spacing::Fine {
        length: FINE,
        fine,
        from_end: false,
        from_middle: false,
    };
    covact::mesh::positions(&spacing, SIDE, fine + coarse, "r").unwrap()
}

/// With the middles of all intervals.
fn halved(x: &[f64]) -> Vec<f64> {
    let mut all = vec![x[0]];
    for w in x.windows(2) {
        all.extend([0.5 * (w[0] + w[1]), w[1]]);
    }
    all
}

/// Writes a quarter block below (`side` = 1) or above z = 0, whose surface `contact` at z = 0 is moved to `shape(r)`; the
/// move fades out over the depth. `cells` are those of [`positions`] along x and y, and down the depth.
fn write_block(path: &Path, quadratic: bool, cells: [u32; 4], side: f64, shape: fn(f64) -> f64) {
    use std::fmt::Write;
    let corners = positions(cells[0], cells[1]);
    let mut heights: Vec<f64> = positions(cells[2], cells[3])
        .iter()
        .map(|d| -side * d)
        .collect();
    heights.sort_by(f64::total_cmp);
    let (x, z) = match quadratic {
        true => (halved(&corners), halved(&heights)),
        false => (corners, heights),
    };
    let n = x.len();
    let mut text = String::from("*NODE\n");
    for (k, depth) in z.iter().enumerate() {
        for (j, b) in x.iter().enumerate() {
            for (i, a) in x.iter().enumerate() {
                let moved = shape(a.hypot(*b)) * (1.0 - depth.abs() / SIDE);
                let number = 1 + i + n * (j + n * k);
                writeln!(text, "{number}, {a:e}, {b:e}, {:e}", depth + moved).unwrap();
            }
        }
    }
    let step = if quadratic { 2 } else { 1 };
    let count = (n - 1) / step;
    let layers = (z.len() - 1) / step;
    let kind = if quadratic { "C3D27" } else { "C3D8" };
    writeln!(text, "*ELEMENT, TYPE={kind}").unwrap();
    let mut contact = String::new();
    let mut element = 0;
    for k in 0..layers {
        for j in 0..count {
            for i in 0..count {
                element += 1;
                let at = |p: [usize; 3]| {
                    let [a, b, c] = [i * step + p[0], j * step + p[1], k * step + p[2]];
                    1 + a + n * (b + n * c)
                };
                let nodes = if quadratic {
                    QUADRATIC.map(at).to_vec()
                } else {
                    QUADRATIC[..8]
                        .iter()
                        .map(|p| at(p.map(|c| c / 2)))
                        .collect()
                };
                let list: Vec<String> = nodes.iter().map(usize::to_string).collect();
                let mut line = element.to_string();
                for (at, node) in list.iter().enumerate() {
                    // At most 16 numbers a line.
                    line += if at == 14 { ",\n" } else { ", " };
                    line += node;
                }
                writeln!(text, "{line}").unwrap();
                if (side > 0.0 && k == layers - 1) || (side < 0.0 && k == 0) {
                    let face = if side > 0.0 { "S2" } else { "S1" };
                    writeln!(contact, "{element}, {face}").unwrap();
                }
            }
        }
    }
    let name = if side > 0.0 { "top" } else { "bottom" };
    writeln!(text, "*SURFACE, NAME={name}, TYPE=ELEMENT\n{contact}").unwrap();
    std::fs::write(path, text).unwrap();
}

/// Places of the nodes of C3D27 in half elements: corners, middles of the edges, then the seven others.
const QUADRATIC: [[usize; 3]; 27] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [1, 0, 2],
    [2, 1, 2],
    [1, 2, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [2, 2, 1],
    [0, 2, 1],
    [1, 1, 1],
    [1, 1, 0],
    [1, 1, 2],
    [1, 0, 1],
    [2, 1, 1],
    [1, 2, 1],
    [0, 1, 1],
];

fn scene(case: Case) -> Value {
    let bodies = case.bodies;
    let expected = hertz(bodies);
    let names = ["lower", "upper"];
    let mut scene = json!({
        "covact": 1,
        "materials": {},
        "bodies": {},
        "contacts": { "press": {
            "slave": "lower.contact_zone",
            "points": "nodes",
            "penalty": { "value": PENALTY }
        }},
        "supports": {},
        "solution": { "step": { "initial": 1, "max": 1 } }
    });
    for (i, (&body, name)) in bodies.iter().zip(names).enumerate() {
        let side = if i == 0 { 1.0 } else { -1.0 };
        let moved = if i == 0 { 0.0 } else { -APPROACH };
        scene["materials"][name] = json!({ "st_venant_kirchhoff": { "E": body.e, "nu": body.nu } });
        scene["bodies"][name] = json!({
            "mesh": { "file": { "path": format!("{name}.inp") } },
            "material": name,
            "element": case.element,
            "sets": {
                "far_x": { "nodes_near_plane": { "point": [SIDE, 0, 0], "normal": [1, 0, 0], "tolerance": 1e-6 } },
                "far_y": { "nodes_near_plane": { "point": [0, SIDE, 0], "normal": [0, 1, 0], "tolerance": 1e-6 } },
                "far_z": { "nodes_near_plane": { "point": [0, 0, -side * SIDE], "normal": [0, 0, 1], "tolerance": 1e-6 } },
                "on_x": { "nodes_near_plane": { "point": [0, 0, 0], "normal": [1, 0, 0], "tolerance": 1e-6 } },
                "on_y": { "nodes_near_plane": { "point": [0, 0, 0], "normal": [0, 1, 0], "tolerance": 1e-6 } },
                "contact_zone": { "faces_in_box": { "min": [-0.01, -0.01, -0.05], "max": [ZONE, ZONE, 0.05] } }
            }
        });
        let far = far_field(body, expected.force, side, moved);
        for face in ["far_x", "far_y", "far_z"] {
            scene["supports"][format!("{name}_{face}")] =
                json!({ "on": format!("{name}.{face}"), "displacement": far });
        }
        for axis in ["x", "y"] {
            scene["supports"][format!("{name}_on_{axis}")] =
                json!({ "on": format!("{name}.on_{axis}"), "symmetry": axis });
        }
    }
    if bodies.len() == 2 {
        scene["contacts"]["press"]["master"] = json!("upper.contact_zone");
    } else {
        scene["contacts"]["press"]["master"] = json!("sphere");
        let motion = match case.driven {
            // A quarter of the force, which grows as the approach does at constant speed.
            true => {
                json!({ "free": { "force": { "z": format!("-{}*t^1.5", expected.force / 4.0) } } })
            }
            false => json!({ "translation": [0, 0, format!("-{APPROACH}*t")] }),
        };
        scene["surfaces"] = json!({ "sphere": {
            "sphere": { "radius": RADIUS, "center": [0, 0, RADIUS] },
            "motion": motion
        }});
    }
    scene
}

/// Relative errors of a run.
#[derive(Debug, Clone, Copy)]
struct Errors {
    /// Contact radius, by `a^2 = 5/2 int p r^2 dA / int p dA`.
    a: f64,
    /// Largest pressure at a node.
    node: f64,
    /// Largest pressure of `p0^2 (1 - r^2 / a^2)` with p0 and a fitted to the squares of the pressures at nodes within .8.
    fit: f64,
    /// The approach that Hertz's law gives to the force, or that the force gave.
    approach: f64,
    /// Of all pressures at nodes, in the mean square.
    field: f64,
}

/// Weights of the nodes along an axis in the rule of contact at nodes: trapezoidal, with quadratic faces Simpson's.
fn weights(axis: &[f64], quadratic: bool) -> Vec<f64> {
    let rule: &[f64] = match quadratic {
        true => &[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
        false => &[0.5, 0.5],
    };
    let step = rule.len() - 1;
    let mut weights = vec![0.0; axis.len()];
    for start in (0..axis.len() - step).step_by(step) {
        let length = axis[start + step] - axis[start];
        for (k, w) in rule.iter().enumerate() {
            weights[start + k] += w * length;
        }
    }
    weights
}

/// Errors of the pressures at the nodes of the lower body; that of the approach is left to the caller.
fn pressure_errors(outcome: &Outcome, quadratic: bool, expected: &Hertz) -> Errors {
    let body = outcome.body("lower", 1);
    let p = body.field("contact_pressure");
    let top = body.top_nodes(|_| true);
    let mut axis: Vec<f64> = top.iter().map(|&n| body.points[n][0]).collect();
    axis.sort_by(f64::total_cmp);
    axis.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let place = |x: f64| axis.iter().position(|a| (a - x).abs() < 1e-9).unwrap();
    let weights = weights(&axis, quadratic);
    let (mut force, mut moment, mut error, mut total) = (0.0, 0.0, 0.0, 0.0);
    let (mut largest, mut fit) = (0.0f64, [0.0; 5]);
    for &node in &top {
        let [x, y, _] = body.points[node];
        let (p, r2) = (p[node], x * x + y * y);
        let w = weights[place(x)] * weights[place(y)];
        let exact = expected.p0 * (1.0 - r2 / expected.a.powi(2)).max(0.0).sqrt();
        force += w * p;
        moment += w * p * r2;
        error += w * (p - exact).powi(2);
        total += w * exact * exact;
        largest = largest.max(p);
        if r2 < 0.64 {
            for (sum, v) in fit.iter_mut().zip([1.0, r2, r2 * r2, p * p, p * p * r2]) {
                *sum += w * v;
            }
        }
    }
    assert!(force.is_finite() && force > 0.0);
    // What the nodes carry is what the history says.
    let written = history_force(outcome) / 4.0;
    assert!((force / written - 1.0).abs() < 2e-3, "{force} {written}");
    let [one, r2, r4, p2, p2r2] = fit;
    let fitted = ((p2 * r4 - p2r2 * r2) / (one * r4 - r2 * r2)).sqrt();
    Errors {
        a: (2.5 * moment / force).sqrt() / expected.a - 1.0,
        node: largest / expected.p0 - 1.0,
        fit: fitted / expected.p0 - 1.0,
        approach: f64::NAN,
        field: (error / total).sqrt(),
    }
}

/// Force between the bodies, four times that of the quarter.
fn history_force(outcome: &Outcome) -> f64 {
    let rigid = outcome.history.column("force.sphere.z").is_some();
    let name = match rigid {
        true => "force.sphere.z",
        false => "slave.force.press.z",
    };
    -4.0 * outcome.at(name, 1.0)
}

fn errors(case: Case) -> Errors {
    let folder = tempfile::tempdir().unwrap();
    let (quadratic, cells) = (case.quadratic(), case.cells);
    let lower = folder.path().join("lower.inp");
    write_block(&lower, quadratic, cells, 1.0, |_| 0.0);
    if case.bodies.len() == 2 {
        // Flat again beyond the master faces, so that the far field is that of a half space.
        let paraboloid = |r: f64| r.min(ZONE).powi(2) / (2.0 * RADIUS);
        let upper = folder.path().join("upper.inp");
        write_block(&upper, quadratic, cells, -1.0, paraboloid);
    }
    let outcome = solve_in(&scene(case), folder.path());
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    assert!(
        summary.newton_iterations <= 12,
        "{}",
        summary.newton_iterations
    );
    let expected = hertz(case.bodies);
    let mut found = pressure_errors(&outcome, quadratic, &expected);
    let force = history_force(&outcome) / expected.force;
    found.approach = match case.driven {
        true => {
            assert!((force - 1.0).abs() < 1e-7, "{force}");
            -outcome.at("displacement.sphere.z", 1.0) / APPROACH - 1.0
        }
        false => force.powf(2.0 / 3.0) - 1.0,
    };
    println!(
        "{} {cells:?} {} bodies, driven {}: {} dofs, {} iterations: a {:+.2} %, p0 {:+.2} % at nodes, {:+.2} % fitted, \
         approach {:+.2} %, field {:.2} %",
        case.element,
        case.bodies.len(),
        case.driven,
        summary.dofs,
        summary.newton_iterations,
        100.0 * found.a,
        100.0 * found.node,
        100.0 * found.fit,
        100.0 * found.approach,
        100.0 * found.field
    );
    found
}

impl Errors {
    /// Radius, largest pressure and approach, each within 1 %.
    fn within_one_percent(&self) {
        for error in [self.a, self.fit, self.approach] {
            assert!(error.abs() < 1e-2, "{self:?}");
        }
    }
}

const ONE: &[Elastic] = &[SOFT];
const TWO: &[Elastic] = &[SOFT, HARD];

fn bricks(cells: [u32; 4], bodies: &'static [Elastic]) -> Errors {
    errors(Case {
        // A block has no thickness: plain bricks treat all directions alike.
        element: "h8_displacement",
        cells,
        bodies,
        driven: false,
    })
}

fn quadratic(cells: [u32; 4], bodies: &'static [Elastic]) -> Errors {
    errors(Case {
        element: "q18",
        cells,
        bodies,
        driven: false,
    })
}

/// Elements .2 and .15 wide. The force, too large by the stiffness of the elements, and the field get better; the field is
/// off mostly next to the border, where its slope is infinite.
fn linear_elements(bodies: &'static [Elastic]) {
    let [coarse, fine] = [[6, 4, 6, 4], [8, 5, 8, 5]].map(|cells| bricks(cells, bodies));
    fine.within_one_percent();
    assert!(fine.node.abs() < 1e-2, "{fine:?}");
    assert!(
        fine.approach < 0.75 * coarse.approach,
        "{coarse:?} {fine:?}"
    );
    assert!(fine.a < 0.75 * coarse.a, "{coarse:?} {fine:?}");
    assert!(fine.field < 0.75 * coarse.field, "{coarse:?} {fine:?}");
}

#[test]
fn rigid_sphere_on_linear_elements() {
    linear_elements(ONE);
}

#[test]
fn two_bodies_of_linear_elements() {
    linear_elements(TWO);
}

/// The solid-shell, made for thin sheets, is no worse a brick.
#[test]
fn rigid_sphere_on_linear_solid_shells() {
    let found = errors(Case {
        element: "h8",
        cells: [8, 5, 8, 5],
        bodies: ONE,
        driven: false,
    });
    found.within_one_percent();
    assert!(found.node.abs() < 1e-2, "{found:?}");
}

/// The largest pressure, at a corner of quadratic elements, is a force that belongs to a shape function partly
/// negative, divided by Simpson's weight 1/36: too large in second order (.1 h^2 / a^2 of a parabolic pressure, and
/// more of an elastic one), as the middles of faces are too small. A fit through all nodes takes the mean of both.
fn quadratic_elements(cells: [u32; 4], bodies: &'static [Elastic]) -> Errors {
    let coarse = quadratic([3, 3, 5, 3], bodies);
    let fine = quadratic(cells, bodies);
    fine.within_one_percent();
    let rate = (coarse.node / fine.node).ln() / (f64::from(cells[0]) / 3.0).ln();
    println!("largest pressure at a node: rate {rate:.2}");
    assert!((rate - 2.0).abs() < 0.4, "{rate}");
    assert!(fine.fit.abs() < coarse.fit.abs(), "{coarse:?} {fine:?}");
    assert!(fine.field < 0.5 * coarse.field, "{coarse:?} {fine:?}");
    fine
}

#[test]
fn rigid_sphere_on_quadratic_elements() {
    let fine = quadratic_elements([6, 3, 10, 3], ONE);
    assert!(fine.node.abs() < 1e-2, "{fine:?}");
}

#[test]
fn two_bodies_of_quadratic_elements() {
    quadratic_elements([5, 3, 8, 3], TWO);
}

/// The sphere, driven by a quarter of Hertz's force, comes as far as his approach.
#[test]
fn sphere_driven_by_force() {
    for (element, cells) in [("h8_displacement", [8, 5, 8, 5]), ("q18", [5, 3, 8, 3])] {
        let found = errors(Case {
            element,
            cells,
            bodies: ONE,
            driven: true,
        });
        found.within_one_percent();
    }
}
