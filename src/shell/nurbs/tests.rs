//! Derivatives of the sheet's elements against dual numbers; rigid motions, patch tests, and the law in plane stress.
use super::plane_stress::{Place, PlaneStress, Sheet};
use super::*;
use crate::mesh::nurbs::Fineness;
use crate::mesh::{Border, Edge, Mesh};
use crate::scene::{Elastic, Material};
use crate::shell::material::{MaterialLaw, Metric};
use covact_geometry::basis::Basis;
use covact_geometry::{NurbsCurve, NurbsPatch, Trim, TrimCurve, TrimLoop};
use nalgebra::{DMatrix, Rotation3, SymmetricEigen};
use num_dual::Dual64;

/// Values without a pattern between -1 and 1.
fn noise(k: usize) -> f64 {
    let x = (12.9898 * k as f64 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn laws() -> [Law; 2] {
    let elastic = Elastic::new(1000.0, 0.3);
    [
        Material::StVenantKirchhoff(elastic),
        Material::NeoHooke(elastic),
    ]
    .map(|m| Law::new(&m).unwrap())
}

/// A patch with a distorted net, `height` high: flat and polynomial where that is zero, else rational.
fn patch(height: f64) -> NurbsPatch {
    let knots = || vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0];
    let points: Vec<Vec3> = (0..25)
        .map(|k| {
            let (i, j) = ((k % 5) as f64 / 4.0, (k / 5) as f64 / 4.0);
            let off = |n: usize| 0.05 * noise(4 * k + n);
            let z = height * (0.8 * i * i - 0.5 * j * j + 0.3 * i * j + off(2));
            Vec3::new(i + off(0), 0.9 * j + 0.2 * i + off(1), z)
        })
        .collect();
    let uneven = if height > 0.0 { 0.2 } else { 0.0 };
    let weights: Vec<f64> = (0..25).map(|k| 1.0 + uneven * noise(4 * k + 3)).collect();
    NurbsPatch::new([3, 3], [knots(), knots()], [5, 5], &points, Some(&weights)).unwrap()
}

fn sheet(height: f64, assumed: bool) -> NurbsSheet {
    NurbsSheet::new(&patch(height), 0.08, Fineness::Elements([2, 2]), assumed).unwrap()
}

/// A disc of its parameters, which cuts all of its four elements.
fn disc(assumed: bool) -> NurbsSheet {
    let knots = [0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0];
    let (centre, radius, w) = (0.45, 0.43, 0.5f64.sqrt());
    let half = |sign: f64| {
        let place = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0]];
        let points = (place.iter().zip([1.0, w, 1.0, w, 1.0])).map(|([x, y], w)| {
            let at = |v: f64| w * (centre + sign * radius * v);
            [at(*x), at(*y), 0.0, w]
        });
        let basis = Basis::new(2, knots.to_vec(), 5).unwrap();
        TrimCurve {
            parameter: NurbsCurve::from_homogeneous(basis, points.collect()).unwrap(),
            space: None,
            entity: 0,
        }
    };
    let curves = vec![half(1.0), half(-1.0)];
    let trim = Trim::new(vec![TrimLoop { curves }], [[0.0, 1.0]; 2], 1e-9).unwrap();
    let patch = patch(1.0).with_trim(Some(trim));
    NurbsSheet::new(&patch, 0.08, Fineness::Elements([2, 2]), assumed).unwrap()
}

fn held(block: &mut NurbsBlock) {
    let plane = Vec3::new(0.6, 0.0, 0.8);
    // Curves of the trim, where it leaves nothing of the edges.
    let borders = match block.sheet.free_borders()[..] {
        [first, second] => [first, second],
        _ => [Edge::ALL[0], Edge::ALL[3]].map(Border::Edge),
    };
    let both = [
        (borders[0], HeldNormal::Clamped),
        (borders[1], HeldNormal::InPlane(plane)),
    ];
    block.hold(&both).unwrap();
    let points = if block.sheet.is_trimmed() { 12 } else { 16 };
    assert_eq!(block.borders.len(), points);
}

