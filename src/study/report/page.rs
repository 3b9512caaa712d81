//! `report.html`: one file with all that a study found.
use super::figures::Figure;
use super::view::View;
use super::{table, words};
use crate::page::head;
use crate::page::markup::{escaped, prose};
use crate::page::number::{digits, percent, seconds, several};
use crate::study::record::{Ending, QuantityRecord};
use std::fmt::Write as _;

/// Bytes of pictures that a page may have. Those beyond are named and linked: they are beside the page.
const PICTURES: usize = 1_200_000;

/// Warnings that are not folded.
const WARNINGS: usize = 10;

/// The page. Whatever it refers to lies beside it.
pub(crate) fn html(view: &View, figures: &[Figure]) -> String {
    let record = view.record;
    let title = match record.title.trim() {
        "" => format!("Study of {}", record.scene),
        title => title.to_string(),
    };
    let mut out = format!(
        "<!DOCTYPE html>\n{}<main>\n",
        head(&title, include_str!("page.css"))
    );
    let _ = writeln!(out, "<h1>{}</h1>", escaped(&title));
    if !record.question.trim().is_empty() {
        let _ = writeln!(out, "<p class=\"question\">{}</p>", prose(&record.question));
    }
    facts(&mut out, view);
    warnings(&mut out, view);
    for section in words::of_view(view) {
        let _ = writeln!(out, "<h2>{}</h2>\n<ul>", escaped(&section.title));
        for sentence in section.sentences {
            let _ = writeln!(out, "<li>{}</li>", prose(&sentence));
        }
        out.push_str("</ul>\n");
    }
    pictures(&mut out, view, figures);
    let _ = writeln!(
        out,
        "<h2>All runs</h2>\n<div class=\"table\">{}</div>",
        table::html(view)
    );
    footer(&mut out, view, figures);
    let _ = write!(
        out,
        "</main>\n<div id=\"tip\" role=\"tooltip\"></div>\n<script>\n{}</script>\n</body>\n</html>\n",
        include_str!("page.js")
    );
    out
}

fn facts(out: &mut String, view: &View) {
    let record = view.record;
    let endings =
        |ending: fn(&Ending) -> bool| record.runs.iter().filter(|r| ending(&r.ending)).count();
    let mut runs = several(record.runs.len(), "run");
    let failed = endings(|e| matches!(e, Ending::Failed(_)));
    let missing = endings(|e| *e == Ending::Missing);
    if failed > 0 {
        runs.push_str(&format!(", {failed} failed"));
    }
    if missing > 0 {
        runs.push_str(&format!(", {missing} missing"));
    }
    let timing = &record.timing;
    let how = format!(
        "{}; {}; {} per run; stopped after {}",
        match timing.repeats {
            0 | 1 => "every run once".to_string(),
            n => format!("medians of {n} repeats, round after round"),
        },
        if timing.one_at_a_time {
            "one run at a time"
        } else {
            "side by side, so that runs may slow each other down"
        },
        several(timing.threads as usize, "thread"),
        seconds(timing.limit)
    );
    let machine = &record.machine;
    let processor = match machine.processor.trim() {
        "" => "processor not known",
        name => name,
    };
    let cores = several(machine.cores, "core");
    out.push_str("<dl class=\"facts\">\n");
    for (name, text) in [
        ("Scene", record.scene.clone()),
        ("Runs", runs),
        ("Times", how),
        (
            "Machine",
            format!("{processor}, {cores}, {}", machine.system),
        ),
        ("Program", format!("covact {}", record.covact)),
    ] {
        let _ = writeln!(out, "<dt>{name}</dt><dd>{}</dd>", escaped(&text));
    }
    out.push_str("</dl>\n");
}

fn warnings(out: &mut String, view: &View) {
    if view.record.warnings.is_empty() {
        return;
    }
    out.push_str("<div class=\"warnings\"><strong>Warnings</strong>\n<ul>\n");
    let item = |warning: &String| format!("<li>{}</li>\n", prose(warning));
    let (first, more) = view
        .record
        .warnings
        .split_at(view.record.warnings.len().min(WARNINGS));
    out.extend(first.iter().map(item));
    out.push_str("</ul>\n");
    if !more.is_empty() {
        let _ = writeln!(out, "<details><summary>{} more</summary>\n<ul>", more.len());
        out.extend(more.iter().map(item));
        out.push_str("</ul></details>\n");
    }
    out.push_str("</div>\n");
}

