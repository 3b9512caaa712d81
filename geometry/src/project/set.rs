//! The set of patches and its search.

use super::cells::{cut, part, parts};
use super::local::Region;
use super::piece::{Pieces, Place, hull, tangent_bounds};
use super::round::{self, Sphere};
use super::search::Search;
use super::topology::{self, Topology};
use super::tree::Tree;
use super::trimmed::Trimmed;
use super::{Foot, Hint, Status};
use crate::bezier::BezierPiece;
use crate::patch::NurbsPatch;
use crate::surface::{Surface, Vec3};

/// Normals that turn by more than this (radians) across a joint or a crease make it sharp: one degree, above what CAD
/// systems leave in joints that are meant to be tangential.
pub(crate) const SHARP_ANGLE: f64 = std::f64::consts::PI / 180.0;

/// Why a set of patches could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatchSetError {
    /// No patches.
    #[error("there are no patches")]
    Empty,
    /// The tolerance is not a positive finite number.
    #[error("the tolerance {0} for joining edges is not a positive number")]
    Tolerance(f64),
    /// The resolution is negative or not finite.
    #[error("the resolution {0} of the patches is not a length")]
    Resolution(f64),
    /// Every patch is a point, or so large that squared lengths overflow.
    #[error("the patches have no usable size: {0}")]
    Size(f64),
    /// More pieces than can be numbered.
    #[error("the patches have too many spans")]
    TooLarge,
    /// Going round over common edges leads back to the other side (a Moebius strip). Only
    /// [`two_sided`](PatchSet::two_sided) says so: closest points and distances need no side.
    #[error(
        "patches {0} and {1} cannot be oriented alike: the surface that they belong to has one side \
         only (patches {2:?})"
    )]
    NotOrientable(usize, usize, Vec<usize>),
}

/// How near edges must be to each other to be joined. The default knows nothing of where the patches come from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Joining {
    /// Edges within this length of each other are joined. `None`: 1e-5 of the size of the set, and ten times as much where
    /// all of an edge coincides with another one.
    pub tolerance: Option<f64>,
    /// Smallest distance between two points that the source of the patches tells apart, for instance
    /// [`CadFile::resolution`](crate::io::CadFile::resolution). A larger gap between joined edges is reported, and two
    /// patches that leave their edges in the same direction, like sheets on top of each other, are joined over smaller gaps
    /// only. At least 1e-6 of the size of the set.
    pub resolution: Option<f64>,
}

/// Numbers of the pieces of one patch, and where it may break.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    /// Number of the first piece; see [`piece`](Self::piece).
    pub first: u32,
    /// For every span, and one past the last: the number of its first piece in this direction.
    pub cells: [Vec<u32>; 2],
    pub spans: [usize; 2],
    /// Borders of spans.
    pub breaks: [Vec<f64>; 2],
    /// For every border of spans: 0 smooth, 1 tangents may differ in length, 2 the surface has a crease or ends.
    pub kinks: [Vec<u8>; 2],
    /// For every span: first and one past the last of the spans that it is smoothly connected with.
    smooth: [Vec<[usize; 2]>; 2],
    /// Bounds on `|rho_i|`.
    pub scale: [f64; 2],
}

impl Grid {
    /// Decides in how many cells each span is cut; the number of all pieces.
    fn cut(&mut self, beziers: &[BezierPiece]) -> usize {
        let mut count = self.spans.map(|n| vec![1; n]);
        for bezier in beziers {
            let wanted = parts(bezier);
            for k in 0..2 {
                let count = &mut count[k][bezier.span[k]];
                *count = wanted[k].max(*count);
            }
        }
        for (cells, count) in self.cells.iter_mut().zip(&count) {
            let mut sum = 0u32;
            *cells = vec![0];
            for &n in count {
                sum = sum.saturating_add(n as u32);
                cells.push(sum);
            }
        }
        (self.cells[0][self.spans[0]] as usize)
            .saturating_mul(self.cells[1][self.spans[1]] as usize)
    }

