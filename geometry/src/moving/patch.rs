//! The knot spans of a NURBS patch whose control points move.

use super::build::Parts;
use super::extraction::Operator;
use super::net::bernstein;
use super::topology::{Outline, Topology};
use super::trimmed::Placed;
use super::{MovingError, MovingFacets};
use crate::basis::WIDTH;
use crate::{NurbsPatch, PatchShape, Trim};
use nalgebra::Matrix4;

/// Functions of a cubic that act on a span.
const M: usize = 4;

/// Some spans of a patch, as [`MovingFacets::of_patches`] takes them.
#[derive(Debug, Clone, Copy)]
pub struct PatchSpans<'a> {
    /// Bicubic.
    pub patch: &'a NurbsPatch,
    /// Numbers of spans, xi1 fastest.
    pub spans: &'a [usize],
    /// Spans with a side that is joined to another patch, whose knots need not match (0: xi1 at its start, 1: at its end, 2: xi2
    /// at its start, 3: at its end): the surface does not end there.
    pub joined: &'a [(usize, usize)],
    /// Trim of the patch, in its parameters.
    pub trim: Option<&'a Trim>,
    /// Spans that it cuts, ascending: there are no feet where it leaves nothing, and none on a curve of the trim beside those of points
    /// above the patch.
    pub cut: &'a [usize],
}

impl MovingFacets {
    /// Some spans of a bicubic patch: [`Self::of_patches`] of one.
    ///
    /// # Errors
    /// As there.
    pub fn of_patch(
        patch: &NurbsPatch,
        spans: &[usize],
        reversed: bool,
        number: impl Fn(u32) -> u32,
    ) -> Result<Self, MovingError> {
        let part = PatchSpans {
            patch,
            spans,
            joined: &[],
            trim: None,
            cut: &[],
        };
        Self::of_patches(&[part], reversed, |_, n| number(n))
    }

    /// Some spans of bicubic patches, each as the facet that it is, exactly. Nodes are the control points, by the numbers that
    /// `number` gives for the place of the patch and the number in it. With `reversed` the outside is against `rho_1 x rho_2`:
    /// the parameters of the facets are then exchanged. [`source`](Self::source) is the place among all spans, patch after patch.
    /// Patches share no nodes; a foot at an edge where they are joined counts as one at a sharp edge.
    ///
    /// # Errors
    /// [`MovingError::Empty`], [`MovingError::TooMany`]; [`MovingError::Patch`] for degrees other than 3 and spans that there are not.
    pub fn of_patches(
        parts: &[PatchSpans],
        reversed: bool,
        number: impl Fn(usize, u32) -> u32,
    ) -> Result<Self, MovingError> {
        let total: usize = parts.iter().map(|p| p.spans.len()).sum();
        if total == 0 {
            return Err(MovingError::Empty);
        }
        if total > (u32::MAX / 64) as usize {
            return Err(MovingError::TooMany(total));
        }
        let mut outlines = Vec::with_capacity(total);
        let mut borders = Vec::new();
        let mut set = Parts::default();
        let mut room = PatchShape::default();
        let mut first_vertex = 0;
        for (place, part) in parts.iter().enumerate() {
            let PatchSpans {
                patch,
                spans,
                joined,
                trim,
                cut,
            } = part;
            let trim = trim.map(|trim| set.trims.push(trim));
            let counts = [0, 1].map(|dir| patch.basis(dir).span_count());
            let fits = spans.iter().all(|span| *span < counts[0] * counts[1]);
            if patch.degree() != [M - 1; 2] || !fits {
                return Err(MovingError::Patch);
            }
            let extractions = [0, 1].map(|dir| -> Vec<Matrix4<f64>> {
                (0..counts[dir])
                    .map(|span| extraction(patch, dir, span))
                    .collect()
            });
            for span in *spans {
                let at = [span % counts[0], span / counts[0]];
                let vertex = |i: usize, j: usize| {
                    (first_vertex + at[0] + i + (counts[0] + 1) * (at[1] + j)) as u32
                };
                let middle = [0, 1].map(|dir| {
                    let [a, b] = patch.basis(dir).span_range(at[dir]);
                    0.5 * (a + b)
                });
                patch.shape_in_span(at, middle, &mut room);
                let nodes: Vec<u32> = room.indices.iter().map(|n| number(place, *n)).collect();
                let [first, second] = [0, 1].map(|dir| &extractions[dir][at[dir]]);
                let rational = patch.is_rational();
                let factor = |a: usize| match rational {
                    true => patch.homogeneous()[room.indices[a] as usize][3],
                    false => 1.0,
                };
                let row = |i: usize, j: usize| -> Vec<(u16, f64)> {
                    let entry =
                        |a: usize| (a as u16, first[(i, a % M)] * second[(j, a / M)] * factor(a));
                    (0..M * M).map(entry).collect()
                };
                // Exchanged parameters: row (i, j) of the facet is (j, i) of the span.
                let rows = (0..M * M).map(|c| match reversed {
                    false => row(c % M, c / M),
                    true => row(c / M, c % M),
                });
                let facet = outlines.len();
                let operator = match rational {
                    true => Operator::rational(rows),
                    false => Operator::new(rows),
                };
                set.push(facet, &nodes, operator)?;
                if let (Some(trim), Ok(_)) = (trim, cut.binary_search(span)) {
                    let placed = Placed {
                        trim,
                        range: [0, 1].map(|dir| patch.basis(dir).span_range(at[dir])),
                        exchanged: reversed,
                    };
                    set.trims.place(facet, placed);
                }
                for (_, side) in joined.iter().filter(|(of, _)| of == span) {
                    borders.push((facet, if reversed { (side + 2) % 4 } else { *side }));
                }
                let corner = |c: usize| match reversed {
                    false => vertex(c % 2, c / 2),
                    true => vertex(c / 2, c % 2),
                };
                outlines.push(Outline {
                    corners: std::array::from_fn(corner),
                    middles: [None; 4],
                });
            }
            first_vertex += (counts[0] + 1) * (counts[1] + 1);
        }
        let mut topology = Topology::new(&outlines)?;
        for (facet, edge) in borders {
            topology.join(facet, edge);
        }
        Ok(set.finish(M - 1, topology))
    }
}

