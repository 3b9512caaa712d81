//! Triangles of one patch.

use super::TessellateError;
use super::borders::Borders;
use crate::project::PatchSet;
use crate::surface::{Surface, Vec3};
use crate::trim::Part;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::collections::{HashMap, HashSet, VecDeque};

/// Rounds in which nodes are added where triangles leave the surface.
const ROUNDS: usize = 24;
/// Most parts of a span in each direction before these rounds.
const PARTS: usize = 64;
/// Most nodes inside of one patch.
const NODES: usize = 2_000_000;

/// What became of a patch.
pub struct Found {
    pub triangles: Vec<[u32; 3]>,
    pub deviation: f64,
    /// Borders cross each other in the parameter plane.
    pub crossed: bool,
}

/// A node with its parameters.
#[derive(Clone, Copy)]
struct Node {
    place: Point2<f64>,
    xi: [f64; 2],
    number: u32,
}

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

type Plane = ConstrainedDelaunayTriangulation<Node>;

/// From parameters to a plane in which lengths are about those in space.
struct Chart {
    start: [f64; 2],
    scale: [f64; 2],
}

impl Chart {
    fn of<S: Surface>(surface: &S) -> Self {
        let domain = surface.domain();
        let mut length = [0.0f64; 2];
        for i in 0..5 {
            for j in 0..5 {
                let xi = [i, j];
                let at = [0, 1].map(|d| {
                    domain[d][0] + (domain[d][1] - domain[d][0]) * (f64::from(xi[d]) + 0.5) / 5.0
                });
                let jet = surface.jet_in_span(surface.find_span(at), at);
                for d in 0..2 {
                    length[d] += jet.rho_i[d].norm() * (domain[d][1] - domain[d][0]) / 25.0;
                }
            }
        }
        // Very long patches are drawn at most a thousand times as long as wide.
        let larger = length[0].max(length[1]);
        Self {
            start: [domain[0][0], domain[1][0]],
            scale: [0, 1].map(|d| {
                let length = (length[d] / larger).max(1e-3);
                let length = if length.is_finite() { length } else { 1.0 };
                length / (domain[d][1] - domain[d][0])
            }),
        }
    }

    fn place(&self, xi: [f64; 2]) -> Point2<f64> {
        let [x, y] = [0, 1].map(|d| {
            let x = (xi[d] - self.start[d]) * self.scale[d];
            // The triangulation takes no numbers whose products vanish.
            if x.abs() < 1e-30 { 0.0 } else { x }
        });
        Point2::new(x, y)
    }
}

