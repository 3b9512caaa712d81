//! Stresses of shells at the bottom, in the middle and at the top of the thickness.
use super::resultants::{each_column, tensor};
use crate::mesh::Mesh;
use crate::output::{Field, Place};
use covact_geometry::Vec3;
use nalgebra::Matrix3;

/// Components in the directions of the mid-surface.
const COMPONENTS: [&str; 6] = ["11", "22", "33", "12", "23", "13"];
/// Names of the fields, from the bottom to the top.
const NAMES: [&str; 3] = ["stress_bottom", "stress_mid", "stress_top"];

/// Cauchy stresses at the bottom, in the middle and at the top of a shell, all nodes of a column the same; NaN at nodes of no
/// column.
pub(super) struct ShellStresses([Vec<f64>; 3]);

impl ShellStresses {
    /// Of a shell with its nodes at these positions and Cauchy stresses at them, in the order of
    /// [`crate::output::STRESS_COMPONENTS`]; `middle` has those in the middle of the layer above each node where it is not the mean
    /// of both faces of the layer. Directions are those of [`super::resultants::Resultants`].
    pub fn new(
        mesh: &Mesh,
        positions: &[Vec3],
        stress: &[[f64; 6]],
        middle: Option<&[[f64; 6]]>,
    ) -> Self {
        let mut out = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![f64::NAN; 6 * stress.len()]);
        each_column(mesh, positions, |column, axes| {
            let (Some(&bottom), Some(&top)) = (column.first(), column.last()) else {
                return;
            };
            let mid = middle_of(column, &axes[2], positions, stress, middle);
            let all = [tensor(&stress[bottom]), mid, tensor(&stress[top])];
            for (out, stress) in out.iter_mut().zip(all) {
                let of = |i: usize, j: usize| axes[i].dot(&(stress * axes[j]));
                let local = [of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(1, 2), of(0, 2)];
                for node in column {
                    out[6 * node..][..6].copy_from_slice(&local);
                }
            }
        });
        ShellStresses(out)
    }

    /// As fields of the output.
    pub fn fields(&self) -> impl Iterator<Item = Field<'_>> {
        NAMES.into_iter().zip(&self.0).map(|(name, data)| Field {
            name,
            components: COMPONENTS.len(),
            component_names: &COMPONENTS,
            data,
            place: Place::Point,
        })
    }
}

/// The stress halfway between both ends of a column, linear between the faces and the middle of the layer that is there.
fn middle_of(
    column: &[usize],
    normal: &Vec3,
    positions: &[Vec3],
    stress: &[[f64; 6]],
    middle: Option<&[[f64; 6]]>,
) -> Matrix3<f64> {
    let height = |node: usize| positions[node].dot(normal);
    let ends = [column[0], column[column.len() - 1]].map(height);
    let half = 0.5 * (ends[0] + ends[1]);
    let layer = column.windows(2).find(|pair| height(pair[1]) >= half);
    let Some(&[below, above]) = layer else {
        return Matrix3::repeat(f64::NAN);
    };
    let (low, high) = (height(below), height(above));
    // From -1 at the lower face of the layer to 1 at the upper one.
    let place = if high > low {
        (2.0 * half - low - high) / (high - low)
    } else {
        0.0
    };
    let [lower, upper] = [below, above].map(|node| tensor(&stress[node]));
    let centre = match middle {
        Some(middle) => tensor(&middle[below]),
        None => 0.5 * (lower + upper),
    };
    let face = if place < 0.0 { lower } else { upper };
    centre + (face - centre) * place.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ElementKind, plate};
    use crate::scene::{Plate, Spacing};
    use nalgebra::Rotation3;

    /// A membrane stress and one that is linear in z, on a plate that is turned: each face has its own, the middle the first alone,
    /// whether a node lies there (two layers) or none does.
    #[test]
    fn of_a_linear_stress() {
        let membrane = Matrix3::new(3.0, 0.5, 0.7, 0.5, -2.0, 0.2, 0.7, 0.2, 0.1);
        let bending = Matrix3::new(-1.0, 0.3, 0.0, 0.3, 4.0, 0.0, 0.0, 0.0, 0.0);
        for (kind, layers) in [
            (ElementKind::H8, 1),
            (ElementKind::H8, 2),
            (ElementKind::H8, 3),
            (ElementKind::Q18, 1),
        ] {
            let plate_of = Plate {
                size: [8.0, 6.0],
                thickness: 0.5,
                elements: [2, 3],
                layers,
                origin: [1.0, 2.0, 3.0],
                spacing: [Spacing::default(), Spacing::default()],
            };
            let mesh = plate(&plate_of, kind).unwrap();
            let bottom = mesh.nodes.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
            let turn = Rotation3::new(Vec3::new(0.0, 0.9, 0.0));
            let positions: Vec<Vec3> = mesh.nodes.iter().map(|x| turn * x).collect();
            let stress: Vec<[f64; 6]> = (mesh.nodes.iter())
                .map(|x| turn * (membrane + bending * (x.z - bottom - 0.25)) * turn.inverse())
                .map(|t| [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|k| t[k]))
                .collect();
            let found = ShellStresses::new(&mesh, &positions, &stress, None);
            for (field, z) in found.fields().zip([-0.25, 0.0, 0.25]) {
                let t = membrane + bending * z;
                let expected = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|k| t[k]);
                for (f, e) in field.data.iter().zip(expected.iter().cycle()) {
                    assert!(
                        (f - e).abs() < 1e-12,
                        "{kind:?} {layers} {}: {f} {e}",
                        field.name
                    );
                }
            }
        }
    }

    /// Where a layer has a stress of its own in its middle, that is taken there.
    #[test]
    fn of_layers_with_points_of_their_own() {
        let plate_of = Plate {
            size: [8.0, 6.0],
            thickness: 0.5,
            elements: [2, 3],
            layers: 1,
            origin: [0.0; 3],
            spacing: [Spacing::default(), Spacing::default()],
        };
        let mesh = plate(&plate_of, ElementKind::H8).unwrap();
        let stress = vec![[1.0; 6]; mesh.nodes.len()];
        let middle = vec![[7.0; 6]; mesh.nodes.len()];
        let found = ShellStresses::new(&mesh, &mesh.nodes, &stress, Some(&middle));
        for (field, expected) in found.fields().zip([1.0, 7.0, 1.0]) {
            assert!(field.data.iter().all(|v| (v - expected).abs() < 1e-12));
        }
    }
}
