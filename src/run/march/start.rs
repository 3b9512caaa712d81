//! Where a run starts: at time 0, or where it was kept.
use super::restart::lines_behind;
use super::{Kept, March, Outputs, StepControl};
use crate::model::error::number;
use crate::model::state::State;
use crate::output::atomic::sweep;
use crate::output::{History, Results};
use crate::run::RunError;
use crate::run::checkpoint::CheckpointError;
use crate::run::commit;
use crate::run::fields::Fields;
use crate::run::history;
use crate::solve::event::Event;
use crate::solve::stepping::Stepping;
use std::path::Path;

impl March<'_, '_> {
    /// Starts at time 0, in a folder that has been cleared of another run.
    pub(super) fn begin(
        &mut self,
        out: &Path,
        fields: Fields,
        stepping: Stepping,
    ) -> Result<(State, StepControl, Outputs), RunError> {
        sweep(out);
        let mut outputs = Outputs {
            results: Results::create(out)?,
            table: History::create(&out.join("history.csv"), history::columns(self.model))?,
            fields,
            written: None,
        };
        for note in outputs.fields.notes() {
            self.warn(note);
        }
        let mut committed = State::new(self.model);
        let masters = &mut self.assembler.masters;
        commit::start(self.model, masters, &mut committed).map_err(|e| RunError::internal(&e))?;
        self.gather(&mut outputs, &committed, 0.0)?;
        self.write(&mut outputs, &committed)?;
        let walk = StepControl {
            stepping,
            before: None,
            hold: false,
        };
        Ok((committed, walk, outputs))
    }

    /// Takes up a run where it was kept: files are as they were then, and what was written later is dropped.
    pub(super) fn go_on(
        &mut self,
        out: &Path,
        fields: Fields,
        mut stepping: Stepping,
        kept: Kept,
    ) -> Result<(State, StepControl, Outputs), RunError> {
        let Kept {
            slot,
            passed_over,
            committed,
            before,
            dt,
            hold,
            progress,
            touched,
            touching,
            watch,
            compliance,
            rule,
            peaks,
            table: mark,
            written,
            factorizations,
            // Given back where the pattern is analysed.
            assembler: _,
            expects_indefinite: _,
            spent,
        } = kept;
        self.workspace.factorizations = factorizations;
        (self.progress, self.touched, self.touching) = (progress, touched, touching);
        (self.watch, self.compliance, self.peaks) = (watch, compliance, peaks);
        self.rule = rule;
        self.cost.earlier = spent;
        self.cost.earlier.resumed += 1;
        stepping.set_size(dt);
        let (step, time) = (self.progress.steps, self.progress.time);
        let path = out.join("history.csv");
        let lost = lines_behind(&path, mark.length);
        let Some(table) = History::resume(&path, history::columns(self.model), mark)? else {
            return Err(CheckpointError::History { path }.into());
        };
        self.keeper.go_on(slot);
        sweep(out);
        let parts = fields.part_names(self.model);
        let last = written.last().map(|last| last.0);
        let mut results = Results::resume(out, written, &parts)?;
        let every = self.scene.output.every;
        for step in (step..=step.saturating_add(lost)).filter(|_| every > 0) {
            // Written because the run ended there, which it does not.
            if last != Some(step) && !step.is_multiple_of(every) {
                results.remove(step, &parts)?;
            }
        }
        let mut outputs = Outputs {
            results,
            table,
            fields,
            written: last,
        };
        if step > 0 {
            outputs.fields.went_on();
        }
        self.gather(&mut outputs, &committed, time)?;
        for text in passed_over {
            let text = format!("{text}; the checkpoint before it is taken");
            self.observer.event(&Event::Note { text });
        }
        let text = format!("continued after step {step} (time {})", number(time));
        self.observer.event(&Event::Note { text });
        let walk = StepControl {
            stepping,
            before,
            hold,
        };
        Ok((committed, walk, outputs))
    }
}
