//! Prescribed and tied degrees of freedom.
//!
//! The full increments are `u = T q + g`: `q` are the free dofs, `T` has a one for each of them and a coefficient for
//! each tied dof, `g` holds prescribed increments and the offsets of tied dofs. The system `K u = r` becomes
//! `T^t K T q = T^t (r - K g)`, element by element (master-slave elimination, e.g. Cook, Malkus, Plesha and Witt,
//! "Concepts and Applications of Finite Element Analysis", 4th ed. 2002, section 13.2).

/// What holds for one degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dof {
    /// Unknown.
    Free,
    /// Its increment is given.
    Prescribed,
    /// Its increment is `coefficient` times that of `dof`, plus a given offset.
    Tied {
        /// The degree of freedom that it is tied to.
        dof: u32,
        /// Its increment over that of `dof`.
        coefficient: f64,
    },
}

/// A contradiction between constraints.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// No such dof.
    #[error("dof {dof} does not exist, there are {dofs}")]
    OutOfRange {
        /// The degree of freedom `3 node + component`.
        dof: u32,
        /// Number of degrees of freedom.
        dofs: usize,
    },
    /// Two constraints on one dof that cannot both hold.
    #[error(
        "component {} of node {} is constrained twice, in different ways",
        dof % 3,
        dof / 3
    )]
    Conflict {
        /// The degree of freedom `3 node + component`.
        dof: u32,
    },
    /// Dofs tied to each other in a circle, or one to itself.
    #[error("component {} of node {} is tied to itself", dof % 3, dof / 3)]
    Cycle {
        /// The degree of freedom `3 node + component`.
        dof: u32,
    },
    /// A tied dof whose target is not among the nodes of its element matrix.
    #[error("component {} of node {} is tied to a node outside its element matrix", dof % 3, dof / 3)]
    TargetMissing {
        /// The degree of freedom `3 node + component`.
        dof: u32,
    },
    /// A coefficient that is no number.
    #[error("component {} of node {} is tied with a coefficient that is not finite", dof % 3, dof / 3)]
    Coefficient {
        /// The degree of freedom `3 node + component`.
        dof: u32,
    },
}

/// Collects constraints.
#[derive(Debug, Clone)]
pub struct DofMapBuilder {
    dofs: Vec<Dof>,
}

impl DofMapBuilder {
    /// All dofs of `nodes` nodes free.
    pub fn new(nodes: usize) -> Self {
        Self {
            dofs: vec![Dof::Free; 3 * nodes],
        }
    }

    /// Prescribes a dof. Doing so twice is no error.
    ///
    /// # Errors
    /// [`ConstraintError::OutOfRange`], [`ConstraintError::Conflict`] if it is tied.
    pub fn prescribe(&mut self, dof: u32) -> Result<(), ConstraintError> {
        self.set(dof, Dof::Prescribed)
    }

    /// Ties `dof` to `coefficient` times `to` (plus an offset given later, see [`DofMap::particular`]). `to` may be
    /// free, prescribed or tied itself, now or later. The same tie given twice is no error.
    ///
    /// # Errors
    /// [`ConstraintError::OutOfRange`], [`Conflict`](ConstraintError::Conflict),
    /// [`Cycle`](ConstraintError::Cycle) if a dof is tied to itself, [`Coefficient`](ConstraintError::Coefficient).
    pub fn tie(&mut self, dof: u32, to: u32, coefficient: f64) -> Result<(), ConstraintError> {
        self.check(to)?;
        if dof == to {
            return Err(ConstraintError::Cycle { dof });
        }
        if !coefficient.is_finite() {
            return Err(ConstraintError::Coefficient { dof });
        }
        self.set(
            dof,
            Dof::Tied {
                dof: to,
                coefficient,
            },
        )
    }

    /// What holds for `dof` so far; `None` if it does not exist.
    pub fn get(&self, dof: u32) -> Option<Dof> {
        self.dofs.get(dof as usize).copied()
    }

