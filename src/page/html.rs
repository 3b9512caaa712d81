//! The text of the page.
use super::markup::{escaped, prose};
use super::number::digits;
use super::pack::{Chunk, Pack};
use super::places::place;
use super::shapes::Shapes;
use super::style::{DARK, LIGHT, rules, variables};
use crate::output::{Comparison, RunStatus, Summary};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// How pages of runs begin.
pub(super) const START: &str = "<!DOCTYPE html>\n<!-- covact run -->\n";
/// Warnings that are not folded.
const WARNINGS: usize = 10;

/// A run in the page.
#[derive(Debug)]
pub(super) struct Run {
    pub name: String,
    /// Names of surfaces and supports whose forces are told.
    pub surfaces: Vec<String>,
    pub summary: Summary,
    pub shapes: Shapes,
    /// Where the history is packed.
    pub table: Chunk,
}

/// What scripts are told of a run.
#[derive(Serialize)]
struct Head<'a> {
    index: usize,
    name: &'a str,
    shapes: &'a Shapes,
    table: Chunk,
    marks: Vec<Mark<'a>>,
}

/// A warning with a place.
#[derive(Serialize)]
struct Mark<'a> {
    number: usize,
    at: [f64; 3],
    text: &'a str,
}

/// What a run in a folder is called.
pub(super) fn name(folder: &Path) -> String {
    let whole = folder.canonicalize();
    let named = whole.as_deref().unwrap_or(folder).file_name();
    named.map_or_else(|| "run".to_owned(), |n| n.to_string_lossy().into_owned())
}

/// Everything up to the contents of a page: title, rules common to all pages and `own` ones.
pub(crate) fn head(title: &str, own: &str) -> String {
    format!(
        "<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         script-src 'unsafe-inline'\"/>\n<title>{}</title>\n<style>\n:root{{{}}}\n\
         @media (prefers-color-scheme:dark){{:root{{{}}}}}\n{}{}{}</style>\n</head>\n<body>\n",
        escaped(title),
        variables(&LIGHT),
        variables(&DARK),
        include_str!("base.css"),
        own,
        rules(),
    )
}

/// The page of one run, or of two with what differs between them.
pub(super) fn page(runs: &[Run], comparison: Option<&Comparison>, pack: &Pack) -> String {
    let names: Vec<&str> = runs.iter().map(|r| r.name.as_str()).collect();
    let title = names.join(" and ");
    let mut out = START.to_owned() + &head(&title, include_str!("web/run.css"));
    let _ = writeln!(
        out,
        "<main>\n<h1>{}</h1>\n<div class=\"runs\">",
        escaped(&title)
    );
    for (index, run) in runs.iter().enumerate() {
        out.push_str("<section>\n");
        if runs.len() > 1 {
            let _ = writeln!(out, "<h2>{}</h2>", escaped(&run.name));
        }
        if !run.summary.title.is_empty() {
            let _ = writeln!(out, "<p>{}</p>", escaped(&run.summary.title));
        }
        status(&mut out, &run.summary);
        let _ = writeln!(
            out,
            "<div id=\"view{index}\"><noscript>The 3-D view and the curves need scripts.</noscript></div>"
        );
        warnings(&mut out, index, &run.summary.warnings);
        out.push_str("</section>\n");
    }
    out.push_str("</div>\n");
    if let Some(comparison) = comparison {
        differences(&mut out, &names, comparison);
    }
    out.push_str(
        "<h2>Curves</h2>\n<div class=\"charts\" id=\"charts\"></div>\n<div class=\"runs\">\n",
    );
    for run in runs {
        out.push_str("<section>\n");
        let of = match runs.len() {
            1 => String::new(),
            _ => format!(" of {}", run.name),
        };
        accuracy(&mut out, &of, &run.summary);
        cost(&mut out, &of, &run.summary);
        plan(&mut out, &of, &run.summary);
        out.push_str("</section>\n");
    }
    let _ = writeln!(
        out,
        "</div>\n<footer>Made by covact {} from history.csv, summary.json and the fields in results.pvd.</footer>\n</main>",
        env!("CARGO_PKG_VERSION")
    );
    data(&mut out, runs, pack);
    out
}

