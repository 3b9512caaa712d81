//! Rigid surfaces driven by force: the rows of their translation and rotation.
//!
//! A driven surface couples with every slave node of its pairs: a dense border of six rows, which the solver eliminates
//! last. The blocks are summed over the points first and scattered once for each slave node. Friction takes the symmetry
//! from the border and from the surface's own block.
use super::{Assembler, Fault, Totals, put};
use crate::contact::carried::{carried, carried_with_friction};
use crate::contact::law::PairLaw;
use crate::model::driven::{Driven, press, turn};
use crate::model::state::{State, heap};
use crate::model::{Model, SurfaceModel};
use crate::scene::ValueError;
use crate::system::{Pattern, PatternError};
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6};

/// A direction of a driven surface's motion that the contact does not resist as it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnresistedMotion {
    /// Index of the surface in the model.
    pub surface: usize,
    /// Unit direction among its six degrees of freedom.
    pub direction: [f64; 6],
    /// Force along it that nothing balances.
    pub force: f64,
}

/// Sums of one driven surface, and where they go.
pub(super) struct DrivenBlock {
    surface: usize,
    /// Slave nodes of all its pairs.
    nodes: Vec<u32>,
    /// Place of every node of the model in `nodes`, `u32::MAX` for others.
    place: Vec<u32>,
    /// Where the blocks of slave node, translation and rotation go, and those of the surface alone.
    maps: Vec<u32>,
    own_map: Vec<u32>,
    /// Per slave node: blocks of its displacement with translation and spin.
    blocks: Vec<[Matrix3<f64>; 2]>,
    /// With friction, what the blocks below the diagonal have over the transposed ones; else empty.
    below: Vec<[Matrix3<f64>; 2]>,
    pub residual: Vector6<f64>,
    pub tangent: Matrix6<f64>,
    pub active: usize,
    /// Smallest element of the slaves.
    element_size: f64,
}

/// Entries of the map of a three-node and of a two-node element.
const THREE: usize = 6;
const TWO: usize = 3;
/// An eigenvalue of a surface's own stiffness below this part of the largest is none.
const NONE: f64 = 1e-9;
/// Stiffness that stands in for none, as a part of the largest.
const STAND_IN: f64 = 1e-3;
/// Part of an element that a surface moves in one iteration where nothing resists it.
const STRIDE: f64 = 0.25;

/// Groups of nodes that the pattern must couple for driven surfaces.
pub(super) fn groups(model: &Model, extend: impl Fn(&[u32], &mut Vec<u32>)) -> Vec<Vec<u32>> {
    let mut groups = Vec::new();
    for (_, _, driven) in model.driven() {
        groups.push(driven.nodes().to_vec());
    }
    for pair in &model.pairs {
        let surface = pair.rigid_master().map(|s| &model.surfaces[s]);
        if let Some(driven) = surface.and_then(|s| s.driven.as_ref()) {
            for p in &pair.points {
                let mut group = Vec::new();
                extend(&p.nodes[..p.count as usize], &mut group);
                group.extend(driven.nodes());
                groups.push(group);
            }
        }
    }
    groups
}

impl DrivenBlock {
    /// Bytes of heap for each slave node of a surface, and with friction more.
    pub const NODE: usize = size_of::<u32>() * (1 + THREE) + size_of::<[Matrix3<f64>; 2]>();
    pub const BELOW: usize = size_of::<[Matrix3<f64>; 2]>();

    /// Bytes of heap for a surface, beside those of its nodes.
    pub fn whole(model: &Model) -> usize {
        size_of::<DrivenBlock>() + size_of::<u32>() * (model.nodes.len() + TWO)
    }

    /// Bytes of heap that it holds, and those that friction adds.
    pub fn bytes(&self) -> [usize; 2] {
        let DrivenBlock {
            surface: _,
            nodes,
            place,
            maps,
            own_map,
            blocks,
            below,
            residual: _,
            tangent: _,
            active: _,
            element_size: _,
        } = self;
        let own = heap(nodes) + heap(place) + heap(maps) + heap(own_map) + heap(blocks);
        [own, heap(below)]
    }

