//! Whether elements that stand for those that gave way may do so: until then both bore the same loads, and what they stored of them
//! tells. Bricks of one change of volume each bend too little where they are long and too much where they are thick; a body that
//! bends is then better off with its own elements, whatever they do from there on.
use super::Simulation;
use super::variant::Safe;
use crate::model::error::number;
use crate::output::{RunStatus, Table};
use crate::run::march::{ALIKE, Caller, Ending};
use crate::scene::Element;
use serde::{Deserialize, Serialize};

/// Part of the strain energy by which two runs differ from which on the elements are kept; from [`ALIKE`] on it is told.
const OTHER: f64 = 0.3;

/// Part of the largest strain energy below which nothing is compared: first touches differ by more.
const LITTLE: f64 = 0.1;

/// A run that was given up for the elements of some bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Former {
    pub bodies: Vec<String>,
    /// Times and strain energies of its steps (energy).
    energies: Vec<[f64; 2]>,
    /// The last of them was accepted before its elements were looked into: what they answered in it may be no measure any more. Those of
    /// older checkpoints do not say.
    #[serde(default = "accepted")]
    accepted: bool,
}

fn accepted() -> bool {
    true
}

impl Former {
    /// The run of a history, whose last step was `accepted` before its elements were looked into, or is sound.
    pub fn new(bodies: Vec<String>, history: &Table, accepted: bool) -> Self {
        Former {
            bodies,
            energies: energies(history),
            accepted,
        }
    }

    /// When the elements gave way.
    fn end(&self) -> f64 {
        self.energies.last().map_or(0.0, |last| last[0])
    }

    /// The last step in which they held.
    fn sound(&self) -> f64 {
        let before = (self.energies.len()).checked_sub(1 + usize::from(self.accepted));
        before.map_or(0.0, |step| self.energies[step][0])
    }

    /// Its strain energy at a time. Between steps its root goes on in a straight line, as a displacement does.
    fn energy(&self, time: f64) -> f64 {
        let mut before = [0.0; 2];
        for &now in &self.energies {
            if time <= now[0] {
                let part = (time - before[0]) / (now[0] - before[0]).max(f64::MIN_POSITIVE);
                let [a, b] = [before[1], now[1]].map(|energy| energy.max(0.0).sqrt());
                return (a + part * (b - a)).powi(2);
            }
            before = now;
        }
        before[1]
    }

    /// The largest part by which the steps of another run differ from this one while it lasted, with their time.
    pub fn differs(&self, history: &Table) -> [f64; 2] {
        let most = (self.energies.iter()).fold(0.0f64, |most, [_, energy]| most.max(*energy));
        let eps = 1e-9 * self.end();
        let both = (energies(history).into_iter()).filter(|[time, _]| *time <= self.sound() + eps);
        let parts = both.map(|[time, energy]| {
            let own = self.energy(time);
            let larger = own.max(energy);
            match larger > LITTLE * most {
                true => [time, (own - energy).abs() / larger],
                false => [time, 0.0],
            }
        });
        parts.fold([0.0; 2], |worst, part| match part[1] > worst[1] {
            true => part,
            false => worst,
        })
    }
}

fn energies(history: &Table) -> Vec<[f64; 2]> {
    let columns = ["time", "energy.internal"].map(|name| history.column(name).unwrap_or_default());
    let [times, energies] = &columns;
    (times.iter().zip(energies))
        .map(|(t, e)| [*t, *e])
        .collect()
}

