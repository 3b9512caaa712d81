//! Cutting of convex polygons in the plane by one another, and Gauss rules on triangles: what integration segments are
//! made of.

/// A point of the plane.
pub type Point = [f64; 2];
/// A convex polygon, counterclockwise.
pub type Polygon = Vec<Point>;

/// Lengths below this count as none; for polygons of size one.
const NEAR: f64 = 1e-10;
/// Areas below this count as none.
const SLIVER: f64 = 1e-12;

/// Twice the signed area of a triangle, positive counterclockwise.
#[inline]
fn cross(a: &Point, b: &Point, c: &Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Area of a polygon, positive counterclockwise.
pub fn area(polygon: &[Point]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else {
        return 0.0;
    };
    0.5 * rest
        .windows(2)
        .map(|w| cross(first, &w[0], &w[1]))
        .sum::<f64>()
}

/// Convex parts of a polygon that is given counterclockwise: itself where it is convex, else triangles about the mean of
/// its corners, of which those that are turned over are left out.
pub fn convex_parts(polygon: Polygon) -> Vec<Polygon> {
    let n = polygon.len();
    let turn = |k: usize| cross(&polygon[k], &polygon[(k + 1) % n], &polygon[(k + 2) % n]);
    if n < 3 {
        return Vec::new();
    }
    if (0..n).all(|k| turn(k) > -NEAR) {
        return match area(&polygon) > SLIVER {
            true => vec![polygon],
            false => Vec::new(),
        };
    }
    let middle = polygon.iter().fold([0.0; 2], |m, p| {
        [m[0] + p[0] / n as f64, m[1] + p[1] / n as f64]
    });
    let triangle = |k: usize| vec![middle, polygon[k], polygon[(k + 1) % n]];
    (0..n).map(triangle).filter(|t| area(t) > SLIVER).collect()
}

/// The parts of a convex polygon to the left of the line from `a` to `b` and to its right (I. E. Sutherland and G. W.
/// Hodgman, "Reentrant polygon clipping", Communications of the ACM 17 (1974), on both sides at once). What is left
/// has no area where the polygon lies on one side.
fn split(polygon: &[Point], a: &Point, b: &Point) -> [Polygon; 2] {
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let side = |p: &Point| {
        let d = cross(a, b, p) / length;
        if d.abs() < NEAR { 0.0 } else { d }
    };
    let (mut left, mut right) = (Polygon::new(), Polygon::new());
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (dp, dq) = (side(p), side(q));
        if dp >= 0.0 {
            left.push(*p);
        }
        if dp <= 0.0 {
            right.push(*p);
        }
        if dp * dq < 0.0 {
            let s = dp / (dp - dq);
            let x = [p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])];
            left.push(x);
            right.push(x);
        }
    }
    [left, right]
}

/// The part of a polygon within the box from `low` to `high`.
pub fn within(mut polygon: Polygon, low: Point, high: Point) -> Polygon {
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    for k in 0..4 {
        [polygon, _] = split(&polygon, &corners[k], &corners[(k + 1) % 4]);
    }
    polygon
}

/// Moves what lies inside of the convex polygon `clip` from `pieces` to `cut`; the rest stays in `pieces`, in more parts.
/// The areas of both together are what they were, but for parts without area.
pub fn cut(pieces: &mut Vec<Polygon>, clip: &[Point], cut: &mut Vec<Polygon>) {
    let mut rest = Vec::with_capacity(pieces.len());
    for piece in pieces.drain(..) {
        let whole = piece.clone();
        let mut inside = piece;
        let mut outside = Vec::new();
        for (k, a) in clip.iter().enumerate() {
            let b = &clip[(k + 1) % clip.len()];
            if (b[0] - a[0]).hypot(b[1] - a[1]) < NEAR {
                continue;
            }
            let [left, right] = split(&inside, a, b);
            if area(&right) > SLIVER {
                outside.push(right);
            }
            inside = left;
            if area(&inside) <= SLIVER {
                break;
            }
        }
        if area(&inside) > SLIVER {
            cut.push(inside);
            rest.append(&mut outside);
        } else {
            // Nothing in common: the piece stays as it is.
            rest.push(whole);
        }
    }
    *pieces = rest;
}

/// The direction along which the first corner of a polygon begins its triangles: a polygon has the same points whichever corner
/// it is listed from. Pieces of faces seldom have an edge across it.
const ALONG: Point = [1.0, 0.618_033_988_749_894_9];

