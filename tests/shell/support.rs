//! A small serial solver for single-body problems, independent of the program's own.
use covact::mesh::{ElementKind, Mesh};
use covact::scene::{Elastic, Material};
use covact::shell::{Formulation, H8Block, H8System, Law, Q18Block, Q18System};
use covact_geometry::Vec3;
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use std::collections::BTreeMap;

/// Structured mesh: `geometry(a, b, c)` with a, b in [0, 1] and c in [-1, 1] along r, s and t. `nx` and `ny` count
/// intervals of nodes: as many as elements for H8, two per element for Q18.
pub struct Grid {
    pub mesh: Mesh,
    pub nx: usize,
    pub ny: usize,
}

pub fn grid(nx: usize, ny: usize, geometry: impl Fn(f64, f64, f64) -> [f64; 3]) -> Grid {
    grid_of(ElementKind::H8, nx, ny, geometry)
}

/// `nx` x `ny` elements of a kind.
pub fn grid_of(
    kind: ElementKind,
    nx: usize,
    ny: usize,
    geometry: impl Fn(f64, f64, f64) -> [f64; 3],
) -> Grid {
    let p = match kind {
        ElementKind::H8 => 1,
        ElementKind::Q18 => 2,
        ElementKind::Nurbs => unreachable!("these are meshes of solid-shells"),
    };
    let (lines_x, lines_y) = (p * nx, p * ny);
    let mut nodes = vec![];
    for k in 0..2 {
        for j in 0..=lines_y {
            for i in 0..=lines_x {
                let (a, b) = (i as f64 / lines_x as f64, j as f64 / lines_y as f64);
                nodes.push(Vec3::from(geometry(a, b, 2.0 * k as f64 - 1.0)));
            }
        }
    }
    let mut grid = Grid {
        mesh: Mesh {
            kind,
            ..plain(nodes, vec![])
        },
        nx: lines_x,
        ny: lines_y,
    };
    for j in 0..ny {
        for i in 0..nx {
            for a in 0..kind.nodes() {
                let (di, dj, dk) = (a % (p + 1), a / (p + 1) % (p + 1), a / (p + 1) / (p + 1));
                let node = grid.node(p * i + di, p * j + dj, dk);
                grid.mesh.connectivity.push(node as u32);
            }
        }
    }
    grid
}

pub fn plain(nodes: Vec<Vec3>, connectivity: Vec<u32>) -> Mesh {
    Mesh {
        kind: ElementKind::H8,
        nodes,
        connectivity,
        node_sets: Default::default(),
        face_sets: Default::default(),
    }
}

impl Grid {
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (k * (self.ny + 1) + j) * (self.nx + 1) + i
    }

    /// Dofs `axes` of both nodes through the thickness of all grid lines (i, j) that are selected.
    pub fn dofs(&self, axes: &[usize], select: impl Fn(usize, usize) -> bool) -> Vec<usize> {
        let mut dofs = vec![];
        for k in 0..2 {
            for j in 0..=self.ny {
                for i in 0..=self.nx {
                    if select(i, j) {
                        dofs.extend(axes.iter().map(|x| 3 * self.node(i, j, k) + x));
                    }
                }
            }
        }
        dofs
    }

    /// Mean of one displacement component over the thickness.
    pub fn mean(&self, u: &[f64], i: usize, j: usize, axis: usize) -> f64 {
        0.5 * (u[3 * self.node(i, j, 0) + axis] + u[3 * self.node(i, j, 1) + axis])
    }
}

pub fn st_venant(e: f64, nu: f64) -> Law {
    Law::new(&Material::StVenantKirchhoff(Elastic {
        e,
        nu,
        density: None,
    }))
    .unwrap()
}

/// Elements of either kind.
pub enum Block {
    H8(H8Block),
    Q18(Q18Block),
}

/// One body with its state.
pub struct Model {
    pub block: Block,
    pub state: Vec<f64>,
    pub dofs: usize,
    /// The last correction, where integration points are mixed.
    pub last: Option<Vec<f64>>,
}

impl Block {
    fn elements(&self) -> usize {
        match self {
            Block::H8(b) => b.elements(),
            Block::Q18(b) => b.elements(),
        }
    }

    fn state_len(&self) -> usize {
        match self {
            Block::H8(b) => b.state_len(),
            Block::Q18(_) => Q18Block::STATE_LEN,
        }
    }

    pub fn alpha_len(&self) -> usize {
        match self {
            Block::H8(b) => b.alpha_len(),
            Block::Q18(_) => Q18Block::ALPHA_LEN,
        }
    }

    fn nodes_of(&self, e: usize) -> Vec<u32> {
        match self {
            Block::H8(b) => b.nodes_of(e).to_vec(),
            Block::Q18(b) => b.nodes_of(e).to_vec(),
        }
    }

