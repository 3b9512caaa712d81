//! Probes of a scene: their nodes.
use super::super::BodyModel;
use super::super::error::{number, text};
use super::super::probe::{ProbeModel, nearest_node};
use super::{Builder, ModelError};
use crate::scene::{Probe, ProbeQuantity};
use covact_geometry::Vec3;

/// Part of the size of a body that the node of a probe may lie from the point that it was to be near.
const FAR: f64 = 0.1;

impl Builder<'_> {
    /// Finds the nodes of all probes, and warns of points that no node is near.
    ///
    /// # Errors
    /// [`ModelError`] for unknown sets and bodies.
    pub(super) fn probes(&mut self) -> Result<Vec<ProbeModel>, ModelError> {
        let mut found = Vec::new();
        let scene = self.scene;
        for (name, probe) in &scene.probes {
            let mut nodes = self.probed(probe, &format!("/probes/{name}"))?;
            nodes.sort_unstable();
            nodes.dedup();
            let missed = probe.near.and_then(|point| self.missed(point, &nodes));
            let told = missed.map(|text| format!("probe `{name}`: {text}"));
            self.warnings.extend(told);
            found.push(ProbeModel {
                name: name.clone(),
                quantity: probe.quantity,
                take: probe.taken(),
                nodes,
            });
        }
        Ok(found)
    }

    /// What is told of a point that even the nearest node is far from.
    fn missed(&self, point: [f64; 3], nodes: &[u32]) -> Option<String> {
        let node = *nodes.first()?;
        let body = self.bodies.iter().rfind(|b| b.first_node <= node)?;
        let at = body.mesh.nodes[(node - body.first_node) as usize];
        let far = (at - Vec3::from(point)).norm();
        let [low, high] = body.mesh.bounds();
        (far > FAR * (high - low).norm()).then(|| {
            let [x, y, z] = point.map(number);
            format!(
                "no node is near ({x}, {y}, {z}); it takes that of body `{}` at ({}, {}, {}), {} away",
                body.name,
                number(at.x),
                number(at.y),
                number(at.z),
                number(far)
            )
        })
    }

    fn probed(&self, probe: &Probe, at: &str) -> Result<Vec<u32>, ModelError> {
        let nodes = self.named_nodes(probe, at)?;
        let of_sheet = |b: &BodyModel| {
            let own = b.first_node..b.first_node + b.mesh.nodes.len() as u32;
            b.block.sheet().is_some() && nodes.iter().any(|n| own.contains(n))
        };
        if probe.quantity == ProbeQuantity::VonMises && self.bodies.iter().any(of_sheet) {
            let message = "a body of kind `nurbs` has no stress at its control points";
            let help = "read it from the fields of the output (`von_mises` on both faces)";
            return Err(text(format!("{at}/quantity"), message).help(help));
        }
        Ok(nodes)
    }

    fn named_nodes(&self, probe: &Probe, at: &str) -> Result<Vec<u32>, ModelError> {
        if let Some(on) = &probe.on {
            let mut nodes = Vec::new();
            for (at, reference) in on.places(&format!("{at}/on")) {
                nodes.extend(self.set_nodes(reference, &at)?.1);
            }
            return Ok(nodes);
        }
        let named = |name: &String| probe.body.as_ref().is_none_or(|own| own == name);
        let mut bodies = self.bodies.iter().filter(|b| named(&b.name));
        let found = match (probe.near, &probe.body) {
            (Some(point), _) => nearest_node(bodies, point).map(|n| vec![n]),
            (None, Some(_)) => bodies.next().map(|body| {
                let first = body.first_node;
                (first..first + body.mesh.nodes.len() as u32).collect()
            }),
            (None, None) => None,
        };
        found.ok_or_else(|| text(at, "the probe names no node"))
    }
}