/// Displacements without a pattern of an element's control points.
fn moved(size: f64) -> [V<f64>; NODES] {
    std::array::from_fn(|a| std::array::from_fn(|c| size * noise(100 + 3 * a + c)))
}

fn dual(u: &[V<f64>; NODES], dof: usize) -> [V<Dual64>; NODES] {
    std::array::from_fn(|a| {
        std::array::from_fn(|c| Dual64::new(u[a][c], if 3 * a + c == dof { 1.0 } else { 0.0 }))
    })
}

/// The tangent is the derivative of the forces, and those the gradient of the energy: both laws, assumed strains and plain ones,
/// clamped edges and planes of symmetry, whole elements and cut ones, at large displacements.
#[test]
fn derivatives_against_dual_numbers() {
    for law in laws() {
        for sheet in [sheet(1.0, true), sheet(1.0, false), disc(true), disc(false)] {
            let mut block = NurbsBlock::new(&sheet, law).unwrap();
            assert_eq!(block.groups.is_empty(), !sheet.is_trimmed());
            held(&mut block);
            let u = moved(0.06);
            let vectors = u.map(Vec3::from);
            let mut system = NurbsSystem::default();
            for e in 0..block.elements() {
                block.evaluate(e, &vectors, None, &mut system).unwrap();
                let norm = system.k.iter().map(|k| k * k).sum::<f64>().sqrt();
                let size = system.f.iter().map(|f| f * f).sum::<f64>().sqrt();
                assert!(norm > 10.0 && size > 0.5, "{norm} {size}");
                let mut plain = [0.0; DOFS];
                let energy = block.residual(e, &vectors, &mut plain).unwrap();
                assert!((energy - system.energy).abs() < 1e-13 * energy);
                for dof in 0..DOFS {
                    let (energy, f) = block.forces(e, &dual(&u, dof)).unwrap();
                    assert!((energy.eps - system.f[dof]).abs() < 1e-12 * size);
                    for row in 0..DOFS {
                        let [exact, k] = [f[row / 3][row % 3].eps, system.k[DOFS * dof + row]];
                        assert!(
                            (exact - k).abs() < 1e-12 * norm,
                            "{e} {dof} {row}: {exact} {k}"
                        );
                        assert!((f[row / 3][row % 3].re - system.f[row]).abs() < 1e-12 * size);
                        assert_eq!(k, system.k[DOFS * row + dof]);
                    }
                }
            }
        }
    }
}

/// A curved patch of which a trim leaves a whole element and a hundredth of the sides of its neighbours.
fn slivers() -> NurbsSheet {
    let corners = [[0.0, 0.0], [0.41, 0.0], [0.41, 0.41], [0.0, 0.41]];
    let line = |k: usize| {
        let [a, b] = [corners[k], corners[(k + 1) % 4]];
        let points = [a, b].map(|[x, y]| [x, y, 0.0, 1.0]).to_vec();
        let basis = Basis::new(1, vec![0.0, 0.0, 1.0, 1.0], 2).unwrap();
        TrimCurve {
            parameter: NurbsCurve::from_homogeneous(basis, points).unwrap(),
            space: None,
            entity: 0,
        }
    };
    let curves = (0..4).map(line).collect();
    let trim = Trim::new(vec![TrimLoop { curves }], [[0.0, 1.0]; 2], 1e-9).unwrap();
    let patch = patch(1.0).with_trim(Some(trim));
    NurbsSheet::new(&patch, 0.08, Fineness::Elements([2, 2]), true).unwrap()
}

