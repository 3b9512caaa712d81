//! `covact plan`.
use super::text::folded;
use super::{CheckArgs, check, print, print_json, report};
use crate::machine::memory::Size;
use crate::plan::{Effect, PairPlan, Per};
use crate::run::{self, PlanReport};
use crate::shell::STATES;

pub(super) fn plan(args: &CheckArgs) -> u8 {
    let scene = match check::load(&args.scene) {
        Ok(scene) => scene,
        Err(e) => return report::scene_error(&e, args.json),
    };
    match run::plan(&scene) {
        Ok(found) if args.json => print_json(&found),
        Ok(found) => print(&folded(&listing(&found))),
        Err(e) => report::run_error(&e, &scene, args.json),
    }
}

/// Titles of the columns.
const TITLES: [&str; 5] = ["", "effect", "per point", "per element", "in all"];
/// Where the line below an effect begins.
const BELOW: &str = "       ";

/// A table whose columns are as wide as what stands in them, sizes to the right, with a line below each row.
#[derive(Default)]
struct Table {
    rows: Vec<([String; 5], String)>,
}

impl Table {
    fn add(&mut self, file: &str, effect: &Effect) {
        let size = |bytes: Option<usize>| bytes.map_or(String::new(), |b| format!("{b} B"));
        let grows = effect.held.iter().any(|h| h.grows);
        let all = match (effect.bytes(), grows) {
            (0, false) => String::new(),
            (0, true) => "grows".to_owned(),
            (bytes, false) => Size(bytes as u64).to_string(),
            (bytes, true) => format!("{} +", Size(bytes as u64)),
        };
        let mut why = effect.why.clone();
        if effect.unsymmetric {
            why += "; it takes the symmetry from the system";
        }
        if !effect.cost.is_empty() {
            why += &format!(" [{}]", effect.cost);
        }
        let cells = [
            if effect.on { "on" } else { "off" }.to_owned(),
            effect.name.to_owned(),
            size(effect.bytes_per(Per::Point)),
            size(effect.bytes_per(Per::Element)),
            all,
        ];
        let below = format!("{BELOW}{file}:{}: {why}", effect.place.line);
        self.rows.push((cells, below));
    }

    fn write(&self, out: &mut String) {
        let titles = TITLES.map(str::to_owned);
        let mut widths = titles.clone().map(|t| t.chars().count());
        for (row, _) in &self.rows {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.chars().count().max(*width);
            }
        }
        let head = (titles, format!("{BELOW}decided at: why"));
        for (row, below) in std::iter::once(&head).chain(&self.rows) {
            let mut line = String::new();
            for (k, (cell, width)) in row.iter().zip(widths).enumerate() {
                line += "  ";
                line += &match k {
                    2..=4 => format!("{cell:>width$}"),
                    _ => format!("{cell:<width$}"),
                };
            }
            *out += &format!("{}\n{}\n", line.trim_end(), below.trim_end());
        }
    }
}

fn listing(found: &PlanReport) -> String {
    let mut out = String::new();
    if !found.title.is_empty() {
        out += &format!("{}\n\n", found.title);
    }
    out += &format!(
        "{} elements, {} nodes, {} unknown displacements (dofs), {} contact points\n",
        found.elements, found.nodes, found.dofs, found.contact_points
    );
    let plan = &found.plan;
    out += &match plan.symmetric {
        true => "the system is symmetric\n".to_owned(),
        false => format!(
            "the system is unsymmetric: {}\n",
            plan.unsymmetric.join("; ")
        ),
    };
    let m = &found.memory;
    out += &format!(
        "a run takes about {} at most, estimated: elements {}, contact {}, surfaces {}, matrix {}, factorization {}\n",
        Size(m.total),
        Size(m.elements),
        Size(m.contact),
        Size(m.surfaces),
        Size(m.matrix),
        Size(m.factor)
    );
    out += &format!(
        "bytes are those of all copies: a run holds what states remember {STATES} times; what is off takes none; `+` grows\n"
    );
    for group in &plan.groups {
        section(&mut out, group.name, &found.file, &group.effects);
    }
    for pair in &plan.pairs {
        section(&mut out, &head(pair), &found.file, &pair.effects);
    }
    out
}

fn head(pair: &PairPlan) -> String {
    format!(
        "contact `{}`{}: {} points of {} on {}, kernel {}",
        pair.name,
        match (pair.edges, pair.back) {
            (true, _) => ", edges of its master",
            (false, true) => ", second half pass",
            (false, false) => "",
        },
        pair.points,
        pair.slave,
        pair.master,
        pair.kernel
    )
}

fn section(out: &mut String, title: &str, file: &str, effects: &[Effect]) {
    *out += &format!("\n{title}\n");
    let mut table = Table::default();
    effects.iter().for_each(|e| table.add(file, e));
    table.write(out);
}