/// Numbers and scripts.
fn data(out: &mut String, runs: &[Run], pack: &Pack) {
    let heads: Vec<Head> = (runs.iter().enumerate())
        .map(|(index, run)| Head {
            index,
            name: &run.name,
            shapes: &run.shapes,
            table: run.table,
            marks: marks(&run.summary.warnings),
        })
        .collect();
    // Numbers that are no numbers do not come about, and a script ends at its tag only.
    let heads = serde_json::to_string(&heads).unwrap_or_else(|_| "[]".into());
    let heads = heads.replace('<', "\\u003c");
    let _ = writeln!(
        out,
        "<script type=\"application/json\" id=\"head\">{heads}</script>"
    );
    out.push_str("<script type=\"text/plain\" id=\"bytes\">");
    STANDARD.encode_string(&pack.bytes, out);
    out.push_str("</script>\n");
    for (id, text) in [
        ("faces-vert", include_str!("web/faces.vert")),
        ("faces-frag", include_str!("web/faces.frag")),
    ] {
        let _ = writeln!(out, "<script type=\"x-shader\" id=\"{id}\">{text}</script>");
    }
    for script in [
        include_str!("web/unpack.js"),
        include_str!("web/camera.js"),
        include_str!("web/stage.js"),
        include_str!("web/viewer.js"),
        include_str!("web/chart.js"),
        include_str!("web/main.js"),
    ] {
        let _ = writeln!(out, "<script>\n{script}</script>");
    }
    out.push_str("</body>\n</html>\n");
}

fn marks(warnings: &[String]) -> Vec<Mark<'_>> {
    let mark = |(k, text): (usize, &'_ String)| place(text).map(|at| (k, at));
    (warnings.iter().enumerate())
        .filter_map(|(k, text)| mark((k, text)).map(|(k, at)| (k, at, text)))
        .map(|(k, at, text)| Mark {
            number: k + 1,
            at,
            text,
        })
        .collect()
}

fn status(out: &mut String, summary: &Summary) {
    let (class, text) = match summary.status {
        RunStatus::Done => ("done", "Done"),
        RunStatus::NotConverged => ("other", "Not converged"),
        RunStatus::NoContact => ("other", "No contact"),
        RunStatus::Interrupted => ("other", "Interrupted"),
        RunStatus::Failed => ("other", "Failed"),
    };
    let reason = (summary.reason.as_ref()).map_or(String::new(), |r| format!(": {}", prose(r)));
    let a = &summary.accuracy;
    let error = match a.step {
        0 => String::new(),
        _ => format!(" Estimated error of forces: {}.", percent(a.force_error)),
    };
    let _ = writeln!(
        out,
        "<p><strong class=\"status-{class}\">{text}</strong>{reason} at time {}: {} steps, {} iterations, {} s.{error}</p>",
        number(summary.time),
        summary.steps,
        summary.newton_iterations,
        number(summary.wall_s)
    );
}

fn warnings(out: &mut String, index: usize, warnings: &[String]) {
    if warnings.is_empty() {
        return;
    }
    out.push_str("<div class=\"warnings\"><strong>Warnings</strong>\n<ul>\n");
    for (k, text) in warnings.iter().enumerate() {
        if k == WARNINGS {
            let more = warnings.len() - WARNINGS;
            let _ = writeln!(out, "</ul><details><summary>{more} more</summary>\n<ul>");
        }
        let number = k + 1;
        let mark = match place(text) {
            Some(_) => format!("<span class=\"mark\">{number}</span>"),
            None => String::new(),
        };
        let _ = writeln!(
            out,
            "<li id=\"w{index}-{number}\">{mark}{}</li>",
            prose(text)
        );
    }
    out.push_str("</ul>\n");
    if warnings.len() > WARNINGS {
        out.push_str("</details>\n");
    }
    out.push_str("</div>\n");
}

fn accuracy(out: &mut String, of: &str, summary: &Summary) {
    let a = &summary.accuracy;
    let _ = writeln!(out, "<h2>Accuracy of forces{}</h2>", escaped(of));
    if a.step == 0 {
        out.push_str("<p>Nothing was in contact.</p>\n");
        return;
    }
    let _ = writeln!(
        out,
        "<p>The compliance of contact changes the largest forces by about {} (step {}, time {}{}): the energy of contact is {} of \
         the strain energy, the penetration {} of the approach of the bodies.</p>",
        percent(a.force_error),
        a.step,
        number(a.time),
        (a.contact.as_ref()).map_or(String::new(), |c| format!(", contact {}", escaped(c))),
        percent(a.energy_ratio),
        percent(a.penetration_ratio)
    );
    let rows = a.contacts.iter().map(|c| {
        vec![
            c.name.clone(),
            number(c.force),
            c.step.to_string(),
            c.active.to_string(),
            (c.few).map_or(String::new(), |n| n.to_string()),
            percent(c.edge_share),
            number(c.penalty),
        ]
    });
    let heads = [
        "contact",
        "largest force",
        "step",
        "points in contact",
        "points that carry 90 %",
        "on sharp edges",
        "penalty",
    ];
    table(out, "plain", &heads, rows);
}

