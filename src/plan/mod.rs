//! The plan of a run: every effect that the program has, on or off, why, and what it costs; and the loop over slave points
//! that each contact pair runs in. Made of a complete model, before anything is solved; the assembly does what it says.
mod bodies;
mod dynamics;
mod held;
mod laws;
mod pairs;
mod rest;
mod summary;
mod tangents;
pub mod without;

pub use held::{Held, Holder, Per};

use crate::model::kernel::Kernel;
use crate::model::symmetry::Unsymmetric;
use crate::model::{EffectKind, Model};
use crate::scene::{LoadedScene, Place};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// Every effect that the program has, in one scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Plan {
    /// Whether the system is symmetric.
    pub symmetric: bool,
    /// What makes it unsymmetric, a sentence for each effect.
    pub unsymmetric: Vec<String>,
    /// Effects of the scene as a whole.
    pub groups: Vec<Group>,
    /// Contact pairs in the order of the model, with the effects of each.
    pub pairs: Vec<PairPlan>,
}

/// Effects that belong together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// What they are about, e.g. "bodies".
    pub name: &'static str,
    /// The effects, in the order of the table.
    pub effects: Vec<Effect>,
}

/// What is done at the points of a contact pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairPlan {
    /// Name of the contact.
    pub name: String,
    /// The second of two half passes.
    pub back: bool,
    /// The sharp edges of the master as slaves.
    pub edges: bool,
    /// Slave faces, `body.set`.
    pub slave: String,
    /// Name of the rigid surface, or `body.set`.
    pub master: String,
    /// Slave points; those of segments as they are at the start.
    pub points: usize,
    /// The loop over the points: what the assembly dispatches on.
    #[serde(serialize_with = "as_text")]
    pub kernel: Kernel,
    /// Effects of the pair, on or off.
    pub effects: Vec<Effect>,
}

/// An effect that the program has, in one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// Name; that of a part begins with the name of the whole.
    pub name: &'static str,
    /// Whether it is on.
    pub on: bool,
    /// What of the scene or of its geometry decides, in words.
    pub why: String,
    /// JSON pointer of the key that decides, which the scene need not have.
    pub pointer: String,
    /// Where that key stands in the scene file, or what would hold it.
    #[serde(flatten)]
    pub place: Place,
    /// A detail, which the list of effects that are on ([`Plan::names`]) leaves out.
    pub detail: bool,
    /// It takes the symmetry from the system.
    pub unsymmetric: bool,
    /// Work that it adds, in words; empty where that is no number of the program or the model.
    pub cost: String,
    /// Memory that it takes; nothing where it is off.
    pub held: Vec<Held>,
}

fn as_text<S: Serializer>(kernel: &Kernel, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(kernel)
}

impl Plan {
    /// The plan of a model.
    pub fn new(loaded: &LoadedScene, model: &Model) -> Plan {
        let teller = Reporter { loaded, model };
        let pairs = model.pairs.iter().enumerate().map(|(index, pair)| {
            let kernel = Kernel::of(model, pair);
            PairPlan {
                name: pair.name.clone(),
                back: pair.half.is_some_and(|h| h.back),
                edges: pair.edges_of.is_some(),
                slave: pair.slave.clone(),
                master: pair.master_name(model).to_owned(),
                points: pair.points.len(),
                kernel,
                effects: teller.pair(index, &kernel),
            }
        });
        Plan {
            symmetric: model.unsymmetric.is_empty(),
            unsymmetric: model.unsymmetric.iter().map(|u| u.why.clone()).collect(),
            pairs: pairs.collect(),
            groups: teller.groups(),
        }
    }

    /// All effects, those of pairs last.
    pub fn effects(&self) -> impl Iterator<Item = &Effect> {
        let groups = self.groups.iter().flat_map(|g| &g.effects);
        groups.chain(self.pairs.iter().flat_map(|p| &p.effects))
    }

    /// Names of the effects that are on, details left out, sorted.
    pub fn names(&self) -> Vec<String> {
        self.named(false)
    }

    /// Names of the details that are on, sorted.
    pub fn details(&self) -> Vec<String> {
        self.named(true)
    }

