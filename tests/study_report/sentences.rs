//! Sentences of records made so that one knows what they must say.
use crate::records::{empty, error, fail, force, label, noise, quantity, run, value};
use covact::study::record::{Ending, Label, Record, RunRecord, Spread};
use covact::study::report::words::sections;

fn section(record: &Record, title: &str) -> Vec<String> {
    let found = sections(record)
        .into_iter()
        .find(|s| s.title.starts_with(title));
    found.map_or(Vec::new(), |s| s.sentences)
}

fn master(chord: f64) -> Label {
    label(&format!("bilinear, chord {chord}"), "bilinear", Some(chord))
}

fn nurbs() -> Label {
    label("NURBS", "NURBS", None)
}

fn shell(element: &str, n: u32) -> Label {
    label(
        &format!("{element} {n} x {n}"),
        element,
        Some(1.0 / f64::from(n)),
    )
}

fn one(master: Label, shell: Label, seconds: f64, of: f64) -> RunRecord {
    let id = format!("{} {}", master.text, shell.text);
    let mut run = run(&id, &[("master", master), ("shell", shell)], seconds);
    run.measured = vec![error(1.0, of)];
    run
}

/// NURBS reaches 0.4 % and facets 0.9 %.
fn two_masters() -> Record {
    let mut record = empty(&["master", "shell"], vec![force(Some(0.0))]);
    record.targets = vec![0.01, 0.1, 0.003, 0.03];
    record.runs = vec![
        one(nurbs(), shell("H8", 10), 0.5, 0.05),
        one(nurbs(), shell("Q18", 10), 0.8, 0.004),
        one(master(0.2), shell("Q18", 10), 2.0, 0.2),
        one(master(0.1), shell("Q18", 10), 4.0, 0.08),
        one(master(0.05), shell("Q18", 20), 31.0, 0.009),
    ];
    record
}

#[test]
fn what_a_target_costs() {
    assert_eq!(
        section(&two_masters(), "What accuracy costs: punch force"),
        [
            "10 % costs 0.5 s with NURBS and H8 10 x 10; bilinear needs 4 s (chord 0.1; Q18 10 x 10).",
            "3 % and 1 % cost 0.8 s with NURBS and Q18 10 x 10; bilinear needs 31 s (chord 0.05; Q18 20 x 20).",
            "No run reaches 0.3 %; the closest comes to 0.4 % in 0.8 s with NURBS and Q18 10 x 10.",
        ]
    );
}

#[test]
fn what_is_reached_by_errors_that_cancel() {
    let mut record = two_masters();
    record.targets = vec![0.01];
    // Coarse facets take force away, coarse shells add to it: next to nothing is left, until either is refined.
    record
        .runs
        .insert(0, one(master(0.2), shell("H8", 10), 0.1, 0.005));
    record
        .runs
        .insert(1, one(master(0.2), shell("H8", 20), 0.2, 0.03));
    assert_eq!(
        section(&record, "What accuracy costs"),
        [
            "1 % costs 0.8 s with NURBS and Q18 10 x 10; bilinear needs 31 s (chord 0.05; Q18 20 x 20).",
            "One run that reaches a target is not counted for it: refined, it is farther off, so that its errors \
             cancel by chance.",
        ]
    );
    // A finer run that is as good confirms it.
    record.runs[1] = one(master(0.2), shell("H8", 20), 0.2, 0.004);
    let told = section(&record, "What accuracy costs");
    assert!(
        told[0].starts_with("1 % costs 0.1 s with bilinear chord 0.2"),
        "{told:?}"
    );
}

#[test]
fn what_is_never_reached() {
    let mut record = two_masters();
    record.targets = vec![0.03, 0.01];
    record.runs.truncate(4);
    let stl = label("STL, chord 0.1", "STL", Some(0.1));
    record.runs.push(one(stl, shell("H8", 10), 1.0, 0.3));
    assert_eq!(
        section(&record, "What accuracy costs"),
        ["3 % and 1 % cost 0.8 s with NURBS and Q18 10 x 10; STL and bilinear never reach them in the runs made."
            .replace("STL and bilinear", "bilinear and STL")]
    );
}

#[test]
fn what_the_reference_cannot_tell() {
    let mut record = two_masters();
    record.quantities = vec![force(Some(0.002))];
    record.targets = vec![0.01, 0.005, 0.001];
    // NURBS is at 0.4 % give or take 0.2 %, the finest facets at 0.9 % give or take 0.2 %.
    assert_eq!(
        section(&record, "What accuracy costs"),
        [
            "1 % costs 0.8 s with NURBS and Q18 10 x 10; whether bilinear reaches it cannot be told, for the \
             reference's own error.",
            "Whether a run reaches 0.5 % cannot be told: the reference's own error is 0.2 %.",
            "0.1 % cannot be told: the reference's own error is 0.2 %.",
        ]
    );
    record.quantities = vec![force(None)];
    record.targets = vec![0.001];
    assert_eq!(
        section(&record, "What accuracy costs"),
        [
            "No run reaches 0.1 %; the closest comes to 0.4 % in 0.8 s with NURBS and Q18 10 x 10.",
            "The reference's own error is not known; errors are distances from it.",
        ]
    );
}

