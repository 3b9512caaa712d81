//! What distorted elements cost, and the limits of `covact::shell::distortion` that follow from it.
//!
//! Patches of 2 x 2 elements in exact states (constant stretching, constant curvature), and the Scordelis-Lo roof with
//! its mesh moved within the surface. Error: of displacements, over the largest displacement; on the roof, of the
//! deflection against the regular mesh, which itself is right within 0.5 %.
use super::support::{Grid, Model, grid_of, st_venant, zeros};
use covact::fem::gauss;
use covact::mesh::ElementKind;
use covact::shell::Formulation;
use covact::shell::distortion::most_distorted;
use covact_geometry::Vec3;
use nalgebra::Matrix3;
use std::f64::consts::FRAC_PI_2;

const KINDS: [ElementKind; 2] = [ElementKind::H8, ElementKind::Q18];
/// What the limits stand for.
const ERROR: f64 = 5e-3;

/// Lagrange functions along a line, each with its derivative.
fn line(kind: ElementKind, x: f64) -> Vec<[f64; 2]> {
    match kind {
        ElementKind::H8 => vec![[0.5 * (1.0 - x), -0.5], [0.5 * (1.0 + x), 0.5]],
        ElementKind::Q18 => vec![
            [0.5 * x * (x - 1.0), x - 0.5],
            [1.0 - x * x, -2.0 * x],
            [0.5 * x * (x + 1.0), x + 0.5],
        ],
        ElementKind::Nurbs => unreachable!("these are meshes of solid-shells"),
    }
}

/// Shape functions of the nodes and their derivatives along r, s, t.
fn shape(kind: ElementKind, [r, s, t]: [f64; 3]) -> Vec<[f64; 4]> {
    let (fr, fs, ft) = (line(kind, r), line(kind, s), line(ElementKind::H8, t));
    let mut out = vec![];
    for [c, dc] in &ft {
        for [b, db] in &fs {
            for [a, da] in &fr {
                out.push([a * b * c, da * b * c, a * db * c, a * b * dc]);
            }
        }
    }
    out
}

fn model(grid: &Grid, e: f64, nu: f64) -> Model {
    match grid.mesh.kind {
        ElementKind::H8 => Model::new(&grid.mesh, Formulation::Eas7, st_venant(e, nu)),
        ElementKind::Q18 => Model::q18(&grid.mesh, st_venant(e, nu)),
        ElementKind::Nurbs => unreachable!("these are meshes of solid-shells"),
    }
}

