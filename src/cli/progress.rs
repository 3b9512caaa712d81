//! The progress of a run, as people and programs want to see it.
use super::{print, report};
use crate::output::RunStatus;
use crate::solve::event::{Event, Observer};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Parts of the bar; a run's time is scaled to it.
const PARTS: u64 = 10_000;

/// One JSON object an event and line, on standard output.
pub(super) struct JsonLines;

impl Observer for JsonLines {
    fn event(&mut self, event: &Event) {
        if let Ok(line) = serde_json::to_string(event) {
            print(&(line + "\n"));
        }
    }
}

/// A table of steps, one line each, on standard error.
pub(super) struct Plain {
    table: Table,
}

impl Plain {
    /// With a line for every iteration where they are wanted.
    pub fn new(end_time: f64, iterations: bool) -> Self {
        Plain {
            table: Table::new(end_time, iterations),
        }
    }
}

impl Observer for Plain {
    fn event(&mut self, event: &Event) {
        for line in self.table.lines(event) {
            report::stderr(&format!("{line}\n"));
        }
    }
}

/// A table of steps and iterations above a progress bar.
pub(super) struct Terminal {
    table: Table,
    bar: ProgressBar,
}

impl Terminal {
    pub fn new(end_time: f64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
        let colour = if report::colours() { ".green" } else { "" };
        let template = format!("{{elapsed:>6}} [{{bar:32{colour}}}] {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Terminal {
            table: Table::new(end_time, true),
            bar,
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Terminal {
    fn event(&mut self, event: &Event) {
        for line in self.table.lines(event) {
            self.bar.println(line);
        }
        match event {
            Event::StepStarted { step, time, dt } => {
                self.bar.set_message(format!(
                    "step {step} to t = {} (dt = {})",
                    short(*time),
                    short(*dt)
                ));
                self.bar.tick();
            }
            Event::StepAccepted { time, .. } => {
                let part = (time / self.table.end_time).clamp(0.0, 1.0);
                self.bar.set_position((part * PARTS as f64) as u64);
            }
            _ => {}
        }
    }
}

/// Turns events into lines of text.
pub(super) struct Table {
    end_time: f64,
    iterations: bool,
    dt: f64,
    /// What went wrong in the step under way: told only where the step fails, which other starts mostly save it from.
    trouble: Vec<String>,
}

impl Table {
    pub fn new(end_time: f64, iterations: bool) -> Self {
        Table {
            end_time,
            iterations,
            dt: 0.0,
            trouble: Vec::new(),
        }
    }

    pub fn lines(&mut self, event: &Event) -> Vec<String> {
        match event {
            Event::Model {
                dofs,
                contact_points,
                effects,
                notes,
            } => {
                let mut lines = vec![format!("{dofs} dofs, {contact_points} contact points")];
                if !effects.is_empty() {
                    lines.push(format!("effects: {}", effects.join(", ")));
                }
                lines.extend(notes.iter().map(|n| format!("note: {n}")));
                lines.push(match self.iterations {
                    true => format!(
                        "{:>5} {:>10} {:>10} {:>5} {:>10} {:>10} {:>7} {:>8} {:>7}",
                        "step",
                        "time",
                        "dt",
                        "iter",
                        "residual",
                        "energy",
                        "active",
                        "changed",
                        "search"
                    ),
                    false => format!(
                        "{:>5} {:>10} {:>10} {:>5} {:>8} {:>12}",
                        "step", "time", "dt", "iter", "active", "penetration"
                    ),
                });
                lines
            }
            Event::StepStarted { dt, .. } => {
                self.dt = *dt;
                self.trouble.clear();
                Vec::new()
            }
            Event::Iteration {
                step,
                iteration,
                residual,
                energy,
                active,
                changed,
                line_search,
            } if self.iterations => {
                vec![format!(
                    "{step:>5} {:>10} {:>10} {iteration:>5} {residual:>10.3e} {energy:>10.3e} {active:>7} {changed:>8} \
                     {line_search:>7.3}",
                    "", ""
                )]
            }
            Event::Augmented {
                step,
                augmentation,
                contact,
                gap,
                slip,
            } if self.iterations => vec![format!(
                "{step:>5} {:>10} {:>10} `{contact}` augmented {augmentation}: gap {gap:.3e}, slip {slip:.3e}",
                "", ""
            )],
            Event::Iteration { .. } | Event::Augmented { .. } => Vec::new(),
            Event::Finished { status, .. } => {
                let trouble = std::mem::take(&mut self.trouble);
                match RunStatus::NotConverged.name() == status {
                    true => trouble,
                    false => Vec::new(),
                }
            }
            Event::PenaltyRaised {
                step,
                contact,
                penalty,
                left,
            } => vec![format!(
                "{step:>5} {:>10} {:>10} `{contact}`: penalty now {penalty:.3e}, {:.0} % of gaps left",
                "",
                "",
                100.0 * left
            )],
            Event::PenaltyRuled {
                step,
                contact,
                penalty,
                error,
            } if self.iterations => vec![format!(
                "{step:>5} {:>10} {:>10} `{contact}`: penalty now {penalty:.3e}, error before {:.1} %",
                "",
                "",
                100.0 * error
            )],
            Event::PenaltyRuled { .. } => Vec::new(),
            Event::PingPong {
                step,
                contact,
                points,
                period,
                broken,
                ..
            } => {
                self.trouble.push(format!(
                    "{step:>5} {:>10} {:>10} contact `{contact}`: {points} point(s) switch every {period} iterations the same; {broken}",
                    "", ""
                ));
                Vec::new()
            }
            Event::StepAccepted {
                step,
                time,
                iterations,
                failed_iterations,
                active,
                penetration,
            } => {
                self.trouble.clear();
                let (time, dt) = (short(*time), short(self.dt));
                let failed = match failed_iterations {
                    0 => String::new(),
                    n => format!("  (+{n} that failed)"),
                };
                vec![match self.iterations {
                    true => format!(
                        "{step:>5} {time:>10} {dt:>10} {iterations:>5} accepted, {active} active, penetration \
                         {penetration:.3e}{failed}"
                    ),
                    false => format!(
                        "{step:>5} {time:>10} {dt:>10} {iterations:>5} {active:>8} {penetration:>12.3e}{failed}"
                    ),
                }]
            }
            Event::StepCut {
                step,
                dt,
                next_dt,
                reason,
            } => {
                let (dt, next) = (short(*dt), short(*next_dt));
                let mut lines = std::mem::take(&mut self.trouble);
                lines.push(format!(
                    "{step:>5} {:>10} {dt:>10} cut to {next}: {reason}",
                    ""
                ));
                lines
            }
            Event::StepRetried {
                step,
                start,
                reason,
            } => {
                let again = format!("{step:>5} {:>10} {:>10} again from {start}", "", "");
                self.trouble.push(format!("{again}: {reason}"));
                // The numbers of iterations start anew, where they are shown.
                match self.iterations {
                    true => vec![again],
                    false => Vec::new(),
                }
            }
            Event::Note { text } => vec![format!("note: {text}")],
            Event::Warning { text } => vec![format!("warning: {text}")],
        }
    }
}

/// About six digits, without trailing zeros.
fn short(x: f64) -> String {
    let text = if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e6) {
        return format!("{x:.3e}");
    } else {
        format!("{x:.6}")
    };
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.125, "0.125"),
            (0.1 + 0.2, "0.3"),
            (1.0, "1"),
            (0.0, "0"),
            (1.5e-5, "1.500e-5"),
        ] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn every_line_of_the_table_is_as_wide_as_its_head() {
        let mut table = Table::new(1.0, true);
        let model = Event::Model {
            dofs: 3,
            contact_points: 2,
            effects: vec![],
            notes: vec!["a".into()],
        };
        let head = table.lines(&model);
        assert_eq!(head[..2], ["3 dofs, 2 contact points", "note: a"]);
        let iteration = Event::Iteration {
            step: 1,
            iteration: 2,
            residual: 1.25e-7,
            energy: 1.0,
            active: 5,
            changed: 0,
            line_search: 1.0,
        };
        let line = table.lines(&iteration);
        assert_eq!(line[0].len(), head[2].len());
        assert!(line[0].len() <= 80, "{}", line[0]);
        assert!(line[0].contains("1.250e-7"));
        assert!(Table::new(1.0, false).lines(&iteration).is_empty());
    }

