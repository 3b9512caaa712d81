//! Bounding-box tree over the pieces.

use super::piece::box_distance2;
use crate::surface::Vec3;

/// A box with either two children or one piece.
#[derive(Debug, Clone)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// The second child (the first one follows its parent), or the piece with [`LEAF`] set.
    next: u32,
}

const LEAF: u32 = 1 << 31;

/// More than the depth of any tree: the halves differ in size by one piece at most, and there are fewer than 2^31.
const STACK: usize = 64;

#[derive(Debug, Clone, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// Builds the tree over boxes (lowest and highest corner); the boxes' numbers are what visits get. Boxes whose
    /// lowest corner is above the highest are left out.
    pub fn new(boxes: &[[Vec3; 2]]) -> Self {
        let mut tree = Tree {
            nodes: Vec::with_capacity(2 * boxes.len()),
        };
        let shown = |k: &u32| !(boxes[*k as usize][0].x > boxes[*k as usize][1].x);
        let mut order: Vec<u32> = (0..boxes.len() as u32).filter(shown).collect();
        if !order.is_empty() {
            tree.build(boxes, &mut order);
        }
        tree
    }

    fn build(&mut self, boxes: &[[Vec3; 2]], order: &mut [u32]) {
        let mut low = Vec3::from_element(f64::INFINITY);
        let mut high = -low;
        let mut centre_low = low;
        let mut centre_high = high;
        for &k in order.iter() {
            let [l, h] = boxes[k as usize];
            low = low.inf(&l);
            high = high.sup(&h);
            centre_low = centre_low.inf(&(l + h));
            centre_high = centre_high.sup(&(l + h));
        }
        let node = self.nodes.len();
        if let [piece] = *order {
            self.nodes.push(Node {
                low,
                high,
                next: piece | LEAF,
            });
            return;
        }
        self.nodes.push(Node { low, high, next: 0 });
        let axis = (centre_high - centre_low).imax();
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |&a, &b| {
            let centre = |k: u32| boxes[k as usize][0][axis] + boxes[k as usize][1][axis];
            centre(a).total_cmp(&centre(b)).then(a.cmp(&b))
        });
        let (first, second) = order.split_at_mut(middle);
        self.build(boxes, first);
        self.nodes[node].next = self.nodes.len() as u32;
        self.build(boxes, second);
    }

    /// Lowest and highest corner of everything.
    pub fn bounds(&self) -> [Vec3; 2] {
        match self.nodes.first() {
            Some(root) => [root.low, root.high],
            None => [Vec3::zeros(), Vec3::zeros()],
        }
    }

    /// Squared distance of the box around everything.
    #[inline]
    pub fn distance2(&self, q: &Vec3) -> f64 {
        let [low, high] = self.bounds();
        box_distance2(q, &low, &high)
    }

    /// Visits pieces whose box is nearer than the bound, near boxes first, and of equally near ones those whose middle is
    /// nearer. `limit2` is the squared bound at the start; `visit` returns the squared bound from then on.
    #[inline]
    pub fn visit(&self, q: &Vec3, mut limit2: f64, mut visit: impl FnMut(u32) -> f64) {
        let Some(root) = self.nodes.first() else {
            return;
        };
        let mut stack = [(0u32, 0.0f64); STACK];
        let mut top = 0;
        let mut node = 0u32;
        let mut distance2 = box_distance2(q, &root.low, &root.high);
        loop {
            if distance2 <= limit2 {
                let next = self.nodes[node as usize].next;
                if next & LEAF == 0 {
                    let (a, b) = (node + 1, next);
                    let (na, nb) = (&self.nodes[a as usize], &self.nodes[b as usize]);
                    let da = box_distance2(q, &na.low, &na.high);
                    let db = box_distance2(q, &nb.low, &nb.high);
                    let off = |n: &Node| (n.low + n.high - 2.0 * q).norm_squared();
                    let first = da < db || da == db && off(na) <= off(nb);
                    let (near, far) = if first {
                        ((a, da), (b, db))
                    } else {
                        ((b, db), (a, da))
                    };
                    if far.1 <= limit2 && top < STACK {
                        stack[top] = far;
                        top += 1;
                    }
                    (node, distance2) = near;
                    continue;
                }
                limit2 = visit(next & !LEAF);
            }
            if top == 0 {
                return;
            }
            top -= 1;
            (node, distance2) = stack[top];
        }
    }

    /// Visits pieces whose box is nearer than the bound by another measure than the distance of a point: `measure` gives the
    /// squared distance of a box, `visit` the squared bound from then on.
    pub fn scan(
        &self,
        measure: impl Fn(&Vec3, &Vec3) -> f64,
        mut limit2: f64,
        mut visit: impl FnMut(u32) -> f64,
    ) {
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let number = stack[top];
            let node = &self.nodes[number as usize];
            if measure(&node.low, &node.high) >= limit2 {
                continue;
            }
            if node.next & LEAF != 0 {
                limit2 = visit(node.next & !LEAF);
                continue;
            }
            let pair = [number + 1, node.next];
            let [a, b] = pair.map(|k| {
                let node = &self.nodes[k as usize];
                measure(&node.low, &node.high)
            });
            for next in if a <= b { [pair[1], pair[0]] } else { pair } {
                if top < STACK {
                    stack[top] = next;
                    top += 1;
                }
            }
        }
    }
}
