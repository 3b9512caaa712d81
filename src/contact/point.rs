//! The response of one contact point, wherever its foot lies: on a face, an edge or a vertex of the master.
//!
//! This is the whole of what a contact point asks of its surroundings. It knows neither what the surface is made of nor
//! which nodes move it: bilinear, quadratic and smoothed facets, NURBS patches and rigid bodies enter as a frame, or as
//! a distance vector with the line it ends on, and their degrees of freedom only afterwards, through the rows of
//! [`kernel::assemble_block`].
use super::corner;
use super::kernel::{self, Normal, SlotMatrix, Slots};
use super::kind::TangentForm;
use super::published::{self, Parts};
use super::rigid::Exact;
use covact_geometry::{Frame, Jet};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use num_dual::DualNum;

/// Largest stiffness across the distance from an edge or a vertex, `N / xi3`, as a multiple of the law's own: beyond it
/// nothing is left of the digits of the rest.
const STIFFEST: f64 = 1e4;

/// Where the foot of a contact point lies and what the surface looks like there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointGeometry<D = f64> {
    /// Inside a face. `xi3` is the normal coordinate, negative where the surfaces press (length).
    Face {
        /// Tangents, normal, metric and curvature at the foot.
        frame: Frame<D>,
        /// Normal coordinate (length).
        xi3: D,
    },
    /// On an edge `rho(s)`, which crosses the parameters of its face along `direction` (`rho' = direction_i rho_i`).
    Edge {
        /// `r_s - rho` (length), orthogonal to `rho_s`.
        d: Vector3<D>,
        /// Signed distance, `-|d|` where the surfaces press (length); not zero.
        xi3: D,
        /// Components of the direction along the edge in the parameters of the face.
        direction: [D; 2],
        /// First derivative of the edge along `direction`.
        rho_s: Vector3<D>,
        /// Second derivative of the edge along `direction`.
        rho_ss: Vector3<D>,
    },
    /// At a vertex: distance vector and signed distance as on an edge.
    Vertex {
        /// `r_s - rho` (length).
        d: Vector3<D>,
        /// Signed distance, negative where the surfaces press (length).
        xi3: D,
    },
    /// Where the parametrisation has no metric and the surface no curvature (the tip of a cone): only the unit normal is
    /// known. (At the pole of a smooth surface the curvature is that of the ways out of it, and the point one of a face.) The geometric part, smaller than the main part by `xi3 kappa`, is left out of the tangent.
    Pole {
        /// Outward unit normal.
        normal: Vector3<D>,
        /// Normal coordinate (length).
        xi3: D,
    },
}

impl PointGeometry {
    /// The same point after a rigid motion of the master and the slave point, from coordinates of the surface to those
    /// of space.
    pub fn moved(&self, pose: &Isometry3<f64>) -> Self {
        let turn = |v: &Vector3<f64>| pose.rotation * v;
        match self {
            PointGeometry::Face { frame, xi3 } => PointGeometry::Face {
                frame: Frame {
                    rho: pose.transform_point(&Point3::from(frame.rho)).coords,
                    rho_i: frame.rho_i.map(|v| turn(&v)),
                    rho_ij: frame.rho_ij.map(|v| turn(&v)),
                    n: turn(&frame.n),
                    ..*frame
                },
                xi3: *xi3,
            },
            PointGeometry::Edge {
                d,
                xi3,
                direction,
                rho_s,
                rho_ss,
            } => PointGeometry::Edge {
                d: turn(d),
                xi3: *xi3,
                direction: *direction,
                rho_s: turn(rho_s),
                rho_ss: turn(rho_ss),
            },
            PointGeometry::Vertex { d, xi3 } => PointGeometry::Vertex {
                d: turn(d),
                xi3: *xi3,
            },
            PointGeometry::Pole { normal, xi3 } => PointGeometry::Pole {
                normal: turn(normal),
                xi3: *xi3,
            },
        }
    }
}

impl<D: DualNum<f64> + Copy> PointGeometry<D> {
    /// The edge through the face of `jet`, at its point and along `direction` in its parameters.
    pub fn edge(jet: &Jet<D>, direction: [D; 2], d: Vector3<D>, xi3: D) -> Self {
        let [a, b] = direction;
        let [r11, r12, r22] = &jet.rho_ij;
        PointGeometry::Edge {
            d,
            xi3,
            direction,
            rho_s: jet.rho_i[0] * a + jet.rho_i[1] * b,
            rho_ss: r11 * (a * a) + r12 * (a * b * 2.0) + r22 * (b * b),
        }
    }

    /// Normal coordinate (length).
    pub fn xi3(&self) -> D {
        match self {
            PointGeometry::Face { xi3, .. }
            | PointGeometry::Edge { xi3, .. }
            | PointGeometry::Vertex { xi3, .. }
            | PointGeometry::Pole { xi3, .. } => *xi3,
        }
    }

    /// Unit vector along which the traction acts, outward: the normal of a face, `d / xi3` on an edge or a vertex.
    pub fn normal(&self) -> Vector3<D> {
        match self {
            PointGeometry::Face { frame, .. } => frame.n,
            PointGeometry::Edge { d, xi3, .. } | PointGeometry::Vertex { d, xi3 } => {
                d * xi3.recip()
            }
            PointGeometry::Pole { normal, .. } => *normal,
        }
    }

