use super::*;

/// y = t^2 at four uneven times.
const SQUARES: [[f64; 2]; 4] = [[0.0, 0.0], [0.1, 0.01], [0.5, 0.25], [1.0, 1.0]];

fn value(rows: &[[f64; 2]], take: Json) -> f64 {
    let mut bench = Bench::new();
    bench.history("a", rows);
    let (_, warnings) = bench.measure(of_f(take), json!({}));
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(bench.of("a").error, None);
    assert_eq!(bench.of("a").missing, None);
    bench.of("a").value.expect("a value")
}

#[test]
fn numbers_of_a_column() {
    let rows = [[0.0, 1.0], [0.5, -3.0], [1.0, 7.0], [2.0, 4.0]];
    assert_eq!(value(&rows, json!("end")), 4.0);
    assert_eq!(value(&rows, json!("max")), 7.0);
    assert_eq!(value(&rows, json!("min")), -3.0);
    // 0.1 * 0.005 + 0.4 * 0.13 + 0.5 * 0.625.
    near(value(&SQUARES, json!("mean")), 0.365, 1e-14);
    near(value(&SQUARES, json!({ "at": 0.3 })), 0.13, 1e-14);
    assert_eq!(value(&SQUARES, json!({ "at": 0.5 })), 0.25);
    assert_eq!(value(&SQUARES, json!({ "at": 1.0 + 1e-12 })), 1.0);
    assert_eq!(value(&[[0.5, 3.0]], json!("mean")), 3.0);
}

/// A line with a cosine of whole periods, sampled at the middles of equal parts: by symmetry the cosine has no mean and no
/// slope, so the swing is that of its samples, 2 A cos(pi k / n), over the line's mean.
#[test]
fn swing_of_a_line_with_a_wave() {
    let (n, k, a) = (60, 3, 0.3);
    let rows: Vec<[f64; 2]> = (0..n)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            let wave = (2.0 * std::f64::consts::PI * f64::from(k) * t).cos();
            [t, -(5.0 + 2.0 * t + a * wave)]
        })
        .collect();
    let expected = 2.0 * a * (std::f64::consts::PI * f64::from(k) / f64::from(n)).cos() / 6.0;
    near(value(&rows, json!("swing")), expected, 1e-12);
    let line: Vec<[f64; 2]> = rows.iter().map(|[t, _]| [*t, 3.0 - t]).collect();
    assert!(value(&line, json!("swing")) < 1e-14);
}

#[test]
fn only_rows_between_two_times() {
    let mut bench = Bench::new();
    bench.history("a", &SQUARES);
    let of = |take: &str, from: f64, to: f64| {
        json!([{ "name": "q", "of": { "column":
            { "name": "f", "take": take, "between": [from, to] } } }])
    };
    let (records, _) = bench.measure(of("end", 0.0, 0.5), json!({}));
    assert_eq!(bench.of("a").value, Some(0.25));
    assert_eq!(records[0].measure, "`f` at the end, time from 0 to 0.5");
    bench.measure(of("mean", 0.1, 0.5), json!({}));
    near(bench.of("a").value.unwrap(), 0.13, 1e-14);
    let (_, warnings) = bench.measure(of("mean", 2.0, 3.0), json!({}));
    assert!(bench.missing("a").contains("between 2 and 3"));
    says(&warnings, &["`q`", "between 2 and 3", "`a`"]);
}

#[test]
fn what_cannot_be_taken_is_said() {
    let mut bench = Bench::new();
    bench.csv("a", "time,force.ball.z,f\n0,1,NaN\n1,2,3\n2,4,5\n");
    let column = |name: &str, take: Json| json!([{ "name": "q", "of": { "column": { "name": name, "take": take } } }]);
    let (_, warnings) = bench.measure(column("force.bal.z", json!("end")), json!({}));
    assert!(bench.missing("a").contains("did you mean `force.ball.z`?"));
    says(&warnings, &["force.ball.z", "`a`"]);
    bench.measure(column("force.ball.z", json!({ "at": 2.5 })), json!({}));
    assert!(bench.missing("a").contains("2.5 is outside of the rows"));
    assert_eq!(bench.of("a").value, None);
    // The row without a number is left out, and the user knows.
    let (_, warnings) = bench.measure(column("f", json!("min")), json!({}));
    assert_eq!(bench.of("a").value, Some(3.0));
    says(&warnings, &["left out", "`a` (1 of 3)"]);
    bench.measure(column("f", json!("swing")), json!({}));
    assert!(bench.missing("a").contains("three rows, and there are 2"));
    bench.csv("b", "time,f\n0,1\n1,NaN\n");
    bench.measure(column("f", json!("end")), json!({}));
    assert!(bench.missing("b").contains("no number"));
    assert_eq!(bench.of("a").value, Some(5.0));
    bench.done("c");
    let (_, warnings) = bench.measure(column("f", json!("max")), json!({}));
    assert!(bench.missing("c").contains("history.csv"));
    says(&warnings, &["history.csv", "`c`"]);
}