fn cost(out: &mut String, of: &str, s: &Summary) {
    let _ = writeln!(out, "<h2>Cost{}</h2>\n<dl class=\"facts\">", escaped(of));
    let mut fact = |name: &str, text: String| {
        let _ = writeln!(out, "<dt>{name}</dt><dd>{}</dd>", escaped(&text));
    };
    fact("Unknowns", s.dofs.to_string());
    fact("Slave points", s.contact_points.to_string());
    fact("Steps", format!("{}, {} cut", s.steps, s.cuts));
    fact(
        "Iterations",
        format!("{}{}", s.newton_iterations, s.in_vain()),
    );
    let cpu = s.cpu_s.map_or(String::new(), |cpu| {
        format!(", {} s of processors", number(cpu))
    });
    fact(
        "Time",
        format!("{} s{cpu}, {} thread(s)", number(s.wall_s), s.threads),
    );
    if let Some(memory) = s.peak_memory_mb {
        fact("Memory", format!("{} MB", number(memory)));
    }
    let mut phases: Vec<(&String, &f64)> = s.phases.iter().collect();
    phases.sort_by(|a, b| b.1.total_cmp(a.1));
    let phases: Vec<String> = (phases.iter())
        .map(|(name, t)| format!("{name} {} s", number(**t)))
        .collect();
    fact("Phases", phases.join(", "));
    fact("Program", format!("covact {}", s.versions.covact));
    out.push_str("</dl>\n");
}

fn plan(out: &mut String, of: &str, summary: &Summary) {
    let Some(plan) = &summary.plan else {
        return;
    };
    let _ = writeln!(out, "<h2>Plan{}</h2>", escaped(of));
    let system = match plan.symmetric {
        true => "The system is symmetric.".to_owned(),
        false => format!(
            "The system is unsymmetric: {}.",
            plan.unsymmetric.join("; ")
        ),
    };
    let _ = writeln!(out, "<p>{}</p>", prose(&system));
    let whole = plan.effects.iter().map(|e| (String::new(), e));
    let paired = plan.pairs.iter().flat_map(|p| {
        let name = match (p.edges, p.back) {
            (true, _) => format!("{} (edges)", p.name),
            (false, true) => format!("{} (back)", p.name),
            (false, false) => p.name.clone(),
        };
        p.effects.iter().map(move |e| (name.clone(), e))
    });
    let rows = (whole.chain(paired)).map(|(pair, e)| vec![pair, e.name.clone(), e.why.clone()]);
    table(out, "plain plan", &["contact", "effect", "why"], rows);
    for pair in &plan.pairs {
        let _ = writeln!(
            out,
            "<p>Contact <code>{}</code> is evaluated by <code>{}</code>.</p>",
            escaped(&pair.name),
            escaped(pair.ran.as_ref().unwrap_or(&pair.kernel))
        );
    }
}

fn differences(out: &mut String, names: &[&str], comparison: &Comparison) {
    out.push_str("<h2>Differences</h2>\n");
    let value = |v: Option<f64>| v.map_or(String::new(), number);
    let change = |v: Option<f64>| {
        v.map_or(String::new(), |v| {
            format!("{}{}", if v > 0.0 { "+" } else { "" }, percent(v))
        })
    };
    let rows = comparison.columns.iter().map(|c| {
        vec![
            c.name.clone(),
            value(c.end[0]),
            value(c.end[1]),
            change(c.change()),
            value(c.peak[0]),
            value(c.peak[1]),
            change(c.peak_change()),
        ]
    });
    let (first, second) = (names[0], names.get(1).copied().unwrap_or(""));
    let heads = [
        "column".to_owned(),
        format!("end, {first}"),
        format!("end, {second}"),
        "change".to_owned(),
        format!("peak, {first}"),
        format!("peak, {second}"),
        "change".to_owned(),
    ];
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    table(out, "plain", &heads, rows);
}

/// A table of a class of the page's rules.
fn table(out: &mut String, class: &str, heads: &[&str], rows: impl Iterator<Item = Vec<String>>) {
    let _ = write!(out, "<div class=\"{class}\"><table>\n<thead><tr>");
    for head in heads {
        let _ = write!(out, "<th>{}</th>", escaped(head));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = write!(out, "<td>{}</td>", prose(&cell));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
}

/// A number in four digits.
fn number(v: f64) -> String {
    digits(v, 4)
}

fn percent(v: f64) -> String {
    format!("{} %", number(100.0 * v))
}
