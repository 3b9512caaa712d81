//! Fields of sheets for the output: on a mesh of quadratic bricks between both faces, as they are deformed.
use crate::mesh::nurbs::{Kept, SheetPatch};
use crate::mesh::{ElementKind, Face, Mesh, NurbsSheet};
use crate::model::BodyModel;
use crate::output::{ContactFields, Field, MidSurface, Place, Precision};
use crate::shell::{Block, NurbsBlock};
use covact_geometry::{NurbsPatch, PatchShape, Vec3};
use std::collections::BTreeMap;

/// Bricks along each direction of an element.
const DIVISIONS: usize = 2;

/// A sheet as bricks, with what its control points have at their nodes.
pub(super) struct SheetFields {
    pub mesh: Mesh,
    pub displacement: Vec<Vec3>,
    pub stress: Vec<[f64; 6]>,
    /// Per node of one face: control points in the body, with their shape functions.
    shapes: Vec<([u32; 16], [f64; 16])>,
}

/// What the mid-surface of a body is called.
pub(super) fn sheet_name(body: &BodyModel) -> String {
    format!("{}_mid", body.name)
}

/// The mid-surface of a body that is a sheet, at displacements `u` of the model; `pressure` is that of all nodes.
pub(super) fn mid_surface(
    body: &BodyModel,
    u: &[f64],
    pressure: Option<&[f64]>,
    precision: Precision,
) -> Option<MidSurface> {
    let sheet = body.block.sheet()?;
    let first = body.first_node as usize;
    let moved = |part: &SheetPatch| {
        let own = 3 * (first + part.first_node as usize);
        let own = u[own..][..3 * part.nodes()].chunks_exact(3);
        let points = part.patch.homogeneous().iter().zip(own);
        let moved = points.map(|([x, y, z, w], u)| [x + w * u[0], y + w * u[1], z + w * u[2], *w]);
        let basis = [0, 1].map(|dir| part.patch.basis(dir).clone());
        // Displacements that are not finite were refused before.
        NurbsPatch::from_homogeneous(basis, moved.collect()).ok()
    };
    Some(MidSurface {
        name: sheet_name(body),
        now: sheet.patches.iter().map(moved).collect::<Option<_>>()?,
        rest: sheet.patches.iter().map(|p| p.patch.clone()).collect(),
        pressure: pressure.map(|all| all[first..first + sheet.nodes()].to_vec()),
        thickness: sheet.thickness,
        kept: sheet.is_trimmed().then(|| {
            let all = 0..sheet.elements();
            all.map(|e| *sheet.kept(e) != Kept::Nothing).collect()
        }),
        precision,
    })
}

/// A point of the grid: the element that it is taken in, and the place there in [0, 1].
struct GridPoint {
    span: [usize; 2],
    at: [f64; 2],
}

impl SheetFields {
    /// Of a body that is a sheet, at displacements `u` of the model; none of other bodies.
    pub fn new(body: &BodyModel, u: &[f64]) -> Option<SheetFields> {
        let Block::Nurbs(block) = &body.block else {
            return None;
        };
        let sheet = block.sheet();
        let grids: Vec<[usize; 2]> = (sheet.patches.iter())
            .map(|p| p.spans().map(|n| 2 * DIVISIONS * n + 1))
            .collect();
        let count: usize = grids.iter().map(|[a, b]| a * b).sum();
        let positions = sheet.positions();
        let own = &u[3 * body.first_node as usize..][..3 * positions.len()];
        let moved: Vec<Vec3> = (positions.iter().zip(own.chunks_exact(3)))
            .map(|(x, u)| x + Vec3::from_column_slice(u))
            .collect();
        let half = 0.5 * sheet.thickness;
        let mut shapes = Vec::with_capacity(count);
        let mut nodes = vec![Vec3::zeros(); 2 * count];
        let mut displacement = vec![Vec3::zeros(); 2 * count];
        let mut room = PatchShape::default();
        for (part, along) in sheet.patches.iter().zip(&grids) {
            let spans = part.spans();
            for k in 0..along[0] * along[1] {
                let point = grid_point([k % along[0], k / along[0]], spans);
                let xi = [0, 1].map(|dir| {
                    let [a, b] = part.patch.basis(dir).span_range(point.span[dir]);
                    a + point.at[dir] * (b - a)
                });
                part.patch.shape_in_span(point.span, xi, &mut room);
                let numbers: [u32; 16] = std::array::from_fn(|a| room.indices[a] + part.first_node);
                let face = |x: &[Vec3]| {
                    let sum = |of: &dyn Fn(usize) -> f64| -> Vec3 {
                        let all = numbers.iter().enumerate();
                        all.map(|(a, n)| x[*n as usize] * of(a)).sum()
                    };
                    let rho = sum(&|a| room.n[a]);
                    let normal = sum(&|a| room.n_i[a][0]).cross(&sum(&|a| room.n_i[a][1]));
                    let normal = normal.try_normalize(0.0).unwrap_or_default();
                    [rho - normal * half, rho + normal * half]
                };
                let (start, now) = (face(&positions), face(&moved));
                let at = shapes.len();
                for side in 0..2 {
                    nodes[side * count + at] = start[side];
                    displacement[side * count + at] = now[side] - start[side];
                }
                shapes.push((numbers, std::array::from_fn(|a| room.n[a])));
            }
        }
        let mesh = bricks(nodes, &grids, sheet);
        let stress = stresses(body, block, u, &grids);
        Some(SheetFields {
            mesh,
            displacement,
            stress,
            shapes,
        })
    }

