//! Is a result what it says? From its history and summary alone.
use super::{Matter, RandomScene};
use crate::output::{RunStatus, Summary, Table};

/// Something that is wrong with a result and that the run did not tell.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Finding(pub String);

/// Largest sum of all forces relative to the largest one of the run.
const BALANCE: f64 = 1e-6;
/// Part of the external work by which the energies may differ before that has to be told.
const ENERGY: f64 = 0.1;
/// Part of the slave's element size that points may sink in before that has to be told.
const SUNK: f64 = 0.05;

/// Looks for what is wrong with the result of a scene.
///
/// # Errors
/// The first thing found.
pub fn audit(scene: &RandomScene, summary: &Summary, history: &Table) -> Result<(), Finding> {
    let fail = |text: String| Err(Finding(text));
    let told = |words: &[&str]| {
        let found = |w: &String| words.iter().any(|word| w.contains(word));
        summary.warnings.iter().any(found)
    };
    if summary.status != RunStatus::Done && summary.reason.as_ref().is_none_or(String::is_empty) {
        return fail(format!(
            "ended as {} without a reason",
            summary.status.name()
        ));
    }
    let released = scene.effects.released_from(scene);
    let time = history.column("time").unwrap_or_default();
    for (row, time) in history.rows.iter().zip(time) {
        // Where no contact is active there is no gap.
        let gone = released.is_some_and(|released| time > released);
        let known = |i: usize| !(gone && history.columns[i] == "gap.min");
        if let Some(i) = (0..row.len()).find(|i| !row[*i].is_finite() && known(*i)) {
            return fail(format!("{} is {}", history.columns[i], row[i]));
        }
    }
    let (largest, out_of_balance) = balance(history, released);
    let out_of_balance = out_of_balance.filter(|_| scene.effects.balances());
    if let Some(finding) = out_of_balance.filter(|_| !told(&["viscous forces"])) {
        return Err(finding);
    }
    let column = |name: &str| {
        let found = history.column(name);
        found.ok_or_else(|| Finding(format!("no column {name}")))
    };
    // Without friction a state does not depend on the steps that led to it; the sum over them is off by what it sums up
    // with.
    let rest = match scene.effects.matter {
        Matter::Inertia { .. } => "energy.integrator",
        _ => "energy.imbalance",
    };
    let [scale, off] = [column("energy.external")?, column(rest)?]
        .map(|of| of.iter().fold(0.0f64, |a, x| a.max(x.abs())));
    if scene.mu.is_some() && off > ENERGY * scale && !told(&["energ"]) {
        return fail(format!(
            "the energies differ by {off:.2e} of {scale:.2e}, and nothing was told"
        ));
    }
    let deepest = column("penetration.max")?.into_iter().fold(0.0, f64::max);
    let size = scene.element_size();
    if deepest > SUNK * size && !told(&["penetration", "sank", "passed through"]) {
        return fail(format!(
            "points sank in by {deepest:.2e} of an element of {size:.2e}, and nothing was told"
        ));
    }
    if summary.status != RunStatus::Done {
        return Ok(());
    }
    let touched = column("points.active")?;
    if let Some(released) = released {
        // What is let go is not in contact at the end.
        let before = column("time")?
            .iter()
            .zip(&touched)
            .any(|(t, n)| *t <= released && *n > 0.0);
        return match before {
            true => Ok(()),
            false => fail("the run is done, but there was no contact".to_owned()),
        };
    }
    let pressing = touched.last().is_some_and(|n| *n > 0.0) && largest > 0.0;
    // Metal stays dented where a tool is drawn back over it, and a body with inertia bounces.
    let returns = matches!(scene.effects.matter, Matter::Elastic | Matter::Face);
    if scene.motion.pressed && returns && !pressing && !told(&["opened", "passed through"]) {
        return fail("the tool presses at the end, but nothing is in contact".to_owned());
    }
    if !(scene.motion.pressed && returns) && touched.iter().all(|n| *n == 0.0) {
        return fail("the run is done, but there was no contact".to_owned());
    }
    Ok(())
}

/// The largest of all forces on the bodies, and the first step at which they do not cancel before contacts are released: then they are
/// loads, which are no columns.
fn balance(history: &Table, released: Option<f64>) -> (f64, Option<Finding>) {
    let times = history.column("time").unwrap_or_default();
    let stays = |t: &f64| released.is_none_or(|released| *t <= released);
    let rows = times.iter().take_while(|t| stays(t)).count();
    let axis = |axis: &str| -> Vec<Vec<f64>> {
        let end = format!(".{axis}");
        let acting = |c: &&String| c.starts_with("force.") && c.ends_with(&end);
        let names = history.columns.iter().filter(acting);
        names.filter_map(|c| history.column(c)).collect()
    };
    let all = ["x", "y", "z"].map(axis);
    let values = all.iter().flatten().flatten();
    let largest = values.fold(0.0f64, |a, f| a.max(f.abs()));
    for (axis, columns) in ["x", "y", "z"].iter().zip(&all) {
        for row in 0..rows {
            let sum: f64 = columns.iter().map(|c| c[row]).sum();
            if sum.abs() > BALANCE * largest {
                let found = format!(
                    "forces along {axis} sum to {sum:.2e} at row {row}; the largest of the run is {largest:.2e}"
                );
                return (largest, Some(Finding(found)));
            }
        }
    }
    (largest, None)
}

impl RandomScene {
    /// Longest edge of an element in the surface that the tool meets.
    fn element_size(&self) -> f64 {
        use super::BodyKind::{Arch, Block, Sheet, SheetOnBlock};
        let size = match self.body {
            Sheet { size, .. } | Block { size, .. } | SheetOnBlock { size, .. } => size,
            Arch {
                radius,
                half_angle,
                half_width,
                ..
            } => [2.0 * radius * half_angle.to_radians(), 2.0 * half_width],
        };
        (size[0] / f64::from(self.elements[0])).max(size[1] / f64::from(self.elements[1]))
    }
}
