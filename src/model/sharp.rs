//! Sharp convex edges and tips of rigid surfaces. Slave points see such an edge only where one of them happens to lie on it: between
//! two points it sinks into the slave's faces, and what it carries depends on the mesh.
use super::error::number;
use super::{Model, PairModel, SurfaceModel};
use crate::model::surface::with_patches;
use covact_geometry::Vec3;

/// Angle between the normals of both sides above which an edge is sharp (radians): as much as a rounding turns over the
/// widest spacing of points that suits it, half of its radius.
const ANGLE: f64 = 0.5;

/// Lines on the patches of a surface, in its own coordinates.
#[derive(Debug)]
pub struct Lines(Vec<Vec<[Vec3; 2]>>);

impl Lines {
    /// The free borders of a surface.
    pub fn borders(surface: &SurfaceModel) -> Lines {
        let found = with_patches!(&surface.set, set => set.free_borders());
        let mut lines = Lines(vec![Vec::new(); surface.set.count()]);
        for (patch, points) in &found {
            lines.add(*patch, points);
        }
        lines
    }

    fn add(&mut self, patch: u32, points: &[Vec3]) {
        let lines = points.windows(2).map(|p| [p[0], p[1]]);
        self.0[patch as usize].extend(lines);
    }

    /// Whether a point of a patch lies within `reach` of one of the lines on it.
    pub fn near(&self, patch: u32, x: &Vec3, reach: f64) -> bool {
        let lines = self.0.get(patch as usize).map_or(&[][..], |l| l);
        lines.iter().any(|[a, b]| {
            let along = b - a;
            let t = (x - a).dot(&along) / along.norm_squared();
            let t = if t.is_finite() {
                t.clamp(0.0, 1.0)
            } else {
                0.0
            };
            (x - (a + along * t)).norm_squared() <= reach * reach
        })
    }
}

/// Sharp convex edges and tips of a surface, in its own coordinates.
#[derive(Debug)]
pub struct SharpEdges {
    /// Lines that follow them; of no length at tips.
    lines: Lines,
    /// Number of edges; that of two patches is one.
    pub count: usize,
    /// Number of tips.
    pub tips: usize,
    /// Largest angle between the normals of both sides of an edge, or of those around a tip (degrees).
    pub angle: f64,
}

impl SharpEdges {
    /// The sharp convex edges and tips of a surface; none where it has none.
    pub fn of(surface: &SurfaceModel) -> Option<SharpEdges> {
        let found = with_patches!(&surface.set, set => set.sharp_edges(ANGLE));
        let mut edges = SharpEdges {
            lines: Lines(vec![Vec::new(); surface.set.count()]),
            count: 0,
            tips: 0,
            angle: 0.0,
        };
        let mut halves = 0usize;
        for edge in found.iter().filter(|e| e.convex) {
            edges.lines.add(edge.patch, &edge.points);
            edges.angle = edges.angle.max(edge.angle.to_degrees());
            halves += 1;
        }
        edges.count = halves.div_ceil(2);
        for tip in with_patches!(&surface.set, set => set.tips(ANGLE)) {
            for patch in &tip.patches {
                edges.lines.add(*patch, &[tip.x, tip.x]);
            }
            edges.angle = edges.angle.max(tip.angle().to_degrees());
            edges.tips += 1;
        }
        (edges.count + edges.tips > 0).then_some(edges)
    }

    /// Whether a point of a patch lies within `reach` of one of its sharp convex edges; `x` in the surface's coordinates.
    pub fn near(&self, patch: u32, x: &Vec3, reach: f64) -> bool {
        self.lines.near(patch, x, reach)
    }

    /// What they are: "2 sharp convex edge(s)".
    fn words(&self) -> String {
        match (self.count, self.tips) {
            (edges, 0) => format!("{edges} sharp convex edge(s)"),
            (0, tips) => format!("{tips} sharp tip(s)"),
            (edges, tips) => format!("{edges} sharp convex edge(s) and {tips} sharp tip(s)"),
        }
    }

    /// What `check` notes of a contact with the surface whose slave points are `spacing` apart.
    pub fn note(&self, contact: &str, surface: &str, spacing: f64) -> String {
        format!(
            "contact `{contact}`: surface `{surface}` has {}, of up to {:.0} degrees; where the slave is bent around one, forces \
             depend on where its points (about {} apart) happen to lie: a rounding of at least {} does not",
            self.words(),
            self.angle,
            number(spacing),
            number(2.0 * spacing)
        )
    }
}

/// Distance of neighbouring slave points of a pair along the longer sides of its faces, on the mean.
pub fn spacing(model: &Model, pair: &PairModel) -> f64 {
    let mesh = &model.bodies[pair.body].mesh;
    let longer = |face: &crate::mesh::Face| {
        let [a, b, c, d] = mesh.face_corners(*face).map(|n| mesh.nodes[n as usize]);
        let (u, v) = (b + d - a - c, c + d - a - b);
        0.5 * u.norm().max(v.norm())
    };
    let faces = pair.faces.len().max(1) as f64;
    let side = pair.faces.iter().map(longer).sum::<f64>() / faces;
    let at_nodes = pair.points.first().is_none_or(|p| p.count == 1);
    let quadratic = (pair.faces.first()).is_some_and(|f| mesh.face_nodes(*f).count != [2, 2]);
    match (at_nodes, quadratic) {
        (true, false) => side,
        (true, true) => 0.5 * side,
        (false, _) => side / (pair.points.len() as f64 / faces).sqrt(),
    }
}
