//! Resultants of the stress through the thickness of shells: membrane forces, bending moments, transverse shear forces.
use crate::fem::shape_derivatives;
use crate::mesh::{ElementKind, Mesh, ThicknessColumns};
use crate::output::{Field, Place};
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Components in the plane of the shell, and across it.
const PLANE: [&str; 3] = ["11", "22", "12"];
const ACROSS: [&str; 2] = ["13", "23"];
/// Sine of the angle (.1 degrees) between the normal and x from which direction 1 is the projection of z instead.
const ALONG_X: f64 = 1.745e-3;

/// Resultants at the nodes of a shell, all nodes of a column the same; NaN at nodes of no column.
pub(super) struct Resultants {
    /// `int sigma_ij dz`, three a node (force / length).
    membrane: Vec<f64>,
    /// `int sigma_ij z dz`, three a node (force length / length).
    moment: Vec<f64>,
    /// `int sigma_i3 dz`, two a node (force / length).
    shear: Vec<f64>,
}

impl Resultants {
    /// Of a shell with its nodes at these positions and Cauchy stresses at them, in the order of
    /// [`crate::output::STRESS_COMPONENTS`]. The stress is linear between the nodes of a column, which elements that are
    /// linear through the thickness have it.
    pub fn new(mesh: &Mesh, positions: &[Vec3], stress: &[[f64; 6]]) -> Self {
        let n = mesh.nodes.len();
        let mut out = Resultants {
            membrane: vec![f64::NAN; 3 * n],
            moment: vec![f64::NAN; 3 * n],
            shear: vec![f64::NAN; 2 * n],
        };
        each_column(mesh, positions, |column, axes| {
            out.integrate(column, axes, positions, stress);
        });
        out
    }

    /// The resultants of a column of nodes, from the bottom to the top.
    fn integrate(
        &mut self,
        column: &[usize],
        axes: &[Vec3; 3],
        positions: &[Vec3],
        stress: &[[f64; 6]],
    ) {
        let (Some(&bottom), Some(&top)) = (column.first(), column.last()) else {
            return;
        };
        let middle = 0.5 * (positions[bottom] + positions[top]);
        let height = |node: usize| (positions[node] - middle).dot(&axes[2]);
        let (mut force, mut moment) = (Matrix3::zeros(), Matrix3::zeros());
        for pair in column.windows(2) {
            let (a, b) = (height(pair[0]), height(pair[1]));
            let [below, above] = [pair[0], pair[1]].map(|node| tensor(&stress[node]));
            force += (below + above) * (0.5 * (b - a));
            moment += (below * (2.0 * a + b) + above * (a + 2.0 * b)) * ((b - a) / 6.0);
        }
        let of = |tensor: &Matrix3<f64>, i: usize, j: usize| axes[i].dot(&(tensor * axes[j]));
        for &node in column {
            for (k, (i, j)) in [(0, 0), (1, 1), (0, 1)].into_iter().enumerate() {
                self.membrane[3 * node + k] = of(&force, i, j);
                self.moment[3 * node + k] = of(&moment, i, j);
            }
            (0..2).for_each(|i| self.shear[2 * node + i] = of(&force, i, 2));
        }
    }

    /// As fields of the output: `membrane_force`, `bending_moment` and `shear_force`.
    pub fn fields(&self) -> [Field<'_>; 3] {
        let field = |name, component_names: &'static [&'static str], data| Field {
            name,
            components: component_names.len(),
            component_names,
            data,
            place: Place::Point,
        };
        [
            field("membrane_force", &PLANE, &self.membrane),
            field("bending_moment", &PLANE, &self.moment),
            field("shear_force", &ACROSS, &self.shear),
        ]
    }
}

/// Calls `of` for every column of nodes, from the bottom to the top, with the directions of the mid-surface there.
pub(super) fn each_column(
    mesh: &Mesh,
    positions: &[Vec3],
    mut of: impl FnMut(&[usize], &[Vec3; 3]),
) {
    let columns = ThicknessColumns::new(mesh);
    let normals = layer_normals(mesh, positions);
    let mut column = Vec::new();
    for bottom in 0..mesh.nodes.len() as u32 {
        if columns.ends(bottom).is_none_or(|ends| ends[0] != bottom) {
            continue;
        }
        column.clear();
        column.extend(columns.upwards(bottom).map(|node| node as usize));
        let normal: Vec3 = column.iter().map(|&node| normals[node]).sum();
        if let Some(axes) = local_axes(normal) {
            of(&column, &axes);
        }
    }
}

pub(super) fn tensor([xx, yy, zz, xy, yz, xz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz)
}

