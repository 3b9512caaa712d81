//! What must not change an answer: motion, numbering, parametrisation, order, threads.
use super::scenes::block_under;
use super::{Broken, Case, Group, Trial};
use serde_json::json;

pub const GROUP: Group = Group {
    name: "invariance",
    cases: &[Case {
        name: "threads",
        what: "a ball pressed into a block, on one thread and on four",
        right: "the same bits",
        run: threads,
    }],
};

fn threads(trial: &mut Trial) -> Result<(), Broken> {
    let ball = json!({
        "sphere": { "radius": 0.5 },
        "placement": { "translation": [0, 0, 1.01] },
        "motion": { "translation": [0, 0, "-0.1*t"] }
    });
    let mut scene = block_under(ball, 8, 3);
    let one = trial.done(&scene)?;
    scene["solution"]["threads"] = 4.into();
    let four = trial.done(&scene)?;
    trial.holds("contact", one.last("force.tool.z")? < -1.0);
    trial.holds("the same rows", one.history == four.history);
    trial.iterations(40);
    Ok(())
}
