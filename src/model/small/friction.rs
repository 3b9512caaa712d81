//! Slip at small displacements: how far a slave point moves along its master.
//!
//! What stands on the master at the foot, as high as the point, moves by `u_m + g_0 dn`, `dn = -rho^i (n . u_m,i)` of a body: slip
//! is `w = u_s - u_m - g_0 dn`, to which the traction is conjugate, so that both sides balance in force and moment. Of
//! a rigid surface it is the motion of the place where the point starts. On edges and vertices of bodies, where the direction of the
//! distance is the normal, `g_0 dn` is left out.
use super::super::master::BodyMaster;
use super::super::motion::SmallMotion;
use super::{SmallPair, SmallPoint, moved, slave_moved};
use crate::contact::points::SlavePoint;
use covact_geometry::{Frame, ShapeRows, Vec3};

/// Adds the arms `g_0 rho^i N_k,i` of the nodes of the face at the foot of a point.
pub(super) fn arms(master: &BodyMaster, at: &SmallPoint, rows: &ShapeRows, out: &mut Vec<Vec3>) {
    let frame = match at.line {
        true => None,
        false => Frame::new(&master.facets.jet(at.hint.patch, at.hint.xi), 1.0),
    };
    let up = frame.map_or([Vec3::zeros(); 2], |frame| frame.rho_up());
    let nodes = master.facets.nodes(at.hint.patch).len();
    let slopes = rows.n_1.iter().zip(&rows.n_2).take(nodes);
    out.extend(slopes.map(|(a, b)| (up[0] * *a + up[1] * *b) * at.gap));
}

impl SmallPair {
    /// Arms of [`Self::master`]; none of a rigid master, or without friction.
    #[inline]
    pub fn arms(&self, point: usize) -> &[Vec3] {
        match (self.starts.get(point..point + 2), self.arms.is_empty()) {
            (Some(range), false) => &self.arms[range[0] as usize..range[1] as usize],
            _ => &[],
        }
    }

    /// Displacement of a point of a pair with friction relative to what stands on the master as high as it (length): slip is
    /// what of it lies in the plane of the normal, and what lies along the normal changes the gap.
    pub fn slip(
        &self,
        point: usize,
        at: &SmallPoint,
        p: &SlavePoint,
        motion: Option<&SmallMotion>,
        u: &[f64],
    ) -> Vec3 {
        let slave = slave_moved(p, u);
        if let Some(motion) = motion {
            return slave - motion.at(&(at.foot + at.normal * at.gap));
        }
        let nodes = self.master(point).iter().zip(self.arms(point));
        nodes.fold(slave, |sum, ((n, w), arm)| {
            let u = moved(*n as usize, u);
            sum - u * *w + arm * at.normal.dot(&u)
        })
    }
}