    /// What went wrong with a start is told where the step fails, and not where another start saves it.
    #[test]
    fn trouble_is_told_only_where_the_step_fails() {
        let start = Event::StepStarted {
            step: 1,
            time: 1.0,
            dt: 1.0,
        };
        let retried = Event::StepRetried {
            step: 1,
            start: "a softened penalty".into(),
            reason: "turned inside out".into(),
        };
        let accepted = Event::StepAccepted {
            step: 1,
            time: 1.0,
            iterations: 7,
            failed_iterations: 12,
            active: 5,
            penetration: 1e-6,
        };
        let cut = Event::StepCut {
            step: 1,
            dt: 1.0,
            next_dt: 0.5,
            reason: "no convergence".into(),
        };
        let finished = |status: &str| Event::Finished {
            status: status.into(),
            wall_s: 1.0,
        };
        for live in [false, true] {
            let lines = |events: &[&Event]| {
                let mut table = Table::new(1.0, live);
                let told: Vec<String> = events.iter().flat_map(|e| table.lines(e)).collect();
                told.join("\n")
            };
            let calm = lines(&[&start, &retried, &accepted, &finished("done")]);
            assert!(!calm.contains("inside out"), "{calm}");
            assert!(calm.contains("(+12 that failed)"), "{calm}");
            // Where iterations are shown, so is where they start anew.
            assert_eq!(
                calm.contains("again from a softened penalty"),
                live,
                "{calm}"
            );
            for end in [&cut, &finished("not_converged")] {
                let told = lines(&[&start, &retried, end]);
                assert!(
                    told.contains("a softened penalty: turned inside out"),
                    "{told}"
                );
            }
            let stopped = lines(&[&start, &retried, &finished("interrupted")]);
            assert!(!stopped.contains("inside out"), "{stopped}");
        }
    }
}