    /// Values of control points, so many numbers each, on both faces.
    pub fn spread(&self, values: &[f64], components: usize) -> Vec<f64> {
        let of = |(nodes, n): &([u32; 16], [f64; 16])| -> Vec<f64> {
            let mut sum = vec![0.0; components];
            for (node, n) in nodes.iter().zip(n) {
                let own = &values[components * *node as usize..][..components];
                sum.iter_mut().zip(own).for_each(|(s, v)| *s += n * v);
            }
            sum
        };
        let face: Vec<f64> = self.shapes.iter().flat_map(of).collect();
        [face.as_slice(), face.as_slice()].concat()
    }

    /// The status of the control point that has the largest share in each node.
    pub fn status(&self, values: &[u8]) -> Vec<u8> {
        let of = |(nodes, n): &([u32; 16], [f64; 16])| {
            let largest = n.iter().zip(nodes).max_by(|a, b| a.0.total_cmp(b.0));
            largest.map_or(0, |(_, node)| values[*node as usize])
        };
        let face: Vec<u8> = self.shapes.iter().map(of).collect();
        [face.as_slice(), face.as_slice()].concat()
    }
}

/// The element of a grid point, the one before it at the last line, and its place there.
fn grid_point(k: [usize; 2], spans: [usize; 2]) -> GridPoint {
    let steps = 2 * DIVISIONS;
    let span = [0, 1].map(|dir| (k[dir] / steps).min(spans[dir] - 1));
    GridPoint {
        span,
        at: [0, 1].map(|dir| (k[dir] - steps * span[dir]) as f64 / steps as f64),
    }
}

/// Bricks over grids of so many nodes along both directions, one for each patch; all nodes of the bottom first. Those over elements of
/// which a trim leaves nothing are left out.
fn bricks(nodes: Vec<Vec3>, grids: &[[usize; 2]], sheet: &NurbsSheet) -> Mesh {
    let count = nodes.len() / 2;
    let mut connectivity = Vec::new();
    let (mut first, mut elements) = (0, 0);
    for (along, part) in grids.iter().zip(&sheet.patches) {
        let nu = part.spans()[0];
        let cells = along.map(|n| (n - 1) / 2);
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                if *part.kept(i / DIVISIONS + nu * (j / DIVISIONS)) == Kept::Nothing {
                    continue;
                }
                elements += 1;
                for k in 0..18 {
                    let (a, b) = (2 * i + k % 3, 2 * j + k / 3 % 3);
                    connectivity.push((first + a + along[0] * b + count * (k / 9)) as u32);
                }
            }
        }
        first += along[0] * along[1];
    }
    let faces = |face: u8| {
        (0..elements)
            .map(|element| Face { element, face })
            .collect()
    };
    Mesh {
        kind: ElementKind::Q18,
        nodes,
        connectivity,
        node_sets: BTreeMap::new(),
        face_sets: BTreeMap::from([
            ("bottom".to_owned(), faces(4)),
            ("top".to_owned(), faces(5)),
        ]),
    }
}

/// Cauchy stress on both faces: from the resultants of every element, averaged where elements of a patch meet.
fn stresses(
    body: &BodyModel,
    block: &NurbsBlock,
    u: &[f64],
    grids: &[[usize; 2]],
) -> Vec<[f64; 6]> {
    let count: usize = grids.iter().map(|[a, b]| a * b).sum();
    let mut sum = vec![[0.0; 6]; 2 * count];
    let mut met = vec![0.0f64; count];
    let steps = 2 * DIVISIONS;
    let places: Vec<[f64; 2]> = (0..(steps + 1) * (steps + 1))
        .map(|k| [k % (steps + 1), k / (steps + 1)].map(|k| k as f64 / steps as f64))
        .collect();
    let mut first = 0;
    for (part, along) in block.sheet().patches.iter().zip(grids) {
        let nu = part.spans()[0];
        for own in 0..part.elements() {
            let e = part.first_element as usize + own;
            let now = body.displacements(block, e, u);
            let Ok(faces) = block.face_stresses(e, &now, &places) else {
                continue;
            };
            for (k, [bottom, top]) in faces.iter().enumerate() {
                let i = steps * (own % nu) + k % (steps + 1);
                let j = steps * (own / nu) + k / (steps + 1);
                let node = first + i + along[0] * j;
                met[node] += 1.0;
                for c in 0..6 {
                    sum[node][c] += bottom[c];
                    sum[count + node][c] += top[c];
                }
            }
        }
        first += along[0] * along[1];
    }
    for (k, sum) in sum.iter_mut().enumerate() {
        sum.iter_mut().for_each(|s| *s /= met[k % count].max(1.0));
    }
    sum
}

/// Contact fields of a sheet on the mesh of its output.
pub(super) struct Spread {
    pub pressure: Vec<f64>,
    pub gap: Vec<f64>,
    pub status: Vec<u8>,
    /// Name, components, values.
    pub fields: Vec<(String, usize, Vec<f64>)>,
}

impl Spread {
    pub fn contact(&self) -> ContactFields<'_> {
        ContactFields {
            pressure: &self.pressure,
            gap: &self.gap,
            status: &self.status,
        }
    }

    pub fn fields(&self) -> impl Iterator<Item = Field<'_>> {
        self.fields.iter().map(|(name, components, data)| Field {
            name,
            components: *components,
            component_names: &[],
            data,
            place: Place::Point,
        })
    }
}
