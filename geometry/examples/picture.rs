//! Draws the picture of the crate's documentation, `assets/projection.svg`: points above a bumpy patch and their closest
//! points, coloured by where these lie. `cargo run -p covact-geometry --example picture > geometry/assets/projection.svg`
use covact_geometry::{Location, NurbsPatch, PatchSet, Vec3};
use std::error::Error;
use std::fmt::Write;

/// Control points in each direction.
const N: usize = 7;
const COLOURS: [(&str, &str); 3] = [
    ("face", "#3b82c4"),
    ("edge", "#e08a1e"),
    ("corner", "#d1495b"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let knots: Vec<f64> = (0..N + 4)
        .map(|k| (k as f64 - 3.0).clamp(0.0, (N - 3) as f64))
        .collect();
    let bump = |i: usize, j: usize| 0.9 * ((2.1 * i as f64).sin() * (1.3 * j as f64 + 0.4).cos());
    let points: Vec<Vec3> = (0..N * N)
        .map(|k| (k % N, k / N))
        .map(|(i, j)| Vec3::new(i as f64, j as f64, bump(i, j)))
        .collect();
    let patch = NurbsPatch::new([3, 3], [knots.clone(), knots], [N, N], &points, None)?;
    let surface = PatchSet::new(vec![patch.clone()], None)?;

    let mut svg = String::from(
        "<svg viewBox=\"0 -32 570 340\" width=\"570\" xmlns=\"http://www.w3.org/2000/svg\" \
         font-family=\"sans-serif\" font-size=\"14\">\n",
    );
    // Lines of constant parameters.
    let [[a, b], [c, d]] = patch.domain();
    let steps = 4 * (N - 3);
    for k in 0..=steps {
        let s = k as f64 / steps as f64;
        for along in 0..2 {
            let line = (0..=60).map(|m| {
                let t = f64::from(m) / 60.0;
                let (u, v) = if along == 0 { (t, s) } else { (s, t) };
                patch.point([a + (b - a) * u, c + (d - c) * v])
            });
            let border = k == 0 || k == steps;
            let (width, opacity) = if border { (1.6, 0.9) } else { (0.7, 0.5) };
            path(&mut svg, line, "#808890", width, opacity)?;
        }
    }
    // Points in a ring and a spiral around and above the surface.
    for k in 0..44u32 {
        let t = f64::from(k) / 44.0;
        let angle = 2.4 * f64::from(k);
        let radius = 4.9 * t.sqrt();
        let q = Vec3::new(3.0 + radius * angle.cos(), 3.0 + radius * angle.sin(), 1.5);
        let foot = surface.project(&q, None, f64::INFINITY).ok_or("no foot")?;
        let kind = match foot.location {
            Location::Face | Location::Crease { .. } => 0,
            Location::Edge { .. } | Location::Pole { .. } => 1,
            Location::Corner { .. } => 2,
        };
        let colour = COLOURS[kind].1;
        path(&mut svg, [q, foot.jet.rho].into_iter(), colour, 1.2, 0.9)?;
        let ([x, y], [fx, fy]) = (screen(&q), screen(&foot.jet.rho));
        writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.2\" fill=\"none\" stroke=\"{colour}\"/>"
        )?;
        writeln!(
            svg,
            "<circle cx=\"{fx:.1}\" cy=\"{fy:.1}\" r=\"3\" fill=\"{colour}\"/>"
        )?;
    }
    for (k, (name, colour)) in COLOURS.iter().enumerate() {
        let y = 8 + 20 * k;
        writeln!(
            svg,
            "<circle cx=\"16\" cy=\"{}\" r=\"4\" fill=\"{colour}\"/>",
            y - 5
        )?;
        writeln!(
            svg,
            "<text x=\"28\" y=\"{y}\" fill=\"currentColor\">{name}</text>"
        )?;
    }
    println!("{svg}</svg>");
    Ok(())
}

/// Seen from above the corner, in parallel projection.
fn screen(x: &Vec3) -> [f64; 2] {
    let (u, v) = (x.x - 3.0, x.y - 3.0);
    [
        320.0 + 42.0 * (u - 0.75 * v),
        175.0 + 15.0 * u + 24.0 * v - 44.0 * x.z,
    ]
}

fn path(
    svg: &mut String,
    points: impl Iterator<Item = Vec3>,
    colour: &str,
    width: f64,
    opacity: f64,
) -> std::fmt::Result {
    write!(svg, "<polyline points=\"")?;
    for x in points {
        let [x, y] = screen(&x);
        write!(svg, "{x:.1},{y:.1} ")?;
    }
    writeln!(
        svg,
        "\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"/>"
    )
}