    /// Adds the boxes of the cells of a patch, those of xi1 fastest, and takes note of their tangents.
    fn push_boxes(&mut self, beziers: &[BezierPiece], boxes: &mut Vec<[Vec3; 2]>) {
        let start = boxes.len();
        boxes.resize(start + self.count(), [Vec3::zeros(); 2]);
        let columns = self.cells[0][self.spans[0]] as usize;
        let (mut scale, mut room) = ([0.0f64; 2], Vec::new());
        for bezier in beziers {
            let parts = [0, 1].map(|k| self.parts(k, bezier.span[k]));
            let first = [0, 1].map(|k| self.cells[k][bezier.span[k]] as usize);
            cut(bezier, parts, |[i, j], net| {
                let own = hull(net);
                let bounds = tangent_bounds(net, bezier.degree, &own, &mut room);
                boxes[start + first[0] + i + columns * (first[1] + j)] = own;
                for (k, place) in [i, j].into_iter().enumerate() {
                    let [a, b] = self.range(k, bezier.span[k], place);
                    scale[k] = scale[k].max(bounds[k] / (b - a));
                }
            });
        }
        self.scale = scale;
    }

    /// Parameters of a cell of a span.
    fn range(&self, dir: usize, span: usize, cell: usize) -> [f64; 2] {
        let [a, b] = [self.breaks[dir][span], self.breaks[dir][span + 1]];
        let parts = self.parts(dir, span);
        let at = |k: usize| {
            if k == parts {
                b
            } else {
                a + (b - a) * (k as f64 / parts as f64)
            }
        };
        [at(cell), at(cell + 1)]
    }

    /// Where a piece of this patch lies.
    pub fn place(&self, patch: u32, number: u32) -> Place {
        let columns = self.cells[0][self.spans[0]];
        let cell = [
            (number - self.first) % columns,
            (number - self.first) / columns,
        ];
        let span = [0, 1].map(|k| self.cells[k].partition_point(|&c| c <= cell[k]) - 1);
        Place {
            patch,
            span,
            cell,
            domain: [0, 1].map(|k| {
                let own = cell[k] - self.cells[k][span[k]];
                self.range(k, span[k], own as usize)
            }),
        }
    }

    /// All pieces of this patch.
    pub fn places(&self, patch: u32) -> impl Iterator<Item = Place> {
        let end = self.first + self.count() as u32;
        (self.first..end).map(move |number| self.place(patch, number))
    }

    /// Degrees and control net of a piece of this patch.
    pub fn net<S: Surface>(&self, surface: &S, place: &Place) -> ([usize; 2], Vec<[f64; 4]>) {
        let bezier = surface.bezier_piece(place.span);
        let parts = [0, 1].map(|k| self.parts(k, place.span[k]));
        let own = [0, 1].map(|k| (place.cell[k] - self.cells[k][place.span[k]]) as usize);
        (bezier.degree, part(bezier, parts, own))
    }

    /// Number of cells of a span in direction `dir`.
    fn parts(&self, dir: usize, span: usize) -> usize {
        (self.cells[dir][span + 1] - self.cells[dir][span]) as usize
    }

    /// Number of all pieces.
    pub fn count(&self) -> usize {
        let [columns, rows] = [0, 1].map(|k| self.cells[k][self.spans[k]] as usize);
        columns * rows
    }

    /// Number of the piece at a place.
    #[inline]
    pub fn piece(&self, [i, j]: [u32; 2]) -> u32 {
        self.first + i + self.cells[0][self.spans[0]] * j
    }

    /// First and one past the last of the spans in direction `dir` that are smoothly connected with span `span`.
    #[inline]
    pub fn smooth_spans(&self, dir: usize, span: usize) -> [usize; 2] {
        self.smooth[dir][span.min(self.spans[dir] - 1)]
    }
}

/// For every span the first and one past the last of those that no kink parts it from.
fn smooth(kinks: &[u8]) -> Vec<[usize; 2]> {
    let mut out: Vec<[usize; 2]> = Vec::with_capacity(kinks.len());
    let mut first = 0;
    for end in 1..kinks.len() {
        if kinks[end] != 0 || end + 1 == kinks.len() {
            out.extend((first..end).map(|_| [first, end]));
            first = end;
        }
    }
    out
}

/// Patches of one kind of surface with their tree, their shared edges and their sides. Queries take `&self` and lock nothing
/// but, where a query is the first to come near a part of the surface, the Bezier form of this part and what proves that points of it
/// are the nearest: these are made then, once, and are the same whoever makes them.
#[derive(Debug, Clone)]
pub struct PatchSet<S: Surface = NurbsPatch> {
    pub(super) patches: Vec<S>,
    pub(super) grids: Vec<Grid>,
    pub(super) pieces: Pieces,
    /// For every patch the sphere that it lies on, if any.
    pub(super) spheres: Vec<Option<Sphere>>,
    pub(super) tree: Tree,
    pub(super) trimmed: Trimmed,
    pub(super) size: f64,
    pub(super) tolerance: f64,
    pub(crate) topology: Topology,
    pub(super) sides: Vec<f64>,
}

