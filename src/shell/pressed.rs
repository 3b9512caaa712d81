//! The assumed thickness strain of elements that are pressed through their thickness.
//!
//! Sampled at the four edges along the thickness, it knows how long these are, and nothing of how far they lean against each
//! other: bent shells, whose edges turn and keep their length, are not stretched by it (P. Betsch and E. Stein, Commun. Numer. Meth.
//! Eng. 11 (1995)). But the faces between the edges are flat, and come closer where the edges lean: what presses on them does
//! work on that, `p phi^2 / 2`, and only the bending of a single element stands against it, `E (t / h)^2 / 6 phi^2`. From
//! `p_0 = E (t / h)^2 / 3` on, a hundredth of E for elements six times as wide as thick, the element gives way in a zigzag.
//!
//! How far edges lean against each other along r and s is known, and by how much that lowers the faces between them: the height between two
//! edges with directors `d_1` and `d_2` is that of `(d_1 + d_2) / 2`, and
//!
//! `|(d_1 + d_2) / 2|^2 = (|d_1|^2 + |d_2|^2) / 2 - |(d_1 - d_2) / 2|^2`.
//!
//! With the last term taken off, the strain counts the height, and the element does not give way. It then resists bending round few
//! elements, though, where curvature changes from one to the next. So it takes off a share `w` of it along r and along s, as large as
//! what presses on it asks for, which is the mean of the pressures on both faces: `(1 - w) p` stays half of `p_0` with the width of
//! that direction. Only shells that something may press on both faces have shares, and bricks have none: they do not bend, and others
//! stand in where they give way.
//!
//! The shares are no unknowns, so that forces have an energy: a step is solved with those of the last one, and again until they are
//! those of what presses at its end. Shares that followed the strain within a step were tried: where the edges have leant by half a
//! radian, their length says nothing of the pressure any more, and elements went there.
use super::kinematics::{Fields, V, dot};
use super::reference::{Reference, TYING};
use num_dual::DualNum;

/// Part of the pressure under which an element gives way that is left to the edges along its thickness.
const LEFT: f64 = 0.5;
/// Largest share: what is left of the edges holds the edges themselves.
const MOST: f64 = 0.99;

/// Corners on the same side of s, and of r.
const ALONG: [usize; 2] = [1, 2];

/// The shares along r and s of an element with a mean stress of `s33` along its thickness and with Young's modulus `e`.
pub(super) fn shares(re: &Reference, s33: f64, e: f64) -> [f64; 2] {
    let [r, s, t] = Fields::new(&re.nodes).centre();
    let flat = [r, s].map(|wide| dot(&t, &t) / dot(&wide, &wide));
    // All of them for elements that are 1.4 times as wide as thick, and none for bricks.
    let shell = (2.0 * (1.0 - flat[0].max(flat[1]))).clamp(0.0, 1.0);
    flat.map(|flat| {
        let left = LEFT * e * flat / 3.0;
        match -s33 > left {
            true => (1.0 + left / s33).min(MOST) * shell,
            false => 0.0,
        }
    })
}

/// Whether there is any.
#[inline(always)]
pub(super) fn any(shares: [f64; 2]) -> bool {
    shares != [0.0; 2]
}

fn half_difference<D: DualNum<f64> + Copy>(a: &V<D>, b: &V<D>) -> V<D> {
    [0, 1, 2].map(|x| (a[x] - b[x]) * 0.5)
}

/// Thickness strains at the corners with these shares; `edges` are those of the edges, from undeformed directors and the
/// derivatives of the displacements along the thickness.
#[inline(always)]
pub(super) fn shared<D: DualNum<f64> + Copy>(
    shares: [f64; 2],
    edges: [D; 4],
    big: &[V<f64>; 4],
    u: &[V<D>; 4],
) -> [D; 4] {
    let mut all = edges;
    for (c, e) in all.iter_mut().enumerate() {
        for (share, bit) in shares.into_iter().zip(ALONG) {
            let before = half_difference(&big[c], &big[c ^ bit]).map(D::from);
            let moved = half_difference(&u[c], &u[c ^ bit]);
            *e -= (dot(&before, &moved) + dot(&moved, &moved) * 0.5) * share;
        }
    }
    all
}