/// Triangulates a patch; its nodes are added to those of the borders.
pub fn triangulate<S: Surface>(
    set: &PatchSet<S>,
    patch: u32,
    tolerance: f64,
    borders: &mut Borders,
) -> Result<Found, TessellateError> {
    let surface = &set.patches()[patch as usize];
    let fault = |reason: String| TessellateError::Patch { patch, reason };
    let chart = Chart::of(surface);
    let mut plane = Plane::new();
    // How often a constraint bounds the face, by its vertices: twice is not at all.
    let mut walls: HashSet<[usize; 2]> = HashSet::new();
    let mut crossed = false;
    let mut chains = Vec::new();
    for polygon in borders.polygons(set, patch) {
        let mut handles: Vec<FixedVertexHandle> = Vec::with_capacity(polygon.len());
        for (xi, number) in polygon {
            let place = chart.place(xi);
            let handle = match plane.locate_vertex(place) {
                // Two nodes of the border at one place are one.
                Some(vertex) => {
                    borders.join(vertex.data().number, number);
                    vertex.fix()
                }
                None => plane
                    .insert(Node { place, xi, number })
                    .map_err(|e| fault(e.to_string()))?,
            };
            if handles.last() != Some(&handle) {
                handles.push(handle);
            }
        }
        chains.push(handles);
    }
    for handles in chains {
        let pairs = handles.iter().zip(handles.iter().cycle().skip(1));
        for (&a, &b) in pairs.filter(|(a, b)| a != b) {
            let edges = plane.try_add_constraint(a, b);
            crossed |= edges.is_empty();
            for edge in edges {
                let [from, to] = plane.directed_edge(edge).vertices().map(|v| v.index());
                let wall = [from.min(to), from.max(to)];
                if !walls.remove(&wall) {
                    walls.insert(wall);
                }
            }
        }
    }
    seed(surface, &chart, tolerance, &mut plane, borders).map_err(&fault)?;
    let mut deviation = 0.0f64;
    for round in 0..=ROUNDS {
        let inside = inside(&plane, &walls, surface, crossed);
        let mut wanted = Vec::new();
        deviation = 0.0;
        for face in plane.inner_faces().filter(|f| inside.contains(&f.index())) {
            let nodes = face.vertices().map(|v| *v.data());
            let corners = nodes.map(|n| borders.position(borders.root_of(n.number)));
            let edges = face.adjacent_edges();
            let fixed = edges.map(|e| e.is_constraint_edge());
            let (off, xi) = worst(surface, &nodes, &corners, fixed);
            deviation = deviation.max(off);
            if off > tolerance {
                wanted.push(xi);
            }
        }
        if wanted.is_empty() || round == ROUNDS {
            break;
        }
        if plane.num_vertices() + wanted.len() > NODES {
            return Err(TessellateError::TooMany(NODES));
        }
        for xi in wanted {
            add(surface, &chart, xi, &mut plane, borders).map_err(&fault)?;
        }
    }
    let inside = inside(&plane, &walls, surface, crossed);
    let swapped = set.sides()[patch as usize] < 0.0;
    let mut triangles = Vec::with_capacity(inside.len());
    for face in plane.inner_faces().filter(|f| inside.contains(&f.index())) {
        let [a, b, c] = face.vertices().map(|v| v.data().number);
        triangles.push(if swapped { [a, c, b] } else { [a, b, c] });
    }
    Ok(Found {
        triangles,
        deviation,
        crossed,
    })
}

/// Adds a node inside of the patch.
fn add<S: Surface>(
    surface: &S,
    chart: &Chart,
    xi: [f64; 2],
    plane: &mut Plane,
    borders: &mut Borders,
) -> Result<(), String> {
    let place = chart.place(xi);
    if plane.locate_vertex(place).is_none() {
        let number = borders.add(surface.point(xi));
        plane
            .insert(Node { place, xi, number })
            .map_err(|e| e.to_string())?;
    }
    Ok(())
}

/// Adds a grid of nodes inside of the patch, as fine as its curvature asks for.
fn seed<S: Surface>(
    surface: &S,
    chart: &Chart,
    tolerance: f64,
    plane: &mut Plane,
    borders: &mut Borders,
) -> Result<(), String> {
    let lines = [0, 1].map(|d| lines(surface, d, tolerance));
    let last = lines.each_ref().map(|l| l.len() - 1);
    for j in 0..=last[1] {
        for i in 0..=last[0] {
            let at = [i, j];
            // The rectangle to the neighbours keeps nodes away from the border.
            let around = [0, 1].map(|d| {
                let line = &lines[d];
                let [before, own, after] =
                    [at[d].saturating_sub(1), at[d], (at[d] + 1).min(last[d])].map(|k| line[k]);
                [own - 0.4 * (own - before), own + 0.4 * (after - own)]
            });
            let on_border = (0..2).any(|d| at[d] == 0 || at[d] == last[d]);
            let inside = match surface.trim() {
                Some(trim) => trim.part(around) == Part::Inside,
                None => !on_border,
            };
            if inside {
                let xi = [lines[0][i], lines[1][j]];
                add(surface, chart, xi, plane, borders)?;
            }
        }
    }
    Ok(())
}

