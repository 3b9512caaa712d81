//! The effects of a contact pair: slave points, and what they meet.
use super::{Effect, Held, Per, Reporter, why};
use crate::assembly::sizes;
use crate::contact::lever::{self, Lever};
use crate::contact::points::SlavePoint;
use crate::model::EffectKind;
use crate::model::PairModel;
use crate::model::error::number;
use crate::model::kernel::{GapKind, Kernel};
use crate::model::state::PointState;
use crate::model::surface::SurfaceSet;
use crate::scene::{Contact, FacetKind, Penalty, Points};

/// A contact pair that is told about.
pub(super) struct EffectContext<'a> {
    pub index: usize,
    pub pair: &'a PairModel,
    pub contact: &'a Contact,
    pub kernel: &'a Kernel,
    /// Its name in the scene's pointers.
    pub at: String,
}

impl EffectContext<'_> {
    /// Pointer of one of the contact's keys.
    pub fn key(&self, key: &str) -> String {
        format!("{}/{key}", self.at)
    }

    pub fn points(&self) -> usize {
        self.pair.points.len()
    }
}

impl Reporter<'_> {
    /// All effects of a pair.
    pub(super) fn pair(&self, index: usize, kernel: &Kernel) -> Vec<Effect> {
        let pair = &self.model.pairs[index];
        let Some(contact) = self.loaded.scene.contacts.get(&pair.name) else {
            return Vec::new();
        };
        let told = EffectContext {
            index,
            pair,
            contact,
            kernel,
            at: crate::scene::pointer(&["contacts", &pair.name]),
        };
        let mut out = vec![self.penalty(&told)];
        out.extend(self.masters(&told));
        out.extend(self.facets(&told));
        out.extend(self.sampling(&told));
        out.extend(self.gaps(&told));
        out.extend(self.tangents(&told));
        out.extend(self.friction(&told));
        out.extend(self.further(&told));
        out
    }

    fn penalty(&self, told: &EffectContext) -> Effect {
        let why = match told.contact.penalty {
            Penalty::Auto => format!(
                "the stiffness of the elements makes it {}: no `penalty` is given",
                number(told.pair.eps_n)
            ),
            Penalty::Value(_) => format!("`penalty` is {}", number(told.pair.eps_n)),
            Penalty::Scaled(factor) => format!(
                "`penalty` is {} times the automatic one: {}",
                number(factor),
                number(told.pair.eps_n)
            ),
        };
        let levers = told
            .pair
            .points
            .first()
            .is_some_and(|p| p.lever_number().is_some());
        let lever = if levers { size_of::<Lever>() } else { 0 };
        let (n, first) = (told.points(), told.index == 0);
        let nodes = if first { self.model.nodes.len() } else { 0 };
        let held = vec![
            Held::model(
                "slave points",
                Per::Point,
                size_of::<SlavePoint>() + lever,
                n,
            ),
            Held::state("points", Per::Point, size_of::<PointState>(), n),
            Held::assembler("contact forces", Per::Node, 24, nodes),
            Held::assembler("pairs", Per::Whole, sizes::PAIR, 1),
        ];
        self.effect(EffectKind::NormalPenalty, told.key("penalty"), Ok(why))
            .holds(held)
    }

    fn masters(&self, told: &EffectContext) -> Vec<Effect> {
        let (pair, key) = (told.pair, told.key("master"));
        let name = pair.master_name(self.model);
        let nodes = |p: &SlavePoint| match p.lever_number() {
            Some(_) => lever::NODES,
            None => p.count as usize,
        };
        let slave = 3 * pair.points.iter().map(nodes).max().unwrap_or(0);
        let rigid = pair.body_master().is_none();
        let of_body = pair.body_master();
        let own = of_body.and_then(|m| m.own.as_ref());
        let large = self.model.small.is_none();
        let most = |p: &PairModel| match p.rigid_master().is_some() && p.averaged.is_none() {
            true if large => p.points.len(),
            _ => 0,
        };
        // One buffer serves all pairs: it belongs to the first of those with most points.
        let largest = self.model.pairs.iter().map(most).max().unwrap_or(0);
        let is_first = (self.model.pairs.iter()).position(|p| most(p) == largest && largest > 0)
            == Some(told.index);
        let mut held = Vec::new();
        if rigid {
            if large {
                let bytes = sizes::RIGID_MAP + sizes::rigid_map(self.model, pair);
                held.push(Held::assembler("rigid maps", Per::Whole, bytes, 1));
            }
            let n = if is_first { largest } else { 0 };
            held.push(Held::assembler("rigid points", Per::Point, sizes::TOUCH, n));
            let n = if most(pair) > 0 { pair.points.len() } else { 0 };
            held.push(Held::assembler(
                "clearances",
                Per::Point,
                sizes::CLEARANCE,
                n,
            ));
            held.push(Held::assembler("points kept", Per::Point, 1, 0).growing());
        }
        let rigid = self
            .effect(
                EffectKind::MasterRigid,
                &key,
                why(
                    rigid,
                    format!("`master` is the rigid surface `{name}`"),
                    format!("`master` is faces of a body, `{name}`"),
                ),
            )
            .costs(format!(
                "no master rows: a 3 x 3 tangent a point, scattered to {slave} x {slave}"
            ))
            .holds(held);
        let mut held = Vec::new();
        let mut cost = String::new();
        if let Some(body) = of_body {
            let facets = 0..body.facets.len() as u32;
            let facet = facets.map(|f| body.facets.nodes(f).len()).max();
            let size = slave + 3 * facet.unwrap_or(0);
            cost = format!("9 x 9 slots a point, scattered to {size} x {size}");
            held.push(Held::assembler("masters", Per::Whole, sizes::MASTER, 1).growing());
            held.push(Held::assembler("couplings", Per::Whole, sizes::COUPLINGS, 1).growing());
            if let (true, Some([each, fixed])) = (large, sizes::meetings(pair)) {
                let points = Held::assembler("points on bodies", Per::Point, each, told.points());
                let room = Held::assembler("points on bodies", Per::Whole, fixed, 1);
                held.extend([points, room].map(|h| h.of_points(pair.segments().is_some())));
            }
        }
        let deformable = self
            .effect(
                EffectKind::MasterDeformable,
                &key,
                why(
                    of_body.is_some(),
                    format!("`master` is faces of a body, `{name}`"),
                    format!("`{name}` is a rigid surface, which has no nodes"),
                ),
            )
            .costs(cost)
            .holds(held);
        let smooth = of_body.is_some_and(|m| m.smooth);
        let smooth = self.effect(
            EffectKind::MasterSmooth,
            told.key("master_surface"),
            why(
                smooth,
                "`master_surface` is `smooth`",
                match of_body {
                    Some(_) => "no `master_surface` of `smooth`: the faces are taken as they are",
                    None => "the master is no body",
                },
            ),
        );
        let own = self.effect(
            EffectKind::SelfContact,
            &key,
            why(
                own.is_some(),
                format!("slave and master are faces of one body, {}", {
                    let body = &self.model.bodies[pair.body].name;
                    format!("`{body}`")
                }),
                "slave and master are not on one body",
            ),
        );
        vec![rigid, deformable, smooth, own]
    }

    /// What a rigid surface is made of.
    fn facets(&self, told: &EffectContext) -> Vec<Effect> {
        let surface = told.pair.rigid_master().map(|s| &self.model.surfaces[s]);
        let of_surface = |key: &str| match surface {
            Some(surface) => format!(
                "{}/{key}",
                crate::scene::pointer(&["surfaces", &surface.name])
            ),
            None => told.key("master"),
        };
        let kinds = [
            (FacetKind::Bilinear, EffectKind::FacetsBilinear, "bilinear"),
            (
                FacetKind::Biquadratic,
                EffectKind::FacetsBiquadratic,
                "biquadratic",
            ),
            (FacetKind::Smooth, EffectKind::FacetsSmooth, "smooth"),
        ];
        let mut out: Vec<Effect> = (kinds.into_iter())
            .map(|(kind, effect, word)| {
                let facets = surface.and_then(|s| s.facets.as_ref());
                let reason = match (surface, facets) {
                    (None, _) => Err("the master is no rigid surface".to_owned()),
                    (Some(s), None) => Err(format!(
                        "no `facets`: surface `{}` is used as it is, {} patch(es)",
                        s.name,
                        s.set.count()
                    )),
                    (Some(s), Some(f)) if f.kind == kind => Ok(match f.chord {
                        Some(chord) => format!(
                            "`facets` are {word}: {} of them, {} from surface `{}` at most",
                            f.count,
                            number(chord),
                            s.name
                        ),
                        None => format!("surface `{}` is {} triangles of a file", s.name, f.count),
                    }),
                    (Some(_), Some(f)) => Err(format!("the facets are {}", f.kind.name())),
                };
                let key = match facets.is_some_and(|f| f.chord.is_none()) {
                    true => of_surface("cad"),
                    false => of_surface("facets"),
                };
                self.effect(effect, key, reason)
            })
            .collect();
        let trims = surface.map_or(0, |s| match &s.set {
            SurfaceSet::Nurbs(set) => set.patches().iter().filter(|p| p.trim().is_some()).count(),
            _ => 0,
        });
        let trimmed = self.effect(
            EffectKind::MasterTrimmed,
            of_surface("cad"),
            why(
                trims > 0,
                format!("{trims} of the master's patches are trimmed"),
                "no patch of the master is trimmed",
            ),
        );
        out.push(trimmed);
        out
    }

    fn sampling(&self, told: &EffectContext) -> Vec<Effect> {
        // Of sheets, whose control points do not lie on them.
        let levers = told
            .pair
            .points
            .first()
            .is_some_and(|p| p.lever_number().is_some());
        let points = match told.pair.sampled {
            Points::Nodes if levers => Points::Gauss(4),
            points => points,
        };
        let [n, faces] = [told.points(), told.pair.faces.len()];
        let words = match points {
            Points::Auto | Points::Nodes => "nodes".to_owned(),
            Points::Gauss(n) => format!("{n} x {n} Gauss points a face"),
            Points::Lobatto(n) => format!("{n} x {n} Lobatto points a face"),
            Points::Segments(n) => format!("segments with rules of degree {n}"),
        };
        let given = match points {
            Points::Nodes if !self.loaded.has(&told.key("points")) => {
                format!("no `points`: {n} nodes of {faces} faces")
            }
            _ if levers => {
                format!("{words}: {n} on {faces} faces, half of the thickness from the mid-surface")
            }
            _ if told.contact.points == Points::Auto => {
                format!("no `points`, and coarser than the master: {words}, {n} on {faces} faces")
            }
            _ => format!("`points` are {words}: {n} on {faces} faces"),
        };
        let kinds = [
            (EffectKind::PointsNodes, matches!(points, Points::Nodes)),
            (EffectKind::PointsGauss, matches!(points, Points::Gauss(_))),
            (
                EffectKind::PointsLobatto,
                matches!(points, Points::Lobatto(_)),
            ),
            (
                EffectKind::PointsSegments,
                matches!(points, Points::Segments(_)),
            ),
        ];
        let effect = |(name, on)| {
            let reason = why(on, &given, format!("the points are {words}"));
            self.effect(name, told.key("points"), reason)
        };
        let mut out: Vec<Effect> = kinds.into_iter().map(effect).collect();
        if let Some(segments) = out.last_mut().filter(|e| e.on) {
            segments.cost = "cut anew at every step".to_owned();
            segments.held = vec![
                Held::state("segments", Per::Whole, sizes::CUT, self.model.pairs.len()).growing(),
            ];
        }
        out
    }

    fn gaps(&self, told: &EffectContext) -> Vec<Effect> {
        let (pair, on) = (told.pair, told.kernel.gap == GapKind::Averaged);
        let mut held = Vec::new();
        if let Some(nodes) = &pair.averaged {
            let (n, m) = (told.points(), nodes.len());
            let [point, node, whole] = sizes::averaged(pair);
            held = vec![
                Held::state("averaged nodes", Per::Node, size_of::<bool>(), m),
                Held::assembler("averaged gaps", Per::Point, point, n),
                Held::assembler("averaged gaps", Per::Node, node, m),
                Held::assembler("averaged gaps", Per::Whole, whole, 1).growing(),
                Held::model("averaged nodes", Per::Whole, nodes.bytes(), 1),
            ];
        }
        let averaged = self
            .effect(
                EffectKind::AveragedGap,
                told.key("gap"),
                why(
                    on,
                    format!(
                        "`gap` is `averaged`, over {} nodes",
                        pair.averaged.as_ref().map_or(0, |a| a.len())
                    ),
                    match self.loaded.has(&told.key("gap")) {
                        true => "`gap` is `pointwise`",
                        false => "no `gap`: every point has its own",
                    },
                ),
            )
            .costs("a closed node couples all nodes of the faces around it")
            .holds(held);
        let halves = self.effect(
            EffectKind::TwoHalfPasses,
            told.key("passes"),
            why(
                pair.half.is_some(),
                "`passes` are `two_half`: each side is the slave once",
                match self.loaded.has(&told.key("passes")) {
                    true => "`passes` is `one`",
                    false => "no `passes`: the slave is one side",
                },
            ),
        );
        let edges = self.effect(
            EffectKind::EdgePass,
            told.key("passes"),
            why(
                pair.edges_of.is_some(),
                format!(
                    "`passes` are `edges`: {} nodes on sharp edges of the master",
                    pair.points.len()
                ),
                "the slave's own points",
            ),
        );
        vec![averaged, self.unsymmetric(halves, &pair.name), edges]
    }
}
