//! A small writer of SVG.
//!
//! `plotters` writes colours and sizes into every shape and flattens all text and groups. A report needs shapes with
//! classes, so that one picture follows the page from light to dark; groups that name their run, so that pointing at one
//! marks it in every picture; a text for each of them; and as few bytes as possible. So this is written here.
use crate::page::markup::escaped;
use crate::page::style::{LIGHT, literal_rules};
use std::fmt::Write as _;

/// Shapes on a canvas of fixed width that grows downwards.
#[derive(Debug, Clone)]
pub(crate) struct Svg {
    pub width: f64,
    pub height: f64,
    /// What the picture shows, for those who do not see it.
    pub label: String,
    body: String,
}

impl Svg {
    pub fn new(width: f64, label: &str) -> Self {
        Svg {
            width,
            height: 0.0,
            label: label.to_string(),
            body: String::new(),
        }
    }

    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let (a, b) = (point(from), point(to));
        let _ = write!(self.body, "<path class=\"{class}\" d=\"M{a}L{b}\"/>");
    }

    pub fn rect(&mut self, class: &str, [x, y]: [f64; 2], [w, h]: [f64; 2]) {
        let (x, y, w, h) = (px(x), px(y), px(w.max(0.0)), px(h.max(0.0)));
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>"
        );
    }

    pub fn polyline(&mut self, class: &str, points: &[[f64; 2]]) {
        if points.len() < 2 {
            return;
        }
        let path: Vec<String> = points.iter().map(|&p| point(p)).collect();
        let path = path.join("L");
        let _ = write!(self.body, "<path class=\"{class}\" d=\"M{path}\"/>");
    }

    pub fn text(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let (x, y, text) = (px(x), px(y), escaped(text));
        let class = if class.is_empty() {
            String::new()
        } else {
            format!(" class=\"{class}\"")
        };
        let _ = write!(self.body, "<text{class} x=\"{x}\" y=\"{y}\">{text}</text>");
    }

    /// Text that is cut where it is too wide, with all of it shown when pointed at.
    pub fn fitted_text(&mut self, class: &str, at: [f64; 2], text: &str, width: f64) {
        let cut = fit(text, width);
        if cut == text {
            return self.text(class, at, text);
        }
        let _ = write!(self.body, "<g><title>{}</title>", escaped(text));
        self.text(class, at, &cut);
        self.body.push_str("</g>");
    }

    pub fn marker(&mut self, shape: usize, at: [f64; 2], size: f64) {
        let path = marker(shape, at, size);
        let _ = write!(self.body, "<path class=\"m\" d=\"{path}\"/>");
    }

    /// Begins a group, of a run where one is given; its text is shown when pointed at.
    pub fn open(&mut self, class: &str, run: Option<usize>, title: &str) {
        let run = run.map_or(String::new(), |i| format!(" data-r=\"{i}\""));
        let _ = write!(self.body, "<g class=\"{class}\"{run}>");
        if !title.is_empty() {
            let _ = write!(self.body, "<title>{}</title>", escaped(title));
        }
    }

    pub fn close(&mut self) {
        self.body.push_str("</g>");
    }

    /// For a page that has the rules of plots.
    pub fn inline(&self) -> String {
        format!(
            "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>",
            px(self.width),
            px(self.height),
            escaped(&self.label),
            self.body
        )
    }

    /// A file that stands alone, on a white ground.
    pub fn standalone(&self) -> String {
        let (w, h) = (px(self.width), px(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{}\">\n<style>\n{}</style>\n\
             <rect width=\"{w}\" height=\"{h}\" rx=\"6\" fill=\"{}\"/>\n{}\n</svg>\n",
            escaped(&self.label),
            literal_rules(&LIGHT),
            LIGHT.ground,
            self.body.replace("</g><g", "</g>\n<g")
        )
    }
}

fn point([x, y]: [f64; 2]) -> String {
    format!("{} {}", px(x), px(y))
}

/// A coordinate to a tenth of a pixel.
fn px(v: f64) -> String {
    let tenths = (v * 10.0).round();
    if !tenths.is_finite() || tenths == 0.0 {
        return "0".to_string();
    }
    let text = format!("{:.1}", tenths / 10.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

/// The path of a marker: circle, square, triangle, diamond, triangle down, cross, pentagon, bar.
fn marker(shape: usize, [x, y]: [f64; 2], size: f64) -> String {
    let around = |corners: &[[f64; 2]]| {
        let at: Vec<String> = corners
            .iter()
            .map(|c| point([x + c[0] * size, y + c[1] * size]))
            .collect();
        format!("M{}z", at.join("L"))
    };
    match shape % 8 {
        0 => {
            let (left, r, d) = (point([x - size, y]), px(size), px(2.0 * size));
            format!("M{left}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z")
        }
        1 => around(&[[-0.88, -0.88], [0.88, -0.88], [0.88, 0.88], [-0.88, 0.88]]),
        2 => around(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
        3 => around(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
        4 => around(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        5 => around(&[
            [-1.2, -0.4],
            [-0.4, -0.4],
            [-0.4, -1.2],
            [0.4, -1.2],
            [0.4, -0.4],
            [1.2, -0.4],
            [1.2, 0.4],
            [0.4, 0.4],
            [0.4, 1.2],
            [-0.4, 1.2],
            [-0.4, 0.4],
            [-1.2, 0.4],
        ]),
        6 => around(&[
            [0.0, -1.15],
            [1.09, -0.36],
            [0.68, 0.93],
            [-0.68, 0.93],
            [-1.09, -0.36],
        ]),
        _ => around(&[[-1.2, -0.55], [1.2, -0.55], [1.2, 0.55], [-1.2, 0.55]]),
    }
}

/// About how wide a text of 12 pixels is set, in a wide typeface.
pub(crate) fn width(text: &str) -> f64 {
    let of = |c: char| match c {
        'i' | 'j' | 'l' | '\'' | '|' | '.' | ',' | ':' | ';' | '!' | ' ' | '\u{202f}' => 3.9,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' | '⁰'..='⁹' | '¹' | '²' | '³' => {
            4.8
        }
        'm' | 'M' | 'W' | '%' | '@' => 11.6,
        'A'..='Z' | 'w' | '<' | '>' | '=' | '+' | '×' | '&' | '−' => 9.4,
        c if (c as u32) >= 0x1100 && !"…–".contains(c) => 12.5,
        _ => 7.5,
    };
    text.chars().map(of).sum()
}

/// A text cut to a width, with an ellipsis where something is missing.
pub(crate) fn fit(text: &str, wide: f64) -> String {
    if width(text) <= wide {
        return text.to_string();
    }
    let mut out = String::new();
    let mut used = width("…") + 5.0;
    for c in text.chars() {
        used += width(c.encode_utf8(&mut [0; 4]));
        if used > wide {
            break;
        }
        out.push(c);
    }
    out.trim_end().to_string() + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_always_finite() {
        assert_eq!(px(f64::NAN), "0");
        assert_eq!(px(f64::INFINITY), "0");
        assert_eq!(px(-0.04), "0");
        assert_eq!(px(12.34), "12.3");
        assert_eq!(px(-7.0), "-7");
    }

    #[test]
    fn long_text_is_cut() {
        assert_eq!(fit("short", 100.0), "short");
        let cut = fit("a name that is much too long for its place", 100.0);
        assert!(cut.ends_with('…') && width(&cut) <= 100.0, "{cut}");
    }
}