    /// Follows ties to their ends.
    ///
    /// # Errors
    /// [`ConstraintError::Cycle`] if ties go in a circle.
    pub fn build(self) -> Result<DofMap, ConstraintError> {
        let n = self.dofs.len();
        let mut links: Vec<Link> = self
            .dofs
            .iter()
            .enumerate()
            .map(|(d, dof)| match dof {
                Dof::Free => Link::To(d as u32, 1.0),
                _ => Link::Removed,
            })
            .collect();
        let mut resolved: Vec<bool> = self
            .dofs
            .iter()
            .map(|d| !matches!(d, Dof::Tied { .. }))
            .collect();
        let mut tied = Vec::new();
        let mut chain = Vec::new();
        for start in 0..n as u32 {
            chain.clear();
            let mut at = start;
            while let (false, Dof::Tied { dof, coefficient }) =
                (resolved[at as usize], self.dofs[at as usize])
            {
                if chain.len() > n {
                    return Err(ConstraintError::Cycle { dof: at });
                }
                chain.push(TiedDof {
                    dof: at,
                    to: dof,
                    coefficient,
                });
                at = dof;
            }
            while let Some(tie) = chain.pop() {
                if let Link::To(target, c) = links[tie.to as usize] {
                    links[tie.dof as usize] = Link::To(target, c * tie.coefficient);
                }
                resolved[tie.dof as usize] = true;
                tied.push(tie);
            }
        }
        Ok(DofMap {
            dofs: self.dofs,
            links,
            tied,
        })
    }

    fn check(&self, dof: u32) -> Result<(), ConstraintError> {
        let dofs = self.dofs.len();
        if (dof as usize) < dofs {
            Ok(())
        } else {
            Err(ConstraintError::OutOfRange { dof, dofs })
        }
    }

    fn set(&mut self, dof: u32, new: Dof) -> Result<(), ConstraintError> {
        self.check(dof)?;
        let old = &mut self.dofs[dof as usize];
        if *old != Dof::Free && *old != new {
            return Err(ConstraintError::Conflict { dof });
        }
        *old = new;
        Ok(())
    }
}

/// Where a dof's equation goes when ties are followed to their end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Link {
    /// To this free dof, with this coefficient (itself with 1 if it is free).
    To(u32, f64),
    /// Nowhere: it is prescribed, or tied to a prescribed dof.
    Removed,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct TiedDof {
    dof: u32,
    to: u32,
    coefficient: f64,
}

/// All constraints of a system, consistent and resolved. Element functions take dofs in the order
/// `3 * local node + component` and matrices column-major.
#[derive(Debug, Clone, PartialEq)]
pub struct DofMap {
    dofs: Vec<Dof>,
    links: Vec<Link>,
    /// Every tied dof, after the dof that it is tied to.
    tied: Vec<TiedDof>,
}

impl DofMap {
    /// No constraints on `nodes` nodes.
    pub fn free(nodes: usize) -> Self {
        Self {
            dofs: vec![Dof::Free; 3 * nodes],
            links: (0..3 * nodes as u32).map(|d| Link::To(d, 1.0)).collect(),
            tied: Vec::new(),
        }
    }

    /// Number of dofs.
    pub fn dofs(&self) -> usize {
        self.dofs.len()
    }

    /// What was asked for `dof`. Panics if it does not exist.
    pub fn dof(&self, dof: usize) -> Dof {
        self.dofs[dof]
    }

    /// Where the equation of `dof` goes. Panics if it does not exist.
    pub fn link(&self, dof: usize) -> Link {
        self.links[dof]
    }

