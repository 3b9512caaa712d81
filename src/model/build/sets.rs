//! Sets of bodies, by the names under which scenes refer to them.
use super::super::error::{At, text};
use super::super::slave::slave_points;
use super::{Builder, ModelError};
use crate::contact::points::SlavePoint;
use crate::mesh::{Face, Mesh};
use crate::scene::{self, SetNames};
use std::collections::HashSet;

/// Body and set of `body.set`.
fn split(reference: &str) -> (&str, &str) {
    reference.split_once('.').unwrap_or((reference, ""))
}

impl Builder<'_> {
    /// What is wrong with references to sets: every one by itself, before any is used.
    pub(super) fn references(&self) -> Vec<ModelError> {
        let mut errors = Vec::new();
        for (name, contact) in &self.scene.contacts {
            let at = |side: &str| format!("/contacts/{name}/{side}");
            errors.extend(self.side(&contact.slave, &at("slave")).err());
            if contact.surface(&self.scene.surfaces).is_none() {
                errors.extend(self.side(&contact.master, &at("master")).err());
            }
        }
        for (name, load) in &self.scene.loads {
            for (at, reference) in load.on.places(&format!("/loads/{name}/on")) {
                match (&load.force, &load.gravity) {
                    (_, Some(_)) => errors.extend(self.body(reference, &at).err()),
                    (Some(_), _) => errors.extend(self.set_nodes(reference, &at).err()),
                    _ if load.couple.is_some() => {
                        errors.extend(self.set_nodes(reference, &at).err());
                    }
                    _ => errors.extend(self.faces(reference, &at).err()),
                }
            }
        }
        for (name, support) in &self.scene.supports {
            for (at, reference) in support.on.places(&format!("/supports/{name}/on")) {
                errors.extend(self.set_nodes(reference, &at).err());
            }
        }
        errors
    }

    pub(super) fn body(
        &self,
        reference: &str,
        pointer: &str,
    ) -> Result<(usize, &Mesh, u32), ModelError> {
        let (name, _) = split(reference);
        let index = *(self.body_index.get(name))
            .ok_or_else(|| text(pointer, format!("there is no body `{name}`")))?;
        let body = &self.bodies[index];
        Ok((index, &body.mesh, body.first_node))
    }

    /// Faces of `body.set`, or all outer faces of `body`.
    fn faces(&self, reference: &str, pointer: &str) -> Result<(usize, Vec<Face>), ModelError> {
        let (index, mesh, _) = self.body(reference, pointer)?;
        if !reference.contains('.') {
            return Ok((index, mesh.outer_faces()));
        }
        let faces = mesh
            .face_set(split(reference).1)
            .at(|| pointer.to_owned())?;
        Ok((index, faces.to_vec()))
    }

    /// Faces of a side of a contact, which belong to one body.
    pub(super) fn side(
        &self,
        side: &SetNames,
        pointer: &str,
    ) -> Result<(usize, Vec<Face>), ModelError> {
        let mut parts = self.faces_of(side, pointer)?;
        match (parts.pop(), parts.is_empty()) {
            (Some(part), true) => Ok(part),
            _ => Err(text(pointer, format!("`{side}` are not sets of one body"))),
        }
    }

    /// Nodes of a node set, of a face set where there is no node set of that name, or of a whole body.
    pub(super) fn set_nodes(
        &self,
        reference: &str,
        pointer: &str,
    ) -> Result<(usize, Vec<u32>), ModelError> {
        let (index, mesh, first) = self.body(reference, pointer)?;
        let set = split(reference).1;
        let local = match mesh.face_sets.get(set) {
            _ if !reference.contains('.') => (0..mesh.nodes.len() as u32).collect(),
            Some(faces) if !mesh.node_sets.contains_key(set) => mesh.nodes_of(faces),
            _ => mesh.node_set(set).at(|| pointer.to_owned())?.to_vec(),
        };
        Ok((index, local.into_iter().map(|n| n + first).collect()))
    }

    /// Faces of the sets by body, each once, in the order in which bodies are first named.
    pub(super) fn faces_of(
        &self,
        on: &SetNames,
        at: &str,
    ) -> Result<Vec<(usize, Vec<Face>)>, ModelError> {
        let mut parts: Vec<(usize, Vec<Face>)> = Vec::new();
        for (pointer, reference) in on.places(at) {
            let (body, faces) = self.faces(reference, &pointer)?;
            match parts.iter_mut().find(|(b, _)| *b == body) {
                None => parts.push((body, faces)),
                Some((_, all)) => {
                    let before: HashSet<Face> = all.iter().copied().collect();
                    all.extend(faces.into_iter().filter(|f| !before.contains(f)));
                }
            }
        }
        Ok(parts)
    }

    /// Whether `body.set` names a set of faces.
    fn is_face_set(&self, reference: &str, pointer: &str) -> Result<bool, ModelError> {
        let (_, mesh, _) = self.body(reference, pointer)?;
        Ok(mesh.face_sets.contains_key(split(reference).1))
    }

    /// Mass that each node of some bodies stands for.
    pub(super) fn masses(&self, on: &SetNames, at: &str) -> Result<Vec<(u32, f64)>, ModelError> {
        let mut masses = Vec::new();
        for (pointer, name) in on.places(at) {
            let (index, mesh, first) = self.body(name, &pointer)?;
            let density = self.bodies[index].material.elastic().density;
            let density = density.ok_or_else(|| {
                text(
                    &pointer,
                    format!("the material of body `{name}` has no density"),
                )
            })?;
            let volumes = match self.bodies[index].block.sheet() {
                Some(sheet) => {
                    let areas = sheet.tributary_areas().into_iter();
                    areas.map(|area| area * sheet.thickness).collect()
                }
                None => mesh.nodal_volumes(),
            };
            let volumes = volumes.into_iter().zip(first..);
            masses.extend(volumes.map(|(volume, node)| (node, density * volume)));
        }
        Ok(masses)
    }

    /// Shares in a total force by the length of edges of sheets; none where a set is not made of edges.
    fn edge_shares(&self, on: &SetNames) -> Option<Vec<(u32, f64)>> {
        let mut shares: Vec<(u32, f64)> = Vec::new();
        for (_, reference) in on.places("") {
            let (name, set) = split(reference);
            let body = &self.bodies[*self.body_index.get(name)?];
            let sheet = body.block.sheet()?;
            for edge in sheet.edge_sets.get(set)? {
                let own = sheet.border_lengths(*edge).into_iter();
                shares.extend(own.map(|(node, length)| (node + body.first_node, length)));
            }
        }
        let total: f64 = shares.iter().map(|(_, length)| length).sum();
        shares.iter_mut().for_each(|(_, share)| *share /= total);
        Some(shares)
    }

    /// Share of each node in a total force: by length on edges of sheets, by tributary area on face sets, equal on node sets.
    pub(super) fn shares(&self, on: &SetNames, at: &str) -> Result<Vec<(u32, f64)>, ModelError> {
        let mut all_faces = true;
        for (pointer, reference) in on.places(at) {
            all_faces &= self.is_face_set(reference, &pointer)?;
        }
        if all_faces {
            let mut points = Vec::new();
            for (body, faces) in self.faces_of(on, at)? {
                let body = &self.bodies[body];
                if let Some(sheet) = body.block.sheet() {
                    let elements = faces.iter().map(|f| f.element as usize);
                    for p in sheet.points(elements, 4).at(|| at.to_owned())? {
                        let nodes = p.nodes.iter().zip(p.n);
                        points.extend(nodes.map(|(node, n)| {
                            SlavePoint::at_node(node + body.first_node, n * p.area)
                        }));
                    }
                    continue;
                }
                let own = slave_points(&body.mesh, &faces, scene::Points::Nodes, body.first_node);
                points.extend(own.at(|| at.to_owned())?);
            }
            let total: f64 = points.iter().map(|p| p.area).sum();
            return Ok(points
                .iter()
                .map(|p| (p.nodes[0], p.area / total))
                .collect());
        }
        if let Some(shares) = self.edge_shares(on) {
            return Ok(shares);
        }
        let mut nodes = Vec::new();
        for (pointer, reference) in on.places(at) {
            nodes.extend(self.set_nodes(reference, &pointer)?.1);
        }
        // Sets may share nodes.
        if matches!(on, SetNames::List(_)) {
            nodes.sort_unstable();
            nodes.dedup();
        }
        let share = 1.0 / nodes.len().max(1) as f64;
        Ok(nodes.into_iter().map(|n| (n, share)).collect())
    }
}
