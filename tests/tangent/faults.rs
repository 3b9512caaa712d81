//! What a moving master does with points that are not plainly in contact.
use crate::cases::{Hardening, mesh, plain};
use crate::support::V;
use covact::contact::fault::PointFault;
use covact::contact::moving::{MovingMaster, MovingTouch};
use covact::contact::rigid::{Exact, Overhang};
use covact_geometry::{Hint, MovingFacets};

fn touch(
    facets: &MovingFacets,
    q: [f64; 3],
    hint: &mut Option<Hint>,
    accept: impl Fn(u32) -> bool,
) -> Result<Option<MovingTouch>, PointFault> {
    let master = MovingMaster {
        facets,
        undeformed: facets,
        depth: 0.3,
        keep: false,
    };
    master.touch(
        &V::from(q),
        (hint, Overhang::default()),
        &Hardening,
        &Exact,
        accept,
    )
}

#[test]
fn open_points_and_faults() {
    let (nodes, list) = mesh(2, 1, |x, y| V::new(x, y, 0.0));
    let plane = plain(&nodes, &list, 1);
    let mut hint = None;
    let met = touch(&plane, [0.4, 0.3, -0.1], &mut hint, |_| true);
    let met = met.unwrap().expect("contact");
    assert_eq!(met.facet, 3);
    assert_eq!(hint.map(|h| h.patch), Some(3));
    assert!((met.xi3 + 0.1).abs() < 1e-15 && met.n < 0.0);
    assert!((met.normal - V::new(0.0, 0.0, 1.0)).norm() < 1e-15);
    for (name, q, accept) in [
        ("above", [0.4, 0.3, 0.1], u32::MAX),
        ("deeper than the depth", [0.4, 0.3, -0.31], u32::MAX),
        ("past the free border", [1.05, 0.3, -0.1], u32::MAX),
        ("past a free corner", [1.05, -1.05, -0.1], u32::MAX),
        // The border to a facet that is refused is free.
        ("under a refused facet", [0.1, 0.3, -0.05], 3),
    ] {
        let met = touch(&plane, q, &mut hint, |f| f != accept);
        assert_eq!(met, Ok(None), "{name}");
    }
    let met = touch(&plane, [0.0, f64::NAN, 0.0], &mut hint, |_| true);
    assert_eq!(met, Err(PointFault::NotFinite));

    // The axis of curvature of a parabola's crest lies half a unit below it.
    let (nodes, list) = mesh(1, 2, |x, y| V::new(x, y, -2.0 * x * x));
    let crest = plain(&nodes, &list, 2);
    assert!(matches!(
        touch(&crest, [0.0, 0.3, -0.2], &mut None, |_| true),
        Ok(Some(_))
    ));
    let fault = touch(&crest, [0.0, 0.3, -0.25], &mut None, |_| true).unwrap_err();
    assert!(fault.to_string().contains("facet 0"), "{fault}");
}
