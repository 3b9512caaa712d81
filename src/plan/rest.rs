//! The effects of rigid surfaces, supports, loads, the solution and the output.
use super::{Effect, Held, Per, Reporter, why};
use crate::assembly::sizes;
use crate::model::EffectKind;
use crate::model::error::number;
use crate::scene::{LinearSolver, Stabilization, pointer};

impl Reporter<'_> {
    pub(super) fn surfaces(&self) -> Vec<Effect> {
        let model = self.model;
        let first = model.driven().next();
        let at = |name: &str, key: &str| format!("{}/{key}", pointer(&["surfaces", name]));
        let mut held = Vec::new();
        for (index, _, _) in model.driven() {
            let nodes = sizes::slave_nodes(model, index);
            held.push(Held::assembler(
                "driven",
                Per::Node,
                sizes::BORDER_NODE,
                nodes,
            ));
            let whole = sizes::border(model);
            held.push(Held::assembler("driven", Per::Whole, whole, 1));
        }
        if model.dead_loads.is_empty() && model.follower_loads.is_empty() {
            // The vector of loads is there for the driving forces alone.
            held.push(Held::assembler("loads", Per::Node, 24, model.nodes.len()));
            held.push(Held::run(
                "loads watched",
                Per::Node,
                24,
                model.body_nodes(),
            ));
        }
        let driven = self
            .effect(
                EffectKind::DrivenByForce,
                match &first {
                    Some((_, surface, _)) => at(&surface.name, "motion/free"),
                    None => "/surfaces".to_owned(),
                },
                match &first {
                    Some((_, surface, driven)) => Ok(format!(
                        "surface `{}` is free {} (`free`)",
                        surface.name,
                        driven.words()
                    )),
                    None => Err(
                        "no surface has a `motion` with `free`: where they are is prescribed"
                            .into(),
                    ),
                },
            )
            .costs("six rows for each surface, coupled with every slave node of its pairs")
            .holds(held);
        let scene = &self.loaded.scene;
        let moves = |name: &str| {
            let described = scene.surfaces.get(name);
            described.is_some_and(|_| self.loaded.has(&at(name, "motion")))
        };
        let moving = model.surfaces.iter().find(|s| moves(&s.name));
        let tools = |k: usize| scene.stages[k].tools.keys().map(move |name| (k, name));
        let staged = (0..scene.stages.len()).flat_map(tools).next();
        let motion = self.effect(
            EffectKind::SurfaceMotion,
            match (moving, staged) {
                (Some(surface), _) => at(&surface.name, "motion"),
                (None, Some((k, _))) => format!("/stages/{k}/tools"),
                (None, None) => "/surfaces".to_owned(),
            },
            match (moving, staged) {
                (Some(surface), _) => Ok(format!("surface `{}` has a `motion`", surface.name)),
                (None, Some((_, name))) => Ok(format!("surface `{name}` is moved by `stages`")),
                _ if model.surfaces.is_empty() => Err("there are no rigid surfaces".to_owned()),
                _ => Err("no surface has a `motion`".to_owned()),
            },
        );
        vec![driven, motion]
    }

    pub(super) fn conditions(&self) -> Vec<Effect> {
        let (model, scene) = (self.model, &self.loaded.scene);
        let mid = scene.supports.iter().find(|(_, s)| s.mid_surface);
        let mid = self
            .effect(
                EffectKind::MidSurface,
                match mid {
                    Some((name, _)) => pointer(&["supports", name, "mid_surface"]),
                    None => "/supports".to_owned(),
                },
                match mid {
                    Some((name, _)) if !model.means.is_empty() => Ok(format!(
                        "support `{name}`: {} pairs of displacements are tied",
                        model.means.len()
                    )),
                    _ => Err("no support has `mid_surface`".to_owned()),
                },
            )
            .costs("elements at the support are condensed one by one");
        let load = |name: Option<&str>| match name {
            Some(name) => pointer(&["loads", name]),
            None => "/loads".to_owned(),
        };
        let none = match scene.loads.is_empty() {
            true => "the scene has no loads",
            false => "no load of this kind",
        };
        // At small displacements pressures do not follow.
        let large = model.small.is_none();
        let followers = || model.follower_loads.iter().map(|(name, _)| name.as_str());
        let dead = model.dead_loads.iter().map(|(name, _)| name.as_str());
        let dead = dead.chain(followers().filter(|_| !large)).next();
        let nodes = model.nodes.len();
        // One vector for all loads, told with the first of them.
        let vector = |first: bool| {
            let n = if first { nodes } else { 0 };
            Held::assembler("loads", Per::Node, 24, n)
        };
        let watched = |first: bool| {
            let n = if first { model.body_nodes() } else { 0 };
            Held::run("loads watched", Per::Node, 24, n)
        };
        let stages: Vec<String> = (0..scene.stages.len())
            .map(|k| scene.stage_in_words(k))
            .collect();
        let stages = self
            .effect(
                EffectKind::Stages,
                "/stages",
                match stages.is_empty() {
                    true => Err("no `stages`: all contacts and supports act throughout".to_owned()),
                    false => Ok(stages.join(", ")),
                },
            )
            .costs("the model and the pattern of its system made anew at the end of a stage");
        let mut out = vec![mid, stages];
        let is_first = dead.is_some();
        out.push(
            self.effect(
                EffectKind::DeadLoad,
                load(dead),
                match dead {
                    Some(name) => Ok(format!("load `{name}` keeps its direction")),
                    None => Err(none.to_owned()),
                },
            )
            .holds(vec![vector(is_first), watched(is_first)]),
        );
        let follower = followers().find(|_| large);
        let is_first = dead.is_none() && follower.is_some();
        let maps = sizes::followers(model);
        let follows = self
            .effect(
                EffectKind::FollowerPressure,
                match follower {
                    Some(name) => format!("{}/follower", load(Some(name))),
                    None => load(None),
                },
                match follower {
                    Some(name) => Ok(format!("load `{name}` has `follower`")),
                    None if followers().next().is_some() => {
                        Err("displacements are small: pressures keep their direction".to_owned())
                    }
                    None => Err(none.to_owned()),
                },
            )
            .costs("a tangent for each loaded face")
            .holds(vec![
                vector(is_first),
                watched(is_first),
                Held::assembler("follower maps", Per::Whole, maps, 1),
            ]);
        let follows = match follower {
            None => follows,
            Some(_) => {
                let names = model.follower_loads.iter().map(|(name, _)| name.as_str());
                let takes = |name: &str| self.unsymmetric(follows.clone(), name);
                let found = names.map(takes).find(|e| e.unsymmetric);
                found.unwrap_or_else(|| follows.clone())
            }
        };
        out.push(follows);
        out
    }

    pub(super) fn solution(&self) -> Vec<Effect> {
        let model = self.model;
        let nodes = model.nodes.len();
        let held = vec![
            Held::assembler("stabilization", Per::Node, 24, nodes),
            Held::model("stabilization", Per::Node, 24, nodes),
        ];
        let viscous = self
            .effect(
                EffectKind::Viscous,
                "/solution/stabilization",
                match self.loaded.scene.solution.stabilization {
                    Stabilization::Viscous { factor, until } => Ok(format!(
                        "`stabilization` is `viscous` with factor {}{}",
                        number(factor),
                        until.map_or(String::new(), |t| format!(" until time {}", number(t)))
                    )),
                    Stabilization::None if self.loaded.has("/solution/stabilization") => {
                        Err("`stabilization` is `none`".to_owned())
                    }
                    Stabilization::Auto if self.model.stabilization.is_some() => {
                        Ok("supports do not hold every body: contact has to".to_owned())
                    }
                    Stabilization::Auto if self.model.dynamics.is_some() => {
                        Err("bodies have inertia, which holds them".to_owned())
                    }
                    Stabilization::Auto | Stabilization::None => {
                        Err("no `stabilization`: supports hold every body".to_owned())
                    }
                },
            )
            .costs("a force and an entry of the diagonal for each unknown of a body")
            .holds(held);
        let why_not = match self.loaded.scene.solution.linear_solver {
            LinearSolver::Cudss => "no effect takes the symmetry: LDL^T by cuDSS",
            LinearSolver::Mumps(_) => "no effect takes the symmetry: LDL^T by MUMPS",
            _ => "no effect takes the symmetry: Cholesky, or LDL^T where it is indefinite",
        };
        let reasons: Vec<&str> = self
            .model
            .unsymmetric
            .iter()
            .map(|u| u.why.as_str())
            .collect();
        let unsymmetric = self
            .effect(
                EffectKind::UnsymmetricSystem,
                "/solution/linear_solver",
                why(!reasons.is_empty(), reasons.join("; "), why_not),
            )
            .costs("both triangles of the matrix, and LU")
            .holds(vec![
                Held::assembler("transposed matrix", Per::Whole, 0, 1).growing(),
            ]);
        let watch = self
            .effect(
                EffectKind::EnergyWatch,
                "/solution",
                Ok("the energies of every run are balanced step by step".to_owned()),
            )
            .holds(vec![Held::run(
                "reactions watched",
                Per::Node,
                24,
                model.body_nodes(),
            )]);
        let [inertia, damping, viscosity] = self.dynamics();
        vec![viscous, inertia, damping, viscosity, unsymmetric, watch]
    }

    pub(super) fn output(&self) -> Vec<Effect> {
        let output = &self.loaded.scene.output;
        let given = self.loaded.has("/output/every");
        let fields = self.effect(
            EffectKind::OutputFields,
            "/output/every",
            why(
                output.every > 0,
                match given {
                    true => format!(
                        "`every` is {}: fields of every accepted step whose number it divides",
                        output.every
                    ),
                    false => "no `every`: of every step".to_owned(),
                },
                "`every` is 0: no fields are written",
            ),
        );
        let points = self
            .effect(
                EffectKind::OutputContactPoints,
                "/output/contact_points",
                why(
                    output.contact_points,
                    "`contact_points` is true",
                    "no `contact_points`",
                ),
            )
            .holds(vec![Held::run(
                "gaps",
                Per::Point,
                size_of::<f64>(),
                self.model.contact_points(),
            )]);
        let through = self.effect(
            EffectKind::OutputShellStresses,
            "/output/shell_stresses",
            why(
                output.shell_stresses,
                "`shell_stresses` is true",
                "no `shell_stresses`",
            ),
        );
        vec![fields, points, through]
    }
}
