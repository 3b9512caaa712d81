//! What elements refuse, and what they say of it.
use super::*;

#[test]
pub(super) fn impossible_strain_is_a_typed_fault() {
    let x = nodes();
    // Pressed flat and through: det F < 0 at all Gauss points, and NaN.
    let mut out = H8System::default();
    // Dashpots take any change of strain: the elements beside them refuse.
    let laws_of_scenes = laws().into_iter().filter(|l| !matches!(l, Law::Dashpot(_)));
    for law in laws_of_scenes {
        let block = H8Block::new(&mesh(&x), Formulation::Eas7, law).unwrap();
        let mut state = vec![0.0; block.state_len()];
        state[0] = 50.0;
        let fault = block
            .evaluate(0, &[Vec3::zeros(); 8], &mut state, &mut out)
            .unwrap_err();
        assert!(matches!(
            fault,
            ElementFault { element: 0, cause: FaultCause::Collapsed { point: 0, ratio } } if ratio < 0.0
        ));
        assert!(
            fault
                .to_string()
                .starts_with("element 0: det C / det G = -"),
            "{fault}"
        );
        state[0] = 0.0;
        let mut u = [Vec3::zeros(); 8];
        u[3].y = f64::NAN;
        assert!(block.evaluate(0, &u, &mut state, &mut out).is_err());
        let mut stress = [[0.0; 6]; 8];
        assert!(block.stresses(0, &u, &state, &mut stress).is_err());
    }
    // Two stretches turned inside out give a positive determinant, which must not pass.
    let mut e = [0.0; 6];
    e[1] = -0.8;
    e[2] = -0.8;
    let Law::NeoHooke(law) = laws()[1] else {
        unreachable!()
    };
    assert!(
        matches!(law.energy(&Metric::CARTESIAN, &e, &()), Err(Collapsed { ratio }) if ratio > 0.0)
    );
}

#[test]
pub(super) fn bad_meshes_and_constants_are_refused() {
    let law = laws()[0];
    let mut bad = mesh(&nodes());
    bad.nodes.swap(0, 4);
    bad.nodes.swap(1, 5);
    bad.nodes.swap(2, 6);
    bad.nodes.swap(3, 7);
    let error = H8Block::new(&bad, Formulation::Eas7, law).unwrap_err();
    assert!(
        matches!(error, ShellError::Inverted { element: 0, jacobian, count: 1 } if jacobian < 0.0)
    );
    assert!(
        error
            .to_string()
            .starts_with("element 0 is inverted or flat: Jacobian determinant -")
    );
    let mut bad = mesh(&nodes());
    bad.connectivity[5] = 99;
    assert_eq!(
        H8Block::new(&bad, Formulation::Eas7, law).unwrap_err(),
        ShellError::Node {
            element: 0,
            node: 99,
            nodes: 8
        }
    );
    let soft = |nu| {
        Law::new(&Material::NeoHooke(Elastic {
            e: 1.0,
            nu,
            density: None,
        }))
    };
    assert!(soft(0.5).is_err() && soft(f64::NAN).is_err() && soft(-1.0).is_err());
    assert!(
        Law::new(&Material::NeoHooke(Elastic {
            e: 0.0,
            nu: 0.3,
            density: None
        }))
        .is_err()
    );
    assert!(matches!(
        H8Block::new(&mesh(&nodes()), Formulation::Eas3, soft(0.49).unwrap()),
        Err(ShellError::TooFewEnhanced { .. })
    ));
}