#[test]
fn spreads_that_overlap() {
    let mut record = two_masters();
    record.targets = vec![0.01];
    record.runs.remove(0);
    record.runs[3].wall = Some(Spread {
        median: 0.9,
        least: 0.82,
        most: 1.1,
        repeats: 3,
    });
    record.runs[3]
        .choices
        .insert("shell".into(), shell("Q18", 10));
    assert_eq!(
        section(&record, "What accuracy costs"),
        ["1 % costs 0.8 s with NURBS; bilinear takes about as much, 0.9 s (chord 0.05)."]
    );
    // The finest facets overlap with NURBS, so that nothing is said about the time of facets.
    assert!(
        section(&record, "What gains")
            .iter()
            .all(|s| !s.contains("time of"))
    );
}

#[test]
fn runs_timed_once() {
    let mut record = two_masters();
    record.targets = vec![0.03];
    for run in &mut record.runs {
        run.wall = run.wall.map(|w| Spread {
            least: w.median,
            most: w.median,
            repeats: 1,
            ..w
        });
    }
    assert_eq!(
        section(&record, "What accuracy costs"),
        [
            "3 % costs 0.8 s with NURBS and Q18 10 x 10; bilinear needs 31 s (chord 0.05; Q18 20 x 20).",
            "Every run was timed once, so that small differences of time mean nothing.",
        ]
    );
    // All take the same iterations, and of times nothing can be said.
    assert_eq!(
        section(&record, "What gains"),
        [
            "With everything else equal, the same Newton iterations are needed by NURBS and bilinear (2 pairs)."
        ]
    );
}

#[test]
fn what_gains_with_all_else_equal() {
    let mut record = empty(&["master", "shell"], vec![force(Some(0.0))]);
    // Ratios of iterations 3, 3.2 and of times 2, 4.
    for (n, plain, facets, times) in [(10, 100, 300, [1.0, 2.0]), (20, 100, 320, [3.0, 12.0])] {
        for (label, iterations, seconds) in
            [(nurbs(), plain, times[0]), (master(0.1), facets, times[1])]
        {
            let mut run = one(label, shell("H8", n), seconds, 0.5);
            run.newton_iterations = iterations;
            record.runs.push(run);
        }
    }
    assert_eq!(
        section(&record, "What gains"),
        [
            "With everything else equal, bilinear needs 3.1 times the Newton iterations of NURBS (3 to 3.2 in 2 pairs).",
            "With everything else equal, bilinear takes 2.8 times the time of NURBS (2 to 4 in 2 pairs).",
        ]
    );
    // Smooth facets take what NURBS take.
    let mut same = record.clone();
    for k in [0, 2] {
        let mut run = record.runs[k].clone();
        run.choices
            .insert("master".into(), label("smooth", "smooth", None));
        same.runs.push(run);
    }
    assert_eq!(
        section(&same, "What gains")[0],
        "With everything else equal, the same Newton iterations are needed by NURBS and smooth (2 pairs)."
    );
    // One pair the other way round, and there is nothing to say about iterations.
    record.runs[3].newton_iterations = 90;
    let said = section(&record, "What gains");
    assert!(said.len() == 1 && said[0].contains("the time"), "{said:?}");
    // A single pair has no range.
    record.runs.truncate(2);
    assert_eq!(
        section(&record, "What gains")[0],
        "With everything else equal, bilinear needs 3 times the Newton iterations of NURBS."
    );
}

#[test]
fn how_errors_fall() {
    let mut record = empty(&["shell"], vec![force(Some(0.0001))]);
    for n in [4u32, 8, 16, 32] {
        let h = 1.0 / f64::from(n);
        for (element, power) in [("H8", 1.9), ("Q18", 3.8)] {
            // Below three times the reference's own error nothing follows the law.
            let law = h.powf(power);
            let of = if law < 3e-4 { 2.5e-4 } else { law };
            let mut run = run("", &[("shell", shell(element, n))], 1.0);
            run.measured = vec![error(1.0, of)];
            record.runs.push(run);
        }
    }
    assert_eq!(
        section(&record, "Rates"),
        ["The error of punch force falls as h^1.9 with H8 (h: relative element size)."]
    );
    record.quantities = vec![force(Some(1e-9))];
    for run in &mut record.runs {
        let label = &run.choices["shell"];
        let power = if label.series == "H8" { 1.9 } else { 3.8 };
        run.measured[0].error = label.size.map(|h| h.powf(power));
    }
    assert_eq!(
        section(&record, "Rates"),
        [
            "The error of punch force falls as h^1.9 with H8 and as h^3.8 with Q18 (h: relative element size)."
        ]
    );
    // Scatter has no rate.
    for (k, run) in record.runs.iter_mut().enumerate() {
        run.measured[0].error = Some([0.1, 0.5, 0.02, 0.3][k % 4]);
    }
    assert!(section(&record, "Rates").is_empty());
}