    /// Forces and tangent by columns, with mixed integration points where there is a last correction.
    pub fn evaluate(
        &self,
        e: usize,
        u: &[Vec3],
        last: Option<&[Vec3]>,
        state: &mut [f64],
    ) -> (Vec<f64>, Vec<f64>) {
        match self {
            Block::H8(b) => {
                let mut out = H8System::default();
                let last = last.map(|du| du.try_into().unwrap());
                b.evaluate_mixed(e, u.try_into().unwrap(), last, state, &mut out)
                    .unwrap();
                (out.f.to_vec(), out.k.to_vec())
            }
            Block::Q18(b) => {
                let mut out = Q18System::default();
                let last = last.map(|du| du.try_into().unwrap());
                b.evaluate_mixed(e, u.try_into().unwrap(), last, state, &mut out)
                    .unwrap();
                (out.f.to_vec(), out.k.to_vec())
            }
        }
    }
}

/// Zero displacements on these dofs.
pub fn zeros(dofs: impl IntoIterator<Item = usize>) -> BTreeMap<usize, f64> {
    dofs.into_iter().map(|d| (d, 0.0)).collect()
}

impl Model {
    pub fn new(mesh: &Mesh, formulation: Formulation, law: Law) -> Model {
        Model::of(
            Block::H8(H8Block::new(mesh, formulation, law).unwrap()),
            mesh,
        )
    }

    pub fn q18(mesh: &Mesh, law: Law) -> Model {
        Model::of(Block::Q18(Q18Block::new(mesh, law).unwrap()), mesh)
    }

    fn of(block: Block, mesh: &Mesh) -> Model {
        let state = vec![0.0; block.state_len() * block.elements()];
        Model {
            block,
            state,
            dofs: 3 * mesh.nodes.len(),
            last: None,
        }
    }

    fn local(&self, e: usize, u: &[f64]) -> Vec<Vec3> {
        (self.block.nodes_of(e).iter())
            .map(|&n| Vec3::from_column_slice(&u[3 * n as usize..3 * n as usize + 3]))
            .collect()
    }

    /// Internal forces and tangent triplets.
    pub fn assemble(&mut self, u: &[f64]) -> (Vec<f64>, Vec<(usize, usize, f64)>) {
        let (mut f, mut k) = (vec![0.0; self.dofs], vec![]);
        let n = self.block.state_len();
        for e in 0..self.block.elements() {
            let local = self.local(e, u);
            let last = self.last.as_ref().map(|du| self.local(e, du));
            let state = &mut self.state[n * e..n * (e + 1)];
            let (fe, ke) = self.block.evaluate(e, &local, last.as_deref(), state);
            let nodes = self.block.nodes_of(e);
            let dof = |r: usize| 3 * nodes[r / 3] as usize + r % 3;
            for (c, fc) in fe.iter().enumerate() {
                f[dof(c)] += fc;
                let column = &ke[fe.len() * c..fe.len() * (c + 1)];
                k.extend(column.iter().enumerate().map(|(r, v)| (dof(r), dof(c), *v)));
            }
        }
        (f, k)
    }

    pub fn update_alpha(&mut self, du: &[f64]) {
        let n = self.block.state_len();
        for e in 0..self.block.elements() {
            let local = self.local(e, du);
            let state = &mut self.state[n * e..n * (e + 1)];
            let alpha: Vec<f64> = state[..self.block.alpha_len()].to_vec();
            match &self.block {
                Block::H8(b) => b.update_alpha(state, local[..].try_into().unwrap(), 1.0, &alpha),
                Block::Q18(b) => b.update_alpha(state, local[..].try_into().unwrap(), 1.0, &alpha),
            }
        }
    }

    /// Displacements of the linear problem, per unit of load: the load and the prescribed displacements are made so
    /// small that nothing nonlinear is left, and a few Newton steps remove what round-off in the tangent costs. (In a
    /// thin shell that is eps (L/h)^4 of the displacements; forces computed from strains carry only eps (L/h)^2.)
    pub fn linear(&mut self, load: &[f64], fixed: &BTreeMap<usize, f64>) -> Vec<f64> {
        const SCALE: f64 = 1e-11;
        let load: Vec<f64> = load.iter().map(|l| l * SCALE).collect();
        let first = fixed.iter().map(|(d, v)| (*d, v * SCALE)).collect();
        let later = zeros(fixed.keys().copied());
        let mut u = vec![0.0; self.dofs];
        for step in 0..8 {
            let (f, k) = self.assemble(&u);
            let residual: Vec<f64> = load.iter().zip(&f).map(|(l, f)| l - f).collect();
            let du = solve(&k, &residual, if step == 0 { &first } else { &later });
            self.update_alpha(&du);
            u.iter_mut().zip(&du).for_each(|(u, d)| *u += d);
        }
        u.iter().map(|u| u / SCALE).collect()
    }

    /// Plain Newton at one load level from `u`; returns the iterations. The criterion is the energy of the correction,
    /// which thin shells can meet where a residual norm cannot.
    pub fn newton(&mut self, u: &mut [f64], load: &[f64], fixed: &BTreeMap<usize, f64>) -> usize {
        self.iterate(u, load, fixed, false)
    }

    /// [`Model::newton`] with mixed integration points.
    pub fn newton_mixed(
        &mut self,
        u: &mut [f64],
        load: &[f64],
        fixed: &BTreeMap<usize, f64>,
    ) -> usize {
        self.iterate(u, load, fixed, true)
    }

