//! The gauntlet, a test per case: the same code as `covact gauntlet`.
use covact::gauntlet::{GROUPS, find};

fn passes(group: &str, name: &str) {
    let case = find(group, name).expect("a case of this name");
    let verdict = case.run();
    for check in &verdict.checks {
        println!("{}: {:.3e} of {:.1e}", check.what, check.value, check.limit);
    }
    println!(
        "{} iterations, {:.1} s",
        verdict.iterations, verdict.seconds
    );
    let failures = verdict.failures().join("\n");
    assert!(verdict.passed(), "{failures}");
}

/// A test for each named case, and the list of them.
macro_rules! cases {
    ($group:ident: $($name:ident),* $(,)?) => {
        mod $group {
            $(#[test]
            fn $name() {
                super::passes(stringify!($group), stringify!($name));
            })*
            pub const NAMES: &[&str] = &[$(stringify!($name)),*];
        }
    };
}

cases!(
    geometry: pole,
    seam,
    weights,
    short_span,
    sliver,
    reversed_patch,
    flat_cylinder,
    small_radius,
    focal,
    beyond_focal,
    crease,
    convex_edge,
    concave_edge,
    corner,
    thin_tool,
    gaps,
    trim,
    free_edge,
);

cases!(motion: borders, open_edges, fillet, sharp_corner, full_turn, cam, turned_together,
    through_in_one_step, mirrored_elements, reversal, fifty_times);

cases!(conditioning: thickness, poisson, penalty, penalty_under_ball, stiffness_ratio, scale, far, time_unit);

cases!(instability:
    rests_on_contact_alone,
    first_touch_flush,
    slides_off,
    refused_without,
    between_tools,
    soft_support,
    snap_under_dead_load,
    snap_under_tool,
);

cases!(friction: mu_0_to_2, slip_front, hysteresis, wedge, pole, closing_again, mu_in_time, fast_turn, sled);

cases!(
    invariance: placed_elsewhere,
    carried_along,
    mirrored,
    renumbered,
    order_of_pairs,
    threads,
    swapped_and_reversed,
    elevated_and_refined,
);

cases!(elements: squeezed, squeezed_sheet, distorted, inverted, full_circle, layers);

cases!(
    bodies: every_rule,
    pile,
    small_on_big,
    mirror_images,
    folded_shut,
    both_faces,
    placed_elsewhere,
    sides_exchanged,
    shrink_fit,
    line_contact,
);

cases!(
    metal: upset,
    any_step,
    let_go_and_reloaded,
    one_curve,
    other_units,
    swings,
    hill_of_mises,
    rolled_across,
    strips,
    thick_tube,
);

cases!(
    forming: holder,
    belt,
    stretched_cup,
    matched_dies,
    springback,
    released_twice,
);

cases!(
    dynamics: bar_on_wall,
    cradle,
    short_on_long,
    moving_frame,
    own_units,
    askew_wall,
    slides_to_rest,
    comes_to_rest,
    pendulum,
    slowed,
);

cases!(
    loads: hydrostatic,
    balloon,
    column,
    lifted_strip,
    catenary,
    truss,
    truss_snaps,
);

cases!(
    stages: as_tables,
    either_order,
    continued,
    solvers,
    small_limit,
    superposed,
    rigid_limit,
);

cases!(
    nurbs: rolled_up,
    frame,
    blown_tube,
    as_other_elements,
    mirror_images,
    described_otherwise,
    joined,
    trimmed,
);

cases!(
    cad: step_solid,
    inches,
    formats,
    one_file_or_two,
    facets,
    triangles,
);

#[test]
fn every_case_is_a_test() {
    let tests = [
        ("geometry", geometry::NAMES),
        ("motion", motion::NAMES),
        ("conditioning", conditioning::NAMES),
        ("instability", instability::NAMES),
        ("friction", friction::NAMES),
        ("invariance", invariance::NAMES),
        ("elements", elements::NAMES),
        ("bodies", bodies::NAMES),
        ("metal", metal::NAMES),
        ("forming", forming::NAMES),
        ("dynamics", dynamics::NAMES),
        ("loads", loads::NAMES),
        ("stages", stages::NAMES),
        ("nurbs", nurbs::NAMES),
        ("cad", cad::NAMES),
    ];
    assert_eq!(GROUPS.len(), tests.len());
    for (group, (name, names)) in GROUPS.iter().zip(tests) {
        let cases: Vec<&str> = group.cases.iter().map(|c| c.name).collect();
        assert_eq!((group.name, &cases[..]), (name, names));
    }
}
