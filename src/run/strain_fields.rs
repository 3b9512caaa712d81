//! Fields of a body that are worked out for the output only: principal stresses, principal logarithmic strains, thickness
//! and thinning.
use crate::fem::{shape, shape_derivatives};
use crate::mesh::{ElementKind, Mesh, ThicknessColumns};
use crate::model::BodyModel;
use crate::output::{Field, Place};
use covact_geometry::Vec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// Names of principal values, from the largest to the smallest.
const PRINCIPAL: [&str; 3] = ["max", "mid", "min"];
/// A body is a shell where its mean thickness is at most this part of the diagonal of its box.
const SHELL: f64 = 0.25;

/// Values at the nodes of a body.
pub(super) struct StrainFields {
    stress: Vec<f64>,
    strain: Vec<f64>,
    /// Thickness and thinning; none of a body that is no shell.
    thickness: Option<[Vec<f64>; 2]>,
}

impl StrainFields {
    /// Of a body with these displacements and stresses at its nodes, the latter in the order of
    /// [`crate::output::STRESS_COMPONENTS`].
    pub fn new(mesh: &Mesh, displacement: &[Vec3], stress: &[[f64; 6]]) -> Self {
        let strain = hencky(mesh, displacement);
        StrainFields {
            stress: stress.iter().flat_map(|s| principal(&tensor(s))).collect(),
            strain: strain.iter().flat_map(principal).collect(),
            thickness: thickness(mesh, displacement),
        }
    }

    /// Whether the body is a shell.
    pub fn of_shell(&self) -> bool {
        self.thickness.is_some()
    }

    /// As fields of the output: `principal_stress`, `principal_log_strain`, and of a shell `thickness` and `thinning`.
    pub fn fields(&self) -> impl Iterator<Item = Field<'_>> {
        let three = |name, data| Field {
            name,
            components: 3,
            component_names: &PRINCIPAL,
            data,
            place: Place::Point,
        };
        let shell = self.thickness.iter().flat_map(|[now, thinning]| {
            [
                Field::point("thickness", now),
                Field::point("thinning", thinning),
            ]
        });
        [
            three("principal_stress", &self.stress[..]),
            three("principal_log_strain", &self.strain[..]),
        ]
        .into_iter()
        .chain(shell)
    }
}

fn tensor([xx, yy, zz, xy, yz, xz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz)
}

