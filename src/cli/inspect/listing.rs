//! The findings as text.
use super::findings::{Curvature, EdgeName, Findings, GapPlace, Patch, Surface};
use crate::model::error::number;
use covact_geometry::io::{FaceBorder, LeftOutKind, SkipKind};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Gaps, overlaps, rims and parts that are listed one by one; `--json` has them all.
const LISTED: usize = 12;

pub(super) fn listing(f: &Findings) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = writeln!(out, "{}: {:?} file, unit {}", f.file, f.format, f.unit.name);
    if let Some(resolution) = f.resolution {
        let _ = writeln!(out, "resolution {resolution:e}");
    }
    let _ = writeln!(out, "\nentities");
    for e in f.entities {
        let number = match e.type_number {
            0 => String::new(),
            n => format!("{n}:{}", e.form),
        };
        let _ = writeln!(out, "{:>7} x {number:<7} {}", e.count, e.name);
    }
    bodies(&mut out, f);
    healed(&mut out, f);
    patches(&mut out, f);
    if let Some(surface) = &f.surface {
        all(&mut out, surface);
    }
    skipped(&mut out, f);
    for note in f.notes {
        let _ = writeln!(out, "note: {note}");
    }
    out
}

/// Every solid and sheet with its names, layers and colours.
fn bodies(out: &mut String, f: &Findings) {
    if f.bodies.is_empty() {
        return;
    }
    let _ = writeln!(out, "\nbodies: {}", f.bodies.len());
    let _ = writeln!(
        out,
        "{:>8} {:>8} {:>5} {:>6} {:>8}  name",
        "entity", "instance", "kind", "faces", "not read"
    );
    for (k, body) in f.bodies.iter().enumerate() {
        let own = || f.patches.iter().filter(|p| p.body == Some(k));
        let listed = |what: &str, names: BTreeSet<&str>| match names.is_empty() {
            true => String::new(),
            false => format!(
                "; {what} {}",
                names.into_iter().collect::<Vec<_>>().join(", ")
            ),
        };
        let place = match body.path.is_empty() {
            true => String::new(),
            false => format!(" ({})", body.path.join(" / ")),
        };
        let _ = writeln!(
            out,
            "{:>8} {:>8} {:>5} {:>6} {:>8}  {}{place}{}{}",
            body.entity,
            body.instance,
            if body.solid { "solid" } else { "sheet" },
            body.faces,
            body.skipped,
            body.name.as_deref().unwrap_or("-"),
            listed("layer", own().filter_map(|p| p.layer).collect()),
            listed("colour", own().filter_map(|p| p.colour).collect()),
        );
    }
}

/// Faces that were read but left out.
fn healed(out: &mut String, f: &Findings) {
    let h = f.healing;
    if h.left_out.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "\nleft out: {} sliver(s), the widest {:.1e}; {} duplicate face(s), at most {:.1e} from those that stay",
        h.slivers, h.widest_sliver, h.duplicates, h.farthest_duplicate
    );
    listed(out, "left out", &h.left_out, |l| match l.why {
        LeftOutKind::Sliver { width } => format!("entity {}: a sliver {width:.1e} wide", l.entity),
        LeftOutKind::Duplicate { of, distance } => format!(
            "entity {}: coincides with entity {of} within {distance:.1e}",
            l.entity
        ),
        _ => format!("entity {}", l.entity),
    });
}

fn patches(out: &mut String, f: &Findings) {
    let s = &f.summary;
    let _ = write!(out, "\npatches: {}", s.patches);
    if s.trimmed + s.rectangles > 0 {
        let whole = s.patches - s.trimmed - s.rectangles;
        let _ = write!(
            out,
            " ({} trimmed, {} narrowed to a rectangle of parameters, {whole} whole)",
            s.trimmed, s.rectangles
        );
    }
    out.push('\n');
    let t = f.trims;
    if t.curves > 0 {
        let _ = writeln!(
            out,
            "boundary curves: {} ({} exact, {} refitted, {} projected); largest gap {:.3e}, largest error {:.3e}, \
             tolerance {:.3e}",
            t.curves, t.exact, t.refitted, t.projected, t.largest_gap, t.largest_error, t.tolerance
        );
        if t.bridged > 0 {
            let _ = writeln!(
                out,
                "  {} gap(s) between curves of a boundary were closed, the largest {:.1e}",
                t.bridged, t.largest_bridge
            );
        }
        if t.rejected > 0 {
            let _ = writeln!(
                out,
                "  {} faces with curves in the parameter plane that disagree with those in space; the latter were used",
                t.rejected
            );
        }
    }
    if f.patches.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "{:>7} {:>4} {:>9} {:>6} {:>7} {:>8} {:>11} {:>10} {:>10}\n        bounds",
        "entity", "type", "border", "degree", "points", "rational", "area", "convex R", "concave R"
    );
    for p in &f.patches {
        patch(out, p);
    }
}