/// Control points of which next to nothing is left are held to their neighbours: tangents with what holds them are consistent, each
/// has a stiffness, and a rotation by 70 degrees is as free of force as without.
#[test]
fn loose_points_follow_their_neighbours() {
    let block = NurbsBlock::new(&slivers(), laws()[0]).unwrap();
    // The outermost row and column, whose shape functions are cubes of the part that is left.
    assert_eq!(block.tethers.len(), 9);
    let turn = Rotation3::new(Vec3::new(0.3, -0.7, 0.5).normalize() * 70f64.to_radians());
    let bending = block.bending();
    let mut system = NurbsSystem::default();
    for tether in &block.tethers {
        let e = tether.element as usize;
        let u = block.reference[e].map(|x| {
            let x = Vec3::from(x);
            turn * x - x + Vec3::new(3.0, 1.0, -2.0)
        });
        let turned = u.map(Into::into);
        assert!(tether.forces(&turned, &mut [[0.0; 3]; NODES]) < 1e-20 * bending);
        let mut f = [0.0; DOFS];
        block.residual(e, &u, &mut f).unwrap();
        assert!(f.iter().all(|f| f.abs() < 1e-11), "{f:?}");
        let u = moved(0.06);
        block
            .evaluate(e, &u.map(Vec3::from), None, &mut system)
            .unwrap();
        let mut f = [[0.0; 3]; NODES];
        let energy = tether.forces(&u, &mut f);
        let largest = f
            .as_flattened()
            .iter()
            .fold(0.0, |m: f64, f| m.max(f.abs()));
        assert!(energy > 1e-9 * bending && largest > 1e-8 * bending);
        for dof in 0..DOFS {
            let mut dual_f = [[Dual64::from(0.0); 3]; NODES];
            let dual_energy = tether.forces(&dual(&u, dof), &mut dual_f);
            assert!((dual_energy.eps - f[dof / 3][dof % 3]).abs() < 1e-13 * largest);
            assert!(system.k[DOFS * dof + dof] > 0.0, "{e} {dof}");
            let mut k = vec![0.0; DOFS * DOFS];
            tether.linearize(&u, &mut [0.0; DOFS], &mut k);
            for row in 0..=dof {
                let exact = dual_f[row / 3][row % 3].eps;
                assert!((exact - k[DOFS * dof + row]).abs() < 1e-12 * largest / 0.06);
            }
        }
    }
}

/// Stiffness of a whole sheet at rest.
fn stiffness(block: &NurbsBlock, mesh: &Mesh) -> DMatrix<f64> {
    let n = 3 * mesh.nodes.len();
    let mut k = DMatrix::zeros(n, n);
    let mut system = NurbsSystem::default();
    for e in 0..block.elements() {
        let still = [Vec3::zeros(); NODES];
        block.evaluate(e, &still, None, &mut system).unwrap();
        let nodes = block.nodes_of(e);
        for column in 0..DOFS {
            for row in 0..DOFS {
                let at = |d: usize| 3 * nodes[d / 3] as usize + d % 3;
                k[(at(row), at(column))] += system.k[DOFS * column + row];
            }
        }
    }
    k
}

/// Six motions cost nothing and no other does, also of a flat sheet, whose membrane bending does not hold; three by three points
/// integrate enough.
#[test]
fn six_rigid_motions_and_no_more() {
    for height in [0.0, 1.0] {
        for assumed in [true, false] {
            let mut sheet = sheet(height, assumed);
            let mesh = sheet.mesh();
            for law in laws() {
                let block = NurbsBlock::new(&sheet, law).unwrap();
                let eigen = SymmetricEigen::new(stiffness(&block, &mesh)).eigenvalues;
                let largest = eigen.amax();
                let mut values: Vec<f64> = eigen.iter().map(|v| v.abs() / largest).collect();
                values.sort_by(f64::total_cmp);
                assert!(values[5] < 1e-13, "{height} {assumed}: {:?}", &values[..8]);
                assert!(values[6] > 1e-8, "{height} {assumed}: {:?}", &values[..8]);
            }
        }
    }
}

/// A rotation by 52 degrees and a shift stress nothing.
#[test]
fn a_rotation_is_free_of_force() {
    let turn = Rotation3::new(Vec3::new(0.3, -0.7, 0.5).normalize() * 52f64.to_radians());
    for law in laws() {
        let block = NurbsBlock::new(&sheet(1.0, true), law).unwrap();
        for e in 0..block.elements() {
            let u = block.reference[e].map(|x| {
                let x = Vec3::from(x);
                turn * x - x + Vec3::new(3.0, 1.0, -2.0)
            });
            let mut f = [0.0; DOFS];
            let energy = block.residual(e, &u, &mut f).unwrap();
            assert!(f.iter().all(|f| f.abs() < 1e-11), "{f:?}");
            assert!(energy.abs() < 1e-20, "{energy}");
            // Stretched by as little as a millionth it has forces.
            let more = block.reference[e].map(|x| Vec3::from(x) * 1e-6);
            block.residual(e, &more, &mut f).unwrap();
            assert!(f.iter().any(|f| f.abs() > 1e-6));
        }
    }
}