    /// The dofs that are no unknowns: prescribed and tied.
    pub fn removed(&self) -> impl Iterator<Item = u32> + '_ {
        self.dofs
            .iter()
            .enumerate()
            .filter(|(_, d)| **d != Dof::Free)
            .map(|(d, _)| d as u32)
    }

    /// Whether any dof of these nodes is constrained.
    pub fn constrains(&self, nodes: &[u32]) -> bool {
        nodes.iter().any(|&node| {
            let first = 3 * node as usize;
            self.dofs[first..first + 3].iter().any(|d| *d != Dof::Free)
        })
    }

    /// Appends `nodes` and then the nodes that their dofs are tied to and that are not among them: the group that the
    /// pattern needs for the element, and the node list of its condensed matrix.
    pub fn extend_nodes(&self, nodes: &[u32], out: &mut Vec<u32>) {
        let first = out.len();
        out.extend_from_slice(nodes);
        for &node in nodes {
            for c in 0..3 {
                if let Link::To(target, _) = self.links[3 * node as usize + c] {
                    let target = target / 3;
                    if !out[first..].contains(&target) {
                        out.push(target);
                    }
                }
            }
        }
    }

    /// `T^t K T` in place: clears the rows and columns of removed dofs of an element matrix after it has added those of
    /// tied dofs, times the coefficient, to their targets. `nodes` must hold the targets, too
    /// ([`extend_nodes`](Self::extend_nodes)), and `ke` have `3 * nodes.len()` rows, zero for the added nodes. `ke` need
    /// not be symmetric.
    ///
    /// # Errors
    /// [`ConstraintError::TargetMissing`]; `ke` is then half done.
    ///
    /// # Panics
    /// If `ke` has another size or a node does not exist.
    pub fn condense_matrix(&self, nodes: &[u32], ke: &mut [f64]) -> Result<(), ConstraintError> {
        let size = 3 * nodes.len();
        assert_eq!(ke.len(), size * size, "matrix of another size");
        for i in 0..size {
            let dof = 3 * nodes[i / 3] + (i % 3) as u32;
            if self.dofs[dof as usize] == Dof::Free {
                continue;
            }
            if let Link::To(target, c) = self.links[dof as usize] {
                let Some(node) = nodes.iter().position(|&n| n == target / 3) else {
                    return Err(ConstraintError::TargetMissing { dof });
                };
                let t = 3 * node + (target % 3) as usize;
                for k in 0..size {
                    ke[t * size + k] += c * ke[i * size + k];
                }
                for k in 0..size {
                    ke[k * size + t] += c * ke[k * size + i];
                }
            }
            for k in 0..size {
                ke[i * size + k] = 0.0;
                ke[k * size + i] = 0.0;
            }
        }
        Ok(())
    }

    /// `r -= K_e g`: what prescribed increments `g` (see [`particular`](Self::particular)) of the element's dofs
    /// contribute to the global right-hand side, before it is folded. `ke` is the matrix as the element made it, with
    /// `3 * nodes.len()` rows. Returns whether there was anything to subtract.
    ///
    /// # Panics
    /// If `ke` has another size, or `g` or `rhs` is too short.
    pub fn subtract_prescribed(
        &self,
        nodes: &[u32],
        ke: &[f64],
        g: &[f64],
        rhs: &mut [f64],
    ) -> bool {
        let size = 3 * nodes.len();
        assert_eq!(ke.len(), size * size, "matrix of another size");
        let mut any = false;
        for (column, values) in ke.chunks_exact(size.max(1)).enumerate() {
            let increment = g[3 * nodes[column / 3] as usize + column % 3];
            if increment == 0.0 {
                continue;
            }
            any = true;
            for (row, k) in values.iter().enumerate() {
                rhs[3 * nodes[row / 3] as usize + row % 3] -= k * increment;
            }
        }
        any
    }

    /// Makes `g` of given values in place: on entry the increments of prescribed dofs and the offsets of tied dofs, on
    /// return also what tied dofs get of the prescribed dofs they hang on; free dofs are set to zero.
    ///
    /// # Panics
    /// If `g` is too short.
    pub fn particular(&self, g: &mut [f64]) {
        for (value, dof) in g[..self.dofs.len()].iter_mut().zip(&self.dofs) {
            if *dof == Dof::Free {
                *value = 0.0;
            }
        }
        for tie in &self.tied {
            g[tie.dof as usize] += tie.coefficient * g[tie.to as usize];
        }
    }

    /// `T^t f` in place: adds the entries of tied dofs, times the coefficient, to their targets, and sets those of all
    /// removed dofs to zero. What was there (reactions) is lost: read it before.
    ///
    /// # Panics
    /// If `f` is too short.
    pub fn fold(&self, f: &mut [f64]) {
        for tie in &self.tied {
            if let Link::To(target, c) = self.links[tie.dof as usize] {
                f[target as usize] += c * f[tie.dof as usize];
            }
        }
        for (value, dof) in f.iter_mut().zip(&self.dofs) {
            if *dof != Dof::Free {
                *value = 0.0;
            }
        }
    }

    /// `u = T q + g` in place: `u` holds the solution at free dofs, `g` is of [`particular`](Self::particular) or
    /// `None` for zero.
    ///
    /// # Panics
    /// If `u` or `g` is too short.
    pub fn expand(&self, u: &mut [f64], g: Option<&[f64]>) {
        for dof in 0..self.dofs.len() {
            if self.dofs[dof] == Dof::Free {
                continue;
            }
            let own = match self.links[dof] {
                Link::To(target, c) => c * u[target as usize],
                Link::Removed => 0.0,
            };
            u[dof] = own + g.map_or(0.0, |g| g[dof]);
        }
    }
}
