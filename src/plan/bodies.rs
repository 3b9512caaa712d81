//! The effects of bodies: their elements and materials.
use super::{Effect, Held, Per, Reporter, why};
use crate::assembly::sizes;
use crate::model::BodyModel;
use crate::model::EffectKind;
use crate::scene::{Body, Element, MeshSource, pointer};

/// Names of bodies as a message lists them.
fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.map(|n| format!("`{n}`")).collect();
    names.join(", ")
}

impl Reporter<'_> {
    fn described(&self) -> impl Iterator<Item = (&BodyModel, &Body)> {
        let scene = &self.loaded.scene;
        (self.model.bodies.iter()).filter_map(|b| Some((b, scene.bodies.get(&b.name)?)))
    }

    pub(super) fn bodies(&self) -> Vec<Effect> {
        let small = self.model.small.is_some();
        let key = "/solution/kinematics";
        let large = match self.loaded.has(key) {
            true => "`kinematics` is `large`: displacements and rotations of any size",
            false => "no `kinematics`: displacements and rotations of any size",
        };
        let declared = "`kinematics` is `small`";
        let nodes = self.model.nodes.len();
        let mut out = vec![
            self.effect(EffectKind::LargeRotation, key, why(!small, large, declared)),
            self.effect(
                EffectKind::SmallDisplacements,
                key,
                why(small, declared, large),
            )
            .costs("one factorization for every change of the points in contact")
            .holds(vec![
                Held::assembler("linear", Per::Point, 8, self.model.contact_points()),
                Held::assembler("linear", Per::Node, 24, nodes),
                Held::assembler("linear", Per::Whole, sizes::LINEAR, 1).growing(),
            ]),
        ];
        out.extend(self.elements());
        out.push(self.seams());
        out.extend(self.strains());
        out.extend(self.materials());
        out
    }

    fn elements(&self) -> Vec<Effect> {
        let kind = |element| match element {
            Element::H8 => EffectKind::H8SolidShell,
            Element::H8Displacement => EffectKind::H8Displacement,
            Element::H8MeanDilatation => EffectKind::H8MeanDilatation,
            Element::H8Eas3 => EffectKind::H8Eas3,
            Element::Q18 => EffectKind::Q18SolidShell,
            Element::Nurbs => EffectKind::NurbsShell,
        };
        let effect = |element: Element| {
            let (effect, word) = (kind(element), element.word());
            let own: Vec<_> = (self.described())
                .filter(|(_, b)| b.element == element)
                .map(|(b, _)| b)
                .collect();
            let given = |b: &&BodyModel| {
                let at = pointer(&["bodies", &b.name, "element"]);
                (self.loaded.has(&at)).then_some(at)
            };
            let at = own.iter().find_map(given);
            let of_sheet = element == Element::Nurbs;
            let how = match at {
                _ if of_sheet => "the body is a face of a CAD file (`nurbs`)".to_owned(),
                Some(_) => format!("`element` is `{word}`"),
                None => "no `element`: the default".to_owned(),
            };
            let at = at.unwrap_or_else(|| match own.first() {
                Some(body) if of_sheet => pointer(&["bodies", &body.name, "nurbs"]),
                Some(body) => pointer(&["bodies", &body.name]),
                None => "/bodies".to_owned(),
            });
            let names = listed(own.iter().map(|b| b.name.as_str()));
            let count: usize = own.iter().map(|b| b.block.elements()).sum();
            let (nodes, points) = match element {
                Element::Q18 => (18, 18),
                Element::Nurbs => (16, 9),
                _ => (8, 8),
            };
            let reason = why(
                !own.is_empty(),
                format!("{how} (body {names}, {count} elements)"),
                match of_sheet {
                    true => "no body is a face of a CAD file (`nurbs`)".to_owned(),
                    false => format!("no body has `element` `{word}`"),
                },
            );
            let size = 3 * nodes;
            self.effect(effect, at, reason).costs(format!(
                "a {size} x {size} tangent an element, from {points} Gauss points"
            ))
        };
        let all = Element::OF_MESHES.into_iter().chain([Element::Nurbs]);
        all.map(effect).collect()
    }

    /// Faces of CAD surfaces that are joined, or held along trims.
    fn seams(&self) -> Effect {
        let joined = || (self.described()).filter(|(b, _)| !b.block.seams().is_empty());
        let sheet = || (self.described()).find(|(b, _)| b.block.sheet().is_some());
        let names = listed(joined().map(|(b, _)| b.name.as_str()));
        let pairs: usize = joined().map(|(b, _)| b.block.seams().len()).sum();
        let springs: usize = (self.described())
            .map(|(b, _)| b.block.anchors().len())
            .sum();
        let at = match joined().next().or_else(sheet) {
            Some((body, _)) => pointer(&["bodies", &body.name, "nurbs"]),
            None => "/bodies".to_owned(),
        };
        self.effect(
            EffectKind::NurbsSeams,
            at,
            why(
                pairs + springs > 0,
                match pairs {
                    0 => format!("{springs} points of trims are held"),
                    _ => format!(
                        "{pairs} pairs of elements on both sides of common edges (body {names})"
                    ),
                },
                "no body has faces with a common edge, or one that is held along a trim",
            ),
        )
        .costs("a 96 x 96 tangent a pair")
        .holds(vec![Held::assembler(
            "seams",
            Per::Whole,
            sizes::seams(self.model),
            1,
        )])
    }

    /// Strains that elements do not take from their displacements alone.
    fn strains(&self) -> Vec<Effect> {
        let assumed = |b: &Body| match &b.mesh {
            MeshSource::Nurbs(nurbs) => nurbs.assumed_membrane,
            _ => b.element.assumes_strains(),
        };
        let with: Vec<_> = self.described().filter(|(_, b)| assumed(b)).collect();
        let names =
            |list: &[(&BodyModel, &Body)]| listed(list.iter().map(|(b, _)| b.name.as_str()));
        let at = |list: &[(&BodyModel, &Body)]| match list
            .first()
            .or(self.described().next().as_ref())
        {
            Some((body, _)) => pointer(&["bodies", &body.name, "element"]),
            None => "/bodies".to_owned(),
        };
        let none = "no element has any: `h8_displacement` takes strains as they are";
        let assumed = self.effect(
            EffectKind::AssumedStrains,
            at(&with),
            why(
                !with.is_empty(),
                format!("against locking of thin elements (body {})", names(&with)),
                none,
            ),
        );
        let (mut held, mut numbers) = (Vec::new(), Vec::new());
        // Sheets have assumed strains alone.
        let solid = |(_, b): &&(&BodyModel, &Body)| b.element != Element::Nurbs;
        let enhanced: Vec<_> = with.iter().filter(solid).copied().collect();
        for (body, _) in &enhanced {
            let len = self.model.state_len(body);
            let n = body.block.elements();
            held.push(Held::state("element states", Per::Element, 8 * len, n));
            numbers.push(body.block.alpha_len());
        }
        numbers.dedup();
        let numbers: Vec<String> = numbers.iter().map(usize::to_string).collect();
        let enhanced = self
            .effect(
                EffectKind::EnhancedStrains,
                at(&enhanced),
                why(
                    !enhanced.is_empty(),
                    format!(
                        "{} an element, condensed (body {})",
                        numbers.join(" or "),
                        names(&enhanced)
                    ),
                    none,
                ),
            )
            .holds(held);
        vec![assumed, enhanced]
    }

    fn materials(&self) -> Vec<Effect> {
        let effect = |effect: &EffectKind| {
            let word = effect.name().strip_prefix("material.")?;
            let own = |b: &&(&BodyModel, &Body)| b.0.material.key() == word;
            let all: Vec<_> = self.described().collect();
            let first = all.iter().find(own);
            let at = match first {
                Some((_, body)) => pointer(&["materials", &body.material, word]),
                None => "/materials".to_owned(),
            };
            let names = listed(all.iter().filter(own).map(|(b, _)| b.name.as_str()));
            let linear = first.is_none_or(|(body, _)| body.material.is_linear());
            let reason = why(
                first.is_some(),
                match !linear && self.model.small.is_some() {
                    true => format!(
                        "the material of body {names}; at small displacements it acts as Hooke's law"
                    ),
                    false => format!("the material of body {names}"),
                },
                format!("no body has a `{word}` material"),
            );
            Some(self.unsymmetric(self.effect(*effect, at, reason), word))
        };
        EffectKind::ALL.iter().filter_map(effect).collect()
    }
}
