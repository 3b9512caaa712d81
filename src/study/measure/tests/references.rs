use super::*;

/// Runs of mesh sizes 1, 1/2, 1/4 whose `f` at the end is given.
fn three(values: [f64; 3]) -> Bench {
    let mut bench = Bench::new();
    bench.history("run", &[[0.0, 0.0], [1.0, 9.0]]);
    for (i, value) in values.into_iter().enumerate() {
        bench.history(&format!("fine{i}"), &[[0.0, 0.0], [1.0, value]]);
    }
    bench.refinement("fine", 3);
    bench
}

/// f + c h^2 has order 2, and the finest run is off by c h^2 exactly.
#[test]
fn richardson_of_a_number() {
    let (f, c) = (10.0, -0.8);
    let at = |h: f64| f + c * h * h;
    let mut bench = three([at(1.0), at(0.5), at(0.25)]);
    let quantity = of_f_against(json!("end"), finest());
    let (records, warnings) = bench.measure(quantity, refinement(json!({})));
    let reference = records[0].reference.as_ref().unwrap();
    let value = at(0.25);
    assert_eq!(reference.value, Some(value));
    near(reference.error.unwrap(), c.abs() / 16.0 / value, 1e-12);
    near(reference.order.unwrap(), 2.0, 1e-12);
    assert!(reference.observed);
    assert!(reference.source.contains("`fine2`"));
    assert!(warnings.is_empty(), "{warnings:?}");
    near(bench.error("run"), (value - 9.0) / value, 1e-14);
    near(bench.error("fine0"), (value - at(1.0)) / value, 1e-14);
    assert!(bench.missing("fine2").contains("the reference itself"));
    // With a scale errors are relative to that.
    let mut quantity = of_f_against(json!("end"), finest());
    quantity[0]["scale"] = json!(2.0);
    let (records, _) = bench.measure(quantity, refinement(json!({})));
    near(bench.error("run"), (value - 9.0) / 2.0, 1e-14);
    let own = records[0].reference.as_ref().and_then(|r| r.error);
    near(own.unwrap(), c.abs() / 16.0 / 2.0, 1e-12);
}

