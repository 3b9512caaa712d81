//! What a checkpoint keeps of a run under way, and how the run goes on from it.
//!
//! Everything that evolves is taken apart field by field: a new field does not compile until it is decided here whether it
//! is kept. What is kept needs a line in `put` and one in `take`, and a new [format](crate::run::checkpoint).
use super::passing::Jump;
use super::{Course, Outputs, RunState, StepControl};
use crate::assembly::{AssemblerMemory, CouplingMemory, Factored};
use crate::effects::inertia::{Motion, MotionEnergy};
use crate::model::Model;
use crate::model::stages::StageStart;
use crate::model::state::State;
use crate::output::{HistoryMark, OutputError, StageSummary};
use crate::run::checkpoint::bytes::{Malformed, Reader, Writer};
use crate::run::checkpoint::{CheckpointError, Keeper, Sections, Slot, stages, state};
use crate::run::compliance::Compliance;
use crate::run::cost::ResourceUse;
use crate::run::habit::Habit;
use crate::run::peaks::Peaks;
use crate::run::penalty_rule::PenaltyRule;
use crate::run::progress::Progress;
use crate::run::unseen::Travel;
use crate::run::watch::Watch;
use crate::system::linear::Method;
use std::collections::BTreeMap;

/// A run under way at an accepted step.
pub struct Kept {
    /// What is wrong with later ones.
    pub(super) passed_over: Vec<String>,
    pub(super) committed: State,
    pub(super) before: Option<(State, f64)>,
    pub(super) dt: f64,
    pub(super) habit: Habit,
    pub(super) jump: Option<Jump>,
    pub(super) progress: Progress,
    pub(super) touched: Vec<bool>,
    pub(super) touching: Vec<bool>,
    /// Per body.
    pub(super) turned: Vec<bool>,
    pub(super) watch: Watch,
    pub(super) compliance: Compliance,
    pub(super) rule: PenaltyRule,
    pub(super) peaks: Peaks,
    pub(super) travels: Vec<Travel>,
    pub(super) files: KeptFiles,
    pub(super) factorizations: BTreeMap<Method, u64>,
    pub(super) largest_force: f64,
    pub assembler: AssemblerMemory,
    pub expects_indefinite: bool,
    pub(super) spent: ResourceUse,
    pub(super) stages: Vec<StageSummary>,
}

/// The files of a run at a checkpoint.
#[derive(Debug, Clone)]
pub(crate) struct KeptFiles {
    /// Where the checkpoint was found.
    pub slot: Slot,
    /// Where the table of the history ended.
    pub table: HistoryMark,
    /// Steps whose fields were written, with their times.
    pub written: Vec<(u32, f64)>,
}

impl Kept {
    /// Reads a checkpoint of a run of this model.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`]
    pub fn read(sections: &Sections, model: &Model) -> Result<Self, CheckpointError> {
        sections.read(|from| Kept::take(model, sections, from))
    }

    fn take(model: &Model, sections: &Sections, from: &mut Reader) -> Result<Self, Malformed> {
        // The model is that of its stage.
        let (_, (_, stages)) = from.section("variant", take_variant)?;
        let (progress, spent) = from.section("progress", |r| {
            Ok((take_progress(r)?, ResourceUse::take(r)?))
        })?;
        let (dt, habit, jump, [touched, touching, turned]) = from.section("path", |r| {
            let pairs = model.pairs.len();
            let (dt, habit, jump) = (r.f64()?, Habit::take(r)?, r.option(Jump::take)?);
            let flags = [pairs, pairs, model.bodies.len()].map(|count| take_flags(count, r));
            let [touched, touching, turned] = flags;
            Ok((dt, habit, jump, [touched?, touching?, turned?]))
        })?;
        let watch = from.section("watch", |r| Watch::take(model, r))?;
        let (compliance, rule, peaks, travels) = from.section("accuracy", |r| {
            let malformed = |_| r.malformed("a motion without a value at the start");
            let mut compliance = Compliance::new(model).map_err(malformed)?;
            let mut peaks = Peaks::new(model);
            compliance.take(model, r)?;
            let rule = PenaltyRule::take(model, r)?;
            peaks.take(r)?;
            let travels: Result<Vec<Travel>, _> =
                model.pairs.iter().map(|_| Travel::take(r)).collect();
            Ok((compliance, rule, peaks, travels?))
        })?;
        let committed = from.section("state", |r| {
            let committed = state::take(model, r)?;
            match watch.fits(&committed) {
                true => Ok(committed),
                false => Err(r.malformed("tractions of other slave points")),
            }
        })?;
        let before = from.section("before", |r| {
            r.option(|r| Ok((state::take_before(model, &committed, r)?, r.f64()?)))
        })?;
        let (assembler, expects_indefinite, factorizations, largest_force) =
            from.section("solver", |r| {
                Ok((
                    take_assembler(model, r)?,
                    r.bool()?,
                    take_counts(r)?,
                    r.f64()?,
                ))
            })?;
        let (table, written) = from.section("output", |r| {
            let table = HistoryMark {
                length: r.u64()?,
                sum: r.u64()?,
            };
            let count = r.count(12)?;
            let written: Result<_, _> = (0..count).map(|_| Ok((r.u32()?, r.f64()?))).collect();
            Ok((table, written?))
        })?;
        Ok(Kept {
            passed_over: sections.passed_over.clone(),
            committed,
            before,
            dt,
            habit,
            jump,
            progress,
            touched,
            touching,
            turned,
            watch,
            compliance,
            rule,
            peaks,
            travels,
            files: KeptFiles {
                slot: sections.slot,
                table,
                written,
            },
            factorizations,
            largest_force,
            assembler,
            expects_indefinite,
            spent,
            stages,
        })
    }
}