#[test]
fn rates_over_named_sizes() {
    let mut record = empty(&["master"], vec![force(Some(0.0))]);
    for chord in [0.4, 0.2, 0.1] {
        let mut run = run("", &[("master", master(chord))], 1.0);
        run.measured = vec![error(1.0, 0.3 * chord)];
        record.runs.push(run);
    }
    assert_eq!(
        section(&record, "Rates"),
        ["The error of punch force falls as chord^1."]
    );
}

#[test]
fn how_much_a_force_swings() {
    let mut record = empty(&["master", "shell"], vec![noise()]);
    for n in [10, 20] {
        for (label, swing) in [(nurbs(), 0.002), (master(0.5), 0.14), (master(0.25), 0.06)] {
            let mut run = run("", &[("master", label), ("shell", shell("H8", n))], 1.0);
            run.measured = vec![value(swing + 1e-4 * f64::from(n - 10))];
            record.runs.push(run);
        }
    }
    assert_eq!(
        section(&record, "Noise"),
        [
            "The force noise is 0.2 to 0.3 % with NURBS, 6 to 6.1 % with bilinear chord 0.25 and 14 % with bilinear chord 0.5."
        ]
    );
}

#[test]
fn what_failed_and_what_is_missing() {
    let mut record = two_masters();
    fail(&mut record.runs[2], "step 3 does not\nconverge.");
    fail(&mut record.runs[3], "stopped after 600 s");
    record.runs[4].ending = Ending::Missing;
    assert_eq!(
        section(&record, "What did not get through"),
        [
            "2 of 5 runs failed: bilinear chord 0.2, Q18 10 x 10 (step 3 does not converge); bilinear chord 0.1, \
             Q18 10 x 10 (stopped after 600 s).",
            "1 of 5 runs has not been done, or the results are not here.",
        ]
    );
    // What failed has no say in what accuracy costs.
    let costs = section(&record, "What accuracy costs").concat();
    assert!(!costs.contains("bilinear"), "{costs}");
}

#[test]
fn a_run_that_is_the_reference_itself_reaches_nothing() {
    let mut record = two_masters();
    record.targets = vec![0.003];
    record.runs[1].measured[0].error = Some(0.0);
    record.runs[1].reference = Some("fine".into());
    assert_eq!(
        section(&record, "What accuracy costs"),
        [
            "No run reaches 0.3 %; the closest comes to 0.9 % in 31 s with bilinear chord 0.05 and Q18 20 x 20."
        ]
    );
}

#[test]
fn values_alone_say_nothing() {
    let mut record = two_masters();
    record.quantities = vec![quantity("peak", "N", "largest `force`")];
    // Iterations that are now more, now less.
    for (run, iterations) in record.runs.iter_mut().zip([10, 10, 9, 11, 10]) {
        run.newton_iterations = iterations;
        run.wall = None;
    }
    assert!(sections(&record).is_empty());
}

/// Gaps fall as the penalty rises: with its inverse.
#[test]
fn the_size_of_a_penalty_is_its_inverse() {
    let mut record = empty(&["penalty"], vec![force(Some(0.0))]);
    for penalty in [1e2, 1e3, 1e4, 1e5] {
        let label = label(
            &format!("penalty {penalty}"),
            "penalty",
            Some(1.0 / penalty),
        );
        let mut run = run("", &[("penalty", label)], 1.0);
        run.measured = vec![error(1.0, 3.0 / penalty)];
        record.runs.push(run);
    }
    assert_eq!(
        section(&record, "Rates"),
        ["The error of punch force falls as (1/penalty)^1."]
    );
}

/// Times of two repeats say nothing; a mean of ratios lies in the range that is printed with it.
#[test]
fn times_need_three_repeats_and_means_their_range() {
    let mut record = empty(&["master", "shell"], vec![force(Some(0.0))]);
    for (n, seconds) in [(10, [1.0, 1.953]), (20, [1.0, 1.958])] {
        for (label, seconds) in [(nurbs(), seconds[0]), (master(0.1), seconds[1])] {
            record.runs.push(one(label, shell("H8", n), seconds, 0.5));
        }
    }
    let said = |record: &Record| section(record, "What gains").concat();
    // The mean, 1.9555, would be 2 with two digits.
    let words = "bilinear takes 1.96 times the time of NURBS (1.95 to 1.96 in 2 pairs)";
    assert!(said(&record).contains(words), "{}", said(&record));
    for run in &mut record.runs {
        run.wall = run.wall.map(|w| Spread { repeats: 2, ..w });
    }
    assert!(!said(&record).contains("the time"), "{}", said(&record));
}
