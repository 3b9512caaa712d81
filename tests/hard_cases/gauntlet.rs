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

cases!(geometry:);

cases!(motion:);

cases!(conditioning:);

cases!(instability:);

cases!(friction:);

cases!(invariance: threads);

cases!(elements:);

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
    ];
    for (group, (name, names)) in GROUPS.iter().zip(tests) {
        let cases: Vec<&str> = group.cases.iter().map(|c| c.name).collect();
        assert_eq!((group.name, &cases[..]), (name, names));
    }
}
