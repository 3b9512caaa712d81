//! Points and lines over two axes.
use super::axis::Axis;
use super::legend::{self, Entry};
use super::svg::{Svg, width};
use super::view::Style;

pub(crate) const WIDTH: f64 = 640.0;
/// Kinds of dashes that tell curves of one colour apart, the first without.
pub(crate) const DASHES: usize = 4;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 54.0;
const HEIGHT: f64 = 280.0;

/// A run in a plot.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub run: usize,
    pub at: [f64; 2],
    /// Bar along x.
    pub spread: Option<[f64; 2]>,
    pub style: Style,
    /// Drawn open: where the point lies, something is missing.
    pub open: bool,
    pub title: String,
}

/// A line.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub points: Vec<[f64; 2]>,
    pub colour: usize,
    pub kind: Kind,
    /// Shown when pointed at.
    pub title: String,
    pub run: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Joins runs.
    Join,
    /// Joins runs that are not the finest in everything else.
    Thin,
    /// Runs on from side to side.
    Level,
    /// A curve of many points, with one of [`DASHES`] kinds of dashes.
    Curve(usize),
    Reference,
}

/// All that a plot shows.
#[derive(Debug, Clone)]
pub(crate) struct Plot {
    pub title: String,
    pub x: Axis,
    pub x_label: String,
    pub y: Axis,
    pub y_label: String,
    pub points: Vec<Point>,
    pub paths: Vec<Path>,
    /// Shaded from the bottom up to here.
    pub band: Option<f64>,
    /// Corners of a staircase, cheapest first.
    pub front: Vec<[f64; 2]>,
    pub legend: Vec<Entry>,
}

impl Plot {
    /// Draws it.
    pub fn draw(&self) -> Svg {
        let mut svg = Svg::new(WIDTH, &self.title);
        svg.fitted_text("title", [12.0, 22.0], &self.title, (WIDTH - 24.0) / 1.3);
        svg.fitted_text("soft", [12.0, 42.0], &self.y_label, WIDTH - 24.0);
        self.band(&mut svg);
        self.grid(&mut svg);
        self.staircase(&mut svg);
        for path in &self.paths {
            self.path(&mut svg, path);
        }
        for point in &self.points {
            self.point(&mut svg, point);
        }
        let bottom = TOP + HEIGHT;
        svg.fitted_text(
            "soft end",
            [WIDTH - RIGHT, bottom + 36.0],
            &self.x_label,
            WIDTH - 40.0,
        );
        svg.height = legend::draw(&mut svg, &self.legend, 16.0, bottom + 48.0) + 10.0;
        svg
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            LEFT + self.x.place(x) * (WIDTH - LEFT - RIGHT),
            TOP + (1.0 - self.y.place(y)) * HEIGHT,
        ]
    }

    fn band(&self, svg: &mut Svg) {
        if let Some(high) = self.band {
            let [_, y] = self.at([self.x.low, high]);
            svg.rect("band", [LEFT, y], [WIDTH - LEFT - RIGHT, TOP + HEIGHT - y]);
        }
    }

    fn grid(&self, svg: &mut Svg) {
        let bottom = TOP + HEIGHT;
        let class = |label: &Option<String>| if label.is_some() { "grid" } else { "fine" };
        for (value, label) in &self.x.ticks {
            let [x, _] = self.at([*value, self.y.low]);
            svg.line(class(label), [x, TOP], [x, bottom]);
        }
        // Labels that would touch the one before are left out.
        let mut free = 0.0;
        for (value, label) in &self.x.ticks {
            let Some(label) = label else { continue };
            let [x, _] = self.at([*value, self.y.low]);
            let half = 0.5 * width(label);
            if x - half < free || x + half > WIDTH {
                continue;
            }
            free = x + half + 6.0;
            svg.text("soft mid", [x, bottom + 17.0], label);
        }
        for (value, label) in &self.y.ticks {
            let [_, y] = self.at([self.x.low, *value]);
            svg.line(class(label), [LEFT, y], [WIDTH - RIGHT, y]);
            if let Some(label) = label {
                svg.text("soft end", [LEFT - 7.0, y + 4.0], label);
            }
        }
        svg.polyline(
            "frame",
            &[[LEFT, TOP], [LEFT, bottom], [WIDTH - RIGHT, bottom]],
        );
    }

    /// From one run of the front level to the next, where the error falls.
    fn staircase(&self, svg: &mut Svg) {
        let mut corners = Vec::new();
        for (k, &corner) in self.front.iter().enumerate() {
            if k > 0 {
                corners.push(self.at([corner[0], self.front[k - 1][1]]));
            }
            corners.push(self.at(corner));
        }
        if let Some(&[x, y]) = corners.first() {
            if corners.len() == 1 {
                corners.push([x + 0.1, y]);
            }
            svg.polyline("front", &corners);
        }
    }

    fn path(&self, svg: &mut Svg, path: &Path) {
        let points: Vec<[f64; 2]> = path.points.iter().map(|&p| self.at(p)).collect();
        svg.open(&format!("c{}", path.colour), path.run, &path.title);
        let class = match path.kind {
            Kind::Join => "l",
            Kind::Curve(dashes) => dashed(dashes),
            Kind::Thin => "l thin",
            Kind::Level => "l dash",
            Kind::Reference => "ref",
        };
        svg.polyline(class, &points);
        svg.close();
    }

    fn point(&self, svg: &mut Svg, point: &Point) {
        let open = if point.open { " open" } else { "" };
        let class = format!("c{}{open}", point.style.colour);
        svg.open(&class, Some(point.run), &point.title);
        let at = self.at(point.at);
        if let Some([low, high]) = point.spread {
            let ends = [low, high].map(|x| self.at([x, point.at[1]])[0]);
            if ends[1] - ends[0] > 1.0 {
                svg.line("e", [ends[0], at[1]], [ends[1], at[1]]);
                for x in ends {
                    svg.line("e", [x, at[1] - 3.0], [x, at[1] + 3.0]);
                }
            }
        }
        svg.marker(point.style.marker, at, 4.3);
        svg.close();
    }
}

/// The class of a line with one of the kinds of dashes.
pub(crate) fn dashed(kind: usize) -> &'static str {
    match kind % DASHES {
        0 => "l",
        1 => "l dash",
        2 => "l dot",
        _ => "l long",
    }
}
