//! The tables.
use crate::effects::NONE;
use crate::scene::{self, Distance};
use std::process::ExitCode;

/// Largest ratio of the program to the kernel, for the whole evaluation of a contact point. Its closest point is part of that;
/// what is left without it is a difference of two large numbers, which is shown and not judged.
const LIMIT: f64 = 1.02;

/// Prints both tables from the labels of what was measured, per slave point; fails where the program exceeds the limit in
/// instructions.
pub fn print(measured: &[(String, u64)], unit: &str) -> ExitCode {
    let points = scene::points() as f64;
    let find = |label: &str| {
        let found = measured.iter().find(|(l, _)| l == label);
        found.map(|(_, n)| *n as f64 / points)
    };
    let mut worst = [0.0f64; 2];
    println!("\n{unit} per slave point ({points} points)");
    println!(
        "{:<34} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "", "search", "program", "one loop", "two loops", "ratio"
    );
    for (master, _) in scene::masters() {
        for distance in Distance::ALL {
            let of = |who: &str| find(&format!("{master}/{}/{who}", distance.name()));
            let (Some(search), Some(program), Some(one), Some(two)) =
                (of("search"), of("program"), of("one loop"), of("two loops"))
            else {
                eprintln!("{master}/{} was not measured", distance.name());
                return ExitCode::FAILURE;
            };
            let parts = [("with the search", 0.0), ("without", search)];
            for ((what, less), worst) in parts.into_iter().zip(&mut worst) {
                let [p, a, b] = [program, one, two].map(|n| n - less);
                let ratio = p / a.min(b);
                *worst = worst.max(ratio);
                println!(
                    "{:<34} {search:>9.1} {p:>9.1} {a:>9.1} {b:>9.1} {ratio:>9.4}",
                    format!("{master}, {}, {what}", distance.name())
                );
            }
        }
    }
    println!("\n{unit} per slave point, and as a multiple of the frictionless penalty's");
    println!(
        "{:<34} {:>9} {:>9} {:>9} {:>9}",
        "", "closed", "ratio", "open", "ratio"
    );
    let effect = |name: &str, d: Distance| find(&format!("effect {name}/{}", d.name()));
    let base = |d: Distance| effect(NONE, d).unwrap_or(f64::NAN);
    let names =
        (measured.iter()).filter_map(|(l, _)| l.strip_prefix("effect ")?.strip_suffix("/closed"));
    for name in names {
        let [closed, open] = [Distance::Closed, Distance::Open]
            .map(|d| (effect(name, d).unwrap_or(f64::NAN), base(d)));
        println!(
            "{name:<34} {:>9.1} {:>9.3} {:>9.1} {:>9.3}",
            closed.0,
            closed.0 / closed.1,
            open.0,
            open.0 / open.1
        );
    }
    let [whole, rest] = worst;
    println!(
        "\nlargest ratio of the program to the kernel: {whole:.4} (limit {LIMIT}); without the search {rest:.4}"
    );
    if unit == "instructions" && whole > LIMIT {
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