/// Those of the first quantity and of cost in full, those of other quantities folded.
fn pictures(out: &mut String, view: &View, figures: &[Figure]) {
    let mut left = PICTURES;
    let quantities = &view.record.quantities;
    let first = figures.iter().filter_map(|f| f.quantity).next();
    let full = first.or((!quantities.is_empty()).then_some(0));
    let of =
        |q: Option<usize>| -> Vec<&Figure> { figures.iter().filter(|f| f.quantity == q).collect() };
    if let Some(q) = full {
        let _ = writeln!(out, "<h2>{}</h2>", escaped(&quantities[q].name));
        about(out, &quantities[q]);
        quantity_group(out, &of(Some(q)), &mut left);
    }
    let cost = of(None);
    if !cost.is_empty() {
        out.push_str("<h2>Time and iterations</h2>\n");
        group(out, &cost, &mut left);
    }
    let others: Vec<usize> = (0..quantities.len()).filter(|&q| Some(q) != full).collect();
    if others.is_empty() {
        return;
    }
    out.push_str("<h2>Other quantities</h2>\n");
    for q in others {
        let figures = of(Some(q));
        // Force noise has one picture, and is what many a study is about.
        let open = if quantities[q].swing && figures.len() < 3 {
            " open=\"open\""
        } else {
            ""
        };
        let name = escaped(&quantities[q].name);
        let _ = writeln!(out, "<details{open}><summary>{name}</summary>");
        about(out, &quantities[q]);
        quantity_group(out, &figures, &mut left);
        out.push_str("</details>\n");
    }
}

/// What the quantity is and what it is compared with.
fn about(out: &mut String, quantity: &QuantityRecord) {
    let mut text = format!("{}.", quantity.measure.trim_end_matches('.'));
    if let Some(reference) = &quantity.reference {
        let value = reference.value.map_or(String::new(), |v| {
            format!(", {} {}", digits(v, 6), quantity.unit)
                .trim_end()
                .to_string()
        });
        let source = reference.source.trim_end_matches('.');
        text.push_str(&format!(" Reference: {source}{value}; "));
        let order = reference.order.map_or(String::new(), |p| digits(p, 2));
        text.push_str(&match (reference.error, reference.observed) {
            (None, _) => "its own error is not known.".to_string(),
            (Some(0.0), _) => "taken for exact.".to_string(),
            (Some(e), _) if order.is_empty() => format!("its own error is about {}.", percent(e)),
            (Some(e), true) => format!(
                "its own error is about {}, from three runs (observed order {order}).",
                percent(e)
            ),
            (Some(e), false) => format!(
                "its own error is about {}, if the order is {order} as assumed.",
                percent(e)
            ),
        });
    }
    let mut chars = text.chars();
    let first = chars.next().into_iter().flat_map(char::to_uppercase);
    let text: String = first.chain(chars).collect();
    let _ = writeln!(out, "<p>{}</p>", prose(&text));
}

fn quantity_group(out: &mut String, figures: &[&Figure], left: &mut usize) {
    if figures.is_empty() {
        out.push_str("<p>No run has a value or an error to draw.</p>\n");
    } else {
        group(out, figures, left);
    }
}

fn group(out: &mut String, figures: &[&Figure], left: &mut usize) {
    out.push_str("<div class=\"figures\">\n");
    let mut beyond = Vec::new();
    for figure in figures {
        let svg = figure.svg.inline();
        let file = escaped(&figure.file);
        if svg.len() > *left {
            beyond.push(format!("<a href=\"{file}.svg\">{file}.svg</a>"));
            continue;
        }
        *left -= svg.len();
        let caption = prose(&figure.caption);
        let _ = writeln!(
            out,
            "<figure>{svg}<figcaption>{caption} <a href=\"{file}.svg\">SVG</a></figcaption></figure>"
        );
    }
    out.push_str("</div>\n");
    if !beyond.is_empty() {
        let _ = writeln!(
            out,
            "<p>Left out to keep this page small, and beside it as files: {}.</p>",
            beyond.join(", ")
        );
    }
}

fn footer(out: &mut String, view: &View, figures: &[Figure]) {
    let files: Vec<String> = figures
        .iter()
        .map(|f| {
            let file = escaped(&f.file);
            format!("<a href=\"{file}.svg\">{file}.svg</a>")
        })
        .collect();
    let pictures = match files.len() {
        0 => String::new(),
        _ => format!("; pictures: {}", files.join(", ")),
    };
    let _ = writeln!(
        out,
        "<footer>Made by covact {} from study.json. Beside this file: <a href=\"study.csv\">study.csv</a>, \
         <a href=\"study.json\">study.json</a>{pictures}.</footer>",
        escaped(&view.record.covact)
    );
}
