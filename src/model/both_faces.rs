//! Bodies of one layer that something may press on both faces: their elements are those that
//! [count the height between these](crate::shell::H8Block::may_be_pressed).
use super::Model;
use super::loads::DeadLoad;
use super::master::Master;
use crate::mesh::Face;
use crate::shell::Block;

/// Tells the elements of every body whether anything touches both faces of it: contact, a pressure, a support.
pub(super) fn tell(model: &mut Model) {
    let (touched, held) = (touched(model), held(model));
    let nodes = &model.nodes;
    for body in &mut model.bodies {
        let Block::H8(block) = &mut body.block else {
            continue;
        };
        let first = body.first_node as usize;
        let mut faces = [false; 2];
        for e in 0..block.elements() {
            let own = block.nodes_of(e).map(|node| node as usize + first);
            let acts = |k: usize| {
                let through = nodes[own[k | 4]] - nodes[own[k & 3]];
                // What holds a node beside that does not press.
                let along = (0..3).filter(|&axis| through[axis].abs() > 0.5 * through.norm());
                touched[own[k]] || along.into_iter().any(|axis| held[own[k]][axis])
            };
            for (face, first) in faces.iter_mut().zip([0, 4]) {
                *face |= (first..first + 4).all(acts);
            }
        }
        block.press_both_faces(faces == [true; 2]);
    }
}

/// Whether contact or a pressure touches the nodes of the model.
fn touched(model: &Model) -> Vec<bool> {
    let mut touched = vec![false; model.nodes.len()];
    let mut mark = |body: usize, faces: &[Face]| {
        let body = &model.bodies[body];
        for &face in faces {
            for &node in body.mesh.face_nodes(face).nodes() {
                touched[(node + body.first_node) as usize] = true;
            }
        }
    };
    for pair in &model.pairs {
        mark(pair.body, &pair.faces);
        if let Master::Body(master) = &pair.master {
            mark(master.body, &master.faces);
        }
    }
    let follow = (model.follower_loads.iter()).flat_map(|(_, load)| &load.faces);
    let dead = (model.dead_loads.iter()).flat_map(|(_, load)| match load {
        DeadLoad::Traction { points, .. } | DeadLoad::Pressure { points, .. } => &points[..],
        DeadLoad::Force { .. } | DeadLoad::Nodal { .. } => &[],
    });
    for &node in (follow.flat_map(|face| face.nodes())).chain(dead.flat_map(|point| point.nodes()))
    {
        touched[node as usize] = true;
    }
    touched
}

/// The directions in which supports hold the nodes of the model.
fn held(model: &Model) -> Vec<[bool; 3]> {
    let mut held = vec![[false; 3]; model.nodes.len()];
    for prescribed in &model.prescribed {
        let dof = prescribed.dof as usize;
        if let Some(node) = held.get_mut(dof / 3) {
            node[dof % 3] = true;
        }
    }
    held
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::build::build;
    use crate::scene;
    use serde_json::{Value, json};

    /// Whether a plate of so many layers may be pressed, on which a ball lies and something more acts.
    fn may(layers: u32, kind: &str, more: Value) -> bool {
        let mut scene = json!({
            "covact": 1,
            "materials": {"m": {"neo_hooke": {"E": 10, "nu": 0.3}}},
            "bodies": {"sheet": {"material": "m", "mesh": {"plate": {
                "size": [4, 4], "thickness": 0.5, "elements": [4, 4], "layers": layers
            }}}},
            "surfaces": {
                "ball": {"sphere": {"radius": 3, "center": [0, 0, 4]}},
                "floor": {"plane": {"center": [0, 0, -1], "normal": [0, 0, 1], "size": [9, 9]}}
            },
            "contacts": {"press": {"slave": "sheet.top", "master": "ball"}},
            "supports": {"hold": {"on": "sheet.x_min", "fixed": true}}
        });
        if !more.is_null() {
            scene[kind]["more"] = more;
        }
        let loaded = scene::parse(&scene.to_string(), "scene.json").expect("well-formed");
        let model = build(&loaded).expect("a model");
        match &model.bodies[0].block {
            Block::H8(block) => block.may_be_pressed(),
            _ => panic!("no such elements"),
        }
    }

    #[test]
    fn a_sheet_may_be_pressed_where_something_acts_on_both_faces() {
        let floor = json!({"slave": "sheet.bottom", "master": "floor"});
        assert!(!may(1, "contacts", Value::Null));
        assert!(may(1, "contacts", floor.clone()));
        assert!(!may(2, "contacts", floor));
        let pressure = |on: &str| json!({"on": on, "pressure": "t"});
        assert!(may(1, "loads", pressure("sheet.bottom")));
        assert!(!may(1, "loads", pressure("sheet.top")));
        let held = json!({"on": "sheet.bottom", "displacement": {"z": 0}});
        assert!(may(1, "supports", held));
        let plane_strain = json!({"on": ["sheet.top", "sheet.bottom"], "displacement": {"y": 0}});
        assert!(!may(1, "supports", plane_strain));
    }
}
