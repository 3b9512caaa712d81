//! What bounds the patches of a sheet: edges, or the parts of them that a trim leaves, and curves of trims.
use super::{Edge, NurbsSheet, SheetPatch, SheetPoint};
use crate::fem::gauss;
use covact_geometry::{NurbsCurve, NurbsPatch, PatchShape, Trim, Vec3};
use std::collections::BTreeMap;

/// How far from a curve its inside is looked for, as a part of the domain.
const BESIDE: f64 = 1e-6;

/// How far inside of a curve the element is looked for that it bounds, likewise.
const INSIDE: f64 = 1e-9;

/// Ranges shorter than this part of an edge are round-off.
const SLIVER: f64 = 1e-9;

/// A curve of the trim of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrimEdge {
    patch: u32,
    curve: u32,
}

impl TrimEdge {
    /// The first of the first patch.
    #[cfg(test)]
    pub const fn first() -> Self {
        TrimEdge { patch: 0, curve: 0 }
    }

    /// Number of the curve, counted over all loops.
    pub const fn curve(self) -> usize {
        self.curve as usize
    }
}

/// What bounds a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Border {
    /// An edge, or what a trim leaves of it.
    Edge(Edge),
    /// A curve of a trim, but for what of it lies on edges.
    Trim(TrimEdge),
}

impl Border {
    /// Place of its patch in [`NurbsSheet::patches`].
    pub const fn patch(self) -> usize {
        match self {
            Border::Edge(edge) => edge.patch(),
            Border::Trim(trim) => trim.patch as usize,
        }
    }

    /// All that bounds a patch with this number.
    pub fn all(number: usize, patch: &NurbsPatch, trim: Option<&Trim>) -> Vec<Border> {
        let curves = 0..trim.map_or(0, Trim::curve_count) as u32;
        let curves = curves.map(|curve| {
            let patch = number as u32;
            Border::Trim(TrimEdge { patch, curve })
        });
        let edges = Edge::of(number).map(Border::Edge).into_iter();
        let bounds = |border: &Border| !Line::new(patch, trim, *border).ranges.is_empty();
        edges.chain(curves).filter(bounds).collect()
    }
}

/// A border in the parameters of its patch.
#[derive(Debug, Clone)]
pub(crate) struct Line<'a> {
    patch: &'a NurbsPatch,
    kind: Kind<'a>,
    /// Parameters that bound the patch, ascending, each without a corner inside.
    ranges: Vec<[f64; 2]>,
}

#[derive(Debug, Clone)]
enum Kind<'a> {
    Edge(Edge),
    Trim {
        trim: &'a Trim,
        number: usize,
        curve: &'a NurbsCurve<2>,
        /// +1 where the patch is on the left of the curve.
        sense: f64,
    },
}

