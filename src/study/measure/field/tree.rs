//! A tree of boxes around cells.
use super::cell::Cell;
use covact_geometry::Vec3;

/// Cells in a leaf.
const LEAF: usize = 4;

/// Finds the nearest of many cells.
pub(super) struct Tree<'a> {
    cells: &'a [Cell],
    points: &'a [Vec3],
    /// Size of every cell: the diagonal of its box.
    sizes: Vec<f64>,
    /// Cell numbers, those of a leaf together.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: [Vec3; 2],
    /// Cells of a leaf in the order, or the number of the second child; the first follows its parent.
    content: Content,
}

enum Content {
    Leaf(std::ops::Range<usize>),
    Second(usize),
}

/// Where a point was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub cell: usize,
    /// Natural coordinates in the cell.
    pub xi: [f64; 3],
    /// Distance of the point from the cell; zero within rounding where it is inside.
    pub distance: f64,
    /// Diagonal of the cell's box.
    pub size: f64,
}

impl<'a> Tree<'a> {
    /// `cells` is not empty, and its nodes are among the points.
    pub fn new(cells: &'a [Cell], points: &'a [Vec3]) -> Tree<'a> {
        let bounds: Vec<[Vec3; 2]> = (cells.iter())
            .map(|cell| cell.placed(points).bounds())
            .collect();
        let mut tree = Tree {
            sizes: bounds.iter().map(|[a, b]| (b - a).norm()).collect(),
            order: (0..cells.len() as u32).collect(),
            nodes: Vec::with_capacity(cells.len()),
            cells,
            points,
        };
        tree.grow(&bounds, 0..tree.order.len());
        tree
    }

    /// Appends the node of a range of the order, and all below it; halves of the longest side, so the depth is logarithmic.
    fn grow(&mut self, bounds: &[[Vec3; 2]], range: std::ops::Range<usize>) {
        let whole = (self.order[range.clone()].iter())
            .map(|&c| bounds[c as usize])
            .reduce(|a, b| [a[0].inf(&b[0]), a[1].sup(&b[1])])
            .unwrap_or([Vec3::zeros(); 2]);
        let number = self.nodes.len();
        self.nodes.push(Node {
            bounds: whole,
            content: Content::Leaf(range.clone()),
        });
        if range.len() <= LEAF {
            return;
        }
        let axis = (whole[1] - whole[0]).imax();
        let half = range.start + range.len() / 2;
        let centre = |c: &u32| bounds[*c as usize][0][axis] + bounds[*c as usize][1][axis];
        self.order[range.clone()].select_nth_unstable_by(range.len() / 2, |a, b| {
            centre(a).total_cmp(&centre(b)).then(a.cmp(b))
        });
        self.grow(bounds, range.start..half);
        self.nodes[number].content = Content::Second(self.nodes.len());
        self.grow(bounds, half..range.end);
    }

    /// The cell that is nearest to `p`. `hint` is tried first; a point inside of it is found at once.
    pub fn nearest(&self, p: &Vec3, hint: usize) -> Found {
        let mut best = self.look(hint.min(self.cells.len() - 1), p);
        let mut stack = [0; 64];
        let mut open = 1;
        while open > 0 && best.distance > self.close(best.cell, p) {
            open -= 1;
            let number = stack[open];
            let node = &self.nodes[number];
            if outside(&node.bounds, p) >= best.distance {
                continue;
            }
            match &node.content {
                Content::Leaf(range) => {
                    for &cell in &self.order[range.clone()] {
                        let found = self.look(cell as usize, p);
                        if found.distance < best.distance {
                            best = found;
                        }
                    }
                }
                Content::Second(second) => {
                    let (near, far) = (number + 1, *second);
                    let swap =
                        outside(&self.nodes[near].bounds, p) > outside(&self.nodes[far].bounds, p);
                    let (near, far) = if swap { (far, near) } else { (near, far) };
                    // The depth is that of 2^32 cells at most, and every level leaves one node behind.
                    (stack[open], stack[open + 1]) = (far, near);
                    open += 2;
                }
            }
        }
        best
    }

    /// Distance at which a point counts as inside of a cell.
    fn close(&self, cell: usize, p: &Vec3) -> f64 {
        1e-11 * self.sizes[cell] + 1e-14 * p.amax()
    }

    fn look(&self, cell: usize, p: &Vec3) -> Found {
        let (xi, distance) = self.cells[cell]
            .placed(self.points)
            .nearest(p, self.close(cell, p));
        Found {
            cell,
            xi,
            distance,
            size: self.sizes[cell],
        }
    }
}

/// Distance of a point from a box.
fn outside([low, high]: &[Vec3; 2], p: &Vec3) -> f64 {
    (low - p).sup(&(p - high)).sup(&Vec3::zeros()).norm()
}
