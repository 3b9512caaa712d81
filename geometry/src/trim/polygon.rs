//! Loops as polygons.

use super::Monotone;
use nalgebra::Vector2;

/// Halvings of a piece.
const DEPTH: u32 = 25;
/// A polygon with too many points is made again with a tolerance so many times as large.
const COARSER: f64 = 4.0;

/// The polygon of a loop, nowhere farther than `tolerance` from its pieces: a share of the `extent` of the domain, or of the
/// loop where that is larger. Coarser where it would have more than `most` points beside those at which pieces begin.
pub fn polygon(
    pieces: &[&Monotone],
    extent: [f64; 2],
    mut tolerance: f64,
    most: usize,
) -> Vec<[f64; 2]> {
    // A loop of many times the size of the domain, which no surface can take, would have points without number.
    let extent = [0, 1].map(|k| {
        let bounds = pieces.iter().map(|piece| piece.bounds());
        let (low, high) = bounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [a, b]| {
            (low.min(a[k]), high.max(b[k]))
        });
        extent[k].max(high - low)
    });
    let most = most.saturating_add(pieces.len());
    loop {
        let mut out = Vec::new();
        let within = pieces
            .iter()
            .all(|piece| flatten(piece, (extent, tolerance), most, &mut out));
        // Everything is flat to a tolerance that is as large as the loop.
        if within || tolerance > 4.0 {
            return out;
        }
        tolerance *= COARSER;
    }
}

/// Adds the first point of a piece and as many inner ones as the tolerance asks for. Returns whether there are no more than
/// `most` then.
fn flatten(
    piece: &Monotone,
    (extent, tolerance): ([f64; 2], f64),
    most: usize,
    out: &mut Vec<[f64; 2]>,
) -> bool {
    out.push(piece.from);
    if piece.net.len() == 2 {
        return true;
    }
    // What rounding makes of the points of a curve far outside of the domain is not followed.
    let far = (piece.net.iter()).flat_map(|c| [0, 1].map(|k| (c[k] / c[2] / extent[k]).abs()));
    let rounding = 2.0 * piece.net.len() as f64 * f64::EPSILON * far.fold(0.0, f64::max);
    let allowed = (0.5 * tolerance).max(rounding);
    let ends = [piece.from, piece.to];
    inner_points(piece, [0.0, 1.0], ends, (extent, allowed), DEPTH, most, out)
}

fn inner_points(
    piece: &Monotone,
    [a, b]: [f64; 2],
    [from, to]: [[f64; 2]; 2],
    (extent, allowed): ([f64; 2], f64),
    depth: u32,
    most: usize,
    out: &mut Vec<[f64; 2]>,
) -> bool {
    let scaled = |p: [f64; 2]| Vector2::new(p[0] / extent[0], p[1] / extent[1]);
    let (u, v) = (scaled(from), scaled(to));
    let off = |s: f64| {
        let d = scaled(piece.point(s)) - u;
        let run = v - u;
        let share = (d.dot(&run) / run.norm_squared()).clamp(0.0, 1.0);
        if share.is_nan() {
            d.norm()
        } else {
            (d - run * share).norm()
        }
    };
    let at = |share: f64| a + share * (b - a);
    // A piece may bend twice between its ends, so three points are looked at. Where numbers overflow nothing is gained by
    // looking closer.
    let bent = [0.25, 0.5, 0.75].iter().any(|&s| off(at(s)) > allowed);
    if !bent || depth == 0 {
        return true;
    }
    if out.len() >= most {
        return false;
    }
    let (s, p) = (at(0.5), piece.point(at(0.5)));
    let measure = (extent, allowed);
    inner_points(piece, [a, s], [from, p], measure, depth - 1, most, out) && {
        out.push(p);
        inner_points(piece, [s, b], [p, to], measure, depth - 1, most, out)
    }
}

#[cfg(test)]
mod tests {
    use crate::curve::conic::elliptic_arc;
    use crate::trim::{Trim, TrimCurve, TrimLoop};
    use nalgebra::Vector2;

    /// A circle around (x, 0.5) that runs round so many times, on the domain from 0 to 1.
    fn circle(x: f64, radius: f64, times: usize) -> Trim {
        let [e1, e2] = [Vector2::x(), Vector2::y()].map(|e| e * radius);
        let circle = elliptic_arc(Vector2::new(x, 0.5), e1, e2, 0.0, std::f64::consts::TAU);
        let curve = TrimCurve {
            parameter: circle.unwrap(),
            space: None,
            entity: 0,
        };
        let curves = vec![curve; times];
        Trim::new(vec![TrimLoop { curves }], [[0.0, 1.0]; 2], 1e-9).unwrap()
    }

    /// Largest distance of the middles of a polygon's sides from the circle.
    fn off(polygon: &[[f64; 2]], x: f64, radius: f64) -> f64 {
        let next = polygon.iter().skip(1).chain(&polygon[..1]);
        let middle = |(a, b): (&[f64; 2], &[f64; 2])| {
            let d = [0, 1].map(|k| 0.5 * (a[k] + b[k]) - [x, 0.5][k]);
            (d[0].hypot(d[1]) - radius).abs()
        };
        polygon.iter().zip(next).map(middle).fold(0.0, f64::max)
    }

    #[test]
    fn near_the_circle_with_the_points_that_takes() {
        let polygon = circle(0.5, 0.4, 1).polygons(1e-5).swap_remove(0);
        assert!(polygon.len() < 1100, "{}", polygon.len());
        let off = off(&polygon, 0.5, 0.4);
        assert!(off < 1e-5 && off > 1e-7, "{off}");
    }

    /// A circle of a million times the size of the domain has no more points than one within it.
    #[test]
    fn shares_of_a_large_loop() {
        let polygon = circle(0.5, 4e5, 1).polygons(1e-5).swap_remove(0);
        assert!(polygon.len() < 1100, "{}", polygon.len());
        assert!(off(&polygon, 0.5, 4e5) < 1e-5 * 8e5);
    }

    /// Rounding moves points of a circle far from the domain by more than the tolerance.
    #[test]
    fn rounding_is_not_followed() {
        let polygon = circle(1e11, 0.4, 1).polygons(1e-5).swap_remove(0);
        assert!(polygon.len() < 1100, "{}", polygon.len());
    }

    #[test]
    fn coarser_beyond_the_most_points() {
        let trim = circle(0.5, 0.4, 20);
        let fine = trim.polygons(1e-5).swap_remove(0);
        let coarse = trim.polygons_within(1e-5, 8_000).swap_remove(0);
        assert!(fine.len() > 10_000, "{}", fine.len());
        assert!((4_000..=8_080).contains(&coarse.len()), "{}", coarse.len());
        assert!(off(&coarse, 0.5, 0.4) < 4e-5);
        // No fewer points than pieces.
        assert_eq!(trim.polygons_within(1e-5, 0)[0].len(), 80);
    }
}
