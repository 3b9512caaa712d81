//! Rigid surfaces driven by force: the rows of their translation and rotation.
//!
//! A driven surface couples with every slave node of its pairs: a dense border of six rows, which the solver eliminates
//! last. The blocks are summed over the points first and scattered once for each slave node.
use super::{Assembler, Fault, Totals, put};
use crate::assembly::{Pattern, PatternError};
use crate::model::driven::{Driven, press, turn};
use crate::model::state::State;
use crate::model::{Model, SurfaceModel};
use crate::scene::ValueError;
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector3, Vector6};

/// A direction of a driven surface's motion that the contact does not resist as it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loose {
    /// Index of the surface in the model.
    pub surface: usize,
    /// Unit direction among its six degrees of freedom.
    pub direction: [f64; 6],
    /// Force along it that nothing balances.
    pub force: f64,
}

/// Sums of one driven surface, and where they go.
pub(super) struct Border {
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
    /// With friction, per slave node: blocks of translation and spin with its displacement, transposed. Without it they
    /// are those above, and there are none here.
    rows: Vec<[Matrix3<f64>; 2]>,
    pub residual: Vector6<f64>,
    pub tangent: Matrix6<f64>,
    pub active: usize,
    /// Smallest element of the slaves.
    element_size: f64,
}

/// Entries of the map of a three-node and of a two-node element.
const THREE: usize = 6;
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

impl Border {
    /// The borders of all driven surfaces.
    pub fn all(model: &Model, pattern: &Pattern) -> Result<Vec<Border>, PatternError> {
        (model.driven())
            .map(|(surface, _, driven)| Border::new(model, surface, driven, pattern))
            .collect()
    }

    fn new(
        model: &Model,
        surface: usize,
        driven: &Driven,
        pattern: &Pattern,
    ) -> Result<Border, PatternError> {
        let mut place = vec![u32::MAX; model.nodes.len()];
        let mut nodes = Vec::new();
        let mut element_size = f64::INFINITY;
        let mut friction = false;
        for pair in model
            .pairs
            .iter()
            .filter(|p| p.rigid_master() == Some(surface))
        {
            element_size = element_size.min(pair.element_size);
            friction |= pair.friction.is_some();
            for (node, _) in pair.points.iter().flat_map(|p| p.terms()) {
                if place[node] == u32::MAX {
                    place[node] = nodes.len() as u32;
                    nodes.push(node as u32);
                }
            }
        }
        let [t, s] = driven.nodes();
        let mut maps = Vec::with_capacity(THREE * nodes.len());
        for &node in &nodes {
            pattern.element_map(&[node, t, s], &mut maps)?;
        }
        let mut own_map = Vec::new();
        pattern.element_map(&[t, s], &mut own_map)?;
        Ok(Border {
            surface,
            blocks: vec![[Matrix3::zeros(); 2]; nodes.len()],
            rows: vec![[Matrix3::zeros(); 2]; if friction { nodes.len() } else { 0 }],
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

    /// Blocks of translation and spin with a slave node's displacement, transposed; only with friction.
    pub fn row(&mut self, node: usize) -> Option<&mut [Matrix3<f64>; 2]> {
        self.rows.get_mut(self.place[node] as usize)
    }

    fn clear(&mut self) {
        self.blocks.fill([Matrix3::zeros(); 2]);
        self.rows.fill([Matrix3::zeros(); 2]);
        self.residual = Vector6::zeros();
        self.tangent = Matrix6::zeros();
        self.active = 0;
    }
}

/// Blocks of a slave node with translation and spin by the six degrees of freedom.
fn by_dof([translation, by_spin]: &[Matrix3<f64>; 2], spin: &Matrix3<f64>) -> [Vector3<f64>; 6] {
    let by_vector = by_spin * spin;
    std::array::from_fn(|c| match c {
        0..3 => translation.column(c).into(),
        _ => by_vector.column(c - 3).into(),
    })
}

impl Assembler<'_> {
    /// Forgets the sums of the last evaluation.
    pub(super) fn clear_borders(&mut self) {
        self.borders.iter_mut().for_each(Border::clear);
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
        let center = self.model.surfaces[surface].center(time, u)?;
        let Some(border) = (self.borders.iter_mut()).find(|b| b.surface == surface) else {
            return Ok(());
        };
        for (p, touch) in pair.points.iter().zip(&self.touches) {
            let Ok(Some(touch)) = touch else { continue };
            let (r, k) = (touch.residual * p.area, touch.tangent * p.area);
            let arm = self.model.point_position(p, u) - center;
            border.carry::<TANGENT>(p, &r, &k, &arm);
        }
        Ok(())
    }

    /// Brings the sums of all pairs into the system.
    pub(super) fn close_borders<const TANGENT: bool>(
        &mut self,
        u: &[f64],
        increments: Option<&[f64]>,
        residual: &mut [f64],
        rhs: &mut [f64],
    ) -> Result<(), Fault> {
        for border in &mut self.borders {
            let surface = &self.model.surfaces[border.surface];
            let Some(driven) = &surface.driven else {
                continue;
            };
            if border.active == 0 {
                return Err(Fault::untouched(surface, driven));
            }
            let (_, theta) = driven.motion(u);
            let (r, k) =
                press::in_rotation_vector(&border.residual, &border.tangent, &theta, driven.lever);
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
                let mut ke = [0.0; 81];
                let columns = by_dof(&border.blocks[i], &spin);
                let rows = (border.rows.get(i)).map_or(columns, |row| by_dof(row, &spin));
                for c in (0..6).filter(|c| free[*c]) {
                    for r in 0..3 {
                        ke[9 * (3 + c) + r] = columns[c][r];
                        // The row is kept where prescribed displacements of the slave are still to come.
                        ke[9 * r + 3 + c] = rows[c][r];
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
            block -= (slope + slope.transpose()) * 0.5;
            let k = Matrix6::from_fn(|i, j| if free[i] && free[j] { k[(i, j)] } else { 0.0 });
            let mut own = k;
            let (values, directions) = match border.rows.is_empty() {
                true => {
                    let eigen = SymmetricEigen::new(k);
                    (eigen.eigenvalues, eigen.eigenvectors)
                }
                // With friction `k` has no symmetry: what is not resisted has no image.
                false => {
                    let v = SymmetricEigen::new(k.transpose() * k).eigenvectors;
                    (Vector6::from_fn(|i, _| (k * v.column(i)).norm()), v)
                }
            };
            let largest = values.amax();
            for i in 0..6 {
                let (value, v) = (values[i], directions.column(i));
                let held = (0..6).all(|c| free[c] || v[c].abs() < 1e-6);
                if value > NONE * largest || !held {
                    continue;
                }
                let force: f64 = (0..6).map(|c| residual[driven.dof(c)] * v[c]).sum();
                let stiffness =
                    (STAND_IN * largest).max(force.abs() / (STRIDE * border.element_size));
                own += v * v.transpose() * (stiffness - value);
                totals.loose.push(Loose {
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
    pub fn runs_away(&self, loose: &[Loose], force: f64) -> Option<Fault> {
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

impl Fault {
    fn untouched(surface: &SurfaceModel, driven: &Driven) -> Fault {
        Fault::Untouched {
            surface: surface.name.clone(),
            free: driven.words(),
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
