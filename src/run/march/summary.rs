//! How a run went: the account of it.
use super::RunState;
use super::start::Problem;
use crate::output::{Accuracy, RunStatus, Summary, Versions};
use crate::run::cost::ResourceUse;
use crate::run::history;
use crate::run::progress::Progress;
use std::collections::BTreeMap;

impl RunState<'_> {
    /// What was spent by now, where the run is given up.
    pub fn give_up(&self) -> ResourceUse {
        let mut spent = self.cost.spent(&self.phases);
        spent.given_up.runs += 1;
        spent.given_up.newton_iterations += self.progress.iterations;
        spent
    }

    /// Takes what was spent on runs that were given up before this one.
    pub fn charge(&mut self, spent: ResourceUse) {
        self.cost.earlier = spent;
    }

    /// How the run went so far, and what it cost. Probes and the checksum of the scene are the caller's to add.
    pub fn summary(&self, threads: usize, status: RunStatus, reason: Option<String>) -> Summary {
        let ResourceUse {
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb,
            resumed,
            given_up,
        } = self.cost.spent(&self.phases);
        let Progress {
            warnings,
            iterations,
            accepted,
            counted: _,
            cuts,
            ping_pongs,
            steps,
            time,
            measured: _,
        } = &self.progress;
        let Problem { model, plan, .. } = self.problem;
        let factorizations = self.workspace.factorizations.iter();
        Summary {
            title: self.problem.loaded.scene.title.clone(),
            status,
            reason,
            time: *time,
            wall_s,
            cpu_s,
            phases,
            peak_memory_mb,
            threads,
            dofs: model.unknowns(),
            contact_points: model.contact_points(),
            newton_iterations: iterations + given_up.newton_iterations,
            failed_iterations: iterations.saturating_sub(*accepted) + given_up.newton_iterations,
            given_up,
            factorizations: factorizations
                .map(|(method, count)| (method.name().to_owned(), *count))
                .collect(),
            steps: *steps,
            cuts: *cuts,
            ping_pongs: *ping_pongs,
            pattern_rebuilds: self.assembler.rebuilds(),
            effects: plan.names(),
            plan: Some(plan.summary(self.assembler.ran())),
            accuracy: Accuracy {
                contacts: self.peaks.account(
                    model,
                    [&self.assembler.penalties, &self.assembler.ratios],
                    |pair| self.compliance.sticking.error(pair),
                ),
                ..self.compliance.account(model)
            },
            probes: BTreeMap::new(),
            warnings: warnings.clone(),
            resumed,
            stages: self.stages.clone(),
            scene: String::new(),
            versions: Versions::default(),
        }
    }
}

impl RunState<'_> {
    /// Names of the columns of the history.
    pub fn columns(&self) -> Vec<String> {
        history::columns(&self.problem.model)
    }
}
