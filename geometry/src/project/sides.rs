//! Which side of every component is the outside.

use super::integrate;
use super::set::{PatchSet, PatchSetError};
use super::{EdgeKind, Foot, Location};
use crate::surface::{Surface, Vec3};

/// How the side of a component was decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SideOutcome {
    /// The points said so.
    Decided {
        /// Points that voted.
        votes: usize,
        /// Points whose foot lies on the component but that did not vote: on a free border, far away in comparison with
        /// others, or on the surface.
        ignored: usize,
    },
    /// No point could vote; the side stays as it was.
    Undecided {
        /// Points whose foot lies on the component.
        ignored: usize,
    },
    /// The component has one side only, so there is nothing to decide.
    OneSided,
}

/// The side of one connected component.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentSide {
    /// Number of the component.
    pub component: usize,
    /// Side of its first patch: +1 where `rho_1 x rho_2` points out; 0 where the component has one side only.
    pub side: f64,
    /// How it was decided.
    pub outcome: SideOutcome,
}

/// Why sides could not be chosen.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SideError {
    /// Points lie on both sides of a component.
    #[error(
        "points lie on both sides of patch {patch}: {front} in front of and {back} behind the connected \
         patches {patches:?} (front: the side of rho_1 x rho_2 of patch {})", patches[0]
    )]
    BothSides {
        /// The patch that the nearest point of the minority projects to.
        patch: usize,
        /// Number of points in front of the component.
        front: usize,
        /// Number of points behind it.
        back: usize,
        /// Patches of the component.
        patches: Vec<usize>,
    },
}

/// Components whose bulge is less than this are flat.
const FLAT: f64 = 1e-6;
/// Points nearer than this fraction of the size lie on the surface and have no side.
const ON_SURFACE: f64 = 1e-9;
/// Points vote if they are no farther away than this multiple of the nearest one's distance ...
const FAR: f64 = 3.0;
/// ... or than this fraction of the size of the set.
const NEAR: f64 = 0.05;

impl<S: Surface> PatchSet<S> {
    /// Side of every patch: +1 where `rho_1 x rho_2` points out of the master, -1 where it points in, 0 where the component
    /// has one side only.
    pub fn sides(&self) -> &[f64] {
        &self.sides
    }

    /// Checks that every component has two sides, as contact needs them.
    ///
    /// # Errors
    /// [`PatchSetError::NotOrientable`] with the patches of the first component that has one side only.
    pub fn two_sided(&self) -> Result<(), PatchSetError> {
        let components = (self.topology.one_sided.iter()).zip(&self.topology.components);
        for (one_sided, members) in components {
            if let &Some([a, b]) = one_sided {
                return Err(PatchSetError::NotOrientable(a, b, members.clone()));
            }
        }
        Ok(())
    }

    /// Patches of every connected component.
    pub fn components(&self) -> &[Vec<usize>] {
        &self.topology.components
    }

    /// Volume that every connected component encloses, by quadrature; `None` for one with free edges (or folded onto
    /// itself, without volume). The sign is that of its [`sides`](Self::sides), whichever way the patches are parametrised:
    /// positive where its normals point out of what it encloses, negative where they point into it. Closed components
    /// start positive; a cavity inside another component is turned over with [`turn_cavities`](Self::turn_cavities), so
    /// that the volumes of a body's components add up to that of its material.
    pub fn volumes(&self) -> &[Option<f64>] {
        &self.topology.volumes
    }

    /// Gives the first patch of every component the side of its own parametrisation, or the other one if `reversed`; the
    /// rest of the component follows. A component with one side only keeps side 0.
    pub fn set_side_as_given(&mut self, reversed: bool) {
        for component in 0..self.topology.components.len() {
            self.set_component_side(component, if reversed { -1.0 } else { 1.0 });
        }
    }

