//! Bounding-box tree over the pieces.

use super::piece::box_distance2;
use crate::surface::Vec3;

/// Two children: their boxes side by side, so that both distances take the same instructions.
#[derive(Debug, Clone)]
struct Node {
    /// `[axis][child]`.
    low: [[f64; 2]; 3],
    high: [[f64; 2]; 3],
    /// A node, or a piece with [`LEAF`] set.
    child: [u32; 2],
}

impl Node {
    /// Squared distances of a point from both boxes.
    #[inline]
    fn distance2(&self, q: &Vec3) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for k in 0..3 {
            for (child, sum) in sum.iter_mut().enumerate() {
                let below = self.low[k][child] - q[k];
                let above = q[k] - self.high[k][child];
                let d = larger(larger(below, above), 0.0);
                *sum += d * d;
            }
        }
        sum
    }

    /// Squared distances of twice the boxes' middles from twice a point.
    fn off(&self, q: &Vec3) -> [f64; 2] {
        [0, 1].map(|child| {
            let one = |k: usize| self.low[k][child] + self.high[k][child] - 2.0 * q[k];
            one(0) * one(0) + one(1) * one(1) + one(2) * one(2)
        })
    }

    fn bounds(&self, child: usize) -> [Vec3; 2] {
        [&self.low, &self.high].map(|b| Vec3::new(b[0][child], b[1][child], b[2][child]))
    }
}

/// The larger of two numbers that are not NaN: one instruction.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

const LEAF: u32 = 1 << 31;

/// More than the depth of any tree: the halves differ in size by one piece at most, and there are fewer than 2^31.
const STACK: usize = 64;

#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    /// Box around everything and where the tree starts; `None` without boxes.
    root: Option<([Vec3; 2], u32)>,
}

impl Tree {
    /// Bytes of heap that it holds.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }

    /// Builds the tree over boxes (lowest and highest corner); the boxes' numbers are what visits get. Boxes whose
    /// lowest corner is above the highest are left out.
    pub fn new(boxes: &[[Vec3; 2]]) -> Self {
        let mut tree = Tree {
            nodes: Vec::with_capacity(boxes.len()),
            root: None,
        };
        let shown = |k: &u32| {
            let [low, high] = &boxes[*k as usize];
            low.x.partial_cmp(&high.x) != Some(std::cmp::Ordering::Greater)
        };
        let mut order: Vec<u32> = (0..boxes.len() as u32).filter(shown).collect();
        if !order.is_empty() {
            tree.root = Some(tree.build(boxes, &mut order));
        }
        tree
    }

    /// Box and number of a subtree.
    fn build(&mut self, boxes: &[[Vec3; 2]], order: &mut [u32]) -> ([Vec3; 2], u32) {
        if let [piece] = *order {
            return (boxes[piece as usize], piece | LEAF);
        }
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
        self.nodes.push(Node {
            low: [[0.0; 2]; 3],
            high: [[0.0; 2]; 3],
            child: [0; 2],
        });
        let axis = (centre_high - centre_low).imax();
        let middle = order.len() / 2;
        order.select_nth_unstable_by(middle, |&a, &b| {
            let centre = |k: u32| boxes[k as usize][0][axis] + boxes[k as usize][1][axis];
            centre(a).total_cmp(&centre(b)).then(a.cmp(&b))
        });
        let (first, second) = order.split_at_mut(middle);
        for (child, half) in [first, second].into_iter().enumerate() {
            let ([low, high], number) = self.build(boxes, half);
            let node = &mut self.nodes[node];
            for k in 0..3 {
                node.low[k][child] = low[k];
                node.high[k][child] = high[k];
            }
            node.child[child] = number;
        }
        ([low, high], node as u32)
    }

    /// Builds the tree over all boxes, so that it can be [refitted](Self::refit) to others: also those that nothing is in
    /// now.
    pub fn with_all(boxes: &[[Vec3; 2]]) -> Self {
        let shown = |[low, high]: &[Vec3; 2]| low.x <= high.x;
        let start: Vec<[Vec3; 2]> = (boxes.iter())
            .map(|b| if shown(b) { *b } else { [Vec3::zeros(); 2] })
            .collect();
        let mut tree = Self::new(&start);
        tree.refit(boxes);
        tree
    }

    /// Takes over other boxes with the same numbers; which boxes are joined stays as it is. Allocates nothing.
    pub fn refit(&mut self, boxes: &[[Vec3; 2]]) {
        let bounds = |nodes: &[Node], number: u32| {
            if number & LEAF != 0 {
                return boxes[(number & !LEAF) as usize];
            }
            let node = &nodes[number as usize];
            let [a, b] = [0, 1].map(|child| node.bounds(child));
            [a[0].inf(&b[0]), a[1].sup(&b[1])]
        };
        // Nodes are numbered before their children.
        for number in (0..self.nodes.len()).rev() {
            for child in 0..2 {
                let [low, high] = bounds(&self.nodes, self.nodes[number].child[child]);
                let node = &mut self.nodes[number];
                for k in 0..3 {
                    node.low[k][child] = low[k];
                    node.high[k][child] = high[k];
                }
            }
        }
        if let Some((root, number)) = &mut self.root {
            *root = bounds(&self.nodes, *number);
        }
    }

    /// Lowest and highest corner of everything.
    pub fn bounds(&self) -> [Vec3; 2] {
        match &self.root {
            Some((bounds, _)) => *bounds,
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
        let Some(([low, high], root)) = &self.root else {
            return;
        };
        let mut stack = ([0u32; STACK], [0.0f64; STACK]);
        let mut top = 0;
        let mut number = *root;
        let mut distance2 = box_distance2(q, low, high);
        loop {
            if distance2 <= limit2 {
                if number & LEAF == 0 {
                    let node = &self.nodes[number as usize];
                    let d = node.distance2(q);
                    let near = if d[0] == d[1] {
                        let off = node.off(q);
                        usize::from(off[1] < off[0])
                    } else {
                        usize::from(d[1] < d[0])
                    };
                    let far = 1 - near;
                    if d[far] <= limit2 && top < STACK {
                        stack.0[top] = node.child[far];
                        stack.1[top] = d[far];
                        top += 1;
                    }
                    number = node.child[near];
                    distance2 = d[near];
                    continue;
                }
                limit2 = visit(number & !LEAF);
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                if stack.1[top] <= limit2 {
                    break;
                }
            }
            number = stack.0[top];
            distance2 = stack.1[top];
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
        let Some(([low, high], root)) = &self.root else {
            return;
        };
        let mut stack = [(*root, measure(low, high)); STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (number, distance2) = stack[top];
            if distance2 >= limit2 {
                continue;
            }
            if number & LEAF != 0 {
                limit2 = visit(number & !LEAF);
                continue;
            }
            let node = &self.nodes[number as usize];
            let d = [0, 1].map(|child| {
                let [low, high] = node.bounds(child);
                measure(&low, &high)
            });
            let near = usize::from(d[0] > d[1]);
            for child in [1 - near, near] {
                if top < STACK {
                    stack[top] = (node.child[child], d[child]);
                    top += 1;
                }
            }
        }
    }
}