    /// The borders of all driven surfaces.
    pub fn all(model: &Model, pattern: &Pattern) -> Result<Vec<DrivenBlock>, PatternError> {
        // One that stands still, because no contact acts on it, has no rows.
        let free = |driven: &Driven| driven.free().contains(&true);
        let borders: Result<Vec<DrivenBlock>, _> = (model.driven())
            .filter(|(_, _, driven)| free(driven))
            .map(|(surface, _, driven)| DrivenBlock::new(model, surface, driven, pattern))
            .collect();
        let mut borders = borders?;
        borders.shrink_to_fit();
        Ok(borders)
    }

    fn new(
        model: &Model,
        surface: usize,
        driven: &Driven,
        pattern: &Pattern,
    ) -> Result<DrivenBlock, PatternError> {
        let mut place = vec![u32::MAX; model.nodes.len()];
        let mut nodes = Vec::new();
        let mut element_size = f64::INFINITY;
        let mut slides = false;
        for pair in model
            .pairs
            .iter()
            .filter(|p| p.rigid_master() == Some(surface))
        {
            element_size = element_size.min(pair.element_size);
            slides |= pair.friction.is_some();
            for (node, _) in pair.points.iter().flat_map(|p| p.terms()) {
                if place[node] == u32::MAX {
                    place[node] = nodes.len() as u32;
                    nodes.push(node as u32);
                }
            }
        }
        nodes.shrink_to_fit();
        let [t, s] = driven.nodes();
        let mut maps = Vec::with_capacity(THREE * nodes.len());
        for &node in &nodes {
            pattern.element_map(&[node, t, s], &mut maps)?;
        }
        let mut own_map = Vec::new();
        pattern.element_map(&[t, s], &mut own_map)?;
        own_map.shrink_to_fit();
        Ok(DrivenBlock {
            surface,
            blocks: vec![[Matrix3::zeros(); 2]; nodes.len()],
            below: match slides {
                true => vec![[Matrix3::zeros(); 2]; nodes.len()],
                false => Vec::new(),
            },
            nodes,
            place,
            maps,
            own_map,
            residual: Vector6::zeros(),
            tangent: Matrix6::zeros(),
            active: 0,
            element_size,
        })
    }

    /// Number of the surface in the model.
    pub fn surface(&self) -> usize {
        self.surface
    }

    /// Blocks of a slave node's displacement with translation and spin.
    pub fn block(&mut self, node: usize) -> &mut [Matrix3<f64>; 2] {
        &mut self.blocks[self.place[node] as usize]
    }

    /// What the blocks of translation and spin with a slave node's displacement, below the diagonal, have over the transposed
    /// [`Self::block`]; only with friction.
    pub fn below(&mut self, node: usize) -> &mut [Matrix3<f64>; 2] {
        &mut self.below[self.place[node] as usize]
    }

    fn clear(&mut self) {
        self.blocks.fill([Matrix3::zeros(); 2]);
        self.below.fill([Matrix3::zeros(); 2]);
        self.residual = Vector6::zeros();
        self.tangent = Matrix6::zeros();
        self.active = 0;
    }
}