/// Lines of constant parameter `d` between which chords keep to the surface.
fn lines<S: Surface>(surface: &S, d: usize, tolerance: f64) -> Vec<f64> {
    let across = surface.domain()[1 - d];
    let mut lines = Vec::new();
    for [a, b] in surface.spans(d) {
        let mut bend = 0.0f64;
        for i in 0..4 {
            for j in 0..8 {
                let mut xi = [0.0; 2];
                xi[d] = a + (b - a) * (f64::from(i) + 0.5) / 4.0;
                xi[1 - d] = across[0] + (across[1] - across[0]) * (f64::from(j) + 0.5) / 8.0;
                let jet = surface.jet_in_span(surface.find_span(xi), xi);
                let normal = jet.rho_i[0].cross(&jet.rho_i[1]).try_normalize(0.0);
                let second = jet.rho_ij[if d == 0 { 0 } else { 2 }];
                bend = bend.max(normal.map_or(0.0, |n| n.dot(&second).abs()));
            }
        }
        // A chord over h leaves the surface by h^2 / 8 times the bend; half of the tolerance is left to the other direction.
        let parts = ((b - a) * (bend / (4.0 * tolerance)).sqrt()).ceil();
        let parts = if parts.is_finite() {
            parts.clamp(1.0, PARTS as f64)
        } else {
            1.0
        };
        let count = parts as usize;
        lines.extend((0..count).map(|k| a + (b - a) * k as f64 / parts));
    }
    lines.push(surface.domain()[d][1]);
    lines
}

/// Where a triangle leaves the surface most, of its middle and those of its sides that are no border, and how far.
fn worst<S: Surface>(
    surface: &S,
    nodes: &[Node; 3],
    corners: &[Vec3; 3],
    fixed: [bool; 3],
) -> (f64, [f64; 2]) {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
    let mean = |weights: [f64; 3]| {
        [0, 1].map(|d| (0..3).map(|k| weights[k] * nodes[k].xi[d]).sum::<f64>())
    };
    // Sides run from each vertex to the next.
    let places = [
        (false, [1.0 / 3.0; 3]),
        (fixed[0], [0.5, 0.5, 0.0]),
        (fixed[1], [0.0, 0.5, 0.5]),
        (fixed[2], [0.5, 0.0, 0.5]),
    ];
    let mut worst = (0.0f64, nodes[0].xi);
    for (_, weights) in places.into_iter().filter(|p| !p.0) {
        let xi = mean(weights);
        let x = surface.point(xi);
        let flat = a * weights[0] + b * weights[1] + c * weights[2];
        let off = match normal {
            Some(n) => n.dot(&(x - a)).abs(),
            None => (x - flat).norm(),
        };
        if off > worst.0 {
            worst = (off, xi);
        }
    }
    worst
}

/// The triangles inside of the border: walls part inside from outside, and the first triangles lie outside.
fn inside<S: Surface>(
    plane: &Plane,
    walls: &HashSet<[usize; 2]>,
    surface: &S,
    crossed: bool,
) -> HashSet<usize> {
    if crossed {
        // Walls are missing.
        let within = plane.inner_faces().filter(|face| {
            let xi = face.vertices().map(|v| v.data().xi);
            let middle = [0, 1].map(|d| (xi[0][d] + xi[1][d] + xi[2][d]) / 3.0);
            surface.trim().is_none_or(|trim| trim.contains(middle))
        });
        return within.map(|face| face.index()).collect();
    }
    let mut side: HashMap<usize, bool> = HashMap::from([(plane.outer_face().index(), false)]);
    let mut queue = VecDeque::new();
    let wall = |edge: spade::handles::DirectedEdgeHandle<'_, Node, (), spade::CdtEdge<()>, ()>| {
        let [a, b] = edge.vertices().map(|v| v.index());
        walls.contains(&[a.min(b), a.max(b)])
    };
    // From the convex hull inwards.
    for edge in plane.convex_hull() {
        let face = edge.rev().face();
        let inner = if face.is_outer() { edge.face() } else { face };
        if side.insert(inner.index(), wall(edge)).is_none() {
            queue.push_back(inner.fix());
        }
    }
    while let Some(fixed) = queue.pop_front() {
        let Some(face) = plane.face(fixed).as_inner() else {
            continue;
        };
        let own = side[&face.index()];
        for edge in face.adjacent_edges() {
            let next = edge.rev().face();
            if !next.is_outer() && !side.contains_key(&next.index()) {
                side.insert(next.index(), own ^ wall(edge));
                queue.push_back(next.fix());
            }
        }
    }
    side.into_iter().filter(|s| s.1).map(|s| s.0).collect()
}