#[test]
fn numbers_of_a_summary() {
    let mut bench = Bench::new();
    let folder = bench.done("a");
    let text = r#"{"wall_s": 1.5, "status": "done", "cpu_s": null,
        "phases": {"solve": 0.25, "a.b": {"c": 7}}}"#;
    write(&folder.join("summary.json"), text);
    let mut of = |name: &str| {
        bench.measure(
            json!([{ "name": "q", "of": { "summary": { "name": name } } }]),
            json!({}),
        );
        bench.of("a").clone()
    };
    assert_eq!(of("wall_s").value, Some(1.5));
    assert_eq!(of("phases.solve").value, Some(0.25));
    assert_eq!(of("phases.a.b.c").value, Some(7.0));
    let missing = |m: Measured| {
        assert_eq!(m.value, None);
        m.missing.expect("a reason")
    };
    assert!(missing(of("phases.solv")).contains("did you mean `phases.solve`?"));
    assert!(missing(of("status")).contains("no number"));
    assert!(missing(of("cpu_s")).contains("empty"));
}

/// Triangle of height 1 over [0, 1] against the constant 2: the mean squares are 1/3 - 2 + 4 and 4.
#[test]
fn root_mean_square_of_curves() {
    let mut bench = Bench::new();
    bench.history("triangle", &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]);
    bench.history("short", &[[0.0, 2.0], [0.5, 2.0]]);
    bench.history("beyond", &[[3.0, 2.0], [5.0, 2.0]]);
    bench.history("zigzag", &[[0.0, 2.0], [0.5, 2.0], [0.25, 2.0]]);
    bench.history("left", &[[1.0, 2.5], [0.0, 2.5]]);
    // A jump from 2 to 4 at 0.75.
    bench.history("jump", &[[0.0, 2.0], [0.75, 2.0], [0.75, 4.0], [1.0, 4.0]]);
    let two = "x, y z\n0,2\n0.3,2\n1,2\n".replace(", ", ",");
    write(&bench.dir.path().join("two.csv"), &two);
    let against = |y: &str| {
        let curve = json!({ "file": "two.csv", "x": "x", "y": y, "source": "made here" });
        of_f_against(json!("curve"), json!({ "curve": curve }))
    };
    let (records, warnings) = bench.measure(against("y z"), json!({}));
    near(bench.error("triangle"), (7.0f64 / 3.0 / 4.0).sqrt(), 1e-14);
    near(bench.error("left"), 0.25, 1e-14);
    near(bench.error("jump"), 0.5, 1e-14);
    assert_eq!(bench.error("short"), 0.0);
    says(
        &warnings,
        &["part of the reference", "`short` (0.500 of its range)"],
    );
    assert!(bench.missing("beyond").contains("no range in common"));
    assert!(bench.missing("zigzag").contains("back and forth"));
    assert_eq!(bench.of("zigzag").curve.as_ref().map(Vec::len), Some(3));
    let record = &records[0];
    assert!(record.curve && !record.swing);
    let reference = record.reference.as_ref().unwrap();
    assert_eq!(reference.source, "made here");
    assert_eq!(reference.curve.as_ref().map(Vec::len), Some(3));
    assert_eq!((reference.value, reference.error), (None, None));
    // A wrong name, and no errors without the curve.
    let (_, warnings) = bench.measure(against("y zz"), json!({}));
    assert!(bench.missing("triangle").contains("did you mean `y z`?"));
    says(&warnings, &["no errors", "did you mean `y z`?"]);
}

#[test]
fn a_curve_over_another_column() {
    let mut bench = Bench::new();
    bench.csv("a", "time,u,f\n1,0,0\n2,2,4\n3,4,8\n");
    bench.csv("b", "time,u,f\n1,4,8.5\n2,1,2.5\n3,0,0.5\n");
    bench.refinement("fine", 2);
    bench.references.insert("fine".into(), vec![1, 0]);
    let quantity = json!([{
        "name": "q",
        "of": { "column": { "name": "f", "take": "curve", "over": "u" } },
        "reference": finest()
    }]);
    let (records, _) = bench.measure(quantity, refinement(json!({ "order": 1 })));
    // 0.5 against 2 u on [0, 4], whose mean square is 64/3.
    near(bench.error("b"), 0.5 / (64.0f64 / 3.0).sqrt(), 1e-14);
    assert_eq!(records[0].measure, "`f` over `u`");
    assert_eq!(
        bench.of("a").curve,
        Some(vec![[0.0, 0.0], [2.0, 4.0], [4.0, 8.0]])
    );
}