/// Principal values, the largest first; NaN where the tensor is not finite.
fn principal(tensor: &Matrix3<f64>) -> [f64; 3] {
    if !tensor.iter().all(|v| v.is_finite()) {
        return [f64::NAN; 3];
    }
    let mut values: [f64; 3] = tensor.symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// The principal logarithmic strain of the largest magnitude at the nodes; 0 where there is none.
pub(super) fn largest_strain(mesh: &Mesh, displacement: &[Vec3]) -> f64 {
    let all = hencky(mesh, displacement);
    let finite = all.iter().flat_map(principal).filter(|s| s.is_finite());
    finite.fold(
        0.0,
        |most: f64, s| if s.abs() > most.abs() { s } else { most },
    )
}

/// Logarithmic strain `ln U` at the nodes, of the displacements: per element where it is most accurate above and below the
/// node (of linear elements the middle of the upper or lower face, of quadratic ones the Gauss points next to the node),
/// averaged between elements by volume. NaN at nodes of no element.
fn hencky(mesh: &Mesh, displacement: &[Vec3]) -> Vec<Matrix3<f64>> {
    let n = mesh.nodes.len();
    let mut sum = vec![Matrix3::zeros(); n];
    let mut weight = vec![0.0; n];
    let gauss = 1.0 / 3f64.sqrt();
    // Where to look along a direction of the plane, by the node's place there.
    let places: &[&[f64]] = match mesh.kind {
        ElementKind::H8 => &[&[0.0], &[0.0]],
        ElementKind::Q18 => &[&[-gauss], &[-gauss, gauss], &[gauss]],
        // Its output is on a mesh of its own.
        ElementKind::Nurbs => return vec![Matrix3::repeat(f64::NAN); n],
    };
    let side = places.len();
    for e in 0..mesh.elements() {
        let nodes = mesh.element(e);
        for (k, &node) in nodes.iter().enumerate() {
            let t = if k < side * side { -1.0 } else { 1.0 };
            for (&r, &s) in (places[k % side].iter())
                .flat_map(|r| places[k / side % side].iter().map(move |s| (r, s)))
            {
                let Some((strain, volume)) = strain_at(mesh, displacement, nodes, [r, s, t]) else {
                    continue;
                };
                sum[node as usize] += strain * volume;
                weight[node as usize] += volume;
            }
        }
    }
    for (s, w) in sum.iter_mut().zip(weight) {
        *s /= w;
    }
    sum
}

/// Logarithmic strain at a place in an element, and the ratio of volumes there; none where the element is inverted.
fn strain_at(
    mesh: &Mesh,
    displacement: &[Vec3],
    nodes: &[u32],
    at: [f64; 3],
) -> Option<(Matrix3<f64>, f64)> {
    let (mut from, mut to) = (Matrix3::zeros(), Matrix3::zeros());
    for (gradient, &node) in shape_gradients(mesh.kind, at).zip(nodes) {
        let gradient = gradient.transpose();
        let x = mesh.nodes[node as usize];
        from += x * gradient;
        to += (x + displacement[node as usize]) * gradient;
    }
    let volume = from.determinant();
    let gradient = to * from.try_inverse()?;
    let mut eigen = SymmetricEigen::new(gradient.transpose() * gradient);
    eigen.eigenvalues.apply(|c| *c = 0.5 * c.ln());
    let strain = eigen.recompose();
    (volume > 0.0 && strain.iter().all(|v| v.is_finite())).then_some((strain, volume))
}

/// Derivatives of the shape functions of an element along r, s and t, in the order of its nodes: the functions of its bottom
/// in r and s, linear in t.
fn shape_gradients(kind: ElementKind, [r, s, t]: [f64; 3]) -> impl Iterator<Item = Vec3> {
    let side = match kind {
        ElementKind::H8 => 2,
        ElementKind::Q18 | ElementKind::Nurbs => 3,
    };
    let n = shape([side; 2], r, s);
    let [along_r, along_s] = shape_derivatives([side; 2], r, s);
    [-0.5, 0.5].into_iter().flat_map(move |slope| {
        let through = 0.5 + slope * t;
        (0..usize::from(side * side))
            .map(move |a| Vec3::new(along_r[a] * through, along_s[a] * through, n[a] * slope))
    })
}

/// Distance between the ends of the column through each node, and the part of it that is lost (negative where a shell
/// thickens). NaN at nodes of no column.
fn thickness(mesh: &Mesh, displacement: &[Vec3]) -> Option<[Vec<f64>; 2]> {
    let columns = ThicknessColumns::new(mesh);
    let ends: Vec<Option<[usize; 2]>> = (0..mesh.nodes.len() as u32)
        .map(|node| columns.ends(node).map(|ends| ends.map(|n| n as usize)))
        .collect();
    let before = |[a, b]: [usize; 2]| (mesh.nodes[b] - mesh.nodes[a]).norm();
    let now = |[a, b]: [usize; 2]| {
        (mesh.nodes[b] + displacement[b] - mesh.nodes[a] - displacement[a]).norm()
    };
    let all = || ends.iter().flatten();
    let mean = all().map(|e| before(*e)).sum::<f64>() / all().count() as f64;
    if !is_thin(mesh, mean) {
        return None;
    }
    let of = |f: &dyn Fn([usize; 2]) -> f64| -> Vec<f64> {
        ends.iter().map(|e| e.map_or(f64::NAN, f)).collect()
    };
    Some([of(&now), of(&|e| 1.0 - now(e) / before(e))])
}

/// Whether a body of this mean thickness is a shell; it is NaN where there is no column.
fn is_thin(mesh: &Mesh, mean: f64) -> bool {
    let (low, high) = mesh.nodes.iter().fold(
        (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
        |(low, high), x| (low.inf(x), high.sup(x)),
    );
    mean <= SHELL * (high - low).norm()
}

/// Whether a body is a shell: [`StrainFields::of_shell`] before there are any fields.
pub(super) fn is_shell(body: &BodyModel) -> bool {
    if let Some(sheet) = body.block.sheet() {
        return is_thin(&body.mesh, sheet.thickness);
    }
    let still = vec![Vec3::zeros(); body.mesh.nodes.len()];
    thickness(&body.mesh, &still).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::plate;
    use crate::scene::{Plate, Spacing};
    use nalgebra::Rotation3;

    fn a_plate(thickness: f64, kind: ElementKind) -> Mesh {
        let plate_of = Plate {
            size: [8.0, 6.0],
            thickness,
            elements: [2, 2],
            layers: 2,
            origin: [1.0, 2.0, 3.0],
            spacing: [Spacing::default(), Spacing::default()],
        };
        plate(&plate_of, kind).unwrap()
    }

    #[test]
    fn a_stretched_and_turned_plate() {
        let stretch = Matrix3::from_diagonal(&Vec3::new(1.2, 0.9, 0.8));
        let turned = Rotation3::new(Vec3::new(0.4, -1.0, 0.7)).matrix() * stretch;
        for kind in [ElementKind::H8, ElementKind::Q18] {
            let mesh = a_plate(1.0, kind);
            let u: Vec<Vec3> = mesh.nodes.iter().map(|x| turned * x - x).collect();
            let stress = vec![[3.0, 3.0, 5.0, 1.0, 0.0, 0.0]; u.len()];
            let fields = StrainFields::new(&mesh, &u, &stress);
            let by_name = |name: &str| {
                let field = fields.fields().find(|f| f.name == name).expect(name);
                field.data.to_vec()
            };
            for (name, expected) in [
                (
                    "principal_log_strain",
                    vec![1.2f64.ln(), 0.9f64.ln(), 0.8f64.ln()],
                ),
                ("principal_stress", vec![5.0, 4.0, 2.0]),
                ("thickness", vec![0.8]),
                ("thinning", vec![0.2]),
            ] {
                let found = by_name(name);
                assert_eq!(found.len(), expected.len() * u.len());
                for (f, e) in found.iter().zip(expected.iter().cycle()) {
                    assert!((f - e).abs() < 1e-12, "{kind:?} {name}: {f} {e}");
                }
            }
        }
    }

    /// Fibres of a plate bent to a cylinder of radius R are stretched by (R + z) / R: of second order in the angle that an
    /// element takes.
    #[test]
    fn a_bent_plate_is_stretched_outside_and_pressed_inside() {
        let mesh = a_plate(1.0, ElementKind::Q18);
        let radius = 20.0;
        let bent = |x: &Vec3| {
            let (sin, cos) = ((x.x - 1.0) / radius).sin_cos();
            let r = radius + x.z - 3.0;
            Vec3::new(1.0 + r * sin, x.y, 3.0 + r * cos - radius)
        };
        let u: Vec<Vec3> = mesh.nodes.iter().map(|x| bent(x) - x).collect();
        let fields = StrainFields::new(&mesh, &u, &vec![[0.0; 6]; u.len()]);
        for (x, strain) in mesh.nodes.iter().zip(fields.strain.chunks_exact(3)) {
            let exact = ((x.z - 3.0) / radius).ln_1p();
            let found = if exact < 0.0 { strain[2] } else { strain[0] };
            assert!((found - exact).abs() < 2e-4, "{found} {exact}");
        }
        let [_, thinning] = fields.thickness.as_ref().unwrap();
        assert!(thinning.iter().all(|t| t.abs() < 1e-12));
    }

    #[test]
    fn a_block_is_no_shell() {
        let mesh = a_plate(7.0, ElementKind::H8);
        let u = vec![Vec3::zeros(); mesh.nodes.len()];
        let fields = StrainFields::new(&mesh, &u, &vec![[0.0; 6]; u.len()]);
        assert!(fields.thickness.is_none());
        assert_eq!(fields.fields().count(), 2);
        assert!(principal(&Matrix3::repeat(f64::NAN))[0].is_nan());
    }
}