    /// How the unit normal turns as the slave point moves over a master that stands still, `dn/dr_s` (1 / length), symmetric:
    /// `-(A^-1 h a^-1)^ij rho_i x rho_j` on a face; nothing at a pole, where the curvature is not known.
    pub fn turn(&self) -> Matrix3<D> {
        match self {
            PointGeometry::Face { frame, xi3 } => {
                let unit = Normal {
                    n: D::one(),
                    dn: D::zero(),
                };
                kernel::normal_tangent_rigid(frame, *xi3, &unit)
            }
            PointGeometry::Edge {
                d,
                xi3,
                rho_s,
                rho_ss,
                ..
            } => {
                let n = d * xi3.recip();
                corner::edge_tangent(d, rho_s, rho_ss, xi3.recip())
                    - n * n.transpose() * xi3.recip()
            }
            PointGeometry::Vertex { d, xi3 } => {
                let n = d * xi3.recip();
                corner::vertex_tangent(xi3.recip()) - n * n.transpose() * xi3.recip()
            }
            PointGeometry::Pole { .. } => Matrix3::from_element(D::zero()),
        }
    }

    /// Whether the traction has a direction: on an edge or a vertex that of the distance, which is lost where the traction
    /// stays while the distance vanishes (an offset, a multiplier). Always under a plain penalty.
    pub fn directs(&self, normal: &Normal<D>) -> bool {
        match self {
            PointGeometry::Edge { xi3, .. } | PointGeometry::Vertex { xi3, .. } => {
                normal.n.re().abs() <= STIFFEST * (normal.dn.re() * xi3.re()).abs()
            }
            PointGeometry::Face { .. } | PointGeometry::Pole { .. } => true,
        }
    }

    /// Whether the closest point is a strict minimum: `a_ij - xi3 h_ij` positive definite on a face,
    /// `|rho'|^2 > rho'' . d` on an edge. Where it is not, the point lies at or beyond a focal surface of the master.
    pub fn is_minimum(&self) -> bool {
        match self {
            PointGeometry::Face { frame, xi3 } => {
                let [i11, i12, i22] =
                    [0, 1, 2].map(|i| frame.a[i].re() - xi3.re() * frame.h[i].re());
                i11 > 0.0 && i11 * i22 - i12 * i12 > 0.0
            }
            PointGeometry::Edge {
                d, rho_s, rho_ss, ..
            } => corner::curvature(d, rho_s, rho_ss).re() > 0.0,
            PointGeometry::Vertex { .. } | PointGeometry::Pole { .. } => true,
        }
    }
}

/// Which tangent a batch uses at face points: a type, so that the choice is made outside the loop over points.
pub trait FaceTangent: TangentForm {
    /// Tangent of a face point in the nine slots.
    fn face_slots<D: DualNum<f64> + Copy>(
        &self,
        frame: &Frame<D>,
        xi3: D,
        normal: &Normal<D>,
    ) -> SlotMatrix<D>;
}

impl FaceTangent for Exact {
    #[inline]
    fn face_slots<D: DualNum<f64> + Copy>(
        &self,
        frame: &Frame<D>,
        xi3: D,
        normal: &Normal<D>,
    ) -> SlotMatrix<D> {
        kernel::normal_tangent(frame, xi3, normal)
    }
}

impl FaceTangent for Parts {
    #[inline]
    fn face_slots<D: DualNum<f64> + Copy>(
        &self,
        frame: &Frame<D>,
        _xi3: D,
        normal: &Normal<D>,
    ) -> SlotMatrix<D> {
        published::normal_tangent(frame, normal, *self)
    }
}

/// Residual and tangent of a contact point of unit weight in the nine slots of [`kernel`].
///
/// The residual is that of internal forces: `N n` on a face and `N d / xi3` on an edge or a vertex, in slot 0 only. Its
/// derivative with respect to the slots, the foot following as the closest point, is the tangent; `tangent` chooses its
/// form on faces. The two sides balance in force and moment, because the force acts along the line from the foot to the
/// slave point.
#[inline]
pub fn respond<D: DualNum<f64> + Copy, T: FaceTangent>(
    geometry: &PointGeometry<D>,
    normal: &Normal<D>,
    tangent: &T,
) -> (Slots<D>, SlotMatrix<D>) {
    match geometry {
        PointGeometry::Face { frame, xi3 } => (
            kernel::normal_residual(frame, normal),
            tangent.face_slots(frame, *xi3, normal),
        ),
        PointGeometry::Edge {
            d,
            xi3,
            direction,
            rho_s,
            rho_ss,
        } => (
            corner::slots_residual(d, *xi3, normal),
            corner::edge_slots(d, *xi3, direction, rho_s, rho_ss, normal),
        ),
        PointGeometry::Vertex { d, xi3 } => (
            corner::slots_residual(d, *xi3, normal),
            corner::vertex_slots(d, *xi3, normal),
        ),
        PointGeometry::Pole { normal: n, .. } => {
            let g3 = kernel::in_slot(0, n);
            (g3 * normal.n, g3 * g3.transpose() * normal.dn)
        }
    }
}
