//! What a trim leaves of the elements of a patch.
//!
//! Elements that a curve of the trim cuts are integrated over what is left of them: along the curve, in groups of sixteen points.
//! Elements and control points keep their numbers; those that are cut away are of no element's part, and control points that act
//! on nothing follow their neighbours.
use super::{NurbsSheet, SheetPatch};
use covact_geometry::{NurbsPatch, PatchShape, RulePoint, Trim};

/// Points of a group.
pub const GROUP: usize = 16;

/// How far from a corner it is looked at, as a part of the patch.
const BESIDE: f64 = 1e-7;

/// What is left of an element.
#[derive(Debug, Clone, PartialEq)]
pub enum Kept {
    /// All of it.
    Whole,
    /// These points of its parameters, in groups of [`GROUP`].
    Part(Vec<RulePoint>),
    /// Nothing.
    Nothing,
}

/// What a trim leaves of a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// The trim, in the parameters of the patch.
    trim: Trim,
    /// By span, xi1 fastest.
    spans: Vec<Kept>,
    /// Corners that are left.
    corners: [bool; 4],
}

impl Cut {
    /// Of a patch that is as fine as its elements. None where the trim leaves all of it.
    pub(super) fn new(patch: &NurbsPatch, trim: &Trim) -> Option<Cut> {
        let rule = crate::fem::gauss(4).expect("a rule of four points exists");
        let rule: Vec<[f64; 2]> = rule
            .iter()
            .map(|(s, w)| [0.5 * (1.0 + s), 0.5 * w])
            .collect();
        let [u, v] = [0, 1].map(|dir| patch.spans(dir));
        let all = v.iter().flat_map(|v| u.iter().map(move |u| [*u, *v]));
        let spans: Vec<Kept> = all
            .map(|span| {
                let points = trim.rules(span, &rule).concat();
                let area: f64 = points.iter().map(|p| p.weight).sum();
                let whole: f64 = span.iter().map(|[a, b]| b - a).product();
                match points.is_empty() {
                    true => Kept::Nothing,
                    false if area > (1.0 - 1e-11) * whole => Kept::Whole,
                    false => Kept::Part(points),
                }
            })
            .collect();
        if spans.iter().all(|s| *s == Kept::Whole) {
            return None;
        }
        let domain = patch.domain();
        let corners = std::array::from_fn(|c| {
            trim.contains(std::array::from_fn(|dir| {
                let [a, b] = domain[dir];
                let at = [BESIDE, 1.0 - BESIDE][c >> dir & 1];
                a + at * (b - a)
            }))
        });
        Some(Cut {
            trim: trim.clone(),
            spans,
            corners,
        })
    }

    /// The trim.
    pub fn trim(&self) -> &Trim {
        &self.trim
    }

    /// Whether nothing is left.
    pub(super) fn is_empty(&self) -> bool {
        self.spans.iter().all(|s| *s == Kept::Nothing)
    }

    /// Numbers of elements that are whole, cut and gone.
    pub fn counts(&self) -> [usize; 3] {
        let of = |test: fn(&Kept) -> bool| self.spans.iter().filter(|s| test(s)).count();
        [
            of(|s| matches!(s, Kept::Whole)),
            of(|s| matches!(s, Kept::Part(_))),
            of(|s| matches!(s, Kept::Nothing)),
        ]
    }
}

impl SheetPatch {
    /// What is left of a span, by its number in the patch.
    pub fn kept(&self, span: usize) -> &Kept {
        self.cut.as_ref().map_or(&Kept::Whole, |c| &c.spans[span])
    }

    /// Whether a corner is left.
    pub(super) fn keeps_corner(&self, corner: usize) -> bool {
        self.cut.as_ref().is_none_or(|c| c.corners[corner])
    }
}

impl NurbsSheet {
    /// What is left of element `e`.
    pub fn kept(&self, e: usize) -> &Kept {
        let (patch, [i, j]) = self.place(e);
        patch.kept(i + patch.spans()[0] * j)
    }

    /// Whether a trim cuts something away.
    pub fn is_trimmed(&self) -> bool {
        self.patches.iter().any(|p| p.cut.is_some())
    }

    /// Elements of which something is left.
    pub fn kept_elements(&self) -> usize {
        let all = self.patches.iter();
        all.map(|p| match &p.cut {
            None => p.elements(),
            Some(cut) => p.elements() - cut.counts()[2],
        })
        .sum()
    }

    /// Control points that act on no element, each with one that does, as near as possible in the net.
    pub fn unused(&self) -> Vec<[u32; 2]> {
        let mut out = Vec::new();
        for part in self.patches.iter().filter(|p| p.cut.is_some()) {
            let [nu, nv] = part.patch.counts();
            let spans = part.spans();
            let mut follows: Vec<Option<u32>> = vec![None; nu * nv];
            let mut room = PatchShape::default();
            for k in (0..part.elements()).filter(|k| *part.kept(*k) != Kept::Nothing) {
                let span = [k % spans[0], k / spans[0]];
                let middle = [0, 1].map(|dir| {
                    let [a, b] = part.patch.basis(dir).span_range(span[dir]);
                    0.5 * (a + b)
                });
                part.patch.shape_in_span(span, middle, &mut room);
                (room.indices.iter()).for_each(|n| follows[*n as usize] = Some(*n));
            }
            // From those that are used outwards.
            let mut front: Vec<usize> = (0..nu * nv).filter(|n| follows[*n].is_some()).collect();
            while !front.is_empty() {
                let mut next = Vec::new();
                for n in front {
                    let (i, j) = (n % nu, n / nu);
                    let beside = [
                        (i > 0).then(|| n - 1),
                        (i + 1 < nu).then_some(n + 1),
                        (j > 0).then(|| n - nu),
                        (j + 1 < nv).then_some(n + nu),
                    ];
                    for m in beside.into_iter().flatten() {
                        if follows[m].is_none() {
                            follows[m] = follows[n];
                            let pair = [m as u32, follows[n].unwrap_or_default()];
                            out.push(pair.map(|n| n + part.first_node));
                            next.push(m);
                        }
                    }
                }
                front = next;
            }
        }
        out
    }
}