impl<'a> Line<'a> {
    pub fn new(patch: &'a NurbsPatch, trim: Option<&'a Trim>, border: Border) -> Line<'a> {
        let domain = patch.domain();
        match (border, trim) {
            (Border::Trim(own), Some(trim)) => Line::trim(patch, trim, own.curve()),
            (Border::Trim(_), None) => Line {
                patch,
                kind: Kind::Edge(Edge::ALL[0]),
                ranges: Vec::new(),
            },
            (Border::Edge(edge), trim) => {
                let whole = domain[1 - edge.direction()];
                Line {
                    patch,
                    kind: Kind::Edge(edge),
                    ranges: match trim {
                        None => vec![whole],
                        Some(trim) => left(trim, domain, edge),
                    },
                }
            }
        }
    }

    fn trim(patch: &'a NurbsPatch, trim: &'a Trim, number: usize) -> Line<'a> {
        let domain = patch.domain();
        let parts = trim.parts(number, domain).into_iter();
        let mut ranges: Vec<[f64; 2]> = parts
            .filter(|p| p.side.is_none())
            .map(|p| p.range)
            .collect();
        let curve = trim.curve(number).map(|c| &c.parameter);
        let Some(curve) = curve else {
            return Line {
                patch,
                kind: Kind::Edge(Edge::ALL[0]),
                ranges: Vec::new(),
            };
        };
        let extent = domain.map(|[a, b]| b - a);
        // Where both sides or none belong to the patch, a curve bounds nothing.
        let sense = |[a, b]: [f64; 2]| -> Option<f64> {
            let jet = curve.jet(a + 0.437 * (b - a));
            let [x, y] = [0, 1].map(|d| jet.d1[d] / extent[d]);
            let size = x.hypot(y);
            let beside = |sign: f64| {
                let off = [-y / size, x / size].map(|c| sign * BESIDE * c);
                trim.contains([0, 1].map(|d| jet.point[d] + off[d] * extent[d]))
            };
            match (beside(1.0), beside(-1.0)) {
                (true, false) => Some(1.0),
                (false, true) => Some(-1.0),
                _ => None,
            }
        };
        ranges.retain(|range| sense(*range).is_some());
        let sense = ranges.first().and_then(|r| sense(*r)).unwrap_or(1.0);
        Line {
            patch,
            kind: Kind::Trim {
                trim,
                number,
                curve,
                sense,
            },
            ranges,
        }
    }

    /// Parts without corners.
    pub fn ranges(&self) -> &[[f64; 2]] {
        &self.ranges
    }

    /// From the first of its parameters to the last one.
    pub fn whole(&self) -> [f64; 2] {
        match (self.ranges.first(), self.ranges.last(), &self.kind) {
            // Of an edge points beyond what is left of it are points, too.
            (.., Kind::Edge(edge)) => self.patch.domain()[1 - edge.direction()],
            (Some([a, _]), Some([_, b]), _) => [*a, *b],
            _ => [0.0, 1.0],
        }
    }

    /// Parameters of the patch.
    pub fn xi(&self, s: f64) -> [f64; 2] {
        match &self.kind {
            Kind::Edge(edge) => {
                let across = edge.direction();
                let mut xi = [s; 2];
                xi[across] = self.patch.domain()[across][usize::from(edge.at_end())];
                xi
            }
            Kind::Trim { curve, .. } => {
                let domain = self.patch.domain();
                let point = curve.point(s);
                [0, 1].map(|d| point[d].clamp(domain[d][0], domain[d][1]))
            }
        }
    }

    /// Their derivative.
    pub fn direction(&self, s: f64) -> [f64; 2] {
        match &self.kind {
            Kind::Edge(edge) => {
                let mut along = [0.0; 2];
                along[1 - edge.direction()] = 1.0;
                along
            }
            Kind::Trim { curve, .. } => {
                let d = curve.jet(s).d1;
                [d[0], d[1]]
            }
        }
    }

    /// Whether the patch is on the left.
    pub fn is_counter_clockwise(&self) -> bool {
        match &self.kind {
            Kind::Edge(edge) => matches!(edge.side(), 1 | 2),
            Kind::Trim { sense, .. } => *sense > 0.0,
        }
    }

    /// Factors of both changes of parameters, whose sum is positive for those that lead out of the patch and zero along the line.
    pub fn outward(&self, s: f64) -> [f64; 2] {
        match &self.kind {
            Kind::Edge(edge) => {
                let mut out = [0.0; 2];
                out[edge.direction()] = if edge.at_end() { 1.0 } else { -1.0 };
                out
            }
            Kind::Trim { sense, .. } => {
                let [x, y] = self.direction(s);
                [sense * y, -sense * x]
            }
        }
    }

    /// The span that it bounds.
    pub fn span(&self, s: f64) -> [usize; 2] {
        let counts = [0, 1].map(|dir| self.patch.basis(dir).span_count());
        match &self.kind {
            Kind::Edge(edge) => {
                let (across, along) = (edge.direction(), 1 - edge.direction());
                let basis = self.patch.basis(along);
                let mut span = [if edge.at_end() { counts[across] - 1 } else { 0 }; 2];
                span[along] = (0..counts[along])
                    .find(|k| s < basis.span_range(*k)[1])
                    .unwrap_or(counts[along] - 1);
                span
            }
            Kind::Trim { .. } => {
                let (xi, out) = (self.xi(s), self.outward(s));
                let extent = self.patch.domain().map(|[a, b]| b - a);
                let scaled = [0, 1].map(|d| out[d] * extent[d]);
                let size = scaled[0].hypot(scaled[1]).max(f64::MIN_POSITIVE);
                [0, 1].map(|d| {
                    let inside = xi[d] - INSIDE * scaled[d] / size * extent[d];
                    let basis = self.patch.basis(d);
                    (0..counts[d])
                        .find(|k| inside < basis.span_range(*k)[1])
                        .unwrap_or(counts[d] - 1)
                })
            }
        }
    }

    /// What of a range bounds the patch, cut into parts that bound one element each and have no corners.
    pub fn pieces(&self, range: [f64; 2]) -> Vec<[f64; 2]> {
        let spans = match &self.kind {
            Kind::Edge(edge) => self.patch.spans(1 - edge.direction()),
            Kind::Trim { trim, number, .. } => {
                let knots = [0, 1].map(|dir| -> Vec<f64> {
                    let spans = self.patch.spans(dir);
                    spans[1..].iter().map(|s| s[0]).collect()
                });
                let all = self.ranges.iter();
                all.flat_map(|r| trim.cut_at(*number, *r, [&knots[0], &knots[1]]))
                    .collect()
            }
        };
        let [low, high] = range;
        // Slivers are round-off.
        let least = 1e-6 * (high - low);
        let mut out = Vec::new();
        for [from, to] in &self.ranges {
            let (low, high) = (low.max(*from), high.min(*to));
            let of = spans.iter().map(|[a, b]| [a.max(low), b.min(high)]);
            out.extend(of.filter(|[a, b]| b - a > least));
        }
        out
    }
}