    /// Sets the side of a component's first patch (the sign of `side`); the others follow. Numbers past the last
    /// component are ignored.
    pub fn set_component_side(&mut self, component: usize, side: f64) {
        let Some(members) = self.topology.components.get(component) else {
            return;
        };
        let wanted = if side < 0.0 { -1.0 } else { 1.0 };
        let factor = wanted * self.sides[members[0]];
        for &patch in members {
            self.sides[patch] *= factor;
        }
        if factor < 0.0
            && let Some(volume) = &mut self.topology.volumes[component]
        {
            *volume = -*volume;
        }
    }

    /// Turns closed components that lie within an odd number of others over, so that the normals of a cavity point into it;
    /// how many. Only components whose first patches have the same `body` are held against each other.
    pub fn turn_cavities<B: PartialEq>(&mut self, body: impl Fn(usize) -> B) -> usize {
        let closed: Vec<usize> = (0..self.topology.components.len())
            .filter(|&c| self.topology.volumes[c].is_some())
            .collect();
        let first = |c: usize| self.topology.components[c][0];
        let turned: Vec<usize> = closed
            .iter()
            .copied()
            .filter(|&own| {
                let alike = |c: usize| c != own && body(first(c)) == body(first(own));
                let others: Vec<usize> = closed.iter().copied().filter(|&c| alike(c)).collect();
                !others.is_empty() && self.depth(own, &others) % 2 == 1
            })
            .collect();
        for &component in &turned {
            let side = -self.sides[self.topology.components[component][0]];
            self.set_component_side(component, side);
        }
        turned.len()
    }

    /// How many of the `others` enclose a component, by where rays from points of it leave them; 0 where no ray tells.
    fn depth(&self, component: usize, others: &[usize]) -> usize {
        let of = |patch: u32| self.topology.component_of[patch as usize];
        let members = &self.topology.components[component];
        for (k, &patch) in members.iter().cycle().take(16).enumerate() {
            let edges = self.topology.of(patch as u32);
            let Some(sample) = edges.iter().flat_map(|e| &e.samples).nth(k / members.len()) else {
                continue;
            };
            let t = k as f64;
            let direction = Vec3::new(
                (1.3 * t + 0.3).cos(),
                (2.1 * t + 0.7).sin(),
                0.377 + 0.1 * t,
            );
            let Ok(hits) = self.hits(&sample.point, &direction, f64::INFINITY) else {
                continue;
            };
            if hits.iter().any(|h| h.grazing) {
                continue;
            }
            let crossed = |c: usize| hits.iter().filter(|h| of(h.patch) == c).count();
            return others.iter().filter(|&&c| crossed(c) % 2 == 1).count();
        }
        0
    }

    /// Points every component away from what it encloses or, where it has free edges, curves around (`inward`: towards it).
    /// A component with one side only keeps side 0.
    ///
    /// What a component curves around is told by the flux of the position, from the centre of its area, through it.
    ///
    /// # Errors
    /// The first component that curves around nothing, as a plane does. No side is changed then.
    pub fn set_sides_outward(&mut self, inward: bool) -> Result<(), usize> {
        let count = self.topology.components.len();
        let mut sides = Vec::with_capacity(count);
        for component in 0..count {
            if self.topology.one_sided[component].is_some() {
                sides.push(0.0);
                continue;
            }
            let bulge = self.bulge(component);
            if bulge.abs() < FLAT {
                return Err(component);
            }
            sides.push(if (bulge < 0.0) != inward { -1.0 } else { 1.0 });
        }
        for (component, side) in sides.into_iter().enumerate() {
            if side != 0.0 {
                self.set_component_side(component, side);
            }
        }
        Ok(())
    }