fn patch(out: &mut String, p: &Patch) {
    let radius = |r: Option<Option<f64>>| match r {
        Some(Some(r)) => number(r),
        Some(None) => "-".to_string(),
        None => "?".to_string(),
    };
    let convex = radius(p.curvature.as_ref().map(|c| c.smallest_convex_radius));
    let concave = radius(p.curvature.as_ref().map(|c| c.smallest_concave_radius));
    let border = match p.border {
        FaceBorder::Natural => "whole",
        FaceBorder::Rectangle => "rectangle",
        FaceBorder::Trimmed => "trimmed",
    };
    let kind = match p.type_number {
        0 => "-".to_string(),
        n => n.to_string(),
    };
    let _ = writeln!(
        out,
        "{:>7} {kind:>4} {border:>9} {:>6} {:>7} {:>8} {:>11} {convex:>10} {concave:>10}\n        {}",
        p.entity,
        format!("{}x{}", p.degree[0], p.degree[1]),
        format!("{}x{}", p.control_points[0], p.control_points[1]),
        if p.rational { "yes" } else { "no" },
        p.area.map_or("?".to_string(), number),
        match (&p.bounds, &p.fault) {
            (Some(b), _) => bounds(b),
            (None, fault) => fault.clone().unwrap_or_default(),
        }
    );
}

fn all(out: &mut String, s: &Surface) {
    let _ = writeln!(out, "\nall patches");
    let _ = writeln!(out, "  bounds     {}", bounds(&s.bounds));
    let _ = writeln!(out, "  area       {:.6}", s.area);
    let [low, high] = s.curvature.range;
    let _ = writeln!(
        out,
        "  curvature  {low:.6} to {high:.6}, smallest radii {}",
        radii(&s.curvature)
    );
    let _ = writeln!(
        out,
        "  edges      {} shared ({} smooth, {} sharp), {} shared in part, {} free, {} poles; tolerance {:.3e}, ten times \
         as much for whole edges",
        s.shared_edges,
        s.smooth_edges,
        s.sharp_edges,
        s.partly_shared_edges,
        s.free_edges,
        s.poles,
        s.tolerance
    );
    if s.branching_edges > 0 {
        let _ = writeln!(
            out,
            "             more than two patches meet at {} edges",
            s.branching_edges
        );
    }
    if let Some(g) = &s.largest_gap_at {
        let [a, b] = &g.edges;
        let _ = writeln!(
            out,
            "  joints     largest gap {:.3e} at {}, between {} and {}",
            g.gap,
            place(g.at),
            edge(a),
            edge(b)
        );
    }
    let between = |g: &GapPlace| {
        let [a, b] = &g.edges;
        format!(
            "{:.3e} at {}, between {} and {}",
            g.gap,
            place(g.at),
            edge(a),
            edge(b)
        )
    };
    let mut bridged: Vec<&GapPlace> = s.bridged.iter().collect();
    bridged.sort_by(|a, b| b.gap.total_cmp(&a.gap));
    listed(out, "bridged", &bridged, |g| {
        format!("gap of {}", between(g))
    });
    listed(out, "open gap", &s.open_gaps, between);
    listed(out, "stacked", &s.stacked, |g| {
        format!(
            "{}: not joined, both patches leave the edge in the same direction",
            between(g)
        )
    });
    listed(out, "overlap", &s.overlaps, |o| {
        format!(
            "{} runs inside of entity {} over {:.0} % of its length, {:.3e} deep at {}",
            edge(&o.edge),
            o.entity,
            100.0 * o.share,
            o.depth,
            place(o.at)
        )
    });
    listed(out, "free rim", &s.borders, |b| {
        format!(
            "{} of length {:.6}: {}",
            if b.closed { "closed" } else { "open" },
            b.length,
            edges(&b.edges)
        )
    });
    if !s.turned.is_empty() {
        let _ = writeln!(
            out,
            "  turned     {} face(s) were turned over to agree with their neighbours, the largest of area {:.6}",
            s.turned.len(),
            s.largest_turned
        );
        listed(out, "turned", &s.turned, |t| {
            format!("entity {} of area {:.6}", t.entity, t.area)
        });
    }
    listed(out, "part", &s.parts, |p| {
        let n = p.patches.len();
        let inside = match p.volume {
            Some(volume) => format!("closed, volume {volume:.6}"),
            None if p.one_sided => {
                "with one side only: distances from it carry no sign".to_string()
            }
            None => "open".to_string(),
        };
        format!(
            "{n} patch{}, area {:.6}, {inside}",
            if n == 1 { "" } else { "es" },
            p.area
        )
    });
}