/// What the curves of a trim leave of an edge.
fn left(trim: &Trim, domain: [[f64; 2]; 2], edge: Edge) -> Vec<[f64; 2]> {
    let along = 1 - edge.direction();
    let mut all: Vec<[f64; 2]> = Vec::new();
    for k in 0..trim.curve_count() {
        let parts = trim.parts(k, domain).into_iter();
        for part in parts.filter(|p| p.side == Some(edge.side())) {
            let Some(curve) = trim.curve(k) else { continue };
            let ends = part.range.map(|t| curve.parameter.point(t)[along]);
            all.push([ends[0].min(ends[1]), ends[0].max(ends[1])]);
        }
    }
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [low, high] = domain[along];
    let tiny = SLIVER * (high - low);
    let mut out: Vec<[f64; 2]> = Vec::new();
    for [a, b] in all {
        // Ends of the domain to the last bit.
        let a = if a - low <= tiny { low } else { a };
        let b = if high - b <= tiny { high } else { b };
        match out.last_mut() {
            Some(last) if a <= last[1] + tiny => last[1] = last[1].max(b),
            _ => out.push([a, b]),
        }
    }
    out.retain(|[a, b]| b - a > tiny);
    out
}

/// A point of a border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BorderPoint {
    /// Shape functions, numbered in the sheet.
    pub at: SheetPoint,
    /// The element that it bounds.
    pub element: usize,
    /// Undeformed length that it stands for.
    pub length: f64,
    /// Factors of both changes of parameters, whose sum is positive for those that lead out of the patch, in any size.
    pub outward: [f64; 2],
    /// Undeformed width of the element across the border.
    pub width: f64,
    /// The same along it.
    pub along: f64,
}

/// Undeformed width of an element with these sides (in parameters) across a border: of an edge along the other parameter, of a curve of a
/// trim at right angles to it.
pub(crate) fn width_across(
    border: Border,
    tangents: [Vec3; 2],
    outward: [f64; 2],
    sides: [f64; 2],
) -> f64 {
    if let Border::Edge(edge) = border {
        let across = edge.direction();
        return tangents[across].norm() * sides[across];
    }
    let [e, f, g] = [
        tangents[0].norm_squared(),
        tangents[0].dot(&tangents[1]),
        tangents[1].norm_squared(),
    ];
    // As changes of parameters the direction at right angles is a^ij m_j.
    let [m1, m2] = outward;
    let det = e * g - f * f;
    let across = [(g * m1 - f * m2) / det, (e * m2 - f * m1) / det];
    let size = (tangents[0] * across[0] + tangents[1] * across[1]).norm();
    let parts = [0, 1].map(|k| across[k] / (size * sides[k]));
    1.0 / parts[0].hypot(parts[1])
}

impl SheetPatch {
    /// The trim, in the parameters of the patch.
    pub fn trim(&self) -> Option<&Trim> {
        self.cut.as_ref().map(super::Cut::trim)
    }

    /// A border of the patch in its parameters.
    pub(crate) fn line(&self, border: Border) -> Line<'_> {
        Line::new(&self.patch, self.trim(), border)
    }
}