/// Directions 1 and 2 in the plane and 3 along a normal of any length: 1 is the projection of x, or of z where x is within
/// .1 degrees of the normal. None without a normal.
fn local_axes(normal: Vec3) -> Option<[Vec3; 3]> {
    let third = normal.try_normalize(0.0)?;
    let along = match third.cross(&Vec3::x()).norm() > ALONG_X {
        true => Vec3::x(),
        false => Vec3::z(),
    };
    let first = (along - third * along.dot(&third)).try_normalize(0.0)?;
    Some([first, third.cross(&first), third])
}

/// Normals of the middles of the layers of elements at their nodes, from bottom to top, weighted by area.
fn layer_normals(mesh: &Mesh, positions: &[Vec3]) -> Vec<Vec3> {
    let side = match mesh.kind {
        ElementKind::H8 => 2u8,
        ElementKind::Q18 | ElementKind::Nurbs => 3,
    };
    let per_layer = usize::from(side * side);
    let place = |k: usize| 2.0 * k as f64 / f64::from(side - 1) - 1.0;
    let derivatives: Vec<[[f64; 9]; 2]> = (0..per_layer)
        .map(|a| {
            let (i, j) = (a % usize::from(side), a / usize::from(side));
            shape_derivatives([side; 2], place(i), place(j))
        })
        .collect();
    let mut out = vec![Vec3::zeros(); positions.len()];
    let mut middle = [Vec3::zeros(); 9];
    for e in 0..mesh.elements() {
        let (below, above) = mesh.element(e).split_at(per_layer);
        for ((middle, &a), &b) in middle.iter_mut().zip(below).zip(above) {
            *middle = 0.5 * (positions[a as usize] + positions[b as usize]);
        }
        for ((derivatives, &a), &b) in derivatives.iter().zip(below).zip(above) {
            let [along_r, along_s] = derivatives.map(|weights| -> Vec3 {
                let terms = middle[..per_layer].iter().zip(weights);
                terms.map(|(x, w)| x * w).sum()
            });
            let normal = along_r.cross(&along_s);
            out[a as usize] += normal;
            out[b as usize] += normal;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::plate;
    use crate::scene::{Plate, Spacing};
    use nalgebra::Rotation3;

    fn a_plate(kind: ElementKind, layers: u32) -> Mesh {
        let plate_of = Plate {
            size: [8.0, 6.0],
            thickness: 0.5,
            elements: [2, 3],
            layers,
            origin: [1.0, 2.0, 3.0],
            spacing: [Spacing::default(), Spacing::default()],
        };
        plate(&plate_of, kind).unwrap()
    }

    fn flat(t: &Matrix3<f64>) -> [f64; 6] {
        [
            t[(0, 0)],
            t[(1, 1)],
            t[(2, 2)],
            t[(0, 1)],
            t[(1, 2)],
            t[(0, 2)],
        ]
    }

    /// A stress that is linear in z, on a plate that lies in its plane and on one that is turned: the same resultants about
    /// the local directions, which turn with it unless x tells them otherwise.
    #[test]
    fn of_a_linear_stress() {
        let force = Matrix3::new(3.0, 0.5, 0.7, 0.5, -2.0, 0.2, 0.7, 0.2, 0.0);
        let bending = Matrix3::new(-1.0, 0.3, 0.0, 0.3, 4.0, 0.0, 0.0, 0.0, 0.0);
        for (kind, layers) in [
            (ElementKind::H8, 1),
            (ElementKind::H8, 3),
            (ElementKind::Q18, 2),
        ] {
            let mesh = a_plate(kind, layers);
            let bottom = mesh.nodes.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
            // About y, so that the projection of x remains direction 1.
            for turn in [0.0, 0.9] {
                let turn = Rotation3::new(Vec3::new(0.0, turn, 0.0));
                let positions: Vec<Vec3> = mesh.nodes.iter().map(|x| turn * x).collect();
                let stress: Vec<[f64; 6]> = (mesh.nodes.iter())
                    .map(|x| force + bending * (x.z - bottom - 0.25))
                    .map(|t| flat(&(turn * t * turn.inverse())))
                    .collect();
                let found = Resultants::new(&mesh, &positions, &stress);
                let near = |found: &[f64], expected: &[f64]| {
                    for (k, (f, e)) in found.iter().zip(expected.iter().cycle()).enumerate() {
                        assert!((f - e).abs() < 1e-12, "{kind:?} {layers} {k}: {f} {e}");
                    }
                };
                near(&found.membrane, &[1.5, -1.0, 0.25]);
                let second = 0.5f64.powi(3) / 12.0;
                near(&found.moment, &[-1.0, 4.0, 0.3].map(|m| m * second));
                near(&found.shear, &[0.35, 0.1]);
            }
        }
    }

    #[test]
    fn directions_on_a_plate_across_x() {
        let [first, second, third] = local_axes(2.0 * Vec3::x()).unwrap();
        assert_eq!((first, second, third), (Vec3::z(), -Vec3::y(), Vec3::x()));
        assert!(local_axes(Vec3::zeros()).is_none());
    }
}