/// Ratio 3, order 1.5 declared: the last difference over 3^1.5 - 1; the coarsest run is not needed.
#[test]
fn a_declared_order() {
    let expected = 0.5 / (3f64.powf(1.5) - 1.0) / 8.5;
    for coarsest in [Ending::Done, Ending::Failed("no convergence".into())] {
        let mut bench = three([6.5, 8.0, 8.5]);
        bench.runs[1].ending = coarsest.clone();
        let more = refinement(json!({ "ratio": 3.0, "order": 1.5 }));
        let (records, warnings) = bench.measure(of_f_against(json!("end"), finest()), more);
        let reference = records[0].reference.as_ref().unwrap();
        near(reference.error.unwrap(), expected, 1e-13);
        assert_eq!((reference.order, reference.observed), (Some(1.5), false));
        // ln 3 / ln 3 is observed where the coarsest run is there: within .5 of what is declared.
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    let mut bench = three([9.0, 8.0, 8.5]);
    let more = refinement(json!({ "ratio": 3.0, "order": 1.5 }));
    let (records, warnings) = bench.measure(of_f_against(json!("end"), finest()), more);
    near(
        records[0].reference.as_ref().unwrap().error.unwrap(),
        expected,
        1e-13,
    );
    says(&warnings, &["order 1.5 is declared", "change sign"]);
}

#[test]
fn no_clean_order() {
    for (values, words) in [
        ([8.0, 9.5, 9.0], "change sign"),
        (
            [8.0, 8.0, 8.5],
            "two coarsest runs of the refinement do not differ",
        ),
        ([0.0, 7.995, 8.0], "order of 10.64"),
    ] {
        let mut bench = three(values);
        let (records, warnings) =
            bench.measure(of_f_against(json!("end"), finest()), refinement(json!({})));
        let reference = records[0].reference.as_ref().unwrap();
        near(
            reference.error.unwrap(),
            (values[2] - values[1]).abs() / values[2],
            1e-12,
        );
        assert_eq!((reference.order, reference.observed), (None, false));
        says(
            &warnings,
            &["`fine`", words, "difference of the two finest"],
        );
    }
}

/// Differences that do not fall tell nothing about the limit, with a declared order or without.
#[test]
fn refinements_that_do_not_converge() {
    // Orders ln(d1 / d2) / ln 2 of differences .5 and .5, .5 and 1, -.5 and 1, 1.2 and 1.
    for (values, order) in [
        ([8.0, 8.5, 9.0], "0.00"),
        ([8.0, 8.5, 9.5], "-1.00"),
        ([9.0, 8.5, 9.5], "-1.00"),
        ([6.8, 8.0, 9.0], "0.26"),
    ] {
        for more in [json!({}), json!({ "order": 2 })] {
            let mut bench = three(values);
            let quantity = of_f_against(json!("end"), finest());
            let (records, warnings) = bench.measure(quantity, refinement(more));
            let reference = records[0].reference.as_ref().unwrap();
            assert_eq!(reference.value, Some(values[2]));
            assert_eq!((reference.error, reference.order), (None, None));
            assert!(!reference.observed);
            let words = format!("does not converge (observed order {order})");
            says(&warnings, &["no estimate", "`fine`", &words]);
        }
    }
}

#[test]
fn runs_that_cannot_be_told_apart() {
    let (f, c) = (10.0, -0.8);
    let at = |h: f64| f + c * h * h;
    let mut bench = three([at(1.0), at(0.5), at(0.25)]);
    // Off by 2 and by 4 times what the reference is off.
    bench.history("close", &[[0.0, 0.0], [1.0, at(0.25) + 0.1]]);
    bench.history("far", &[[0.0, 0.0], [1.0, at(0.25) - 0.2]]);
    let (_, warnings) = bench.measure(of_f_against(json!("end"), finest()), refinement(json!({})));
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    says(&warnings, &["cannot be told apart", "`close` (1.0e-2)"]);
    assert!(!warnings[0].contains("`far`"));
}

#[test]
fn references_that_are_not_there() {
    let quantity = || of_f_against(json!("end"), finest());
    let failed = || Ending::Failed("the disk is full".into());
    let mut bench = three([7.0, 8.0, 8.5]);
    bench.runs[3].ending = failed();
    let (records, warnings) = bench.measure(quantity(), refinement(json!({})));
    assert!(bench.missing("run").contains("the disk is full"));
    assert_eq!(bench.of("run").value, Some(9.0));
    assert_eq!(bench.of("fine2").value, None);
    let reference = records[0].reference.as_ref().unwrap();
    assert_eq!((reference.value, reference.error), (None, None));
    says(&warnings, &["no errors", "`fine2`", "the disk is full"]);
    // A coarser run that failed: errors, but none of the reference.
    let mut bench = three([7.0, 8.0, 8.5]);
    bench.runs[1].ending = failed();
    let (records, warnings) = bench.measure(quantity(), refinement(json!({})));
    near(bench.error("run"), 0.5 / 8.5, 1e-14);
    assert_eq!(records[0].reference.as_ref().unwrap().error, None);
    says(&warnings, &["no estimate", "`fine0`", "the disk is full"]);
    // Two runs and no order.
    let mut bench = three([7.0, 8.0, 8.5]);
    bench.references.insert("fine".into(), vec![2, 3]);
    let (records, warnings) = bench.measure(quantity(), refinement(json!({})));
    assert_eq!(records[0].reference.as_ref().unwrap().error, None);
    says(
        &warnings,
        &["no estimate", "order of convergence is declared"],
    );
    // Runs that agree exactly tell nothing either, with an order or without.
    for more in [json!({}), json!({ "order": 2 })] {
        let mut bench = three([7.0, 8.5, 8.5]);
        let (records, warnings) = bench.measure(quantity(), refinement(more));
        assert_eq!(records[0].reference.as_ref().unwrap().error, None);
        says(&warnings, &["no estimate", "two finest runs do not differ"]);
    }
    // A name that the study does not have.
    let quantity = of_f_against(json!("end"), json!({ "finest": "fnie" }));
    let (_, warnings) = bench.measure(quantity, refinement(json!({})));
    assert!(bench.missing("run").contains("did you mean `fine`?"));
    says(&warnings, &["no errors", "did you mean `fine`?"]);
    // A run that was not done has no value and says why.
    bench.runs[0].ending = Ending::Missing;
    bench.measure(of_f(json!("end")), json!({}));
    assert_eq!(bench.of("run").value, None);
    assert!(bench.missing("run").contains("not been done"));
}

#[test]
fn numbers_as_references() {
    let mut bench = Bench::new();
    bench.history("a", &[[0.0, 0.0], [1.0, -3.0]]);
    let value = |value: f64| json!({ "value": { "value": value, "source": "closed form" } });
    let (records, warnings) = bench.measure(of_f_against(json!("end"), value(-4.0)), json!({}));
    near(bench.error("a"), 0.25, 1e-15);
    let reference = records[0].reference.as_ref().unwrap();
    assert_eq!((reference.value, reference.error), (Some(-4.0), Some(0.0)));
    assert_eq!(reference.source, "closed form");
    assert!(warnings.is_empty(), "{warnings:?}");
    let (_, warnings) = bench.measure(of_f_against(json!("end"), value(0.0)), json!({}));
    assert!(bench.missing("a").contains("the reference is zero"));
    assert_eq!(bench.of("a").value, Some(-3.0));
    says(&warnings, &["the reference is zero and no `scale`"]);
    let mut quantity = of_f_against(json!("end"), value(0.0));
    quantity[0]["scale"] = json!(6.0);
    bench.measure(quantity, json!({}));
    near(bench.error("a"), 0.5, 1e-15);
    // A curve has no error relative to a number.
    let (_, warnings) = bench.measure(of_f_against(json!("curve"), value(1.0)), json!({}));
    assert!(bench.missing("a").contains("compared with a curve"));
    says(&warnings, &["no errors", "compared with a curve"]);
}

/// Curves t + c h^2 t: differences are proportional to the curve, so order 2, and the error is c h^2 of the finest.
#[test]
fn richardson_of_curves() {
    let c = 0.3;
    let mut bench = Bench::new();
    for (i, h) in [1.0, 0.5, 0.25].into_iter().enumerate() {
        // Other rows in every run.
        let n = 3 + i;
        let rows: Vec<[f64; 2]> = (0..=n)
            .map(|k| k as f64 / n as f64)
            .map(|t| [t, t * (1.0 + c * h * h)])
            .collect();
        bench.history(&format!("fine{i}"), &rows);
    }
    bench.refinement("fine", 3);
    let (records, warnings) = bench.measure(
        of_f_against(json!("curve"), finest()),
        refinement(json!({})),
    );
    let reference = records[0].reference.as_ref().unwrap();
    near(reference.order.unwrap(), 2.0, 1e-12);
    near(
        reference.error.unwrap(),
        (c / 16.0) / (1.0 + c / 16.0),
        1e-12,
    );
    assert!(reference.observed && reference.value.is_none());
    assert!(warnings.is_empty(), "{warnings:?}");
    near(
        bench.error("fine1"),
        (c * 3.0 / 16.0) / (1.0 + c / 16.0),
        1e-12,
    );
}