impl<L: PairLaw> Assembler<'_, L> {
    /// Forgets the sums of the last evaluation.
    pub(super) fn clear_borders(&mut self) {
        self.borders.iter_mut().for_each(DrivenBlock::clear);
    }

    /// Adds what the points of pair `index`, evaluated just now, do to the driven surface they touch.
    pub(super) fn carry<const TANGENT: bool>(
        &mut self,
        index: usize,
        u: &[f64],
        time: f64,
    ) -> Result<(), ValueError> {
        let pair = &self.model.pairs[index];
        let Some(surface) = pair.rigid_master() else {
            return Ok(());
        };
        let slides = pair.friction.is_some();
        let center = self.model.surfaces[surface].center(time, u)?;
        let Some(border) = (self.borders.iter_mut()).find(|b| b.surface == surface) else {
            return Ok(());
        };
        for (p, touch) in pair.points.iter().zip(&self.touches) {
            let Ok(Some(touch)) = touch else { continue };
            border.active += 1;
            let (r, k) = (touch.residual * p.area, touch.tangent * p.area);
            let arm = self.model.point_position(p, u) - center;
            let c = match slides {
                true => carried_with_friction(&r, &k, &arm),
                false => carried(&r, &k, &arm),
            };
            press::add(&mut border.residual, &-r, &c.spin);
            if TANGENT {
                press::add_tangent(&mut border.tangent, &k, &c);
                for (node, w) in p.terms() {
                    let at = border.place[node] as usize;
                    let [translation, spin] = &mut border.blocks[at];
                    *translation -= k * w;
                    *spin += c.point_spin * w;
                    if slides {
                        let [translation, spin] = &mut border.below[at];
                        *translation -= (k - k.transpose()) * w;
                        *spin += (c.spin_point - c.point_spin.transpose()) * w;
                    }
                }
            }
        }
        Ok(())
    }

    /// Brings the sums of all pairs into the system.
    pub(super) fn close_borders<const TANGENT: bool>(
        &mut self,
        (u, time): (&[f64], f64),
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<(), Fault> {
        for border in &mut self.borders {
            let surface = &self.model.surfaces[border.surface];
            let Some(driven) = &surface.driven else {
                continue;
            };
            // One that nothing drives rests where it is.
            if border.active == 0 && !driven.idle(time, u)? {
                return Err(Fault::untouched(self.model, border.surface, driven));
            }
            let (_, theta) = driven.motion(u);
            let (r, k) = match border.below.is_empty() {
                true => press::in_rotation_vector,
                false => press::in_rotation_vector_with_friction,
            }(&border.residual, &border.tangent, &theta, driven.lever);
            border.residual = r;
            let at = driven.dof(0);
            for c in 0..6 {
                residual[at + c] += r[c];
                self.contact[at + c] += r[c];
            }
            if !TANGENT {
                continue;
            }
            border.tangent = k;
            let free = driven.free();
            let spin = turn::spin_of(&theta) / driven.lever;
            let [t, s] = driven.nodes();
            for (i, &node) in border.nodes.iter().enumerate() {
                let [translation, by_spin] = &border.blocks[i];
                let by_vector = by_spin * spin;
                let mut ke = [0.0; 81];
                let mut over = [Matrix3::zeros(); 2];
                if let Some([translation, spin_over]) = border.below.get(i) {
                    over = [*translation, spin.tr_mul(spin_over)];
                }
                for column in 0..6 {
                    for row in 0..3 {
                        let value = match column < 3 {
                            true => translation[(row, column)],
                            false => by_vector[(row, column - 3)],
                        };
                        if free[column] {
                            ke[9 * (3 + column) + row] = value;
                        }
                        // The row is kept where prescribed displacements of the slave are still to come.
                        let below = value + over[column / 3][(column % 3, row)];
                        ke[9 * row + 3 + column] = if free[column] { below } else { 0.0 };
                    }
                }
                let map = &border.maps[THREE * i..THREE * (i + 1)];
                if self.dofs.constrains(&[node]) {
                    put(
                        &mut self.matrix,
                        self.dofs,
                        &mut self.work,
                        &[node, t, s],
                        map,
                        &mut ke,
                        increments,
                        rhs,
                    );
                } else {
                    self.matrix.scatter(map, &ke);
                }
            }
        }
        Ok(())
    }

    /// Driving forces, as external ones.
    pub(super) fn driving(&mut self, state: &State, time: f64) -> Result<(), ValueError> {
        for (_, _, driven) in self.model.driven() {
            let at = driven.dof(0);
            for (c, f) in driven.driving(time, &state.u)?.into_iter().enumerate() {
                self.external[at + c] += f;
            }
        }
        Ok(())
    }

    /// Scatters the surfaces' own blocks, with a stand-in where the contact resists a motion not at all: without it a
    /// ball that may spin would make the system singular. Forces along such a motion move the surface by a fraction of
    /// an element in each iteration, until something resists or the iterations run out; where there are none, the
    /// surface is held. The residual is untouched, and with it the solution.
    pub(super) fn own_blocks(
        &mut self,
        u: &[f64],
        time: f64,
        residual: &[f64],
        totals: &mut Totals,
    ) -> Result<(), Fault> {
        for border in &self.borders {
            let Some(driven) = &self.model.surfaces[border.surface].driven else {
                continue;
            };
            let free = driven.free();
            let (_, theta) = driven.motion(u);
            let (_, moment) = driven.given(time)?;
            let lever = driven.lever;
            // A given moment of fixed direction is not conservative: the symmetric part of its stiffness.
            let slope = turn::moment_slope(&theta, &moment) / (lever * lever);
            let mut k = border.tangent;
            let mut block = k.fixed_view_mut::<3, 3>(3, 3);
            block -= match border.below.is_empty() {
                true => (slope + slope.transpose()) * 0.5,
                false => slope,
            };
            let k = Matrix6::from_fn(|i, j| if free[i] && free[j] { k[(i, j)] } else { 0.0 });
            let mut own = k;
            let (values, vectors) = resistances(&k, border.below.is_empty());
            let largest = values.amax();
            for i in 0..6 {
                let (value, v) = (values[i], vectors.column(i));
                let held = (0..6).all(|c| free[c] || v[c].abs() < 1e-6);
                if value > NONE * largest || !held {
                    continue;
                }
                // One that rests and touches nothing has no force at all: any stiffness will do.
                if border.active == 0 {
                    own += v * v.transpose();
                    continue;
                }
                let force: f64 = (0..6).map(|c| residual[driven.dof(c)] * v[c]).sum();
                let stiffness =
                    (STAND_IN * largest).max(force.abs() / (STRIDE * border.element_size));
                own += v * v.transpose() * (stiffness - value);
                totals.loose.push(UnresistedMotion {
                    surface: border.surface,
                    direction: std::array::from_fn(|c| v[c]),
                    force: -force,
                });
            }
            let masked =
                Matrix6::from_fn(|i, j| if free[i] && free[j] { own[(i, j)] } else { 0.0 });
            self.matrix.scatter(&border.own_map, masked.as_slice());
        }
        Ok(())
    }

    /// What a linear system that cannot be solved says of driven surfaces: the degree of freedom is one of theirs, and
    /// in which direction they are not held.
    pub fn unheld(&self, dof: usize) -> Option<Fault> {
        let (_, surface, driven) =
            (self.model.driven()).find(|(_, _, d)| (d.dof(0)..d.dof(6)).contains(&dof))?;
        let mut direction = [0.0; 6];
        direction[dof - driven.dof(0)] = 1.0;
        Some(Fault::unresisted(surface, driven, &direction))
    }

    /// The fault of a run that forces drive on and on, where one of `loose` is more than rounding.
    pub fn runs_away(&self, loose: &[UnresistedMotion], force: f64) -> Option<Fault> {
        let worst = loose
            .iter()
            .max_by(|a, b| a.force.abs().total_cmp(&b.force.abs()))?;
        if worst.force.abs() <= force {
            return None;
        }
        let surface = &self.model.surfaces[worst.surface];
        let driven = surface.driven.as_ref()?;
        Some(Fault::unresisted(surface, driven, &worst.direction))
    }
}

