//! Direct solution by MUMPS, the multifrontal solver (P. R. Amestoy, I. S. Duff, J.-Y. L'Excellent and J. Koster, "A fully
//! asynchronous multifrontal solver using distributed dynamic scheduling", SIAM J. Matrix Anal. Appl. 23 (2001)).
//!
//! A symmetric matrix is factorized without pivoting first, as a definite one. Where that finds negative or tiny pivots, it is
//! factorized with pivots of one and two rows, as all matrices on its pattern are from there on.
mod instance;
mod layout;
mod library;
mod settings;
#[cfg(test)]
mod tests;

pub use settings::MumpsOptions;

use super::foreign::{Backend, Csr, ForeignSolver};
use super::{
    Analysis, DofName, Factorization, LinearError, Method, MumpsFault, Ordering, OrderingChoice,
    SolverOptions, ordering, reserved,
};
use crate::machine::memory;
use crate::scene::MumpsOrdering;
use crate::system::{Pattern, SystemMatrix};
use instance::{Entries, Instance, Kind};

struct Mumps {
    symmetric: bool,
    solver: SolverOptions,
    options: MumpsOptions,
    /// Where the values of the entries come from, and the instance, which is away while another one is made.
    prepared: Option<(Csr, Instance)>,
    kind: Kind,
}

impl ForeignSolver {
    /// A solver that leaves the work to MUMPS.
    pub fn mumps(symmetric: bool, solver: SolverOptions, options: MumpsOptions) -> Self {
        let backend = Mumps {
            symmetric,
            solver,
            options,
            prepared: None,
            kind: match symmetric {
                true => Kind::Definite,
                false => Kind::Unsymmetric,
            },
        };
        ForeignSolver::new(Box::new(backend), symmetric, solver)
    }
}

impl Backend for Mumps {
    fn analyze(&mut self, pattern: &Pattern) -> Result<Analysis, LinearError> {
        self.prepared = None;
        let n = pattern.dofs();
        let order = match self.options.ordering {
            MumpsOrdering::Auto => Some(OrderingChoice::Best),
            MumpsOrdering::Metis => Some(OrderingChoice::Metis),
            MumpsOrdering::Amd => Some(OrderingChoice::Amd),
            _ => None,
        };
        let order = order
            .map(|choice| ordering::order(pattern, choice))
            .transpose()?;
        let mut csr = Csr::new(pattern, self.symmetric)?;
        let (rows, columns) = csr.take_triplets();
        let places = order.as_ref().map(|o| {
            let nodes = o.old_to_new.iter().map(|&new| 3 * new as i32);
            nodes
                .flat_map(|first| [first + 1, first + 2, first + 3])
                .collect()
        });
        let entries = Entries {
            order: n,
            values: reserved(rows.len())?,
            rows,
            columns,
            places,
        };
        let instance = self.instance(entries)?;
        let mut analysis = match &order {
            Some(order) => Analysis::of(order, &self.solver).0,
            None => Analysis {
                ordering: Ordering::Other,
                flops: 0.0,
                flops_amd: None,
                flops_metis: None,
                fill: 0,
                stored: 0,
                memory_bytes: 0,
                threads: 1,
                metis_failed: None,
            },
        };
        // The library's own threads are none of the dense kernels here.
        analysis.threads = 1;
        (analysis.flops, analysis.fill) = instance.cost();
        analysis.stored = analysis.fill as usize;
        let own = csr.bytes() + 16 * instance.entries.rows.len() + 4 * n;
        analysis.memory_bytes = instance.memory() as usize + own;
        memory::ask(instance.memory()).map_err(LinearError::Memory)?;
        self.prepared = Some((csr, instance));
        Ok(analysis)
    }

    fn factorize(&mut self, matrix: &SystemMatrix) -> Result<Option<Factorization>, LinearError> {
        let (csr, mut instance) = self.prepared.take().ok_or(LinearError::NotAnalyzed)?;
        csr.gather(matrix, &mut instance.entries.values);
        let mut made = instance.factorize();
        if self.kind == Kind::Definite && !self.is_definite(made, &instance)? {
            self.kind = Kind::Indefinite;
            instance = self.instance(instance.into_entries())?;
            if let Err(shortage) = memory::ask(instance.memory()) {
                self.prepared = Some((csr, instance));
                return Err(LinearError::Memory(shortage));
            }
            made = instance.factorize();
        }
        let found = match made {
            Ok(()) => self.found(&instance).map(Some),
            // No pivot is large enough: the host names the unknown.
            Err(MumpsFault::Code { code: -10, .. }) => Ok(None),
            Err(fault) => Err(fault.into()),
        };
        self.prepared = Some((csr, instance));
        found
    }

    fn solve(&mut self, x: &mut [f64]) -> Result<(), LinearError> {
        let (_, instance) = self.prepared.as_mut().ok_or(LinearError::NotFactorized)?;
        Ok(instance.solve(x)?)
    }

    fn clear(&mut self) {
        self.prepared = None;
    }

    fn expects_indefinite(&self) -> bool {
        self.kind == Kind::Indefinite
    }

    fn expect_indefinite(&mut self, expected: bool) {
        if !expected || self.kind != Kind::Definite {
            return;
        }
        self.kind = Kind::Indefinite;
        if let Some((csr, instance)) = self.prepared.take() {
            // What fails is looked for again when a matrix is factorized.
            self.prepared = self
                .instance(instance.into_entries())
                .ok()
                .map(|i| (csr, i));
        }
    }
}

impl Mumps {
    fn instance(&self, entries: Entries) -> Result<Instance, LinearError> {
        let numbers = (self.solver.threads, self.solver.pivot_tolerance);
        let made = Instance::new(self.kind, entries, &self.options, numbers);
        Ok(made?)
    }

    /// Whether a factorization without pivoting was that of a positive definite matrix.
    fn is_definite(
        &self,
        made: Result<(), MumpsFault>,
        instance: &Instance,
    ) -> Result<bool, LinearError> {
        match made {
            Ok(()) => Ok(instance.negative_pivots() == 0
                && instance.smallest_pivot() >= self.solver.pivot_tolerance),
            // A pivot that is zero, or not positive.
            Err(MumpsFault::Code {
                code: -10 | -40, ..
            }) => Ok(false),
            Err(fault) => Err(fault.into()),
        }
    }

    fn found(&self, instance: &Instance) -> Result<Factorization, LinearError> {
        let ratio = instance.smallest_pivot();
        if let Some(unknown) = instance.null_pivot() {
            let dof = DofName::new(unknown);
            return Err(LinearError::TinyPivot { dof, ratio });
        }
        let (method, negative_pivots) = match self.kind {
            Kind::Definite => (Method::Llt, 0),
            Kind::Indefinite => (Method::Ldlt, instance.negative_pivots()),
            Kind::Unsymmetric => (Method::Lu, usize::from(instance.is_determinant_negative())),
        };
        Ok(Factorization {
            method,
            negative_pivots,
            perturbed_pivots: 0,
            smallest_pivot_ratio: ratio,
            smallest_pivot: None,
        })
    }
}