impl RunState<'_> {
    /// Writes the checkpoint of the last accepted step: `table` and `fields` are where the history ends and what fields are
    /// written. Says whether it is time to bring everything to the disk.
    pub fn keep(
        &self,
        keeper: &mut Keeper,
        table: HistoryMark,
        fields: &[(u32, f64)],
    ) -> Result<bool, OutputError> {
        let RunState {
            // Given by the scene.
            problem,
            assembler,
            solver,
            workspace,
            phases,
            progress,
            touched,
            touching,
            watch,
            compliance,
            rule,
            peaks,
            unseen,
            cost,
            course,
            // Of the checkpoint that the run went on from.
            files: _,
            stages,
        } = self;
        let Course {
            committed,
            // Made anew by every step.
            trial: _,
            walk,
            outputs,
        } = course;
        let StepControl {
            stepping,
            before,
            habit,
            turned,
            // A run that goes on finds it anew.
            given_up: _,
            jump,
        } = walk;
        let Outputs {
            // Gathered anew from the accepted state.
            fields: _,
            // In the table.
            row: _,
        } = outputs;
        let model = &problem.model;
        let spent = cost.spent(phases);
        let memory = assembler.memory();
        keeper.keep(|out| {
            // First, since the model that reads the others depends on it.
            out.section("variant", |out| {
                out.text(&problem.changes);
                stages::put(model, stages, out);
            });
            out.section("progress", |out| {
                put_progress(progress, out);
                spent.put(out);
            });
            out.section("path", |out| {
                out.f64(stepping.size());
                habit.put(out);
                out.option(jump.as_ref(), |out, jump| jump.put(out));
                put_flags(touched, out);
                put_flags(touching, out);
                let bodies = 0..model.bodies.len();
                put_flags(
                    &bodies.map(|b| turned.contains(&b)).collect::<Vec<_>>(),
                    out,
                );
            });
            out.section("watch", |out| watch.put(out));
            out.section("accuracy", |out| {
                compliance.put(out);
                rule.put(out);
                peaks.put(out);
                let travels = unseen.between.travels(model);
                travels.iter().for_each(|travel| travel.put(out));
            });
            out.section("state", |out| state::put(model, committed, out));
            out.section("before", |out| {
                out.option(before.as_ref(), |out, (state, size)| {
                    state::put_before(model, state, out);
                    out.f64(*size);
                });
            });
            out.section("solver", |out| {
                put_assembler(&memory, out);
                // A pattern that is still to be analysed makes the solver forget.
                out.bool(!memory.new_pattern && solver.expects_indefinite());
                let (counts, largest_force) = workspace.kept();
                put_counts(counts, out);
                out.f64(largest_force);
            });
            out.section("output", |out| {
                let HistoryMark { length, sum } = table;
                out.u64(length);
                out.u64(sum);
                out.count(fields.len());
                for (step, time) in fields {
                    out.u32(*step);
                    out.f64(*time);
                }
            });
        })
    }
}

fn put_progress(progress: &Progress, out: &mut Writer) {
    let Progress {
        warnings,
        iterations,
        accepted,
        counted,
        cuts,
        steps,
        time,
        ping_pongs,
        measured,
    } = progress;
    out.count(warnings.len());
    warnings.iter().for_each(|text| out.text(text));
    out.u64(*iterations);
    out.u64(*accepted);
    out.u64(*counted);
    out.u32(*cuts);
    out.u32(*steps);
    out.f64(*time);
    out.u32(*ping_pongs);
    out.f64(*measured);
}

fn take_progress(from: &mut Reader) -> Result<Progress, Malformed> {
    let count = from.count(8)?;
    let warnings: Result<_, _> = (0..count).map(|_| from.text().map(str::to_owned)).collect();
    Ok(Progress {
        warnings: warnings?,
        iterations: from.u64()?,
        accepted: from.u64()?,
        counted: from.u64()?,
        cuts: from.u32()?,
        steps: from.u32()?,
        time: from.f64()?,
        ping_pongs: from.u32()?,
        measured: from.f64()?,
    })
}

/// What the run has other than its scene, and its stages.
pub(in crate::run) fn take_variant<'b>(
    from: &mut Reader<'b>,
) -> Result<(&'b str, (StageStart, Vec<StageSummary>)), Malformed> {
    Ok((from.text()?, stages::take(from)?))
}

