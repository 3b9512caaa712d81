//! The law of rolled sheets against that of von Mises, against its r-values, and in other frames.
use super::super::J2;
use super::super::j2::tests::CASES;
use super::*;

const E: f64 = 200e3;
const NU: f64 = 0.3;
const LAME: (f64, f64) = (
    E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)),
    0.5 * E / (1.0 + NU),
);
const R: [f64; 3] = [1.8, 1.4, 2.2];

fn sheet(hardening: Hardening, r: [f64; 3], angle: f64) -> Hill48 {
    Hill48::new(LAME, hardening, r, [angle.cos(), angle.sin(), 0.0])
}

fn largest<const N: usize>(a: [f64; N]) -> f64 {
    a.into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// Over two steps in a skew frame, whatever the rolling direction.
#[test]
fn with_equal_r_values_it_is_that_of_von_mises() {
    let skew = Metric::new([1.3, 0.8, 0.05, 0.2, -0.03, 0.04]);
    let steps = [
        [0.01, -0.015, 0.0008, 0.012, -0.001, 0.002],
        [0.03, 0.01, -0.001, -0.02, 0.002, -0.001],
    ];
    for hardening in CASES {
        let law = sheet(hardening, [1.0; 3], 0.4);
        let (lambda, mu) = LAME;
        let other = J2 {
            lambda,
            mu,
            hardening,
        };
        let mut old = Hill48State {
            turn: [0.6, 0.8],
            ..Hill48State::UNUSED
        };
        let mut its = super::super::J2State::UNUSED;
        for strain in &steps {
            let [a, b] = [
                law.response(&skew, strain, &old).unwrap(),
                other.response(&skew, strain, &its).unwrap(),
            ];
            let scale = largest(b.stress);
            assert!(scale > 100.0);
            let off = largest(std::array::from_fn::<f64, 6, _>(|v| {
                a.stress[v] - b.stress[v]
            }));
            assert!(off < 1e-11 * scale, "{off:e} {scale}");
            let moduli = b
                .tangent
                .as_flattened()
                .iter()
                .zip(a.tangent.as_flattened());
            let off = moduli.map(|(b, a)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10 * b.tangent[0][0], "{off:e}");
            assert!((a.energy / b.energy - 1.0).abs() < 1e-12);
            old = law.advance(&skew, strain, &old).unwrap();
            its = other.advance(&skew, strain, &its).unwrap();
            assert!(old.p > 1e-3 && (old.p / its.p - 1.0).abs() < 1e-11);
            assert!((old.work / its.work - 1.0).abs() < 1e-11);
        }
    }
}

/// A strip of unit frame whose axis has the rolling direction at `angle`, pulled to the logarithmic strain `log` in steps and free
/// otherwise: axial Kirchhoff stress and plastic strain along the strip's axes.
fn pulled(law: &Hill48, log: f64, steps: u32) -> (f64, [f64; 6], f64) {
    let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut old = law.start(&frame);
    let mut strain = [0.0; 6];
    let mut stress = [0.0; 6];
    for step in 1..=steps {
        strain[0] = 0.5 * ((2.0 * log * f64::from(step) / f64::from(steps)).exp() - 1.0);
        for _ in 0..60 {
            let r = law.response(&Metric::CARTESIAN, &strain, &old).unwrap();
            let free = nalgebra::SMatrix::<f64, 5, 5>::from_fn(|v, w| r.tangent[v + 1][w + 1]);
            let force = nalgebra::SVector::<f64, 5>::from_fn(|v, _| r.stress[v + 1]);
            stress = r.stress;
            let step = free.lu().solve(&force).expect("the strip has a stiffness");
            (strain[1..].iter_mut().zip(step.iter())).for_each(|(e, s)| *e -= s);
            if force.norm() < 1e-9 * r.stress[0].abs() {
                break;
            }
        }
        assert!(largest(std::array::from_fn::<f64, 5, _>(|v| stress[v + 1])) < 1e-6 * stress[0]);
        old = law.advance(&Metric::CARTESIAN, &strain, &old).unwrap();
    }
    let axes = Axes::new(&Metric::CARTESIAN, old.turn);
    let plastic = axes.contravariant(&law.components(&old.strain, 0.0));
    (stress[0] * (1.0 + 2.0 * strain[0]), plastic, old.p)
}

/// Hill (1948): plastic strains across the strip and through its thickness are as the r-value given for its direction, and the strip
/// across the rolling direction yields at `sqrt((1 + r0) r90 / (r0 (1 + r90)))` of the stress of the one along it.
#[test]
fn strips_narrow_by_their_r_values() {
    let plain = Hardening::Linear {
        initial: 200.0,
        slope: 0.0,
    };
    let mut first = 0.0;
    for (degrees, r) in [(0.0, R[0]), (45.0, R[1]), (90.0, R[2])] {
        // Strains so small that the axes do not turn under the strip at 45 degrees, which shears.
        let (stress, plastic, p) = pulled(&sheet(plain, R, f64::to_radians(degrees)), 4e-3, 8);
        let found = plastic[1] / plastic[2];
        println!("{degrees}: {stress} {found} {p}");
        assert!(plastic[2] < -5e-4);
        assert!((found / r - 1.0).abs() < 1e-4, "{degrees}: {found} for {r}");
        if degrees == 0.0 {
            first = stress;
            assert!((stress / 200.0 - 1.0).abs() < 1e-9, "{stress}");
            assert!((plastic[0] / p - 1.0).abs() < 1e-9);
        }
        if degrees == 90.0 {
            let ratio = ((1.0 + R[0]) * R[2] / (R[0] * (1.0 + R[2]))).sqrt();
            assert!((stress / first / ratio - 1.0).abs() < 1e-9, "{stress}");
        }
    }
}

/// The same sheet seen in a skew frame: stress and tangent are those of Cartesian axes, for a rolling direction in between.
#[test]
fn a_frame_does_not_matter() {
    let law = sheet(CASES[1], R, 0.5);
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let frame = [[1.2, 0.3, 0.0], [-0.4, 0.7, 0.0], [0.1, -0.2, 0.25]];
    let g = Matrix3::from_fn(|i, a| frame[i][a]);
    let metric = {
        let m = g * g.transpose();
        Metric::new(VOIGT.map(|(i, j)| m[(i, j)]))
    };
    let plain = [0.02, -0.013, -0.006, 0.018, 0.004, -0.003];
    let [e11, e22, e33, e12, e23, e13] = plain;
    let full = Matrix3::new(
        e11,
        0.5 * e12,
        0.5 * e13,
        0.5 * e12,
        e22,
        0.5 * e23,
        0.5 * e13,
        0.5 * e23,
        e33,
    );
    // E_ij = G_i . E . G_j
    let there = g * full * g.transpose();
    let skew = VOIGT.map(|(i, j)| there[(i, j)] * if i == j { 1.0 } else { 2.0 });
    let (a, b) = (law.start(&unit), law.start(&frame));
    assert!((b.turn[0] - 1.0).abs() > 0.01);
    let expected = law.response(&Metric::CARTESIAN, &plain, &a).unwrap();
    let found = law.response(&metric, &skew, &b).unwrap();
    assert!((found.energy / expected.energy - 1.0).abs() < 1e-12);
    let [s11, s22, s33, s12, s23, s13] = found.stress;
    let s = g.transpose() * Matrix3::new(s11, s12, s13, s12, s22, s23, s13, s23, s33) * g;
    let scale = largest(expected.stress);
    assert!(scale > 100.0);
    for (v, (i, j)) in VOIGT.into_iter().enumerate() {
        let off = (s[(i, j)] - expected.stress[v]).abs();
        assert!(off < 1e-11 * scale, "{v}: {off:e} {scale}");
    }
    let next = [
        law.advance(&Metric::CARTESIAN, &plain, &a),
        law.advance(&metric, &skew, &b),
    ];
    let [x, y] = next.map(|s| s.unwrap());
    assert!(x.p > 1e-3 && (x.p / y.p - 1.0).abs() < 1e-11);
    for (x, y) in x.strain.into_iter().zip(y.strain) {
        assert!((x - y).abs() < 1e-13);
    }
}

#[test]
fn a_direction_along_the_normal_is_seen() {
    let law = |rolling| Hill48::new(LAME, CASES[0], R, rolling);
    let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.0, 1.0]];
    assert!(law([1.0, 0.0, 5.0]).lies_in(&frame));
    assert!(!law([0.05, 0.0, 1.0]).lies_in(&frame));
}
