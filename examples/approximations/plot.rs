//! The picture: error against unknowns, both logarithmic, every curve named at its end.
use super::Outcome;
use super::cases::{Master, Shell};
use super::errors::{Curve, Errors};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

const SIZE: (u32, u32) = (860, 540);
/// Grey and colours of medium lightness, on a ground that is left open: readable on white and on black.
const TEXT: RGBColor = RGBColor(125, 133, 144);
/// Least distance of two names (pixels).
const APART: i32 = 17;

fn colour(master: Master) -> RGBColor {
    match master {
        Master::Facets => RGBColor(217, 119, 6),
        Master::Smooth => RGBColor(16, 160, 110),
        Master::Nurbs => RGBColor(70, 140, 250),
    }
}

/// Errors below this cannot be told from that of the reference.
fn floor(errors: &Errors) -> f64 {
    errors.reference.own.max(1e-6)
}

/// Draws all curves to an SVG file.
pub fn draw(errors: &Errors, path: &Path) -> Outcome<()> {
    let all = || errors.curves.iter().flat_map(|c| &c.points);
    let range = |k: usize| {
        let values = all().map(move |p| p[k]).filter(|v| *v > 0.0);
        values.fold([f64::INFINITY, 0.0f64], |[a, b], v| [a.min(v), b.max(v)])
    };
    let ([left, right], [low, high]) = (range(0), range(1));
    if !(left < right && low < high) {
        return Err("there are not enough runs for a picture".into());
    }
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    let font = |size: i32| ("sans-serif", size).into_font().color(&TEXT);
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_right(150)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d(
            (0.8 * left..1.15 * right).log_scale(),
            (0.5 * low.max(0.3 * floor(errors))..1.6 * high).log_scale(),
        )?;
    chart
        .configure_mesh()
        .light_line_style(TEXT.mix(0.0))
        .bold_line_style(TEXT.mix(0.25))
        .axis_style(TEXT)
        .label_style(font(14))
        .axis_desc_style(font(15))
        .x_desc("unknowns")
        .y_desc("error of the force")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| percent(*y))
        .draw()?;

    // What the reference itself is worth.
    let own = floor(errors);
    let line = [(0.8 * left, own), (1.15 * right, own)];
    chart.draw_series(DashedLineSeries::new(line, 2, 5, TEXT.stroke_width(1)))?;
    chart.draw_series([Text::new(
        "estimated error of the reference",
        (0.85 * left, own * 0.93),
        font(13),
    )])?;

    let mut names = Vec::new();
    for curve in &errors.curves {
        let colour = colour(curve.master);
        // Smooth and exact masters may hardly differ: a wide line shows around a narrow one.
        let width = match curve.master {
            Master::Smooth => 6,
            _ => 2,
        };
        let points: Vec<(f64, f64)> = (curve.points.iter())
            .map(|p| (p[0], p[1].max(0.55 * low.max(0.3 * own))))
            .collect();
        match curve.shell {
            Shell::H8 => {
                chart.draw_series(DashedLineSeries::new(
                    points.iter().copied(),
                    7,
                    4,
                    colour.stroke_width(width),
                ))?;
                let ring = |p: &(f64, f64)| Circle::new(*p, 4, colour.stroke_width(2));
                chart.draw_series(points.iter().map(ring))?;
            }
            Shell::Q18 => {
                chart.draw_series(LineSeries::new(
                    points.iter().copied(),
                    colour.stroke_width(width),
                ))?;
                chart.draw_series(points.iter().map(|p| Circle::new(*p, 4, colour.filled())))?;
            }
        }
        if let Some(&end) = points.last() {
            names.push((chart.backend_coord(&end), name(curve), colour));
        }
    }
    // Names keep the order of the ends and their distance from each other.
    names.sort_by_key(|(at, ..)| at.1);
    let mut places: Vec<i32> = names.iter().map(|(at, ..)| at.1).collect();
    for _ in 0..names.len() {
        for k in 1..places.len() {
            let short = APART - (places[k] - places[k - 1]);
            if short > 0 {
                places[k - 1] -= short / 2;
                places[k] += short - short / 2;
            }
        }
    }
    for ((at, name, colour), y) in names.iter().zip(places) {
        let style = ("sans-serif", 14)
            .into_font()
            .color(colour)
            .pos(Pos::new(HPos::Left, VPos::Center));
        root.draw(&PathElement::new(
            vec![(at.0 + 6, at.1), (at.0 + 16, y)],
            colour.stroke_width(1),
        ))?;
        root.draw(&Text::new(name.clone(), (at.0 + 20, y), style))?;
    }
    root.present()?;
    Ok(())
}

fn name(curve: &Curve) -> String {
    let master = match curve.master {
        Master::Facets => "facets",
        Master::Smooth => "smooth",
        Master::Nurbs => "NURBS",
    };
    format!("{} on {master}", curve.shell.name())
}

fn percent(y: f64) -> String {
    let text = format!("{:.5}", 100.0 * y);
    format!("{} %", text.trim_end_matches('0').trim_end_matches('.'))
}