/// A flat sheet with a distorted net, stretched and sheared evenly: the forces inside of it vanish, because assumed strains keep
/// the element's mean. (Of rational patches up to the error of integration.)
#[test]
fn patch_test_on_a_distorted_net() {
    let mut sheet = sheet(0.0, true);
    let mesh = sheet.mesh();
    let [nu, nv] = sheet.patches[0].patch.counts();
    for law in laws() {
        let block = NurbsBlock::new(&sheet, law).unwrap();
        let mut forces = vec![Vec3::zeros(); mesh.nodes.len()];
        for e in 0..block.elements() {
            let u = block.reference[e]
                .map(|x| 1e-3 * Vec3::new(2.0 * x[0] + 0.7 * x[1], -0.4 * x[0] + 1.1 * x[1], 0.0));
            let mut f = [0.0; DOFS];
            block.residual(e, &u, &mut f).unwrap();
            for (node, f) in block.nodes_of(e).iter().zip(f.chunks_exact(3)) {
                forces[*node as usize] += Vec3::from_column_slice(f);
            }
        }
        let largest = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        assert!(largest > 1e-2);
        for (n, f) in forces.iter().enumerate() {
            let (i, j) = (n % nu, n / nu);
            let inside = i > 0 && i < nu - 1 && j > 0 && j < nv - 1;
            assert!(
                !inside || f.norm() < 1e-12 * largest,
                "{n}: {}",
                f.norm() / largest
            );
        }
    }
}

/// A flat sheet whose every point moves by `c x` along z, after which its tangent is asked for along `x` along y. Both stretch it along x in
/// second order only, by `c^2 / 2` and `1 / 2`: what mixed integration points leave out is `t C_1111 (c^2 / 2)` times the area, of second
/// order in the correction. Forces and energy are the same.
#[test]
fn what_a_correction_stretches_is_left_out_of_the_geometric_part() {
    let c = 0.4;
    for sheet in [sheet(0.0, true), sheet(0.0, false)] {
        let block = NurbsBlock::new(&sheet, laws()[0]).unwrap();
        for e in 0..block.elements() {
            let du = block.reference[e].map(|x| Vec3::z() * (c * x[0]));
            let evaluated = |part: Option<f64>| {
                let last = part.map(|part| du.map(|d| d * part));
                let mut out = NurbsSystem::default();
                block.evaluate(e, &du, last.as_ref(), &mut out).unwrap();
                let v: Vec<f64> = block.reference[e]
                    .iter()
                    .flat_map(|x| [0.0, x[0], 0.0])
                    .collect();
                let mut sum = 0.0;
                for (column, v2) in out.k.chunks_exact(DOFS).zip(&v) {
                    sum += v2 * column.iter().zip(&v).map(|(k, v1)| k * v1).sum::<f64>();
                }
                (sum, out.f, out.energy)
            };
            let (plain, f, energy) = evaluated(None);
            let expected = 1000.0 / (1.0 - 0.09) * 0.5 * c * c * block.volume(e);
            for (last, part) in [(1.0, 1.0), (0.5, 0.25), (-1.0, 1.0)] {
                let (mixed, same, stored) = evaluated(Some(last));
                assert!((f, energy) == (same, stored));
                assert!(
                    (plain - mixed - part * expected).abs() < 1e-12 * plain,
                    "{plain} {mixed}"
                );
            }
        }
    }
}