    /// Flux of the position through a component, from the centre of its area and along `rho_1 x rho_2` of its first patch,
    /// over the same with distances: from -1 to 1, 1 for a sphere with its normals outward.
    fn bulge(&self, component: usize) -> f64 {
        let members = &self.topology.components[component];
        let edges = |patch: usize| self.topology.of(patch as u32);
        let mut moments = [0.0; 4];
        for &patch in members {
            let of = integrate::over(self, patch as u32, edges(patch), |jet| {
                let area = jet.rho_i[0].cross(&jet.rho_i[1]).norm();
                let x = jet.rho;
                [area, x.x * area, x.y * area, x.z * area]
            });
            (0..4).for_each(|i| moments[i] += of[i]);
        }
        let center = Vec3::new(moments[1], moments[2], moments[3]) / moments[0];
        let mut sums = [0.0; 2];
        for &patch in members {
            let [flux, distance] = integrate::over(self, patch as u32, edges(patch), |jet| {
                let area = jet.rho_i[0].cross(&jet.rho_i[1]);
                let way = jet.rho - center;
                [way.dot(&area), way.norm() * area.norm()]
            });
            // The side of a patch relative to that of the first.
            sums[0] += flux * self.sides[patch] * self.sides[members[0]];
            sums[1] += distance;
        }
        sums[0] / sums[1]
    }

    /// Chooses the side of every component so that the points (where the slave starts) lie outside.
    ///
    /// Every point votes for the component that holds its closest point. Points do not vote if their foot lies on a free
    /// border, a pole or a free corner (they are beside the surface rather than above it), if they are within 1e-9 of
    /// the size of the surface, or if they are farther away than both three times the distance of the nearest voter of
    /// the component and 5 % of the size of the set.
    ///
    /// # Errors
    /// [`SideError::BothSides`] where voters of a component contradict each other. No side is changed then.
    pub fn orient_towards(&mut self, points: &[Vec3]) -> Result<Vec<ComponentSide>, SideError> {
        let count = self.topology.components.len();
        let mut votes: Vec<Vec<(f64, usize, bool)>> = vec![Vec::new(); count];
        let mut ignored = vec![0; count];
        let mut hint = None;
        for point in points {
            let Some(foot) = self.project(point, hint, f64::INFINITY) else {
                continue;
            };
            hint = Some(foot.hint());
            let component = self.topology.component_of[foot.patch as usize];
            if self.topology.one_sided[component].is_some() {
                continue;
            }
            if beside(&foot) || foot.signed_distance.abs() <= ON_SURFACE * self.size {
                ignored[component] += 1;
                continue;
            }
            // In front of the component's first patch as it is given.
            let first = self.topology.components[component][0];
            let front = foot.signed_distance * self.sides[first] > 0.0;
            votes[component].push((foot.distance, foot.patch as usize, front));
        }
        let mut out = Vec::with_capacity(count);
        for (component, (votes, mut ignored)) in votes.iter_mut().zip(ignored).enumerate() {
            let nearest = votes.iter().map(|v| v.0).fold(f64::INFINITY, f64::min);
            let limit = (FAR * nearest).max(NEAR * self.size);
            let all = votes.len();
            votes.retain(|v| v.0 <= limit);
            ignored += all - votes.len();
            let front = votes.iter().filter(|v| v.2).count();
            let back = votes.len() - front;
            let members = &self.topology.components[component];
            if front > 0 && back > 0 {
                let minority = front < back;
                let patch = votes
                    .iter()
                    .filter(|v| v.2 == minority)
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .map_or(members[0], |v| v.1);
                return Err(SideError::BothSides {
                    patch,
                    front,
                    back,
                    patches: members.clone(),
                });
            }
            let (side, outcome) = if self.topology.one_sided[component].is_some() {
                (0.0, SideOutcome::OneSided)
            } else if votes.is_empty() {
                (self.sides[members[0]], SideOutcome::Undecided { ignored })
            } else {
                let votes = votes.len();
                (
                    if front > 0 { 1.0 } else { -1.0 },
                    SideOutcome::Decided { votes, ignored },
                )
            };
            out.push(ComponentSide {
                component,
                side,
                outcome,
            });
        }
        for side in &out {
            self.set_component_side(side.component, side.side);
        }
        Ok(out)
    }
}

/// Whether the query of a foot may lie beside the surface rather than above it.
fn beside(foot: &Foot) -> bool {
    matches!(
        foot.location,
        Location::Edge {
            kind: EdgeKind::Free,
            ..
        } | Location::Corner {
            kind: EdgeKind::Free,
            ..
        } | Location::Pole { .. }
    )
}
