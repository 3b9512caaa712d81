//! Thick cylinder of MacNeal and Harder (1985), plane strain, internal pressure, nearly incompressible.
use super::support::{Model, plain, st_venant};
use covact::fem::face::shape;
use covact::fem::{Quad, gauss};
use covact::shell::Formulation;
use covact_geometry::Vec3;
use std::collections::BTreeMap;

/// Radii of the published mesh, of elements of 10 degrees.
const RADII: [f64; 6] = [3.0, 3.5, 4.2, 5.2, 6.75, 9.0];

/// How the unit pressure becomes forces on nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Load {
    /// On the flat inner faces of the elements.
    Facets,
    /// On the arc, with the elements' shape functions.
    Arc,
    /// Radial, of the same work as the pressure on the arc when the arc widens.
    Work,
}

/// Radial displacement of the inner surface over the exact one. `radial`: the thickness coordinate t runs along the
/// radius, otherwise along the axis. `fine` elements in place of one, both ways.
fn ratio(nu: f64, formulation: Formulation, radial: bool, load_on: Load, fine: usize) -> f64 {
    let arcs = 9 * fine;
    let step = 10f64.to_radians() / fine as f64;
    let radii: Vec<f64> = (0..=5 * fine)
        .map(|i| {
            let (a, part) = ((i / fine).min(4), i - fine * (i / fine).min(4));
            RADII[a] + (RADII[a + 1] - RADII[a]) * part as f64 / fine as f64
        })
        .collect();
    let node = |r: usize, j: usize, k: usize| (k * (arcs + 1) + j) * radii.len() + r;
    let mut nodes = vec![];
    for k in 0..2 {
        for j in 0..=arcs {
            let (sin, cos) = (step * j as f64).sin_cos();
            nodes.extend(radii.iter().map(|r| Vec3::new(r * cos, r * sin, k as f64)));
        }
    }
    let mut connectivity = vec![];
    for j in 0..arcs {
        for r in 0..radii.len() - 1 {
            for a in 0..8 {
                let (x, y, z) = (a & 1, (a >> 1) & 1, a >> 2);
                // Cyclic, so that the elements stay right-handed.
                let n = if radial {
                    node(r + z, j + x, y)
                } else {
                    node(r + x, j + y, z)
                };
                connectivity.push(n as u32);
            }
        }
    }
    let mesh = plain(nodes, connectivity);
    let mut load = vec![0.0; 3 * mesh.nodes.len()];
    for j in 0..arcs {
        let corners = [
            node(0, j, 0),
            node(0, j + 1, 0),
            node(0, j, 1),
            node(0, j + 1, 1),
        ];
        let quad = Quad::bilinear(corners.map(|n| mesh.nodes[n]));
        match load_on {
            Load::Facets => {
                // Out of the hole, normal to the flat facet.
                let normal = quad.area_vector(0.0, 0.0).normalize();
                for (n, area) in corners.into_iter().zip(quad.weights()) {
                    for axis in 0..3 {
                        load[3 * n + axis] += area * normal[axis];
                    }
                }
            }
            Load::Arc => {
                let rule = gauss(5).unwrap();
                for (s, w) in rule.iter() {
                    let angle = step * (j as f64 + 0.5 * (1.0 + s));
                    for (n, shape) in corners.into_iter().zip(shape([2, 2], s, 0.0)) {
                        let force = w * 0.5 * step * RADII[0] * shape;
                        load[3 * n] += force * angle.cos();
                        load[3 * n + 1] += force * angle.sin();
                    }
                }
            }
            Load::Work => {
                for n in corners {
                    let force = 0.25 * step * mesh.nodes[n].xy();
                    load[3 * n] += force.x;
                    load[3 * n + 1] += force.y;
                }
            }
        }
    }
    let mut fixed = BTreeMap::new();
    for k in 0..2 {
        for j in 0..=arcs {
            for r in 0..radii.len() {
                fixed.insert(3 * node(r, j, k) + 2, 0.0);
                if j == 0 {
                    fixed.insert(3 * node(r, j, k) + 1, 0.0);
                } else if j == arcs {
                    fixed.insert(3 * node(r, j, k), 0.0);
                }
            }
        }
    }
    let mut model = Model::new(&mesh, formulation, st_venant(1000.0, nu));
    let u = model.linear(&load, &fixed);
    let (a, b): (f64, f64) = (3.0, 9.0);
    let exact =
        (1.0 + nu) * a * a / (1000.0 * (b * b - a * a)) * (b * b / a + (1.0 - 2.0 * nu) * a);
    u[3 * node(0, 0, 0)] / exact
}

/// Their results are for one sector of 10 degrees; the paper gives the unit pressure at the inner radius, not the forces
/// on nodes. For elements with straight edges three readings are sensible, and differ by the square of the angle: on
/// facets (as a pressure on element faces does, and as the published 0.986 of their 8-node brick is to be read), on
/// the arc, and by work. At least 0.98 is asked for with the pressure where the exact solution has it, on the arc.
#[test]
fn thick_cylinder() {
    // The published exact value for nu = 0.4999.
    let exact: f64 = 1.4999 * 9.0 / 72e3 * (27.0 + 0.0002 * 3.0);
    assert!((exact - 5.0623e-3).abs() < 1e-7);
    // An independent implementation in another language (numpy), four digits.
    for (radial, expected) in [
        (false, [0.9859, 0.9884, 0.9910]),
        (true, [0.9799, 0.9824, 0.9849]),
    ] {
        for (load, expected) in [Load::Facets, Load::Arc, Load::Work]
            .into_iter()
            .zip(expected)
        {
            let found = ratio(0.4999, Formulation::Eas7, radial, load, 1);
            println!("thick cylinder, t radial {radial}, {load:?}: {found:.4}");
            assert!(
                (found - expected).abs() < 1e-4,
                "t radial {radial}, {load:?}: {found}"
            );
            assert!(found > 0.98 || load == Load::Facets);
        }
        let brick = ratio(0.4999, Formulation::Displacement, radial, Load::Arc, 1);
        assert!(brick < 0.06, "the brick must lock: {brick}");
    }
}

/// What is missing to 1 is no locking: nearly the same at nu = 0.3, and it falls with the square of the element size,
/// with t along the radius also from 0.9799. (In the independent implementation, two more in-plane enhanced strains, a
/// third, and rst through the thickness, up to eleven, change none of these digits; a richer transverse shear gives 0.9824
/// with t along the radius, at the price of the bending of thin shells, which lives by the poor one.)
#[test]
fn thick_cylinder_converges() {
    for radial in [false, true] {
        let error = |nu, fine| 1.0 - ratio(nu, Formulation::Eas7, radial, Load::Facets, fine);
        let [one, two] = [1, 2].map(|fine| error(0.4999, fine));
        let compressible = error(0.3, 1);
        println!("t radial {radial}: {one:.5} {two:.5}, nu = 0.3: {compressible:.5}");
        assert!(one < 1.6 * compressible, "{one} {compressible}");
        let rate = (one / two).log2();
        assert!(rate > 1.8 && rate < 2.2, "{rate}");
    }
}