fn put_flags(flags: &[bool], out: &mut Writer) {
    out.count(flags.len());
    flags.iter().for_each(|f| out.bool(*f));
}

fn take_flags(count: usize, from: &mut Reader) -> Result<Vec<bool>, Malformed> {
    from.exactly(count, "flags")?;
    (0..count).map(|_| from.bool()).collect()
}

fn put_assembler(memory: &AssemblerMemory, out: &mut Writer) {
    let AssemblerMemory {
        penalties,
        ratios,
        couplings,
        rebuilds,
        factored,
        farthest,
        motion,
        // The pattern is built, and analysed, anew in any case.
        new_pattern: _,
    } = memory;
    out.count(penalties.len());
    out.f64s(penalties);
    out.f64s(ratios);
    for coupling in couplings {
        out.option(coupling.as_ref(), |out, coupling| {
            let CouplingMemory {
                counts,
                facets,
                links,
            } = coupling;
            put_numbers(counts, out);
            put_numbers(facets, out);
            put_numbers(links.as_flattened(), out);
        });
    }
    out.u32(*rebuilds);
    out.option(factored.as_ref(), |out, factored| {
        put_flags(&factored.closed, out);
        out.f64s(&factored.penalties);
    });
    out.f64(*farthest);
    out.option(motion.as_ref(), |out, motion| {
        let Motion {
            v,
            a,
            forces,
            energy:
                MotionEnergy {
                    kinetic,
                    start,
                    damped,
                    viscous,
                },
            farthest,
            greatest,
            event,
        } = motion;
        out.count(v.len());
        [v, a, forces].into_iter().for_each(|x| out.f64s(x));
        out.f64s(&[*kinetic, *start, *damped, *viscous, *farthest, *greatest]);
        out.bool(*event);
    });
}

fn take_motion(model: &Model, from: &mut Reader) -> Result<Motion, Malformed> {
    let count = 3 * model.nodes.len();
    from.exactly(count, "velocities")?;
    let [mut v, mut a, mut forces] = [(); 3].map(|()| vec![0.0; count]);
    for x in [&mut v, &mut a, &mut forces] {
        from.f64s(x)?;
    }
    let mut sums = [0.0; 6];
    from.f64s(&mut sums)?;
    let [kinetic, start, damped, viscous, farthest, greatest] = sums;
    Ok(Motion {
        v,
        a,
        forces,
        energy: MotionEnergy {
            kinetic,
            start,
            damped,
            viscous,
        },
        farthest,
        greatest,
        event: from.bool()?,
    })
}

fn take_assembler(model: &Model, from: &mut Reader) -> Result<AssemblerMemory, Malformed> {
    from.exactly(model.pairs.len(), "penalties")?;
    let mut penalties = vec![0.0; model.pairs.len()];
    from.f64s(&mut penalties)?;
    let mut ratios = penalties.clone();
    from.f64s(&mut ratios)?;
    let mut couplings = Vec::with_capacity(model.pairs.len());
    for _ in &model.pairs {
        couplings.push(from.option(|from| {
            Ok(CouplingMemory {
                counts: take_numbers(from)?,
                facets: take_numbers(from)?,
                links: take_numbers(from)?.as_chunks().0.to_vec(),
            })
        })?);
    }
    let rebuilds = from.u32()?;
    let factored = from.option(|from| {
        let closed = take_flags(model.contact_points(), from)?;
        let mut penalties = vec![0.0; model.pairs.len()];
        from.f64s(&mut penalties)?;
        Ok(Factored { closed, penalties })
    })?;
    let farthest = from.f64()?;
    let motion = from.option(|from| take_motion(model, from))?;
    Ok(AssemblerMemory {
        penalties,
        ratios,
        couplings,
        rebuilds,
        factored,
        farthest,
        motion,
        new_pattern: true,
    })
}

fn put_numbers(numbers: &[u32], out: &mut Writer) {
    out.count(numbers.len());
    numbers.iter().for_each(|n| out.u32(*n));
}

fn take_numbers(from: &mut Reader) -> Result<Vec<u32>, Malformed> {
    let count = from.count(4)?;
    (0..count).map(|_| from.u32()).collect()
}

fn put_counts(counts: &BTreeMap<Method, u64>, out: &mut Writer) {
    out.count(counts.len());
    for (method, count) in counts {
        out.text(method.name());
        out.u64(*count);
    }
}

fn take_counts(from: &mut Reader) -> Result<BTreeMap<Method, u64>, Malformed> {
    let mut out = BTreeMap::new();
    for _ in 0..from.count(16)? {
        let name = from.text()?;
        let all = [Method::Llt, Method::Ldlt, Method::Lu];
        let Some(method) = all.into_iter().find(|m| m.name() == name) else {
            return Err(from.malformed("an unknown factorization"));
        };
        out.insert(method, from.u64()?);
    }
    Ok(out)
}