impl NurbsSheet {
    /// Gauss points along a border, element after element.
    pub fn border_points(&self, border: Border, count: usize) -> Vec<Vec<BorderPoint>> {
        let part = &self.patches[border.patch()];
        let line = part.line(border);
        let rule = gauss(count).expect("a rule of this many points exists");
        let positions = part.patch.points();
        let mut room = PatchShape::default();
        let nu = part.spans()[0];
        let mut of = |[a, b]: [f64; 2]| {
            let points = rule.iter().map(|(s, w)| {
                let s = 0.5 * (a + b) + 0.5 * s * (b - a);
                let span = line.span(s);
                let weight = 0.5 * w * (b - a);
                let p = part.point(span, line.xi(s), weight, &positions, &mut room);
                let tangents = p.n_i.map(|n_i| -> Vec3 {
                    (p.nodes.iter().zip(n_i))
                        .map(|(n, d)| positions[(*n - part.first_node) as usize] * d)
                        .sum()
                });
                let [x, y] = line.direction(s);
                let outward = line.outward(s);
                let sides = [0, 1].map(|dir| {
                    let [a, b] = part.patch.basis(dir).span_range(span[dir]);
                    b - a
                });
                let size = (tangents[0] * x + tangents[1] * y).norm();
                BorderPoint {
                    at: p,
                    element: part.first_element as usize + span[0] + nu * span[1],
                    length: p.weight * size,
                    outward,
                    width: width_across(border, tangents, outward, sides),
                    along: size / (x / sides[0]).hypot(y / sides[1]),
                }
            });
            points.collect()
        };
        line.pieces(line.whole()).into_iter().map(&mut of).collect()
    }

    /// Integral of every control point's shape function along a border (length).
    pub fn border_lengths(&self, border: Border) -> Vec<(u32, f64)> {
        let mut lengths: BTreeMap<u32, f64> = BTreeMap::new();
        for p in self
            .border_points(border, super::DEGREE + 1)
            .iter()
            .flatten()
        {
            for (node, n) in p.at.nodes.iter().zip(p.at.n).filter(|(_, n)| *n != 0.0) {
                *lengths.entry(*node).or_default() += n * p.length;
            }
        }
        lengths.into_iter().collect()
    }

    /// Sets of borders: those that are not joined all along, each by itself; loops of several curves; `rim` for all, of several
    /// patches.
    pub(super) fn named_borders(&self) -> BTreeMap<String, Vec<Border>> {
        let mut out: BTreeMap<String, Vec<Border>> = BTreeMap::new();
        let free = self.free_borders();
        for border in &free {
            out.insert(self.border_name(*border), vec![*border]);
        }
        for border in &free {
            if let Border::Trim(trim) = border
                && let Some(name) = self.loop_name(*trim)
            {
                let all = out.entry(name).or_default();
                if !all.contains(border) {
                    all.push(*border);
                }
            }
        }
        if self.patches.len() > 1 {
            out.insert("rim".to_owned(), free);
        }
        out
    }

    /// Nodes of borders: rows of control points along edges; those of anchors of curves of trims, or else the control points that act
    /// on them.
    pub(super) fn border_nodes(&self, borders: &[Border]) -> Vec<u32> {
        let mut out = Vec::new();
        for border in borders {
            match border {
                Border::Edge(edge) => out.extend(self.row(*edge, 0)),
                Border::Trim(trim) => match self.anchored(*trim) {
                    Some(nodes) => out.extend(nodes),
                    None => out.extend(self.border_lengths(*border).iter().map(|(n, _)| *n)),
                },
            }
        }
        super::sorted(out)
    }

    /// What bounds the patches and is not joined all along.
    pub fn free_borders(&self) -> Vec<Border> {
        let all = self.patches.iter().enumerate();
        all.flat_map(|(k, p)| Border::all(k, &p.patch, p.trim()))
            .filter(|border| !self.joints.inner.contains(border))
            .collect()
    }

    /// The set of a border: `edge.1` to `edge.4`, `trim.1` for the first loop of curves where it has one curve, or `trim.1.2`.
    pub fn border_name(&self, border: Border) -> String {
        let part = &self.patches[border.patch()];
        match border {
            Border::Edge(edge) => {
                let number = part.side_in_file(edge);
                self.name(edge.patch(), &format!("edge.{number}"))
            }
            Border::Trim(own) => {
                let set = match part.trim().and_then(|t| Some((t, t.place(own.curve())?))) {
                    Some((trim, (number, place))) if trim.loops()[number].curves.len() > 1 => {
                        format!("trim.{}.{}", number + 1, place + 1)
                    }
                    Some((_, (number, _))) => format!("trim.{}", number + 1),
                    None => "trim".to_owned(),
                };
                self.name(border.patch(), &set)
            }
        }
    }

    /// The set of the whole loop that a curve of a trim belongs to.
    pub fn loop_name(&self, trim: TrimEdge) -> Option<String> {
        let patch = trim.patch as usize;
        let (number, _) = self.patches[patch].trim()?.place(trim.curve())?;
        Some(self.name(patch, &format!("trim.{}", number + 1)))
    }
}