/// A flat sheet bent to an even curvature by its control points has the moment of the closed form and no membrane force.
#[test]
fn constant_curvature() {
    let knots = || vec![0.0, 0.0, 1.0, 1.0];
    let flat = |i: usize| Vec3::new((i % 2) as f64, (i / 2) as f64, 0.0);
    let plate: Vec<Vec3> = (0..4).map(flat).collect();
    let plate = NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &plate, None).unwrap();
    let sheet = NurbsSheet::new(&plate, 0.1, Fineness::Elements([2, 2]), true).unwrap();
    let block = NurbsBlock::new(&sheet, laws()[0]).unwrap();
    // w = k x^2 / 2: its control points along x are those of the square.
    let k = 1e-6;
    let square: Vec<Vec3> = [0.0, 0.0, 0.5].map(|w| Vec3::new(k * w, 0.0, 0.0)).to_vec();
    let curve: Vec<Vec3> = square.iter().chain(&square).copied().collect();
    let quadratic = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let w = NurbsPatch::new([2, 1], [quadratic, knots()], [3, 2], &curve, None).unwrap();
    // In the sheet's own space, so that the control points go with each other.
    let w = w.elevated(0, 1).unwrap().elevated(1, 2).unwrap();
    let w = w
        .insert_knots(0, &[0.5])
        .unwrap()
        .insert_knots(1, &[0.5])
        .unwrap();
    assert_eq!(w.counts(), sheet.patches[0].patch.counts());
    let w = w.points();
    for e in 0..block.elements() {
        let u = block
            .nodes_of(e)
            .map(|n| Vec3::new(0.0, 0.0, w[n as usize].x));
        let mean = block.mean_resultants(e, &u).unwrap();
        let bending = 1000.0 * 0.1f64.powi(3) / (12.0 * (1.0 - 0.09));
        // kap_11 = -w_,11.
        assert!(
            (mean.moment[0] / (-bending * k) - 1.0).abs() < 1e-9,
            "{mean:?}"
        );
        assert!((mean.moment[1] / (-0.3 * bending * k) - 1.0).abs() < 1e-9);
        assert!(mean.membrane.iter().all(|n| n.abs() < 1e-9 * bending));
    }
}

/// Neo-Hooke in plane stress is the law in three dimensions with the thickness strain that leaves no stress across: the same
/// stress, and the condensed moduli by differences of it.
#[test]
fn plane_stress_is_the_condensed_law() {
    let law = laws()[1];
    let Law::NeoHooke(solid) = law else { panic!() };
    let Some(Sheet::Rubber(rubber)) = Sheet::new(&law, 1e-4) else {
        panic!()
    };
    let place = Place {
        metric: [1.3, 0.8, 0.2],
        curvature: [0.0; 3],
    };
    let e = [0.3, -0.12, 0.25, 0.0, 0.0, 0.0];
    let answer = rubber.answer(0, &place, &e).unwrap();
    // E_33 by Newton's method on the law in three dimensions.
    let metric = Metric::new([1.3, 0.8, 1.0, 0.2, 0.0, 0.0]);
    let mut across = 0.0;
    let mut response = solid.response(&metric, &[0.0; 6], &()).unwrap();
    for _ in 0..30 {
        let strain = [e[0], e[1], across, e[2], 0.0, 0.0];
        response = solid.response(&metric, &strain, &()).unwrap();
        across -= response.stress[2] / response.tangent[2][2];
    }
    let scale = answer.resultants[0].abs();
    assert!(scale > 1e-3);
    for (plane, full) in [(0, 0), (1, 1), (2, 3)] {
        let expected = 1e-4 * response.stress[full];
        assert!((answer.resultants[plane] - expected).abs() < 1e-12 * scale);
        for (other, column) in [(0, 0), (1, 1), (2, 3)] {
            let c = &response.tangent;
            let condensed = c[full][column] - c[full][2] * c[2][column] / c[2][2];
            let found = answer.tangent[plane][other];
            assert!((found - 1e-4 * condensed).abs() < 1e-12 * 1e-4 * c[0][0]);
        }
    }
    assert!((answer.energy - 1e-4 * response.energy).abs() < 1e-12 * answer.energy);
    assert!((rubber.thinning(&place, &e) - (1.0 + 2.0 * across).sqrt()).abs() < 1e-12);
}

/// Laws without a form in plane stress are refused.
#[test]
fn hencky_is_refused() {
    let hencky = Law::new(&Material::Hencky(Elastic::new(1.0, 0.3))).unwrap();
    assert_eq!(
        NurbsBlock::new(&sheet(1.0, true), hencky).unwrap_err(),
        ShellError::PlaneStress
    );
}
