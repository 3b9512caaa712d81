//! Legends below plots, where they cover no data.
use super::plot::dashed;
use super::svg::{Svg, width};
use super::view::{Style, View};

/// What stands before the text of an entry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sign {
    /// Line and marker.
    Series(Style),
    Colour(usize),
    Marker(usize),
    Phase(usize),
    Band,
    Front,
    Reference,
    /// Colour and kind of dashes.
    Curve(usize, usize),
    /// A line without markers in the colour of a series.
    Level(Style),
    Bar,
    None,
}

#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub sign: Sign,
    pub text: String,
}

impl Entry {
    pub fn new(sign: Sign, text: impl Into<String>) -> Self {
        let text = text.into();
        Entry { sign, text }
    }
}

const ROW: f64 = 19.0;

/// Entries of the series that `shown` names; `more` is added to the name of a series.
pub(crate) fn series(
    view: &View,
    shown: &[usize],
    more: impl Fn(usize) -> Option<String>,
) -> Vec<Entry> {
    if let Some(factors) = &view.factors {
        let used = |of: fn(Style) -> usize, n: usize| {
            (shown.iter()).any(|&s| of(view.series[s].style) == n)
        };
        let colours = factors.colours.iter().enumerate();
        let markers = factors.markers.iter().enumerate();
        return colours
            .filter(|(i, _)| used(|s| s.colour, *i))
            .map(|(i, text)| Entry::new(Sign::Colour(i), text))
            .chain(
                markers
                    .filter(|(i, _)| used(|s| s.marker, *i))
                    .map(|(i, text)| Entry::new(Sign::Marker(i), text)),
            )
            .collect();
    }
    let mut entries: Vec<Entry> = shown
        .iter()
        .map(|&s| {
            let series = &view.series[s];
            let more = more(s).map_or(String::new(), |m| format!(" ({m})"));
            Entry::new(Sign::Series(series.style), format!("{}{more}", series.name))
        })
        .collect();
    // Names in a plot of many series would take more room than the plot.
    if entries.len() > 24 {
        let rest = entries.len() - 24;
        entries.truncate(24);
        entries.push(Entry::new(Sign::None, format!("and {rest} more series")));
    }
    entries
}

/// Draws entries in columns from `top` down; returns where they end.
pub(crate) fn draw(svg: &mut Svg, entries: &[Entry], left: f64, top: f64) -> f64 {
    if entries.is_empty() {
        return top;
    }
    let room = svg.width - left - 12.0;
    let widest = entries
        .iter()
        .map(|e| width(&e.text) + 46.0)
        .fold(0.0, f64::max);
    // One long name among many short ones is cut rather than given a column as wide as the plot.
    let widest = if entries.len() > 6 {
        widest.min(0.5 * room)
    } else {
        widest
    };
    let columns = ((room / widest).floor() as usize).clamp(1, 4);
    let rows = entries.len().div_ceil(columns);
    let columns = entries.len().div_ceil(rows);
    let wide = (room / columns as f64).min(widest + 12.0);
    for (i, entry) in entries.iter().enumerate() {
        let x = left + (i / rows) as f64 * wide;
        let y = top + ((i % rows) as f64 + 0.5) * ROW;
        sign(svg, entry.sign, [x, y]);
        let indent = if entry.sign == Sign::None { 0.0 } else { 32.0 };
        svg.fitted_text("", [x + indent, y + 4.0], &entry.text, wide - indent - 6.0);
    }
    top + rows as f64 * ROW
}

fn sign(svg: &mut Svg, sign: Sign, [x, y]: [f64; 2]) {
    let (from, middle, to) = ([x, y], [x + 13.0, y], [x + 26.0, y]);
    let colour = |i: usize| format!("c{i}");
    match sign {
        Sign::Series(style) => {
            svg.open(&colour(style.colour), None, "");
            svg.line("l", from, to);
            svg.marker(style.marker, middle, 4.5);
            svg.close();
        }
        Sign::Level(style) => {
            svg.open(&colour(style.colour), None, "");
            svg.line("l dash", from, to);
            svg.close();
        }
        Sign::Colour(c) => {
            svg.open(&colour(c), None, "");
            svg.rect("bar", [x + 4.0, y - 5.0], [18.0, 10.0]);
            svg.close();
        }
        Sign::Marker(shape) => {
            svg.open("c6", None, "");
            svg.marker(shape, middle, 4.5);
            svg.close();
        }
        Sign::Bar => {
            svg.open("c6", None, "");
            svg.line("e", from, to);
            svg.line("e", [x, y - 3.5], [x, y + 3.5]);
            svg.line("e", [to[0], y - 3.5], [to[0], y + 3.5]);
            svg.close();
        }
        Sign::Phase(p) => svg.rect(&format!("p{p}"), [x + 8.0, y - 5.5], [15.0, 11.0]),
        Sign::Band => svg.rect("band", [x, y - 5.5], [26.0, 11.0]),
        Sign::Front => svg.line("front", [x + 3.0, y], [x + 23.0, y]),
        Sign::Curve(c, dashes) => {
            svg.open(&colour(c), None, "");
            svg.line(dashed(dashes), from, to);
            svg.close();
        }
        Sign::Reference => svg.line("ref", from, to),
        Sign::None => {}
    }
}