/// Derivatives of those strains by the directors, `[corner][director]`.
#[inline(always)]
pub(super) fn rows<D: DualNum<f64> + Copy>(shares: [f64; 2], now: &[V<D>; 4]) -> [[V<D>; 4]; 4] {
    let mut rows = [[[D::zero(); 3]; 4]; 4];
    for (c, rows) in rows.iter_mut().enumerate() {
        rows[c] = now[c];
        for (share, bit) in shares.into_iter().zip(ALONG) {
            let lean = half_difference(&now[c], &now[c ^ bit]);
            for x in 0..3 {
                let part = lean[x] * (0.5 * share);
                rows[c][x] -= part;
                rows[c ^ bit][x] += part;
            }
        }
    }
    rows
}

/// Second derivatives of those strains by directors `a` and `b`, times the forces on them: a factor of the unit tensor.
#[inline(always)]
pub(super) fn second(shares: [f64; 2], force: &[f64; TYING], a: usize, b: usize) -> f64 {
    let own = if a == b { force[a] } else { 0.0 };
    let lean = shares.into_iter().zip(ALONG).map(|(share, bit)| {
        let both = 0.25 * share * (force[a] + force[a ^ bit]);
        match (a == b, a == b ^ bit) {
            (true, _) => -both,
            (_, true) => both,
            _ => 0.0,
        }
    });
    own + lean.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::h8::{Formulation, H8Block, H8System};
    use super::super::kinematics::Fields;
    use super::super::material::Law;
    use super::super::tests::mesh;
    use super::*;
    use crate::scene::{Elastic, Material};
    use covact_geometry::Vec3;
    use nalgebra::{SMatrix, SVector};

    /// A flat element of the given thickness on a unit square.
    fn flat(thickness: f64) -> [Vec3; 8] {
        let bit = |a: usize, k: usize| f64::from(u8::from(a >> k & 1 == 1));
        std::array::from_fn(|a| Vec3::new(bit(a, 0), bit(a, 1), thickness * bit(a, 2)))
    }

    fn block(nodes: &[Vec3; 8]) -> H8Block {
        let law = Law::new(&Material::NeoHooke(Elastic {
            e: 5.0,
            nu: 0.3,
            density: None,
        }))
        .unwrap();
        H8Block::new(&mesh(nodes), Formulation::Eas7, law).unwrap()
    }

    /// The edges along the thickness lean against each other along r, as long as before.
    fn bent(nodes: &[Vec3; 8], angle: f64) -> [Vec3; 8] {
        let t = nodes[4].z;
        nodes.map(|x| {
            let turned = (2.0 * x.x - 1.0) * angle;
            let up = x.z - 0.5 * t;
            Vec3::new(up * turned.sin(), 0.0, up * (turned.cos() - 1.0))
        })
    }

    #[test]
    fn the_shares_leave_half_of_what_gives_way() {
        let (re, _) = Reference::new(flat(0.25).map(|x| x.data.0[0]));
        let gives_way = 5.0 / 48.0;
        assert_eq!(shares(&re, 1.0, 5.0), [0.0; 2], "pulled");
        assert_eq!(shares(&re, -0.49 * gives_way, 5.0), [0.0; 2]);
        for times in [0.6, 1.0, 10.0] {
            for share in shares(&re, -times * gives_way, 5.0) {
                let left = (1.0 - share) * times;
                assert!((left - 0.5).abs() < 1e-12, "{left}");
            }
        }
        // Twice as long along r it gives way there at a fourth of that.
        let long = flat(0.25).map(|x| [2.0 * x.x, x.y, x.z]);
        let [along, across] = shares(&Reference::new(long).0, -0.3 * gives_way, 5.0);
        assert!(along > 0.5 && across == 0.0, "{along} {across}");
        let brick = flat(1.0).map(|x| x.data.0[0]);
        assert_eq!(shares(&Reference::new(brick).0, -5.0, 5.0), [0.0; 2]);
    }

    /// Edges that keep their length do not strain an element; the height between its faces is less.
    #[test]
    fn the_shares_know_of_the_height() {
        let nodes = flat(0.25);
        let u = bent(&nodes, 0.3).map(|u| u.data.0[0]);
        let [big, du] = [&nodes.map(|x| x.data.0[0]), &u].map(Fields::new);
        let edges = [0, 1, 2, 3].map(|c| {
            let d = super::super::kinematics::stretch(&big.t[c], &du.t[c]);
            assert!(d.abs() < 1e-15);
            d
        });
        let height = 0.125f64.powi(2) * (0.3f64.cos().powi(2) - 1.0) / 2.0;
        for part in [0.5, 1.0] {
            for e in shared([part, 0.0], edges, &big.t, &du.t) {
                assert!((e - part * height).abs() < 1e-15, "{e} {height}");
            }
            // Along s they do not lean.
            assert_eq!(shared([0.0, part], edges, &big.t, &du.t), edges);
        }
    }

    /// An element that is pressed between its faces is stable with its share, and not without; let go of, it has none.
    #[test]
    fn a_pressed_element_holds() {
        let nodes = flat(0.25);
        let block = block(&nodes);
        let (part, wide) = (0.1f64, 0.9f64.powf(-0.3));
        let u = nodes.map(|x| Vec3::new((wide - 1.0) * x.x, (wide - 1.0) * x.y, -part * x.z));
        let mut state = vec![0.0; block.state_len()];
        assert!(block.loses_hold(0, &u, &state).unwrap());
        let [change, energy] = block.press(0, &u, &mut state).unwrap();
        let last = state.len() - 1;
        assert!(state[last] == change && state[last - 1] == change && change > 0.2);
        // Edges that do not lean have the same strains.
        assert!(energy.abs() < 1e-12, "{energy}");
        assert!(!block.loses_hold(0, &u, &state).unwrap());
        let pulled = u.map(|u| -u);
        block.press(0, &pulled, &mut state).unwrap();
        assert_eq!(state[last], 0.0);
    }

    /// Where nothing may press on one of the faces any more the shares go, and none comes.
    #[test]
    fn shares_go_where_one_face_is_free() {
        let nodes = flat(0.25);
        let mut block = block(&nodes);
        let mut state = vec![0.0; block.state_len()];
        let u = nodes.map(|x| Vec3::new(0.0, 0.0, -0.1 * x.z));
        let [change, _] = block.press(0, &u, &mut state).unwrap();
        assert!(change > 0.1, "{change}");
        block.press_both_faces(false);
        assert_eq!(block.press(0, &u, &mut state).unwrap()[0], change);
        assert_eq!(block.press(0, &u, &mut state).unwrap(), [0.0; 2]);
    }

    /// Rigid motions of an element that is pressed neither strain it nor meet resistance.
    #[test]
    fn rigid_motions_are_free() {
        let nodes = super::super::tests::nodes();
        let block = block(&nodes);
        let turn = nalgebra::Rotation3::from_euler_angles(0.7, -0.4, 1.1);
        let u = nodes.map(|x| turn * x - x + Vec3::new(0.3, 0.1, -2.0));
        let mut state = vec![0.0; block.state_len()];
        let last = state.len() - 2;
        state[last..].copy_from_slice(&[0.6, 0.3]);
        let mut out = H8System::default();
        block.evaluate(0, &u, &mut state, &mut out).unwrap();
        assert!(out.f.iter().all(|f| f.abs() < 1e-12), "{:?}", out.f);
        assert!(out.energy.abs() < 1e-12);
        let k = SMatrix::<f64, 24, 24>::from_column_slice(&out.k);
        let values = k.symmetric_eigenvalues();
        let zero = values.iter().filter(|v| v.abs() < 1e-12 * values.amax());
        assert_eq!(zero.count(), 6, "{values}");
        let now: [Vec3; 8] = std::array::from_fn(|a| nodes[a] + u[a]);
        let spin = SVector::<f64, 24>::from_fn(|dof, _| Vec3::y().cross(&now[dof / 3])[dof % 3]);
        assert!((k * spin).amax() < 1e-12 * k.amax());
    }
}