/// Directions of a surface's motion, and how much stiffness it has along them. Without symmetry these are the singular
/// values: the symmetric part of a tangent with points that slide has a negative eigenvalue along every direction in which
/// friction grows with pressure, whereas what is loose moves without any force.
fn resistances(k: &Matrix6<f64>, symmetric: bool) -> (Vector6<f64>, Matrix6<f64>) {
    if symmetric {
        let eigen = SymmetricEigen::new(*k);
        return (eigen.eigenvalues, eigen.eigenvectors);
    }
    // Through `K^T K` a singular value would be known to half of the digits only; as its eigenvectors these directions are
    // known well enough, and the stiffness along them follows from them.
    let vectors = SymmetricEigen::new(k.transpose() * k).eigenvectors;
    let values = Vector6::from_fn(|i, _| (k * vectors.column(i)).norm());
    (values, vectors)
}

impl Fault {
    fn untouched(model: &Model, index: usize, driven: &Driven) -> Fault {
        let rubs: Vec<&str> = (model.pairs.iter())
            .filter(|p| p.friction.is_some() && p.rigid_master() == Some(index))
            .map(|p| p.name.as_str())
            .collect();
        Fault::Untouched {
            surface: model.surfaces[index].name.clone(),
            free: driven.words(),
            friction: match rubs.is_empty() {
                true => String::new(),
                false => format!(
                    ". Where friction was to hold it, it was pushed harder than contact `{}` can: the coefficient times the \
                     pressing force",
                    rubs.join("`, `")
                ),
            },
        }
    }

    /// A motion of a driven surface that nothing resists.
    pub fn unresisted(surface: &SurfaceModel, driven: &Driven, direction: &[f64; 6]) -> Fault {
        Fault::Unresisted {
            surface: surface.name.clone(),
            motion: driven.direction_words(direction),
        }
    }
}
