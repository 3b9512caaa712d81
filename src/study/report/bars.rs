//! A horizontal bar per run.
use super::axis::Axis;
use super::legend::{self, Entry};
use super::plot::WIDTH;
use super::svg::{Svg, width};
use super::view::Style;

const TOP: f64 = 34.0;
const RIGHT: f64 = 96.0;
const ROW: f64 = 19.0;
const BAR: f64 = 12.0;

/// What a row shows.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    /// Lengths with their phases, one after the other.
    Stack(Vec<(usize, f64)>),
    /// A bar, and a mark where the most was.
    Most(f64, Option<f64>),
    /// Words instead of a bar.
    Words(String),
}

#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub run: usize,
    pub name: String,
    pub style: Style,
    pub shape: Shape,
    /// Behind the bar.
    pub value: String,
    pub title: String,
}

#[derive(Debug, Clone)]
pub(crate) struct Bars {
    pub title: String,
    pub axis: Axis,
    pub axis_label: String,
    pub rows: Vec<Row>,
    pub legend: Vec<Entry>,
}

impl Bars {
    /// Draws them.
    pub fn draw(&self) -> Svg {
        let mut svg = Svg::new(WIDTH, &self.title);
        svg.fitted_text("title", [12.0, 22.0], &self.title, (WIDTH - 24.0) / 1.3);
        let widest = self
            .rows
            .iter()
            .map(|r| width(&r.name))
            .fold(60.0, f64::max);
        let left = (widest + 44.0).min(320.0);
        let bottom = TOP + self.rows.len() as f64 * ROW + 6.0;
        let place = |v: f64| left + self.axis.place(v) * (WIDTH - left - RIGHT);
        for (value, label) in &self.axis.ticks {
            let class = if label.is_some() { "grid" } else { "fine" };
            svg.line(class, [place(*value), TOP], [place(*value), bottom]);
        }
        let mut free = 0.0;
        for (value, label) in &self.axis.ticks {
            let Some(label) = label else { continue };
            let (x, half) = (place(*value), 0.5 * width(label));
            if x - half >= free {
                free = x + half + 6.0;
                svg.text("soft mid", [x, bottom + 15.0], label);
            }
        }
        for (k, row) in self.rows.iter().enumerate() {
            let y = TOP + 4.0 + (k as f64 + 0.5) * ROW;
            self.row(&mut svg, row, y, left, &place);
        }
        svg.line("frame", [left, TOP], [left, bottom]);
        svg.fitted_text(
            "soft end",
            [WIDTH - RIGHT, bottom + 34.0],
            &self.axis_label,
            WIDTH - RIGHT - 16.0,
        );
        svg.height = legend::draw(&mut svg, &self.legend, 16.0, bottom + 44.0) + 10.0;
        svg
    }

    fn row(&self, svg: &mut Svg, row: &Row, y: f64, left: f64, place: &impl Fn(f64) -> f64) {
        svg.open(&format!("c{}", row.style.colour), Some(row.run), &row.title);
        svg.marker(row.style.marker, [18.0, y], 4.2);
        let name = super::svg::fit(&row.name, left - 36.0);
        svg.text("", [30.0, y + 4.0], &name);
        let top = y - 0.5 * BAR;
        let end = match &row.shape {
            Shape::Stack(parts) => {
                let mut sum = 0.0;
                for &(phase, length) in parts {
                    let (from, to) = (place(sum), place(sum + length));
                    sum += length;
                    svg.rect(&format!("seg p{phase}"), [from, top], [to - from, BAR]);
                }
                place(sum)
            }
            Shape::Most(value, most) => {
                svg.rect("bar", [left, top], [place(*value) - left, BAR]);
                let most = most.map(place).filter(|x| *x > place(*value) + 1.0);
                if let Some(x) = most {
                    svg.line("e", [place(*value), y], [x, y]);
                    svg.line("e", [x, y - 4.0], [x, y + 4.0]);
                }
                most.unwrap_or(place(*value))
            }
            Shape::Words(words) => {
                svg.fitted_text("soft", [left + 6.0, y + 4.0], words, WIDTH - left - 20.0);
                left
            }
        };
        if !row.value.is_empty() {
            svg.text("small", [end + 6.0, y + 4.0], &row.value);
        }
        svg.close();
    }
}