/// A line for each, as far as they are listed.
fn listed<T>(out: &mut String, name: &str, items: &[T], line: impl Fn(&T) -> String) {
    for item in items.iter().take(LISTED) {
        let _ = writeln!(out, "  {name:<10} {}", line(item));
    }
    if let more @ 1.. = items.len().saturating_sub(LISTED) {
        let _ = writeln!(out, "  {name:<10} ... and {more} more (--json lists them)");
    }
}

fn skipped(out: &mut String, f: &Findings) {
    let kinds: Vec<String> = (f.summary.skipped_by_kind.iter())
        .map(|(kind, n)| format!("{n} {}", reason(*kind)))
        .collect();
    let _ = write!(out, "\nskipped: {}", f.skipped.len());
    if !kinds.is_empty() {
        let _ = write!(out, " ({})", kinds.join(", "));
    }
    out.push('\n');
    for s in f.skipped {
        let kind = if s.type_number == 0 {
            String::new()
        } else {
            format!(" (type {})", s.type_number)
        };
        let _ = writeln!(out, "  entity {}, {}{kind}: {}", s.entity, s.name, s.reason);
    }
}

fn reason(kind: SkipKind) -> &'static str {
    match kind {
        SkipKind::Blanked => "hidden",
        SkipKind::Purpose => "marked as annotation or construction",
        SkipKind::Dependent => "part of what is no surface",
        SkipKind::Template => "part of a subfigure that is placed nowhere",
        SkipKind::Unsupported => "of a type that is not read",
        SkipKind::Surface => "with data that gives no surface",
        SkipKind::Boundary => "with boundary curves that give no trim",
        _ => "for other reasons",
    }
}

fn edge(e: &EdgeName) -> String {
    match e.edge {
        n @ 0..4 => format!("entity {} side {n}", e.entity),
        n => format!("entity {} trim curve {}", e.entity, n - 4),
    }
}

/// The first of some edges, and how many more.
fn edges(list: &[EdgeName]) -> String {
    let first: Vec<String> = list.iter().take(4).map(edge).collect();
    match list.len().saturating_sub(4) {
        0 => first.join(", "),
        more => format!("{}, ... {more} more", first.join(", ")),
    }
}

fn radii(c: &Curvature) -> String {
    let one = |r: Option<f64>, sense: &str| r.map(|r| format!("{r:.6} {sense}"));
    let both: Vec<String> = [
        one(c.smallest_convex_radius, "convex"),
        one(c.smallest_concave_radius, "concave"),
    ]
    .into_iter()
    .flatten()
    .collect();
    match both.is_empty() {
        true => "none (flat)".to_string(),
        false => both.join(", "),
    }
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("({x:.6}, {y:.6}, {z:.6})")
}

pub(super) fn bounds([low, high]: &[[f64; 3]; 2]) -> String {
    // No minus sign in front of what rounds to zero.
    let tidy = |x: f64| if x.abs() < 5e-5 { 0.0 } else { x };
    let axis = |i: usize| format!("[{:.4}, {:.4}]", tidy(low[i]), tidy(high[i]));
    format!("{} {} {}", axis(0), axis(1), axis(2))
}