impl<S: Surface> PatchSet<S> {
    /// [`join`](Self::join) with the given tolerance and no knowledge of the resolution.
    ///
    /// # Errors
    /// As [`join`](Self::join).
    pub fn new(patches: Vec<S>, tolerance: Option<f64>) -> Result<Self, PatchSetError> {
        let joining = Joining {
            tolerance,
            resolution: None,
        };
        Self::join(patches, joining)
    }

    /// Joins patches to a set: finds common edges, connected components and a consistent orientation. A component without
    /// free edges gets the volume that it encloses inside; of any other the first patch keeps its own side (`rho_1 x rho_2`
    /// points out). A component with one side only (a Moebius strip) can be projected on, but has no sides; see
    /// [`two_sided`](Self::two_sided).
    ///
    /// Edges are joined where they are within `tolerance` (a length) of each other; by default that is 1e-5 of
    /// [`size`](Self::size), and ten times as much where all of an edge coincides with another one. For two edges it is no
    /// more than 5 % of the shorter one's length, and a hundred times as much where both carry the same number of the
    /// file. Patches that leave their edges in the same direction are joined only if the gap is within
    /// [`Joining::resolution`]. [`edges`](Self::edges) tells what was joined, the gaps that were bridged, and where edges
    /// come near each other without being joined.
    ///
    /// # Errors
    /// No patches, or a useless tolerance, resolution or size.
    pub fn join(patches: Vec<S>, joining: Joining) -> Result<Self, PatchSetError> {
        if patches.is_empty() {
            return Err(PatchSetError::Empty);
        }
        if let Some(tolerance) = joining.tolerance
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(PatchSetError::Tolerance(tolerance));
        }
        if let Some(resolution) = joining.resolution
            && !(resolution.is_finite() && resolution >= 0.0)
        {
            return Err(PatchSetError::Resolution(resolution));
        }
        let mut boxes = Vec::new();
        let mut trimmed = Trimmed::default();
        let mut grids = Vec::with_capacity(patches.len());
        for (number, patch) in patches.iter().enumerate() {
            let beziers = patch.bezier_pieces();
            let mut grid = grid(patch, boxes.len() as u32);
            let total = grid.cut(&beziers);
            if total.saturating_add(boxes.len()) >= 1 << 31 {
                return Err(PatchSetError::TooLarge);
            }
            grid.push_boxes(&beziers, &mut boxes);
            trimmed.push_patch(patch, number as u32, &grid, &beziers);
            grids.push(grid);
        }
        let pieces = Pieces::of(boxes.len());
        trimmed.shrink();
        trimmed.finish_boxes(&mut boxes);
        if boxes.len() >= 1 << 31 {
            return Err(PatchSetError::TooLarge);
        }
        let tree = Tree::new(&boxes);
        let [low, high] = tree.bounds();
        let size = (high - low).norm();
        if !(size > 1e-100 && size < 1e100) {
            return Err(PatchSetError::Size(size));
        }
        let sides = vec![1.0; patches.len()];
        drop(boxes);
        let spheres =
            (patches.iter().zip(&grids)).map(|(patch, grid)| Sphere::of(patch, grid, size));
        let mut spheres: Vec<Option<Sphere>> = spheres.collect();
        round::number(&mut spheres);
        let mut set = PatchSet {
            patches,
            grids,
            pieces,
            spheres,
            tree,
            trimmed,
            size,
            tolerance: 0.0,
            topology: Topology::default(),
            sides,
        };
        topology::build(&mut set, joining);
        Ok(set)
    }

    /// The patches, by number.
    pub fn patches(&self) -> &[S] {
        &self.patches
    }

    /// Closest point of the set to `q`, or `None` where nothing lies within the distance `reach` (which may be
    /// infinite) or `q` is not finite.
    ///
    /// Without a hint the tree is searched from the top. With a hint the iteration starts there, and its distance then
    /// bounds the same search: the answer is the same, found sooner. The result is the global minimum up to 1e-11 of the
    /// size of the set plus 1e-14 of the distance; where several points are equally near, which of them is given
    /// depends on the hint.
    ///
    /// ```
    /// use covact_geometry::{Bilinear, Location, PatchSet, Vec3};
    /// let corners = [[0., 0., 0.], [2., 0., 0.], [0., 1., 0.], [2., 1., 0.]].map(Vec3::from);
    /// let set = PatchSet::new(vec![Bilinear::new(corners)?], None)?;
    /// let foot = set.project(&Vec3::new(0.5, 0.5, 0.3), None, f64::INFINITY).expect("a finite point");
    /// assert_eq!(foot.location, Location::Face);
    /// assert!((foot.signed_distance.abs() - 0.3).abs() < 1e-15);
    /// // Beside it the foot lies on the edge, and nothing lies within .1 of the point.
    /// let q = Vec3::new(2.5, 0.5, 0.0);
    /// let foot = set.project(&q, None, f64::INFINITY).expect("a finite point");
    /// assert!(matches!(foot.location, Location::Edge { .. }));
    /// assert!(set.project(&q, None, 0.1).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn project(&self, q: &Vec3, hint: Option<Hint>, reach: f64) -> Option<Foot> {
        self.project_above(q, hint, reach, f64::INFINITY)
    }

    /// [`project`](Self::project) where points outside need not be certain beyond the distance `above`, as in contact,
    /// where such a point is open whatever its foot. Where the search takes long because other points are nearly as near
    /// (on the axis of a surface of revolution), it ends once it has proved that nothing is nearer than `above`, or than
    /// the foot by more than a ten-thousandth of the distance. The status is then [`Status::NonUnique`], and never
    /// [`Status::NotConverged`] for a foot whose distance is proved to exceed `above`.
    pub fn project_above(
        &self,
        q: &Vec3,
        hint: Option<Hint>,
        reach: f64,
        above: f64,
    ) -> Option<Foot> {
        if !(q.x.is_finite() && q.y.is_finite() && q.z.is_finite() && reach >= 0.0)
            || self.tree.distance2(q) > reach * reach
        {
            return None;
        }
        let mut search = Search::new(self, *q, reach);
        search.above = above;
        if let Some(hint) = hint
            && let Some(patch) = self.patches.get(hint.patch as usize)
            && hint.xi.iter().all(|x| x.is_finite())
        {
            search.start(hint.patch, patch.find_span(hint.xi), hint.xi);
        }
        search.run();
        let (complete, tied) = (search.complete, search.is_tied());
        let (_, local) = search.best?;
        let mut foot = self.finish(q, local, complete, tied);
        if complete && foot.status == Status::NotConverged && foot.signed_distance > above {
            foot.status = Status::NonUnique;
        }
        Some(foot)
    }

    /// Number of the piece that holds `xi` of a pair of spans.
    #[inline]
    pub(super) fn piece_number(&self, patch: u32, span: [usize; 2], xi: [f64; 2]) -> u32 {
        let grid = &self.grids[patch as usize];
        let place = [0, 1].map(|k| {
            let [first, end] = [grid.cells[k][span[k]], grid.cells[k][span[k] + 1]];
            let [a, b] = [grid.breaks[k][span[k]], grid.breaks[k][span[k] + 1]];
            let step = (xi[k] - a) / (b - a) * f64::from(end - first);
            // The cast takes what is negative to zero.
            first + (step as u32).min(end - first - 1)
        });
        grid.piece(place)
    }

    /// The region between creases and edges that holds a pair of spans.
    #[inline]
    pub(super) fn region(&self, patch: u32, span: [usize; 2]) -> Region {
        let grid = &self.grids[patch as usize];
        let mut spans = [[0; 2]; 2];
        let mut domain = [[0.0; 2]; 2];
        for k in 0..2 {
            let [first, end] = grid.smooth_spans(k, span[k]);
            spans[k] = [first, end];
            domain[k] = [grid.breaks[k][first], grid.breaks[k][end]];
        }
        Region {
            patch,
            spans,
            domain,
        }
    }
}

fn grid<S: Surface>(patch: &S, first: u32) -> Grid {
    let mut spans = [0; 2];
    let mut breaks = [Vec::new(), Vec::new()];
    let mut kinks = [Vec::new(), Vec::new()];
    for k in 0..2 {
        let ranges = patch.spans(k);
        spans[k] = ranges.len();
        let [start, end] = patch.domain()[k];
        breaks[k] = ranges.iter().map(|r| r[0]).chain([end]).collect();
        breaks[k][0] = start;
        let creases = patch.crease_knots(k);
        let sharp = patch.sharp_knots(k, SHARP_ANGLE);
        kinks[k] = breaks[k]
            .iter()
            .map(|x| {
                if *x == start || *x == end || sharp.contains(x) {
                    2
                } else {
                    u8::from(creases.contains(x))
                }
            })
            .collect();
    }
    Grid {
        first,
        cells: [Vec::new(), Vec::new()],
        spans,
        breaks,
        smooth: [smooth(&kinks[0]), smooth(&kinks[1])],
        kinks,
        scale: [0.0; 2],
    }
}