    fn iterate(
        &mut self,
        u: &mut [f64],
        load: &[f64],
        fixed: &BTreeMap<usize, f64>,
        mixed: bool,
    ) -> usize {
        self.last = None;
        let mut largest: f64 = 0.0;
        for iteration in 0..40 {
            let (f, k) = self.assemble(u);
            let residual: Vec<f64> = load.iter().zip(&f).map(|(l, f)| l - f).collect();
            let du = solve(&k, &residual, fixed);
            let energy: f64 = du
                .iter()
                .zip(&residual)
                .map(|(d, r)| d * r)
                .sum::<f64>()
                .abs();
            largest = largest.max(energy);
            self.update_alpha(&du);
            u.iter_mut().zip(&du).for_each(|(u, d)| *u += d);
            self.last = mixed.then_some(du);
            if energy < 1e-14 * largest {
                self.last = None;
                return iteration + 1;
            }
        }
        panic!("no convergence");
    }
}

/// `u[second] + sign u[first] = value` for pairs of displacements: a mean that is held (a support on the mid-surface), or
/// a difference (the turn of a section).
pub type Ties = BTreeMap<[usize; 2], (f64, f64)>;

impl Model {
    /// [`Model::newton`] with ties. The second of a pair is eliminated, so that nothing stiff is added.
    pub fn newton_tied(
        &mut self,
        u: &mut [f64],
        load: &[f64],
        fixed: &BTreeMap<usize, f64>,
        ties: &Ties,
    ) -> usize {
        let mut of = vec![None; u.len()];
        for ([first, second], (sign, _)) in ties {
            of[*second] = Some((*first, *sign));
        }
        let mut largest: f64 = 0.0;
        for iteration in 0..40 {
            let (f, k) = self.assemble(u);
            // Nothing but round-off after the first iteration.
            let missing: BTreeMap<usize, f64> = (ties.iter())
                .map(|([a, b], (sign, value))| (*b, value - sign * u[*a] - u[*b]))
                .collect();
            let mut residual: Vec<f64> = load.iter().zip(&f).map(|(l, f)| l - f).collect();
            let mut triplets = Vec::with_capacity(k.len());
            for (r, c, v) in k {
                let (column, v) = match of[c] {
                    Some((first, sign)) => {
                        residual[r] -= v * missing[&c];
                        (first, -sign * v)
                    }
                    None => (c, v),
                };
                triplets.push(match of[r] {
                    Some((first, sign)) => (first, column, -sign * v),
                    None => (r, column, v),
                });
            }
            let mut held = fixed.clone();
            for ([first, second], (sign, _)) in ties {
                residual[*first] -= sign * residual[*second];
                held.insert(*second, 0.0);
            }
            let mut du = solve(&triplets, &residual, &held);
            let mut energy = 0.0;
            for (d, r) in du.iter().zip(&residual) {
                energy += d * r;
            }
            for ([first, second], (sign, _)) in ties {
                du[*second] = missing[second] - sign * du[*first];
            }
            largest = largest.max(energy.abs());
            self.update_alpha(&du);
            u.iter_mut().zip(&du).for_each(|(u, d)| *u += d);
            if energy.abs() < 1e-16 * largest {
                return iteration + 1;
            }
        }
        panic!("no convergence");
    }
}

/// Solves with prescribed displacements.
pub fn solve(k: &[(usize, usize, f64)], load: &[f64], fixed: &BTreeMap<usize, f64>) -> Vec<f64> {
    let mut number = vec![usize::MAX; load.len()];
    let mut free = vec![];
    for (d, number) in number.iter_mut().enumerate() {
        if !fixed.contains_key(&d) {
            *number = free.len();
            free.push(d);
        }
    }
    let mut rhs = faer::Col::<f64>::from_fn(free.len(), |i| load[free[i]]);
    let mut triplets = vec![];
    for &(r, c, v) in k {
        if number[r] == usize::MAX {
            continue;
        }
        match fixed.get(&c) {
            Some(value) => rhs[number[r]] -= v * value,
            None => triplets.push(Triplet::new(number[r], number[c], v)),
        }
    }
    let matrix = SparseColMat::try_new_from_triplets(free.len(), free.len(), &triplets).unwrap();
    let x = match matrix.sp_cholesky(faer::Side::Lower) {
        Ok(llt) => llt.solve(&rhs),
        Err(_) => matrix.sp_lu().unwrap().solve(&rhs),
    };
    let mut u = vec![0.0; load.len()];
    for (&d, &value) in fixed {
        u[d] = value;
    }
    for (i, &d) in free.iter().enumerate() {
        u[d] = x[i];
    }
    u
}

/// Prints and checks a value against the number and the relative tolerance.
pub fn close(what: &str, found: f64, expected: f64, tolerance: f64) {
    println!("{what}: {found:.6e}, expected {expected:.6e} within {tolerance}");
    assert!(
        (found / expected - 1.0).abs() <= tolerance,
        "{what}: {found} instead of {expected}"
    );
}