/// Bezier points of a span as combinations of its control points: by what both say at four points of the span.
fn extraction(patch: &NurbsPatch, dir: usize, span: usize) -> Matrix4<f64> {
    let basis = patch.basis(dir);
    let [a, b] = basis.span_range(span);
    let (mut bezier, mut spline) = (Matrix4::zeros(), Matrix4::zeros());
    for k in 0..M {
        let xi = 2.0 * k as f64 / (M - 1) as f64 - 1.0;
        let own = bernstein::<f64, M>(xi)[0];
        let mut n = [[0.0; WIDTH]];
        basis.evaluate(span, 0.5 * (a + b) + 0.5 * xi * (b - a), &mut n);
        for c in 0..M {
            bezier[(k, c)] = own[c];
            spline[(k, c)] = n[0][c];
        }
    }
    let inverse = bezier.try_inverse().unwrap_or_else(Matrix4::zeros);
    // Round-off in the place of a zero would make every operator its own.
    (inverse * spline).map(|x| if x.abs() < 1e-14 { 0.0 } else { x })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moving::ShapeRows;
    use crate::surface::Vec3;

    fn patch() -> NurbsPatch {
        let knots = |inner: &[f64]| [&[0.0; 4][..], inner, &[1.0; 4]].concat();
        let counts = [6, 5];
        let points: Vec<Vec3> = (0..30)
            .map(|k| {
                let (i, j) = ((k % 6) as f64, (k / 6) as f64);
                let bump = (1.7 * k as f64).sin();
                Vec3::new(i + 0.2 * bump, j - 0.1 * bump, 0.3 * bump + 0.05 * i * i)
            })
            .collect();
        NurbsPatch::new(
            [3, 3],
            [knots(&[0.3, 0.7]), knots(&[0.6])],
            counts,
            &points,
            None,
        )
        .unwrap()
    }

    /// Facets are the spans: points and derivatives of the patch, shape functions that move with the control points, a normal
    /// that is turned round on the other side, and no edges inside.
    #[test]
    fn facets_are_the_spans() {
        let patch = patch();
        let points = patch.points();
        let spans: Vec<usize> = (0..6).collect();
        for reversed in [false, true] {
            let mut facets = MovingFacets::of_patch(&patch, &spans, reversed, |n| n + 100).unwrap();
            facets.update(|n| points[n as usize - 100]);
            assert_eq!((facets.len(), facets.degree()), (6, 3));
            let mut rows = ShapeRows::default();
            for (facet, span) in spans.iter().enumerate() {
                let ranges = [span % 3, span / 3];
                let ranges = [0, 1].map(|dir| patch.spans(dir)[ranges[dir]]);
                for at in [[-0.6, 0.9], [0.2, -0.3], [1.0, -1.0]] {
                    let own = if reversed { [at[1], at[0]] } else { at };
                    let xi = [0, 1].map(|dir| {
                        let [a, b] = ranges[dir];
                        0.5 * (a + b) + 0.5 * own[dir] * (b - a)
                    });
                    let jet = facets.jet(facet as u32, at);
                    let exact = patch.jet(xi);
                    assert!((jet.rho - exact.rho).norm() < 1e-13);
                    let [n, m] = [&jet, &exact].map(|j| {
                        let n = j.rho_i[0].cross(&j.rho_i[1]);
                        n.normalize()
                    });
                    let sign = if reversed { -1.0 } else { 1.0 };
                    assert!((n - m * sign).norm() < 1e-12);
                    facets.shape(facet as u32, at, &mut rows);
                    assert_eq!(rows.count, 16);
                    let sum = |w: &[f64]| -> Vec3 {
                        let nodes = facets.nodes(facet as u32).iter();
                        nodes
                            .zip(w)
                            .map(|(n, w)| points[*n as usize - 100] * *w)
                            .sum()
                    };
                    assert!((sum(&rows.n) - jet.rho).norm() < 1e-13);
                    assert!((sum(&rows.n_1) - jet.rho_i[0]).norm() < 1e-12);
                    assert!((sum(&rows.n_2) - jet.rho_i[1]).norm() < 1e-12);
                }
            }
            // A point above the border of two spans has its foot on a face.
            let exact = patch.jet([0.3, 0.4]);
            let n = exact.rho_i[0].cross(&exact.rho_i[1]).normalize();
            let foot = facets
                .project(&(exact.rho + n * 0.05), None, f64::INFINITY, |_| true)
                .unwrap();
            assert_eq!(foot.place, crate::MovingPlace::Face);
            let sign = if reversed { -1.0 } else { 1.0 };
            assert!((foot.signed_distance - 0.05 * sign).abs() < 1e-12);
        }
    }

    /// Two halves of a square whose spans do not match, one a little above the other and turned up by 20 degrees: points over the
    /// gap have their foot at the seam, which is no free border, on both sides; at the other borders feet are free.
    #[test]
    fn a_seam_is_no_border() {
        let plate = |x: [f64; 2], rise: f64, inner: &[f64]| {
            let corners: Vec<Vec3> = (0..4)
                .map(|k| {
                    let z = if k % 2 == 1 { rise } else { 0.0 };
                    Vec3::new(x[k % 2], (k / 2) as f64, z)
                })
                .collect();
            let knots = || vec![0.0, 0.0, 1.0, 1.0];
            let patch = NurbsPatch::new([1, 1], [knots(), knots()], [2, 2], &corners, None);
            let patch = patch.unwrap().elevated(0, 2).unwrap();
            patch
                .elevated(1, 2)
                .unwrap()
                .insert_knots(1, inner)
                .unwrap()
        };
        let slope = -20f64.to_radians().tan();
        let (a, b) = (
            plate([0.0, 1.0], 0.0, &[0.5]),
            plate([1.0, 2.0], slope, &[0.3, 0.6]),
        );
        let points = [a.points(), b.points()];
        for reversed in [false, true] {
            let of = |joined: bool| {
                let part = |patch, spans, joined| PatchSpans {
                    patch,
                    spans,
                    joined,
                    trim: None,
                    cut: &[],
                };
                let [left, right]: [&[_]; 2] = match joined {
                    true => [&[(0, 1), (1, 1)], &[(0, 0), (1, 0), (2, 0)]],
                    false => [&[], &[]],
                };
                let parts = [part(&a, &[0, 1], left), part(&b, &[0, 1, 2], right)];
                let mut facets =
                    MovingFacets::of_patches(&parts, reversed, |k, n| 100 * k as u32 + n).unwrap();
                facets.update(|n| points[n as usize / 100][n as usize % 100]);
                facets
            };
            let place = |facets: &MovingFacets, x: Vec3| {
                let foot = facets.project(&x, None, f64::INFINITY, |_| true).unwrap();
                (foot.place, foot.signed_distance)
            };
            // In the wedge of the normals.
            let above = Vec3::new(1.0 + 0.1 * 10f64.to_radians().sin(), 0.4, 0.1);
            let (open, _) = place(&of(false), above);
            assert!(matches!(
                open,
                crate::MovingPlace::Edge {
                    kind: crate::project::EdgeKind::Free,
                    ..
                }
            ));
            let (found, distance) = place(&of(true), above);
            assert!(
                matches!(
                    found,
                    crate::MovingPlace::Edge {
                        kind: crate::project::EdgeKind::Sharp,
                        ..
                    }
                ),
                "{found:?}"
            );
            let exact = (0.01f64 + (above.x - 1.0).powi(2)).sqrt();
            let sign = if reversed { -1.0 } else { 1.0 };
            assert!(
                (distance - sign * exact).abs() < 1e-12,
                "{distance} {exact}"
            );
            // At the outer end of the seam the border is free, and so is the other end of the first half.
            for x in [Vec3::new(1.01, -0.1, 0.1), Vec3::new(-0.1, 0.4, 0.1)] {
                let (found, _) = place(&of(true), x);
                let free = matches!(
                    found,
                    crate::MovingPlace::Edge {
                        kind: crate::project::EdgeKind::Free,
                        ..
                    } | crate::MovingPlace::Corner {
                        kind: crate::project::EdgeKind::Free
                    }
                );
                assert!(free, "{found:?}");
            }
            let (face, _) = place(&of(true), Vec3::new(0.5, 0.4, 0.1));
            assert_eq!(face, crate::MovingPlace::Face);
        }
    }

    #[test]
    fn what_is_not_bicubic_is_refused() {
        let of = |patch: &NurbsPatch, spans: &[usize]| {
            MovingFacets::of_patch(patch, spans, false, |n| n).map(|_| ())
        };
        assert_eq!(of(&patch(), &[6]), Err(MovingError::Patch));
        assert_eq!(of(&patch(), &[]), Err(MovingError::Empty));
        let high = patch().elevated(0, 1).unwrap();
        assert_eq!(of(&high, &[0]), Err(MovingError::Patch));
    }
}
