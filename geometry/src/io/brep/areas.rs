//! What it makes of a face to choose one of two kinds of boundary curves that contradict each other.

use super::curves::Tally;
use super::face::{Boundary, Face, Stretch};
use super::grant::Grant;
use super::host::Host;
use super::loops::{GAP, loops};
use super::metered::{Metered, NoSet, set_of};
use crate::NurbsPatch;
use crate::project::Joining;

/// Areas that differ by less than this share are the same face.
const SAME: f64 = 0.01;

/// The face that the curves in the parameter plane bound by themselves, if they do, with what became of them and what is to
/// be said of it.
pub fn by_parameters(
    host: &Host,
    face: &Face,
    sort: bool,
) -> Option<(NurbsPatch, Tally, Vec<String>)> {
    let stretch = |s: &Stretch| Stretch {
        parameter: s.parameter.clone(),
        ..Stretch::default()
    };
    let boundaries: Vec<Boundary> = (face.boundaries.iter())
        .map(|b| Boundary {
            name: b.name.clone(),
            stretches: b.stretches.iter().map(stretch).collect(),
        })
        .collect();
    let mut tally = Tally {
        tolerance: host.agree,
        ..Tally::default()
    };
    let mut said = Vec::new();
    let made = loops(host, &boundaries, sort, &mut tally, &mut said).ok()?;
    let trimmed = host.patch.trimmed_by(made, face.outer, GAP).ok()?;
    Some((trimmed.patch, tally, said))
}

/// Says how far the areas of a face as it was read and of the `other` one differ, if they do. Comparing them is charged to the
/// grant.
pub fn disagreement(read: &NurbsPatch, other: &NurbsPatch, grant: &Grant) -> Option<String> {
    let area = |patch| {
        let patch = Metered::trimmed(patch, grant);
        let work = patch.work_of_area();
        let set = set_of(vec![patch], Joining::default(), (grant, 0))?;
        match grant.spend(work) {
            true => Ok(set.areas()[0]),
            false => Err(NoSet::Work),
        }
    };
    match area(read).and_then(|read| Ok((read, area(other)?))) {
        Ok((read, other)) => ((read - other).abs() > SAME * read.max(other)).then(|| {
            format!(
                "as read its area is {read:.6}; its curves in the parameter plane would make it {other:.6}"
            )
        }),
        Err(NoSet::Patches(_)) => None,
        Err(reason) => Some(format!(
            "its area was not compared with that which its curves in the parameter plane would make: {reason}"
        )),
    }
}
