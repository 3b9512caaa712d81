//! The picture: V above, H below, over the way slid.
use super::{Curve, Outcome};
use plotters::prelude::*;
use std::path::Path;

const SIZE: (u32, u32) = (860, 560);
/// Grey and colours of medium lightness, on a ground that is left open: readable on white and on black.
const TEXT: RGBColor = RGBColor(125, 133, 144);
const COLOURS: [RGBColor; 2] = [RGBColor(70, 140, 250), RGBColor(217, 119, 6)];

/// Draws the curves, the first on top, to an SVG file.
pub fn draw(curves: &[Curve; 2], path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    let (upper, lower) = root.split_vertically(SIZE.1 / 2);
    panel(&upper, curves, 2, "V [N/mm]")?;
    panel(&lower, curves, 1, "H [N/mm]")?;
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    curves: &[Curve; 2],
    k: usize,
    name: &str,
) -> Outcome<()> {
    let font = |size: i32| ("sans-serif", size).into_font().color(&TEXT);
    let all = || curves.iter().flat_map(|c| &c.points);
    let end = all().map(|p| p[0]).fold(0.0, f64::max);
    let high = all().map(|p| p[k]).fold(0.0, f64::max);
    if !(end > 0.0 && high > 0.0) {
        return Err("there is no slide to draw".into());
    }
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(24)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..end, 0.0..1.15 * high)?;
    chart
        .configure_mesh()
        .light_line_style(TEXT.mix(0.0))
        .bold_line_style(TEXT.mix(0.25))
        .axis_style(TEXT)
        .label_style(font(14))
        .axis_desc_style(font(15))
        .x_labels(7)
        .y_labels(6)
        .x_desc("slide [mm]")
        .y_desc(name)
        .x_label_formatter(&|x| format!("{x:.1}"))
        .y_label_formatter(&|y| format!("{y:.1}"))
        .draw()?;
    for (curve, colour) in curves.iter().zip(COLOURS).rev() {
        let line = curve.points.iter().map(|p| (p[0], p[k]));
        let swing = curve.middle(k);
        let text = format!(
            "{}: swing {:.1} %",
            curve.name,
            100.0 * swing.swing / swing.mean
        );
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
            .label(text)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .label_font(font(14))
        .margin(12)
        .draw()?;
    Ok(())
}
