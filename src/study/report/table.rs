//! The table of all runs.
use super::figures::{per_step, phases_in_words};
use super::front::pareto;
use super::view::View;
use crate::page::markup::escaped;
use crate::page::number::{count, digits, percent, seconds, several};
use crate::study::record::Ending;
use std::fmt::Write as _;

/// A column: its name, a longer one, and whether it holds numbers.
struct Column {
    name: String,
    hint: String,
    number: bool,
}

/// A cell: what is shown, by what it is sorted, more for who points at it.
#[derive(Default)]
struct Cell {
    text: String,
    key: Option<f64>,
    hint: String,
    class: &'static str,
}

impl Cell {
    fn number(value: Option<f64>, text: impl Fn(f64) -> String) -> Cell {
        let key = value.filter(|v| v.is_finite());
        Cell {
            text: key.map_or(String::new(), text),
            key,
            ..Cell::default()
        }
    }

    fn hint(self, hint: String) -> Cell {
        Cell { hint, ..self }
    }
}

/// The table in HTML.
pub(crate) fn html(view: &View) -> String {
    let columns = columns(view);
    let mut out = String::from("<table id=\"runs\"><thead><tr>");
    for column in &columns {
        let class = if column.number { " class=\"n\"" } else { "" };
        let _ = write!(
            out,
            "<th scope=\"col\"{class} title=\"{}\">{}</th>",
            escaped(&column.hint),
            escaped(&column.name)
        );
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    let front = front(view);
    for i in 0..view.record.runs.len() {
        let ending = match view.run(i).ending {
            Ending::Done => "done",
            Ending::Failed(_) => "failed",
            Ending::Missing => "missing",
        };
        let _ = write!(out, "<tr class=\"{ending}\" data-r=\"{i}\">");
        for (cell, column) in cells(view, i, front.contains(&i)).iter().zip(&columns) {
            write_cell(&mut out, cell, column);
        }
        out.push_str("</tr>\n");
    }
    out + "</tbody></table>"
}

fn write_cell(out: &mut String, cell: &Cell, column: &Column) {
    let class = match (column.number, cell.class) {
        (true, "") => " class=\"n\"".to_string(),
        (true, class) => format!(" class=\"n {class}\""),
        (false, "") => String::new(),
        (false, class) => format!(" class=\"{class}\""),
    };
    // Enough to sort by.
    let key = match cell.key {
        Some(key) => format!(
            " data-v=\"{}\"",
            format!("{key:.5e}").replace("00000e", "e")
        ),
        None => String::new(),
    };
    let hint = match cell.hint.as_str() {
        "" => String::new(),
        hint => format!(" title=\"{}\"", escaped(hint)),
    };
    let _ = write!(out, "<td{class}{key}{hint}>{}</td>", escaped(&cell.text));
}

/// Runs of the Pareto front of the first quantity with a reference.
fn front(view: &View) -> Vec<usize> {
    let quantities = &view.record.quantities;
    let Some(q) = quantities.iter().position(|q| q.reference.is_some()) else {
        return Vec::new();
    };
    let runs = view.done();
    let points: Vec<(f64, f64)> = (runs.iter())
        .map(|&i| {
            let wall = view.wall(i).map_or(f64::NAN, |w| w.median);
            (wall, view.error(i, q).unwrap_or(f64::NAN))
        })
        .collect();
    pareto(&points).into_iter().map(|k| runs[k]).collect()
}

fn columns(view: &View) -> Vec<Column> {
    let mut out = Vec::new();
    let mut add = |name: &str, hint: &str, number: bool| {
        out.push(Column {
            name: name.to_string(),
            hint: hint.to_string(),
            number,
        });
    };
    add("run", "folder of the run", false);
    for &c in &view.varying {
        add(&view.record.choices[c], "choice", false);
    }
    add("status", "how it ended", false);
    for quantity in &view.record.quantities {
        let unit = match quantity.unit.as_str() {
            "" => String::new(),
            unit => format!(" ({unit})"),
        };
        if !quantity.curve {
            add(&format!("{}{unit}", quantity.name), &quantity.measure, true);
        }
        if quantity.reference.is_some() {
            add(&format!("error of {}", quantity.name), "relative", true);
        }
    }
    add(
        "time",
        "median of the elapsed time; point at it for the phases",
        true,
    );
    add("spread", "least to most of the repeats", true);
    add("CPU", "processor time of all threads, median", true);
    add("MB", "peak memory", true);
    add("dofs", "degrees of freedom", true);
    add("points", "contact points", true);
    add("Newton", "Newton iterations of all steps", true);
    add("per step", "mean Newton iterations per accepted step", true);
    add("most", "most Newton iterations of a step", true);
    add("steps", "accepted steps", true);
    add("cuts", "times a step was cut", true);
    out
}

fn cells(view: &View, i: usize, on_front: bool) -> Vec<Cell> {
    let run = view.run(i);
    let words = |text: String| Cell {
        text,
        ..Cell::default()
    };
    let mut name = words(match &run.reference {
        Some(reference) => format!("{} (reference {reference})", run.id),
        None => run.id.clone(),
    });
    name.key = Some(i as f64);
    let mut out = vec![name];
    for &c in &view.varying {
        let text = |i: usize| view.label(i, c).map_or("", |l| l.text.as_str());
        let mut cell = words(text(i).to_string());
        // In the order of the study: letters would put 10 before 9, and 0.1 before 0.025.
        let first = (0..=i).find(|&j| text(j) == text(i));
        cell.key = first.map(|j| j as f64);
        if cell.text.chars().count() > 30 {
            cell.class = "choice";
        }
        out.push(cell);
    }
    out.push(status(run, on_front));
    let done = run.ending == Ending::Done;
    for (q, quantity) in view.record.quantities.iter().enumerate() {
        let measured = view.measured(i, q);
        let missing = measured.and_then(|m| m.missing.clone()).unwrap_or_default();
        if !quantity.curve {
            let value = measured.and_then(|m| m.value);
            let text = |v: f64| {
                if quantity.swing {
                    percent(v)
                } else {
                    digits(v, 5)
                }
            };
            out.push(Cell::number(value, text).hint(missing.clone()));
        }
        if quantity.reference.is_some() {
            let mut cell = Cell::number(measured.and_then(|m| m.error), percent);
            if cell.key.is_none() && done {
                cell.text = "none".into();
            }
            out.push(cell.hint(missing));
        }
    }
    let wall = run.wall;
    let time = Cell::number(wall.map(|w| w.median), seconds);
    out.push(time.hint(phases_in_words(view, i)));
    let repeated = wall.filter(|w| w.repeats > 1);
    let mut spread = Cell::number(repeated.map(|w| (w.most - w.least) / w.median), percent);
    if let Some(w) = repeated {
        spread.text = format!("{}–{}", digits(w.least, 3), digits(w.most, 3));
        spread.hint = format!("{} repeats", w.repeats);
    }
    out.push(spread);
    out.push(Cell::number(run.cpu.map(|c| c.median), seconds));
    out.push(Cell::number(run.peak_memory_mb, |v| digits(v, 3)));
    // A run that was never begun has no counts.
    let counted = |n: u64| {
        let n = (n > 0 || done).then_some(n);
        Cell::number(n.map(|n| n as f64), |v| count(v as u64))
    };
    let per_step = per_step(view, i);
    out.push(counted(run.dofs as u64));
    out.push(counted(run.contact_points as u64));
    out.push(counted(run.newton_iterations));
    out.push(Cell::number(per_step.map(|p| p.0), |v| digits(v, 2)));
    out.push(Cell::number(per_step.map(|p| f64::from(p.1)), |v| {
        digits(v, 3)
    }));
    out.push(counted(u64::from(run.steps)));
    out.push(counted(u64::from(run.cuts)));
    out
}

fn status(run: &crate::study::record::RunRecord, on_front: bool) -> Cell {
    let (text, key, class) = match &run.ending {
        Ending::Done if on_front => ("done, Pareto front".to_string(), 0.0, "front-run"),
        Ending::Done => ("done".to_string(), 1.0, ""),
        Ending::Failed(reason) => (format!("failed: {reason}"), 2.0, "reason"),
        Ending::Missing => ("missing".to_string(), 3.0, "reason"),
    };
    let text = match run.warnings.len() {
        0 => text,
        n => format!("{text}, {}", several(n, "warning")),
    };
    // A page is no log: `study.json` and `study.csv` have all of them.
    let mut hint = run.warnings.join("; ");
    if let Some((at, _)) = hint.char_indices().nth(400) {
        hint.truncate(at);
        hint.push('…');
    }
    Cell {
        text,
        key: Some(key),
        hint,
        class,
    }
}
