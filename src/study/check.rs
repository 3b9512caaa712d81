//! What can be wrong with a study, apart from its scene.
use super::file::MasterChoice;
use super::file::{Choice, Grid, Measure, Reference, StlSource, Study, Take};
use super::load::LoadedStudy;
use crate::scene::{Checker, Problem, Scene, pointer};
use std::collections::BTreeSet;

/// Most runs of a study, those of its references left out.
pub(super) const MOST_RUNS: usize = 10_000;

/// Problems that need neither the variants of the scene nor results.
pub(super) fn check(loaded: &LoadedStudy, scene: &Scene) -> Vec<Problem> {
    let mut c = Checker::new(loaded);
    let study = &loaded.study;
    if study.grids.is_empty() {
        let help = "write `[{\"choices\": [{\"shell\": {\"values\": [{\"h8\": [10, 10]}]}}]}]`";
        c.add(
            "/grids",
            "a study needs at least one grid",
            Some(help.into()),
        );
    }
    let mut runs = 0usize;
    for (i, grid) in study.grids.iter().enumerate() {
        check_grid(&mut c, &format!("/grids/{i}"), grid);
        let counts = grid.choices.iter().map(Choice::count);
        runs = runs.saturating_add(counts.fold(1, usize::saturating_mul));
    }
    if runs > MOST_RUNS {
        let message = format!("the grids have {runs} combinations");
        c.add("/grids", message, Some(format!("at most {MOST_RUNS}")));
    }
    for (name, refinement) in &study.references {
        let at = pointer(&["references", name]);
        let count = refinement.runs.len();
        if !(2..=3).contains(&count) {
            let message = format!("a reference has {count} run(s)");
            let help = "two or three, coarse to fine: the coarser ones tell how far the last one is from the limit";
            c.add(&format!("{at}/runs"), message, Some(help.into()));
        }
        if !(refinement.ratio > 1.0 && refinement.ratio.is_finite()) {
            let message = format!("the ratio of mesh sizes is {}", refinement.ratio);
            c.add(&format!("{at}/ratio"), message, Some("more than 1".into()));
        }
        if let Some(order) = refinement.order {
            c.positive(&format!("{at}/order"), "the order", order);
        }
    }
    if study.quantities.is_empty() {
        let help = "name a column of the history: `{\"name\": \"force\", \"of\": {\"column\": {\"name\": \"force.ball.z\"}}}`";
        c.add(
            "/quantities",
            "a study needs a quantity to measure",
            Some(help.into()),
        );
    }
    check_quantities(&mut c, study, scene);
    let timing = &study.timing;
    c.whole("/timing/repeats", timing.repeats, 1, 1000);
    c.whole("/timing/threads", timing.threads, 1, 4096);
    c.positive("/timing/limit", "the limit", timing.limit);
    for (i, target) in study.targets.iter().enumerate() {
        c.positive(&format!("/targets/{i}"), "a relative error", *target);
    }
    c.finish()
}

fn check_grid(c: &mut Checker, at: &str, grid: &Grid) {
    if grid.choices.is_empty() {
        let help = "name what varies: `master`, `shell`, `points`, `tangent`, `penalty`, `augmentation`, `step`, \
                    `tolerance`, `key` or `variants`";
        c.add(
            &format!("{at}/choices"),
            "the grid has no choices",
            Some(help.into()),
        );
    }
    let mut names = BTreeSet::new();
    for (k, choice) in grid.choices.iter().enumerate() {
        let at = format!("{at}/choices/{k}/{}", choice.key());
        let name = choice.name();
        if name.trim().is_empty() {
            c.add(&format!("{at}/name"), "the name is empty", None);
        }
        if !names.insert((name, choice.target())) {
            let message = format!("two choices of the grid are called `{name}`");
            c.add(
                &at,
                message,
                Some("give every choice a name of its own".into()),
            );
        }
        if choice.count() == 0 {
            let message = "the choice has no values";
            c.add(
                &format!("{at}/values"),
                message,
                Some("name at least one".into()),
            );
        }
        check_values(c, &at, choice);
    }
}

