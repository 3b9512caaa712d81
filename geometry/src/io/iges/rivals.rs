//! Faces whose two kinds of boundary curves contradict each other: which kind is meant, by how they meet their neighbours.
//!
//! The flag PREF of a boundary (142, 141) says which kind its writer prefers, and some set it on curves that are mirrored or
//! turned. What belongs to a part has edges in common with the faces around it.

use super::super::report::CadPatch;
use super::Model;
use super::faces::Outcome;
use crate::io::brep::{Metered, NoSet, Tally, add, set_of};
use crate::io::report::FaceBorder;
use crate::patch::PatchError;
use crate::project::{Joining, PatchSet};
use crate::surface::Surface;
use crate::{NurbsPatch, Vec3};

/// Surfaces within this share of a face's size may be its neighbours.
const AROUND: f64 = 1e-3;
/// The other curves count if they leave fewer of the edges without a neighbour by this share of them.
const CLEARLY: f64 = 0.05;
/// Faces that a note names.
const NAMED: usize = 8;

/// A face as its curves in the parameter plane would bound it, where those in space were taken.
pub struct Rival {
    pub patch: NurbsPatch,
    pub border: FaceBorder,
    /// What became of the curves, for the face as it was read and for this one.
    pub tallies: [Tally; 2],
    /// What is to be said of each.
    pub notes: [Vec<String>; 2],
}

impl Rival {
    /// The same with the opposite normal.
    pub fn turned(self) -> Result<Self, PatchError> {
        let patch = self.patch.reversed(0)?;
        Ok(Self { patch, ..self })
    }
}

/// All of a file, with the entity and the instance of the patch that each stands against.
#[derive(Default)]
pub struct Rivals {
    found: Vec<(u32, u32, Rival)>,
}

impl Extend<(u32, u32, Rival)> for Rivals {
    fn extend<I: IntoIterator<Item = (u32, u32, Rival)>>(&mut self, rivals: I) {
        self.found.extend(rivals);
    }
}

impl Rivals {
    /// Takes for all of them the kind of curves with which more of their edges have a neighbour; as they were read if none
    /// has clearly more.
    pub fn settle(self, out: &mut Outcome, model: &Model, notes: &mut Vec<String>) {
        let place = |&(entity, instance, _): &(u32, u32, Rival)| {
            let own = |p: &CadPatch| (p.entity, p.instance) == (entity, instance);
            out.patches.iter().position(own)
        };
        let places: Vec<Option<usize>> = self.found.iter().map(place).collect();
        let standing = places.into_iter().zip(self.found);
        let standing: Vec<(usize, Rival)> = standing
            .filter_map(|(place, (.., rival))| Some((place?, rival)))
            .collect();
        if standing.is_empty() {
            return;
        }
        let shares = free_shares(&out.patches, &standing, model);
        let clearly = |[own, other]: [f64; 2]| other + CLEARLY < own;
        let chosen = usize::from(shares.as_ref().is_ok_and(|&shares| clearly(shares)));
        match shares {
            Ok(shares) if shares[0] != shares[1] => {
                notes.push(told(&out.patches, &standing, shares, chosen));
            }
            Ok(_) | Err(NoSet::Patches(_)) => {}
            Err(reason) => notes.push(format!(
                "{}; those in space were taken without a look at how either meet the faces around them: {reason}",
                contradicting(&out.patches, &standing)
            )),
        }
        for (place, mut rival) in standing {
            notes.append(&mut rival.notes[chosen]);
            add(&mut out.trims, &rival.tallies[chosen]);
            if chosen == 1 {
                let patch = &mut out.patches[place];
                (patch.patch, patch.border) = (rival.patch, rival.border);
            }
        }
    }
}

/// Share of the edges of the faces in question that no neighbour goes on from, as they were read and as their rivals are, unless
/// that cannot be told.
fn free_shares(
    patches: &[CadPatch],
    standing: &[(usize, Rival)],
    model: &Model,
) -> Result<[f64; 2], NoSet> {
    let grant = &model.grant;
    let boxes: Vec<[Vec3; 2]> = (standing.iter())
        .flat_map(|(place, rival)| [patches[*place].patch.bounds(), rival.patch.bounds()])
        .collect();
    let near = |patch: &NurbsPatch| {
        let [low, high] = patch.bounds();
        boxes.iter().any(|[a, b]| {
            let slack = AROUND * (b - a).norm();
            (0..3).all(|k| low[k] <= b[k] + slack && high[k] >= a[k] - slack)
        })
    };
    let around: Vec<usize> = (0..patches.len())
        .filter(|&k| near(&patches[k].patch))
        .collect();
    let rival = |k: usize| standing.iter().find(|s| s.0 == k).map(|s| &s.1.patch);
    let share = |other: bool| -> Result<f64, NoSet> {
        let patch = |&k: &usize| {
            let chosen = rival(k).filter(|_| other);
            Metered::trimmed(chosen.unwrap_or(&patches[k].patch), grant)
        };
        let joining = Joining {
            tolerance: None,
            resolution: model.resolution(),
        };
        let own = around.iter().map(patch).collect();
        let set = set_of(own, joining, (grant, 0))?;
        let (mut free, mut all) = (0.0, 0.0);
        for (number, _) in (around.iter().enumerate()).filter(|(_, k)| rival(**k).is_some()) {
            let trim = set.patches()[number].trim();
            all += trim.map_or(4.0, |t| t.curve_count() as f64);
            free += free_edges(&set, number as u32);
        }
        Ok(free / all)
    };
    Ok([share(false)?, share(true)?])
}

/// Edges of a patch that no neighbour goes on from; those that one has in part count in part.
fn free_edges(set: &PatchSet<Metered>, patch: u32) -> f64 {
    let report = set.edges();
    let own = report.free.iter().filter(|e| e.0 == patch);
    let shares = own.map(|edge| {
        let part = report.partial.iter().find(|p| p.edge == *edge);
        1.0 - part.map_or(0.0, |p| p.share)
    });
    let folded = report.folded.iter().filter(|e| e.0 == patch).count();
    shares.sum::<f64>() + folded as f64
}

/// Names the faces in question.
fn contradicting(patches: &[CadPatch], standing: &[(usize, Rival)]) -> String {
    let numbers: Vec<String> = (standing.iter().take(NAMED))
        .map(|(place, _)| patches[*place].entity.to_string())
        .collect();
    let more = match standing.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    format!(
        "entities {}{more}: their curves in the parameter plane and in space contradict each other",
        numbers.join(", ")
    )
}

fn told(
    patches: &[CadPatch],
    standing: &[(usize, Rival)],
    shares: [f64; 2],
    chosen: usize,
) -> String {
    let [own, other] = shares.map(|s| 100.0 * s);
    format!(
        "{}; with those in space {own:.0} % of their edges have no neighbour that goes on from there, with those in the parameter \
         plane {other:.0} %; those {} were taken",
        contradicting(patches, standing),
        ["in space", "in the parameter plane"][chosen]
    )
}
