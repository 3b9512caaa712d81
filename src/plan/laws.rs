//! The laws of a contact pair beyond the penalty: friction, augmentation, offset, overclosures.
use super::pairs::EffectContext;
use super::{Effect, Held, Per, Reporter, why};
use crate::assembly::sizes;
use crate::contact::friction::history::PointHistory;
use crate::contact::kind::FrictionKind;
use crate::model::EffectKind;
use crate::model::PairModel;
use crate::model::error::number;
use crate::scene::{InitialOverclosure, Penalty};

impl Reporter<'_> {
    pub(super) fn friction(&self, told: &EffectContext) -> Vec<Effect> {
        let pair = told.pair;
        let off = |word: &str| match &told.contact.friction {
            None => {
                "no `friction`: points have no history of slip, and the system keeps its symmetry"
                    .to_owned()
            }
            Some(_) if pair.friction.is_none() => {
                "the coefficient is zero throughout, so that there is no friction".to_owned()
            }
            Some(_) => format!("`friction` is not {word}"),
        };
        let moving = pair.body_master().is_some();
        let large = self.model.small.is_none();
        let asked = pair.friction.as_ref().map(|f| f.law.kind().name());
        let key = asked.map_or(told.key("friction"), |law| {
            told.key(&format!("friction/{law}"))
        });
        let mut out = Vec::new();
        for kind in FrictionKind::LAWS {
            let Some(effect) = kind.effect() else {
                continue;
            };
            let (on, word) = (told.kernel.friction == kind, kind.name());
            let ratio = pair.friction.as_ref().map_or(0.0, |f| f.ratio);
            let reason = why(
                on,
                format!(
                    "`friction` is {word}, with a tangential penalty of {} of the normal one{}",
                    number(ratio),
                    match told.contact.tangential_penalty {
                        Penalty::Auto => "",
                        _ => " (`tangential_penalty`)",
                    }
                ),
                off(word),
            );
            let cost = match moving {
                _ if !large => "a 3 x 3 tangent a point, and a factorization in every iteration",
                true => {
                    "two 9 x 9 tangents a point, and columns of the attraction point's facet; a law"
                }
                false => {
                    "a law and a trial traction a point; the tangent stays 3 x 3, without symmetry"
                }
            };
            let friction = self.effect(effect, key.clone(), reason).costs(cost);
            let mut held = self.history(told);
            if pair.links() && moving {
                held.push(Held::assembler("links", Per::Whole, 0, 1).growing());
                if let (true, Some([each, fixed])) = (large, sizes::sliding(pair)) {
                    let n = told.points();
                    let points = Held::assembler("sliding points", Per::Point, each, n);
                    let room = Held::assembler("sliding points", Per::Whole, fixed, 1);
                    held.extend([points, room].map(|h| h.of_points(pair.segments().is_some())));
                }
            }
            if let Some([each, room]) = sizes::rubs(pair) {
                let n = told.points();
                held.push(Held::assembler("rubbing points", Per::Point, each, n));
                held.push(Held::assembler("rubbing points", Per::Whole, room, 1).growing());
            }
            let rubs = |p: &PairModel| p.friction.is_some();
            if self.model.pairs.iter().position(rubs) == Some(told.index) {
                let (nodes, n) = (self.model.nodes.len(), self.model.histories());
                held.push(Held::run("friction fields", Per::Node, 88, nodes));
                // One list for all points with history.
                let slips = Held::assembler("slips", Per::Point, sizes::SLIP, n);
                held.push(slips.of_points(self.model.recuts_histories()));
                if !large {
                    held.push(Held::assembler("linear", Per::Point, sizes::RUBBING, n));
                }
            }
            let surface = pair.rigid_master().map(|s| &self.model.surfaces[s]);
            if surface.is_some_and(|s| s.driven.is_some()) {
                held.extend(self.slides(told));
            }
            out.push(self.unsymmetric(friction.holds(held), &pair.name));
        }
        out
    }

    /// What driven surfaces hold for the friction of their pairs, told with the first of these.
    fn slides(&self, told: &EffectContext) -> Option<Held> {
        let surface = told.pair.rigid_master();
        let rubs = |p: &&PairModel| p.rigid_master() == surface && p.friction.is_some();
        let first = self.model.pairs.iter().find(rubs)?;
        let nodes = sizes::slave_nodes(self.model, surface?);
        std::ptr::eq(first, told.pair)
            .then(|| Held::assembler("driven friction", Per::Node, sizes::BELOW, nodes))
    }

    /// Histories, once for friction and augmentation.
    fn history(&self, told: &EffectContext) -> Vec<Held> {
        let each = size_of::<PointHistory>();
        let histories = Held::state("histories", Per::Point, each, told.pair.carriers());
        vec![histories.of_points(told.pair.segments().is_some())]
    }

    /// Augmentation, offset, and what becomes of overclosures at the start.
    pub(super) fn further(&self, told: &EffectContext) -> Vec<Effect> {
        let pair = told.pair;
        let mut held = Vec::new();
        if pair.augmentation.is_some() {
            if pair.friction.is_none() {
                held.extend(self.history(told));
            }
            let augmented = |p: &PairModel| p.augmentation.is_some();
            if self.model.pairs.iter().position(augmented) == Some(told.index) {
                // One list for all points with history.
                let n = self.model.histories();
                let answers = Held::assembler("answers", Per::Point, sizes::ANSWER, n);
                let watched = Held::run("multipliers watched", Per::Point, 16, n);
                let cut = self.model.recuts_histories();
                held.extend([answers, watched].map(|h| h.of_points(cut)));
            }
        }
        let augmentation = self
            .effect(
                EffectKind::Augmentation,
                told.key("augmentation"),
                match &pair.augmentation {
                    Some(a) => Ok(format!(
                        "`augmentation`: until gaps are below {}, {} times a step at most",
                        number(a.gap),
                        a.max
                    )),
                    None => Err("no `augmentation`: the penalty alone holds the points".to_owned()),
                },
            )
            .costs("a solve more for each augmentation of a step")
            .holds(held);
        let offset = self.effect(
            EffectKind::Offset,
            told.key("offset"),
            why(
                pair.offset > 0.0,
                match pair.body_master().map_or(0.0, |m| m.height) {
                    0.0 => format!("`offset`: contact begins {} in front", number(pair.offset)),
                    height => format!(
                        "contact begins {} in front of the mid-surface, with half of the thickness {}",
                        number(pair.offset),
                        number(height)
                    ),
                },
                match self.loaded.has(&told.key("offset")) {
                    true => "`offset` is zero",
                    false => "no `offset`: contact begins on the master",
                },
            ),
        );
        let mut out = vec![augmentation, offset];
        let choice = told.contact.initial_overclosure;
        let kinds = [
            (
                EffectKind::OverclosureStressFree,
                choice == InitialOverclosure::StressFree,
            ),
            (
                EffectKind::OverclosureShrink,
                matches!(choice, InitialOverclosure::Shrink { .. }),
            ),
        ];
        for (effect, asked) in kinds {
            let reason = match (asked, &pair.overclosure) {
                (true, Some(over)) => {
                    let below = over.z0.iter().filter(|z| **z < 0.0).count();
                    Ok(format!("{below} point(s) start below the master"))
                }
                (true, None) => Err("no point starts below the master".to_owned()),
                (false, _) => Err(match choice {
                    InitialOverclosure::Strain => {
                        "what starts below the master is resolved with strain"
                    }
                    InitialOverclosure::Refuse => "what starts below the master is refused",
                    _ => "`initial_overclosure` is another",
                }
                .to_owned()),
            };
            let n = pair.overclosure.as_ref().map_or(0, |o| o.z0.len());
            let key = told.key("initial_overclosure");
            let effect = self.effect(effect, key, reason).holds(vec![Held::model(
                "overclosures",
                Per::Point,
                size_of::<f64>(),
                n,
            )]);
            out.push(effect);
        }
        let n = pair.bow.len();
        out.push(
            self.effect(
                EffectKind::OverclosureCurved,
                told.key("initial_overclosure"),
                why(
                    n > 0,
                    "flat facets change the overclosure at the start by more than 1 %".to_owned(),
                    "flat facets change no overclosure at the start by more than 1 %",
                ),
            )
            .holds(vec![Held::model(
                "bows of facets",
                Per::Point,
                size_of::<f64>(),
                n,
            )]),
        );
        out
    }
}