/// Nodal forces that are in equilibrium with a uniform stress, and those of a force per volume.
fn consistent(grid: &Grid, stress: &Matrix3<f64>, body: Vec3) -> Vec<f64> {
    let mesh = &grid.mesh;
    let mut load = vec![0.0; 3 * mesh.nodes.len()];
    let (plane, through) = (gauss(4).unwrap(), gauss(2).unwrap());
    for e in 0..mesh.elements() {
        let nodes = mesh.element(e);
        for (t, wt) in through.iter() {
            for (s, ws) in plane.iter() {
                for (r, wr) in plane.iter() {
                    let n = shape(mesh.kind, [r, s, t]);
                    let mut j = Matrix3::zeros();
                    for (n, &node) in n.iter().zip(nodes) {
                        let d = nalgebra::RowVector3::new(n[1], n[2], n[3]);
                        j += mesh.nodes[node as usize] * d;
                    }
                    let dv = j.determinant() * wr * ws * wt;
                    let to_gradient = j.transpose().try_inverse().unwrap();
                    for (n, &node) in n.iter().zip(nodes) {
                        let gradient = to_gradient * Vec3::new(n[1], n[2], n[3]);
                        let f = stress * gradient * dv + body * (n[0] * dv);
                        for axis in 0..3 {
                            load[3 * node as usize + axis] += f[axis];
                        }
                    }
                }
            }
        }
    }
    load
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Patch {
    /// Uniform plane stress, exact on any geometry.
    Stretching,
    /// Constant curvature, exact on flat plates.
    Bending,
}

/// Largest error of a displacement over the largest displacement, all displacements of the outline being given.
fn patch(grid: &Grid, state: Patch) -> f64 {
    let (e, nu) = (1e6, 0.25);
    let (nx, ny) = (grid.nx, grid.ny);
    let poisson = -2.0 * nu / (1.0 - nu);
    let exact: Vec<f64> = (grid.mesh.nodes.iter())
        .flat_map(|p| {
            let (x, y, z) = (p.x, p.y, p.z);
            let (f, w) = match state {
                Patch::Stretching => (1.0, poisson * z),
                Patch::Bending => (-z, 0.5 * (x * x + x * y + y * y - poisson * z * z)),
            };
            [1e-3 * f * (x + 0.5 * y), 1e-3 * f * (y + 0.5 * x), 1e-3 * w]
        })
        .collect();
    let outline = |i: usize, j: usize| i == 0 || i == nx || j == 0 || j == ny;
    let fixed = (grid.dofs(&[0, 1, 2], outline).into_iter())
        .map(|d| (d, exact[d]))
        .collect();
    let load = match state {
        Patch::Stretching => {
            let normal = 1e-3 * e / (1.0 - nu);
            let shear = 1e-3 * e / (2.0 * (1.0 + nu));
            let stress = Matrix3::new(normal, shear, 0.0, shear, normal, 0.0, 0.0, 0.0, 0.0);
            consistent(grid, &stress, Vec3::zeros())
        }
        Patch::Bending => vec![0.0; exact.len()],
    };
    let u = model(grid, e, nu).linear(&load, &fixed);
    let largest = exact.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(largest > 5e-4);
    (u.iter().zip(&exact)).fold(0.0f64, |m, (u, x)| m.max((u - x).abs())) / largest
}

/// A patch on the unit square (elements 0.5 long) distorted by an amount, as a map of a, b in [0, 1] and c in [-1, 1].
struct Family {
    name: &'static str,
    thickness: f64,
    states: &'static [Patch],
    map: Map,
}

type Map = fn(amount: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3];

/// 1 at the centre of the patch, 0 at its outline.
fn hat(a: f64, b: f64) -> f64 {
    (1.0 - (2.0 * a - 1.0).abs()) * (1.0 - (2.0 * b - 1.0).abs())
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// -1 and 1 on the first and second of the middle nodes of the lines inside a patch of quadratic elements, else 0.
fn middle(along: f64, across: f64) -> f64 {
    match (same(across, 0.5), same(along, 0.25), same(along, 0.75)) {
        (true, true, _) => -1.0,
        (true, _, true) => 1.0,
        _ => 0.0,
    }
}

const BOTH: &[Patch] = &[Patch::Stretching, Patch::Bending];

/// Vertex in the middle moved along the diagonal, or at an angle: straight-sided elements.
fn straight() -> Vec<Family> {
    fn diagonal(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * d * hat(a, b);
        [a + m, b + m, 0.5 * h * c]
    }
    fn sideways(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * d * hat(a, b);
        [a + m, b - 0.4 * m, 0.5 * h * c]
    }
    let mut out = vec![];
    for thickness in [0.1, 0.01] {
        for (name, map) in [
            ("vertex, diagonal", diagonal as Map),
            ("vertex, sideways", sideways),
        ] {
            out.push(Family {
                name,
                thickness,
                states: BOTH,
                map,
            });
        }
    }
    out
}

/// Middle nodes of edges moved; edges that are arcs and waves.
fn curved() -> Vec<Family> {
    fn along(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * d;
        [
            a + m * middle(a, b).abs(),
            b + m * middle(b, a).abs(),
            0.5 * h * c,
        ]
    }
    fn across(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * d;
        [a + m * middle(b, a), b + m * middle(a, b), 0.5 * h * c]
    }
    fn arcs(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let (r, angle) = (1.0 + a, 4.0 * d * b);
        [r * angle.cos(), r * angle.sin(), 0.5 * h * c]
    }
    fn bulge(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        [a + 2.0 * d * b * (1.0 - b) * (1.0 - a), b, 0.5 * h * c]
    }
    fn waves(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * d;
        [
            a + m * (6.0 * b).sin(),
            b + m * (6.0 * a).sin(),
            0.5 * h * c,
        ]
    }
    let mut out = vec![];
    for thickness in [0.1, 0.01] {
        for (name, map) in [
            ("middle nodes along edges", along as Map),
            ("middle nodes across edges", across),
            ("arcs", arcs),
            ("one side bulging", bulge),
            ("waves", waves),
        ] {
            out.push(Family {
                name,
                thickness,
                states: BOTH,
                map,
            });
        }
    }
    out
}

/// Directors off the normal, and a middle vertex out of the plane, with directors left or turned with the surface.
fn tilted() -> Vec<Family> {
    fn directors(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let m = 0.5 * h * d * c * hat(a, b);
        [a + m, b + 0.5 * m, 0.5 * h * c]
    }
    fn warped(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        [a, b, 0.5 * h * c + 0.5 * d * hat(a, b)]
    }
    // Mean slope where elements meet, as a mesh that is made by offsetting along the mean normals of nodes has it.
    fn turned(d: f64, h: f64, a: f64, b: f64, c: f64) -> [f64; 3] {
        let slope = |x: f64, y: f64| match same(x, 0.5) {
            true => 0.0,
            false => d * (0.5 - x).signum() * (1.0 - (2.0 * y - 1.0).abs()),
        };
        let t = 0.5 * h * c;
        [
            a - t * slope(a, b),
            b - t * slope(b, a),
            t + 0.5 * d * hat(a, b),
        ]
    }
    let mut out = vec![];
    for thickness in [0.1, 0.01] {
        for (name, map) in [
            ("directors tilted", directors as Map),
            ("warped, directors parallel", warped),
            ("warped, directors turned", turned),
        ] {
            out.push(Family {
                name,
                thickness,
                states: &[Patch::Stretching],
                map,
            });
        }
    }
    out
}

impl Family {
    fn grid(&self, kind: ElementKind, amount: f64) -> Grid {
        grid_of(kind, 2, 2, |a, b, c| {
            (self.map)(amount, self.thickness, a, b, c)
        })
    }

    fn error(&self, grid: &Grid) -> f64 {
        (self.states.iter()).fold(0.0, |m: f64, state| m.max(patch(grid, *state)))
    }

    /// The patch whose worst element is at `share` of the limit.
    fn at(&self, kind: ElementKind, share: f64) -> Grid {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let found = most_distorted(&self.grid(kind, middle).mesh).unwrap().share;
            if found < share {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.grid(kind, low)
    }
}

/// Straight-sided elements represent constant stretching and constant curvature of flat plates exactly.
#[test]
fn straight_sides_cost_nothing_in_patches() {
    for kind in KINDS {
        for family in straight() {
            for amount in [1.0 / 16.0, 0.125, 0.25, 0.375, 0.45] {
                let grid = family.grid(kind, amount);
                let error = family.error(&grid);
                assert!(
                    error < 1e-10,
                    "{kind:?} {} {amount}: {error:e}",
                    family.name
                );
            }
        }
        let grid = straight()[0].grid(kind, 0.375);
        assert!(most_distorted(&grid.mesh).unwrap().share > 0.9);
    }
}

/// Below the limit every family stays under 0.5 %; a fifth above it one does not, and error grows with the measure.
fn limit_holds(kind: ElementKind, families: &[Family]) {
    let mut beyond = 0.0f64;
    for family in families {
        let name = (kind, family.name, family.thickness);
        let errors = [0.5, 1.0, 1.2].map(|share| {
            let grid = family.at(kind, share);
            let found = most_distorted(&grid.mesh).unwrap();
            assert!(
                (found.share / share - 1.0).abs() < 1e-6,
                "{name:?} {found:?}"
            );
            family.error(&grid)
        });
        let shown = errors.map(|e| format!("{e:.2e}"));
        println!("{name:?}: at 0.5, 1, 1.2 of the limit {shown:?}");
        assert!(
            errors[0] < errors[1] && errors[1] < errors[2],
            "{name:?} {errors:?}"
        );
        assert!(errors[1] < ERROR, "{name:?} {errors:?}");
        beyond = beyond.max(errors[2]);
    }
    assert!(
        beyond > ERROR,
        "{kind:?}: {beyond:e} a fifth above the limit"
    );
}

#[test]
fn limit_of_nodes_off_the_middle_of_edges() {
    limit_holds(ElementKind::Q18, &curved());
}

#[test]
fn limit_of_tilted_directors() {
    for kind in KINDS {
        limit_holds(kind, &tilted());
    }
}

/// Taper is not measured: half the thickness more in the middle of the patch.
#[test]
fn taper_costs_little() {
    for kind in KINDS {
        for thickness in [0.1, 0.01] {
            let family = Family {
                name: "taper",
                thickness,
                states: &[Patch::Stretching],
                map: |d, h, a, b, c| [a, b, 0.5 * h * c * (1.0 + d * hat(a, b))],
            };
            let error = family.error(&family.grid(kind, 0.5));
            println!("{kind:?} taper, h {thickness}: {error:.2e}");
            assert!(error > 1e-6 && error < 2.5e-3);
        }
    }
}

/// Nodes of an n x n mesh of the unit square moved: vertices in a pattern, what lies between with them.
#[derive(Debug, Clone, Copy)]
enum Pattern {
    /// Neighbours in opposite directions along the diagonal.
    Chess,
    /// Rows to the left and to the right.
    Rows,
    /// Every second vertex of every second row.
    Mixed,
    /// By chance.
    Scattered,
}

fn moved(
    kind: ElementKind,
    n: usize,
    pattern: Pattern,
    amount: f64,
    geometry: impl Fn(f64, f64, f64) -> [f64; 3],
) -> Grid {
    let size = n as f64;
    let vertex = |i: usize, j: usize| -> [f64; 2] {
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let even = |k: usize| if k.is_multiple_of(2) { 1.0 } else { 0.0 };
        let o = match pattern {
            Pattern::Chess => [sign(i + j); 2],
            Pattern::Rows => [sign(j), 0.0],
            Pattern::Mixed => [even(j) * sign(i + j), 0.5 * even(i) * sign(i + j)],
            Pattern::Scattered => {
                let mut x = (i * 7919 + j * 104_729 + 12_345) as u64;
                let mut next = || {
                    x = (x.wrapping_mul(6_364_136_223_846_793_005))
                        .wrapping_add(1_442_695_040_888_963_407);
                    (x >> 33) as f64 / (1u64 << 30) as f64 - 1.0
                };
                next();
                [next(), next()]
            }
        };
        let free = |k: usize| if k > 0 && k < n { amount / size } else { 0.0 };
        [o[0] * free(i), o[1] * free(j)]
    };
    grid_of(kind, n, n, |a, b, c| {
        let (x, y) = (a * size, b * size);
        let (i, j) = ((x as usize).min(n - 1), (y as usize).min(n - 1));
        let (u, v) = (x - i as f64, y - j as f64);
        let mut place = [a, b];
        for (di, wi) in [(0, 1.0 - u), (1, u)] {
            for (dj, wj) in [(0, 1.0 - v), (1, v)] {
                let o = vertex(i + di, j + dj);
                place[0] += wi * wj * o[0];
                place[1] += wi * wj * o[1];
            }
        }
        geometry(place[0], place[1], c)
    })
}

/// Deflection of the Scordelis-Lo roof (`obstacle.rs`) and the mesh's worst share of the limit.
fn roof(kind: ElementKind, n: usize, pattern: Pattern, amount: f64) -> (f64, f64) {
    let (radius, length, t) = (25.0, 50.0, 0.25);
    let grid = moved(kind, n, pattern, amount, |a, b, c| {
        let (r, phi) = (radius + 0.5 * c * t, 40f64.to_radians() * a);
        [r * phi.sin(), 0.5 * length * b, r * phi.cos()]
    });
    let load = consistent(&grid, &Matrix3::zeros(), Vec3::new(0.0, 0.0, -90.0 / t));
    let (nx, ny) = (grid.nx, grid.ny);
    let mut fixed = grid.dofs(&[0], |i, _| i == 0);
    fixed.extend(grid.dofs(&[0, 2], |_, j| j == 0));
    fixed.extend(grid.dofs(&[1], |_, j| j == ny));
    let u = model(&grid, 4.32e8, 0.0).linear(&load, &zeros(fixed));
    (
        -grid.mean(&u, nx, ny, 2),
        most_distorted(&grid.mesh).unwrap().share,
    )
}

#[test]
fn limit_of_skew_and_taper_in_the_surface() {
    // Neighbouring vertices in opposite directions are the worst of the patterns.
    for (kind, n, below, above) in [
        (ElementKind::H8, 16, 0.103, 0.12),
        (ElementKind::Q18, 4, 0.1505, 0.17),
    ] {
        let regular = roof(kind, n, Pattern::Chess, 0.0).0;
        assert!((regular / 0.3006 - 1.0).abs() < ERROR, "{regular}");
        let change = |pattern, amount| {
            let (w, share) = roof(kind, n, pattern, amount);
            let error = w / regular - 1.0;
            println!("{kind:?} {pattern:?} {amount}: {share:.3} of the limit, error {error:.2e}");
            (error.abs(), share)
        };
        let (error, share) = change(Pattern::Chess, below);
        assert!(error < ERROR && share > 0.95 && share < 1.0);
        let (error, share) = change(Pattern::Chess, above);
        assert!(error > ERROR && share < 1.3);
        for (pattern, amount) in [
            (Pattern::Rows, 0.25),
            (Pattern::Mixed, 0.2),
            (Pattern::Scattered, 0.15),
        ] {
            let (error, share) = change(pattern, amount);
            assert!(error < ERROR && share > 0.25 && share < 1.0);
        }
    }
}

/// What the limits do not promise: the cylinder pinched by point forces (`obstacle.rs`), whose bending 8 x 8 elements
/// just resolve, loses more than 0.5 % far below the limit; by 16 x 16, 0.15 % (not run here).
#[test]
fn pinched_cylinder_is_more_sensitive() {
    let deflection = |n: usize, amount: f64| {
        let (radius, length, t) = (300.0, 600.0, 3.0);
        let grid = moved(ElementKind::Q18, n, Pattern::Rows, amount, |a, b, c| {
            let (r, phi) = (radius + 0.5 * c * t, FRAC_PI_2 * a);
            [r * phi.sin(), 0.5 * length * b, r * phi.cos()]
        });
        let (nx, ny) = (grid.nx, grid.ny);
        let mut load = vec![0.0; 3 * grid.mesh.nodes.len()];
        for k in 0..2 {
            load[3 * grid.node(0, ny, k) + 2] = -0.125;
        }
        let mut fixed = grid.dofs(&[0], |i, _| i == 0);
        fixed.extend(grid.dofs(&[2], |i, _| i == nx));
        fixed.extend(grid.dofs(&[0, 2], |_, j| j == 0));
        fixed.extend(grid.dofs(&[1], |_, j| j == ny));
        let u = model(&grid, 3e6, 0.3).linear(&load, &zeros(fixed));
        let share = most_distorted(&grid.mesh).unwrap().share;
        assert!(share < 0.3, "{share}");
        -grid.mean(&u, 0, ny, 2)
    };
    let change = deflection(8, 0.125) / deflection(8, 0.0) - 1.0;
    println!("pinched cylinder, rows moved by 1/8: 8 x 8 {change:.2e}");
    assert!(change < -ERROR && change > -0.02);
}