/// Gauss points of a convex polygon, exact on its triangles to `degree` (1 to 5, more than that is 5): calls `point`
/// with place and weight; the weights are positive and sum to the area.
///
/// The rules with 1, 3, 6 and 7 points: G. Strang and G. J. Fix, "An Analysis of the Finite Element Method" (1973), table
/// 4.1, and G. R. Cowper, "Gaussian quadrature formulas for triangles", International Journal for Numerical Methods in
/// Engineering 7 (1973). The one of degree 3 with 4 points has a negative weight, so that of degree 4 takes its place.
pub fn integrate(polygon: &[Point], degree: u8, mut point: impl FnMut(Point, f64)) {
    let along = |p: &Point| ALONG[0] * p[0] + ALONG[1] * p[1];
    let places = polygon.iter().map(along).enumerate();
    let Some((first, _)) = places.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return;
    };
    let corner = |k: usize| &polygon[(first + k) % polygon.len()];
    let a = corner(0);
    for k in 1..polygon.len() - 1 {
        let (b, c) = (corner(k), corner(k + 1));
        let area = 0.5 * cross(a, b, c);
        if area <= 0.0 {
            continue;
        }
        let corners = [a, b, c];
        let mut put = |l: [f64; 3], w: f64| {
            let x = |c: usize| (0..3).map(|k| l[k] * corners[k][c]).sum();
            point([x(0), x(1)], w * area);
        };
        let (middle, orbits): (f64, &[[f64; 2]]) = rule(degree);
        if middle > 0.0 {
            put([1.0 / 3.0; 3], middle);
        }
        for &[l, w] in orbits {
            let other = 0.5 * (1.0 - l);
            for k in 0..3 {
                let mut at = [other; 3];
                at[k] = l;
                put(at, w);
            }
        }
    }
}

/// Weight of the middle of a triangle, and of threefold orbits `(l, (1 - l) / 2, (1 - l) / 2)` with their `l`.
fn rule(degree: u8) -> (f64, &'static [[f64; 2]]) {
    match degree {
        0 | 1 => (1.0, &[]),
        2 => (0.0, &[[2.0 / 3.0, 1.0 / 3.0]]),
        3 | 4 => (
            0.0,
            &[
                [0.108_103_018_168_070_23, 0.223_381_589_678_011_47],
                [0.816_847_572_980_458_5, 0.109_951_743_655_321_87],
            ],
        ),
        _ => (
            0.225,
            &[
                [0.059_715_871_789_769_8, 0.132_394_152_788_506_2],
                [0.797_426_985_353_087_3, 0.125_939_180_544_827_15],
            ],
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `int x^a y^b` over the triangle (0,0), (1,0), (0,1) is `a! b! / (a + b + 2)!`; one degree more is not exact.
    #[test]
    fn the_rules_have_their_degree() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let error = |degree: u8, a: i32, b: i32| {
            let mut sum = 0.0;
            integrate(&triangle, degree, |[x, y], w| {
                assert!(w > 0.0);
                sum += w * x.powi(a) * y.powi(b);
            });
            (sum - factorial(a) * factorial(b) / factorial(a + b + 2)).abs()
        };
        for degree in 1..=5u8 {
            for a in 0..=i32::from(degree) {
                for b in 0..=i32::from(degree) - a {
                    assert!(error(degree, a, b) < 1e-15, "{degree} {a} {b}");
                }
            }
        }
        for degree in [1, 2, 4, 5] {
            assert!(error(degree, i32::from(degree) + 1, 0) > 1e-5, "{degree}");
        }
    }

    #[test]
    fn cutting_loses_nothing() {
        let square = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        // A turned square of side 1.2 inside, one that overlaps both, one that coincides with an edge, one outside.
        let turned = |angle: f64, half: f64, at: Point| -> Polygon {
            (0..4)
                .map(|k| {
                    let phi = angle + std::f64::consts::FRAC_PI_2 * f64::from(k);
                    [at[0] + half * phi.cos(), at[1] + half * phi.sin()]
                })
                .collect()
        };
        let mut pieces = vec![square.clone()];
        let mut inside = Vec::new();
        let sum = |p: &[Polygon]| p.iter().map(|p| area(p)).sum::<f64>();
        let side = 0.6 * std::f64::consts::SQRT_2;
        cut(&mut pieces, &turned(0.3, side, [0.0; 2]), &mut inside);
        assert!((sum(&inside) - 1.44).abs() < 1e-14);
        assert!((sum(&pieces) - 2.56).abs() < 1e-14);
        cut(&mut pieces, &turned(0.1, 0.9, [0.8, 0.3]), &mut inside);
        let beside = turned(
            std::f64::consts::FRAC_PI_4,
            std::f64::consts::SQRT_2,
            [2.0, 0.0],
        );
        let before = (sum(&inside), inside.len(), pieces.len());
        cut(&mut pieces, &beside, &mut inside);
        assert_eq!(before, (sum(&inside), inside.len(), pieces.len()));
        assert!((sum(&inside) + sum(&pieces) - 4.0).abs() < 1e-13);
        assert!(inside.iter().chain(&pieces).all(|p| area(p) > 0.0));
        // The whole square, corner on corner.
        let mut pieces = vec![square.clone()];
        let mut inside = Vec::new();
        cut(&mut pieces, &square, &mut inside);
        assert!(pieces.is_empty());
        assert_eq!(inside, [square]);
    }

    #[test]
    fn a_polygon_that_is_not_convex_is_cut_into_triangles() {
        let arrow = vec![[0.0, 0.0], [2.0, -1.0], [1.6, 0.0], [2.0, 1.0]];
        let whole = area(&arrow);
        let parts = convex_parts(arrow);
        assert_eq!(parts.len(), 4);
        assert!((parts.iter().map(|p| area(p)).sum::<f64>() - whole).abs() < 1e-15);
    }
}