fn listed(bodies: &[String]) -> String {
    let names: Vec<String> = bodies.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

/// What was found of the elements that were kept, and what follows from it.
const KEPT: &str = "and were kept:";
const SO: &str = "what follows may be off";

/// The scene with the default elements of bodies for those that had taken their place.
fn kept(safe: &Safe, former: &Former, [time, part]: [f64; 2]) -> Option<Safe> {
    let mut kept = safe.clone();
    kept.former = None;
    for body in &former.bodies {
        kept.loaded.scene.bodies.get_mut(body)?.element = Element::H8;
        let head = format!("body `{body}`: its default elements");
        kept.changed.retain(|text| !text.starts_with(&head));
    }
    kept.kept.extend(former.bodies.iter().cloned());
    kept.changed.push(format!(
        "body {}: its default elements (`h8`) gave way at time {}, as they do under large strains, {KEPT} with \
         `h8_mean_dilatation` the strain energy at time {}, before that, is {:.0} % other; {SO}. Refine it",
        listed(&former.bodies),
        number(former.end()),
        number(time),
        100.0 * part
    ));
    Some(kept)
}

/// The scene with other elements for bodies whose default ones were kept, where these find no equilibrium.
pub(super) fn instead_of_kept(before: Option<&Safe>) -> Option<Safe> {
    let mut safe = before.filter(|safe| !safe.kept.is_empty())?.clone();
    for body in std::mem::take(&mut safe.kept) {
        safe.loaded.scene.bodies.get_mut(&body)?.element = Element::H8MeanDilatation;
    }
    for text in safe.changed.iter_mut().filter(|text| text.contains(KEPT)) {
        let found = "and then found no equilibrium; the run was repeated with others all the same:";
        let so = "forces, or displacements under given ones, may be off by as much";
        *text = text.replace(KEPT, found).replace(SO, so);
    }
    Some(safe)
}

impl Simulation<'_> {
    /// Compares the last step with the run that this one stands for: an ending, where the elements of that one are the better ones.
    pub(super) fn beside_former(&mut self) -> Option<Ending> {
        let former = self.safe.as_ref()?.former.clone()?;
        let now = self.time();
        let [time, part] = former.differs(&self.history);
        if part > OTHER && self.kept_elements().is_some() {
            let text = format!(
                "body {}: `h8_mean_dilatation` bends otherwise than its default elements",
                listed(&former.bodies)
            );
            return Some(Ending::new(RunStatus::NotConverged, Some(text)));
        }
        if now < former.sound() {
            return None;
        }
        if let Some(safe) = &mut self.safe {
            safe.former = None;
        }
        if part > ALIKE {
            let text = format!(
                "body {}: at time {}, before its default elements gave way, its strain energy with `h8_mean_dilatation` is {:.0} % \
                 other than with these: forces, or displacements under given ones, may be off by as much",
                listed(&former.bodies),
                number(time),
                100.0 * part
            );
            let caller = Caller {
                observer: &mut *self.options.observer,
                interrupt: self.options.interrupt,
            };
            (self.running).with_dependent_mut(|_, run| run.march(caller).0.warn(text));
        }
        None
    }

    /// The scene with the elements that gave way, where those in their place have been found to be no better.
    pub(super) fn kept_elements(&self) -> Option<Safe> {
        let safe = self.safe.as_ref()?;
        let former = safe.former.as_ref()?;
        let found = former.differs(&self.history);
        (found[1] > OTHER)
            .then(|| kept(safe, former, found))
            .flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::super::variant::safe_variant;
    use super::*;
    use crate::scene;

    fn history(rows: &[[f64; 2]]) -> Table {
        Table {
            columns: vec!["time".to_owned(), "energy.internal".to_owned()],
            rows: rows.iter().map(|row| row.to_vec()).collect(),
        }
    }

    /// Energies of a linear answer, which other steps do not change.
    #[test]
    fn runs_are_compared_at_the_same_times_while_both_last() {
        let of = |stiffness: f64, times: &[f64]| -> Vec<[f64; 2]> {
            times.iter().map(|t| [*t, stiffness * t * t]).collect()
        };
        let former = Former::new(
            vec!["b".to_owned()],
            &history(&of(1.0, &[0.1, 0.2, 0.5, 1.0])),
            true,
        );
        assert_eq!(former.end(), 1.0);
        let [_, same] = former.differs(&history(&of(1.0, &[0.15, 0.4, 0.7])));
        assert!(same < 1e-12, "{same}");
        let [time, part] = former.differs(&history(&of(2.0, &[0.05, 0.4])));
        assert_eq!(time, 0.4);
        assert!((part - 0.5).abs() < 1e-12, "{part}");
        // First touches are not compared, nor is the step in which the elements gave way.
        let [_, little] = former.differs(&history(&[[0.05, 0.09]]));
        let [_, later] = former.differs(&history(&[[0.6, 9.0]]));
        assert_eq!([little, later], [0.0; 2]);
    }

    /// Elements are taken back, and given again where nothing else is left, with what was found told of both.
    #[test]
    fn elements_come_and_go() {
        let scene = scene::parse(
            r#"{
                "covact": 1,
                "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3}}},
                "bodies": {"b": {"mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"}}
            }"#,
            "scene.json",
        )
        .unwrap();
        let steps = history(&[[0.1, 1.0], [0.2, 4.0], [0.3, 5.0]]);
        let element = |safe: &Safe| safe.loaded.scene.bodies["b"].element;
        let replaced = safe_variant(&scene, None, ["b"].into_iter(), (0.3, &steps, true)).unwrap();
        assert_eq!(element(&replaced), Element::H8MeanDilatation);
        assert!(instead_of_kept(Some(&replaced)).is_none());
        let former = replaced.former.clone().unwrap();
        let found = former.differs(&history(&[[0.1, 2.0], [0.2, 8.0], [0.3, 50.0]]));
        let back = kept(&replaced, &former, found).unwrap();
        assert_eq!(element(&back), Element::H8);
        assert_eq!(back.kept, ["b"]);
        assert!(back.former.is_none() && back.changed.len() == 1);
        let told = &back.changed[0];
        assert!(
            told.contains("gave way at time 0.3")
                && told.contains("at time 0.1, before that, is 50 % other"),
            "{told}"
        );
        let again = instead_of_kept(Some(&back)).unwrap();
        assert_eq!(element(&again), Element::H8MeanDilatation);
        assert!(again.kept.is_empty());
        assert!(
            again.changed[0].contains("found no equilibrium")
                && again.changed[0].contains("50 % other; forces")
        );
    }
}