    fn named(&self, details: bool) -> Vec<String> {
        let on = self.effects().filter(|e| e.on && e.detail == details);
        let mut names: Vec<String> = on.map(|e| e.name.to_owned()).collect();
        names.sort();
        names.dedup();
        names
    }

    /// Bytes that the effects that are on announce for a part of what holds it, in one copy, and whether that is a number
    /// that grows in the course of a run.
    pub fn announced(&self, holder: Holder, part: &str) -> (usize, bool) {
        let held = self.effects().flat_map(|e| &e.held);
        let own = held.filter(|h| h.holder == holder && h.part == part);
        own.fold((0, false), |(bytes, grows), h| {
            (bytes + h.each * h.count, grows || h.grows)
        })
    }
}

impl Effect {
    /// Bytes that a run holds for it, all copies.
    pub fn bytes(&self) -> usize {
        self.held.iter().map(Held::bytes).sum()
    }

    /// Bytes for each point, element or node that a run holds for it, all copies; none where there are none.
    pub fn bytes_per(&self, per: Per) -> Option<usize> {
        // Parts of several bodies or surfaces: what the largest takes.
        let mut parts: BTreeMap<&str, usize> = BTreeMap::new();
        for held in self.held.iter().filter(|h| h.per == per) {
            let most = parts.entry(held.part).or_default();
            *most = (*most).max(held.each * held.copies);
        }
        let bytes = parts.values().sum();
        (bytes > 0).then_some(bytes)
    }

    fn costs(mut self, cost: impl Into<String>) -> Self {
        if self.on {
            self.cost = cost.into();
        }
        self
    }

    fn holds(mut self, held: Vec<Held>) -> Self {
        if self.on {
            let some = |h: &Held| h.each * h.count > 0 || h.grows;
            self.held = held.into_iter().filter(some).collect();
        }
        self
    }
}

/// Why an effect is on, or why it is off.
type Why = Result<String, String>;

/// On or off, with the reason.
fn why(on: bool, yes: impl Into<String>, no: impl Into<String>) -> Why {
    match on {
        true => Ok(yes.into()),
        false => Err(no.into()),
    }
}

/// Makes the entries of a plan.
struct Reporter<'a> {
    loaded: &'a LoadedScene,
    model: &'a Model,
}

impl Reporter<'_> {
    /// An effect that the key at `pointer` decides about.
    fn effect(&self, kind: EffectKind, pointer: impl Into<String>, why: Why) -> Effect {
        let pointer = pointer.into();
        let (on, why) = match why {
            Ok(why) => (true, why),
            Err(why) => (false, why),
        };
        let place = self.loaded.place_of(&pointer);
        Effect {
            name: kind.name(),
            on,
            why,
            pointer,
            place,
            detail: kind.is_detail(),
            unsymmetric: false,
            cost: String::new(),
            held: Vec::new(),
        }
    }

    /// The effect of `of`, a contact, a load or a law, takes the symmetry where the model says so.
    fn unsymmetric(&self, mut effect: Effect, of: &str) -> Effect {
        let takes = |u: &Unsymmetric| u.effect.name() == effect.name && u.of == of;
        effect.unsymmetric = effect.on && self.model.unsymmetric.iter().any(takes);
        effect
    }

    fn groups(&self) -> Vec<Group> {
        let group = |name, effects| Group { name, effects };
        let mut out = vec![
            group("bodies", self.bodies()),
            group("rigid surfaces", self.surfaces()),
            group("supports and loads", self.conditions()),
            group("solution", self.solution()),
            group("output", self.output()),
        ];
        if self.model.pairs.is_empty() {
            out.push(group("contact", self.no_contact()));
        }
        out
    }

    /// The effects of contact pairs, where there are none.
    fn no_contact(&self) -> Vec<Effect> {
        let off = |kind| {
            let why = Err("the scene has no contacts".to_owned());
            self.effect(kind, "/contacts", why)
        };
        let kinds = EffectKind::ALL.iter().copied();
        kinds.filter(|kind| kind.of_pairs()).map(off).collect()
    }
}