/// What the scene would not find, or not at this place.
fn check_values(c: &mut Checker, at: &str, choice: &Choice) {
    match choice {
        Choice::Master { values, .. } => {
            for (k, value) in values.iter().enumerate() {
                let at = format!("{at}/values/{k}/stl");
                match value {
                    MasterChoice::Stl(StlSource::File(path)) => {
                        c.file(&format!("{at}/file"), path, &[]);
                    }
                    MasterChoice::Stl(StlSource::Chord(x)) => {
                        c.positive(&format!("{at}/chord"), "the chord error", *x);
                    }
                    MasterChoice::Stl(StlSource::Size(x)) => {
                        c.positive(&format!("{at}/size"), "the size of the facets", *x);
                    }
                    MasterChoice::Stl(StlSource::Count(n)) => {
                        for (i, n) in n.iter().enumerate() {
                            c.whole(&format!("{at}/count/{i}"), *n, 1, 100_000);
                        }
                    }
                    _ => {}
                }
            }
        }
        Choice::Step { values } => {
            for (k, step) in values.iter().enumerate() {
                c.positive(&format!("{at}/values/{k}"), "the step", *step);
            }
        }
        Choice::Key { at: pointers, .. } if pointers.is_empty() => {
            let help = "write JSON pointers, as in `[\"/solution/newton/line_search\"]`";
            c.add(
                &format!("{at}/at"),
                "no key of the scene is named",
                Some(help.into()),
            );
        }
        Choice::Variants { values, .. } => {
            let mut labels = BTreeSet::new();
            for (k, variant) in values.iter().enumerate() {
                if !labels.insert(variant.label.as_str()) {
                    c.add(
                        &format!("{at}/values/{k}/label"),
                        format!("two variants are called `{}`", variant.label),
                        Some("give every variant a label of its own".into()),
                    );
                }
                if variant.label.trim().is_empty() {
                    c.add(
                        &format!("{at}/values/{k}/label"),
                        "the label is empty",
                        None,
                    );
                }
                if let Some(size) = variant.size {
                    c.positive(&format!("{at}/values/{k}/size"), "the size", size);
                }
            }
        }
        _ => {}
    }
}

fn check_quantities(c: &mut Checker, study: &Study, scene: &Scene) {
    let mut names = BTreeSet::new();
    for (i, quantity) in study.quantities.iter().enumerate() {
        let at = format!("/quantities/{i}");
        if quantity.name.trim().is_empty() {
            c.add(&format!("{at}/name"), "the name is empty", None);
        }
        if !names.insert(&quantity.name) {
            let message = format!("two quantities are called `{}`", quantity.name);
            c.add(
                &format!("{at}/name"),
                message,
                Some("choose another name".into()),
            );
        }
        match &quantity.of {
            Measure::Field { body, .. } => {
                let bodies = scene.bodies.keys();
                c.refers(
                    &format!("{at}/of/field/body"),
                    "body",
                    "bodies",
                    body,
                    bodies,
                );
            }
            Measure::Column { take, between, .. } => {
                if let Take::At(time) = take {
                    c.finite(&format!("{at}/of/column/take/at"), &[*time]);
                }
                if let Some(range) = between {
                    c.ordered(&format!("{at}/of/column/between"), "the times", *range);
                }
            }
            Measure::Summary { .. } => {}
        }
        match &quantity.reference {
            Some(Reference::Finest(name)) => {
                let known = study.references.keys();
                let at = format!("{at}/reference/finest");
                c.refers(&at, "reference", "references", name, known);
            }
            Some(Reference::Curve { file, .. }) => {
                c.file(&format!("{at}/reference/curve/file"), file, &[]);
            }
            Some(Reference::Value { value, .. }) => {
                c.finite(&format!("{at}/reference/value/value"), &[*value]);
            }
            None => {}
        }
        if let Some(scale) = quantity.scale {
            c.positive(&format!("{at}/scale"), "the scale", scale);
        }
    }
}
