//! A random scene as the user would write it, in any frame.
use super::draw::{BodyKind, Held, RandomScene, Tool};
use covact_geometry::io::{CadFile, LengthUnit, write_json};
use covact_geometry::{NurbsPatch, Vec3};
use nalgebra::Isometry3;
use serde_json::{Value, json};

/// Where a whole scene is put: turned and moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame(pub Isometry3<f64>);

impl Default for Frame {
    fn default() -> Self {
        Frame(Isometry3::identity())
    }
}

/// A scene and the CAD file it names, if any.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The scene as JSON.
    pub scene: Value,
    /// The patches of `tool.json`; empty: the scene names no file.
    pub patches: Vec<NurbsPatch>,
    /// The face of `sheet.json`, where the sheet is one.
    pub face: Option<NurbsPatch>,
}

impl Written {
    /// The contents of `tool.json`.
    ///
    /// # Errors
    /// Those of the JSON library; none is known to occur.
    pub fn cad(&self) -> Result<Option<String>, serde_json::Error> {
        match self.patches.is_empty() {
            true => Ok(None),
            false => text(self.patches.clone()).map(Some),
        }
    }

    /// The contents of `sheet.json`.
    ///
    /// # Errors
    /// As [`Self::cad`].
    pub fn sheet(&self) -> Result<Option<String>, serde_json::Error> {
        let face = self.face.clone();
        face.map(|face| text(vec![face])).transpose()
    }
}

/// A CAD file of patches.
fn text(patches: Vec<NurbsPatch>) -> Result<String, serde_json::Error> {
    let unit = LengthUnit {
        name: "mm".into(),
        to_metre: Some(1e-3),
    };
    write_json(&CadFile::of(patches, unit))
}

impl Frame {
    /// As a placement after which `first` was moved already.
    pub fn placement(&self, first: [f64; 3]) -> Value {
        let (axis, angle) = match self.0.rotation.axis_angle() {
            Some((axis, angle)) => ([axis.x, axis.y, axis.z], angle.to_degrees()),
            None => ([0.0, 0.0, 1.0], 0.0),
        };
        let to = self.point(first);
        json!({ "axis": axis, "angle": angle, "translation": to })
    }

    /// A vector of the scene in the frame.
    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        (self.0.rotation * Vec3::from(v)).into()
    }

    /// A point of the scene in the frame.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        (self.0.rotation * Vec3::from(p) + self.0.translation.vector).into()
    }
}

impl RandomScene {
    /// The scene in `frame`.
    pub fn write(&self, frame: &Frame) -> Written {
        let (tool, patches) = self.tool(frame);
        let step = 1.0 / f64::from(self.steps);
        let mut scene = json!({
            "covact": 1,
            "title": self.story(),
            "materials": { "stuff": self.material(self.e) },
            "bodies": self.bodies(frame),
            "surfaces": { "tool": tool },
            "contacts": { "press": self.contact(&format!("body.{}", self.slave())) },
            "supports": self.supports(),
            "solution": { "step": { "initial": step, "max": step, "min": step / 1024.0 }, "threads": 1 },
            "output": { "every": 0 }
        });
        if let BodyKind::SheetOnBlock { .. } = self.body {
            scene["contacts"]["press"]["master"] = json!("tool");
            let mut between = self.contact("body.bottom");
            between["master"] = json!("base.top");
            scene["contacts"]["lie"] = between;
            scene["supports"]["floor"] = json!({ "on": "base.bottom", "fixed": true });
        }
        if let Some(force) = self.motion.force {
            let end = self.motion.path.last().map_or(0.0, |p| p.0);
            scene["surfaces"]["tool"]["motion"] = json!({
                "free": { "force": { "z": { "table": [[0, 0], [end, force]] } } }
            });
        }
        self.effects.apply(self, frame, &mut scene);
        Written {
            scene,
            patches,
            face: self.effects.face(self),
        }
    }

    fn slave(&self) -> &'static str {
        match self.body {
            BodyKind::Arch { .. } => "outer",
            _ => "top",
        }
    }

    fn material(&self, e: f64) -> Value {
        let law = match self.body {
            BodyKind::Block { .. } | BodyKind::SheetOnBlock { .. } => "neo_hooke",
            _ => "st_venant_kirchhoff",
        };
        json!({ law: { "E": e, "nu": self.nu } })
    }

    fn bodies(&self, frame: &Frame) -> Value {
        let n = self.elements;
        let plate = |size: [f64; 2], thickness: f64| {
            json!({ "plate": {
                "size": size, "thickness": thickness, "elements": n,
                "origin": [-0.5 * size[0], -0.5 * size[1], -0.5 * thickness]
            } })
        };
        let block = |size: [f64; 2], top: f64, height: f64, n: [u32; 3]| {
            let [x, y] = size.map(|s| 0.5 * s);
            json!({ "block": { "min": [-x, -y, top - height], "max": [x, y, top], "elements": n } })
        };
        let body = |mesh: Value, element: &str| json!({ "mesh": mesh, "material": "stuff", "element": element, "placement": frame.placement([0.0; 3]) });
        let element = self.element;
        match self.body {
            BodyKind::Sheet { size, thickness } => {
                json!({ "body": body(plate(size, thickness), element) })
            }
            BodyKind::Block { size, height } => {
                json!({ "body": body(block(size, 0.0, height, [n[0], n[1], 3]), element) })
            }
            BodyKind::Arch {
                radius,
                thickness,
                half_angle,
                half_width,
            } => {
                let mesh = json!({ "cylinder_panel": {
                    "radius": radius, "thickness": thickness, "angles": [-half_angle, half_angle],
                    "y": [-half_width, half_width], "elements": n,
                    "origin": [0.0, 0.0, -radius - 0.5 * thickness]
                } });
                json!({ "body": body(mesh, element) })
            }
            BodyKind::SheetOnBlock {
                size,
                thickness,
                gap,
            } => {
                let base = block(size.map(|s| 1.1 * s), -thickness - gap, 3.0, [5, 5, 2]);
                json!({ "body": body(plate(size, thickness), element), "base": body(base, "h8_displacement") })
            }
        }
    }

    fn supports(&self) -> Value {
        let fixed = |set: &str| json!({ "on": format!("body.{set}"), "fixed": true });
        let sets: &[&str] = match (self.body, self.held) {
            (BodyKind::Block { .. }, _) => &["bottom"],
            (BodyKind::Arch { .. }, _) => &["phi_min", "phi_max"],
            (_, Held::AllRound) => &["x_min", "x_max", "y_min", "y_max"],
            (_, Held::TwoEdges) => &["x_min", "x_max"],
            (_, Held::OneEdge) => &["x_min"],
        };
        // A support keeps its name in the mirror.
        let name = |set: &str| match (self.mirrored, set) {
            (true, "x_min" | "phi_min") => set.replace("min", "max"),
            (true, "x_max" | "phi_max") => set.replace("max", "min"),
            _ => set.to_owned(),
        };
        let all = sets
            .iter()
            .map(|set| ((*set).to_owned(), fixed(&name(set))));
        Value::Object(all.collect())
    }

    fn contact(&self, slave: &str) -> Value {
        let mut contact = json!({ "slave": slave, "master": "tool", "points": self.points.0 });
        if self.points.1 > 0 {
            contact["points"] = json!({ self.points.0: self.points.1 });
        }
        if let Some(factor) = self.penalty {
            contact["penalty"] = json!({ "scaled": factor });
        }
        if let Some(mu) = self.mu {
            contact["friction"] = json!({ "coulomb": { "mu": mu } });
        }
        if self.augmented {
            contact["augmentation"] = json!({});
        }
        contact
    }

    fn tool(&self, frame: &Frame) -> (Value, Vec<NurbsPatch>) {
        let (mut tool, patches) = match &self.tool {
            Tool::Sphere { radius } => (json!({ "sphere": { "radius": radius } }), Vec::new()),
            Tool::Cylinder { radius, axis } => (
                json!({ "cylinder": { "radius": radius, "length": 30, "axis": axis } }),
                Vec::new(),
            ),
            Tool::Plane { normal } => (
                json!({ "plane": { "size": [40, 40], "normal": normal } }),
                Vec::new(),
            ),
            Tool::Patch(patch) => (
                json!({ "cad": { "file": "tool.json" } }),
                vec![(**patch).clone()],
            ),
        };
        tool["placement"] = frame.placement(self.center);
        if let Some((kind, count)) = self.facets {
            tool["facets"] = json!({ "kind": kind, "count": [count, count] });
        }
        let path = &self.motion.path;
        let along = |axis: usize| {
            let rows = path.iter().map(|(t, v)| json!([t, frame.vector(*v)[axis]]));
            json!({ "table": rows.collect::<Vec<_>>() })
        };
        tool["motion"] = json!({ "translation": [along(0), along(1), along(2)] });
        if self.motion.turn != 0.0 {
            tool["motion"]["rotation"] = json!({
                "center": frame.point(self.center),
                "axis": frame.vector([0.0, 0.0, 1.0]),
                "angle": { "table": [[0, 0], [0.5, 0], [1, self.motion.turn]] }
            });
        }
        (tool, patches)
    }

    /// What the scene is, in a line.
    pub fn story(&self) -> String {
        let tool = match &self.tool {
            Tool::Sphere { radius } => format!("sphere of radius {radius:.1}"),
            Tool::Cylinder { radius, .. } => format!("cylinder of radius {radius:.1}"),
            Tool::Plane { .. } => "tilted plane".to_owned(),
            Tool::Patch(patch) => match patch.is_rational() {
                true => "rational hills".to_owned(),
                false => "hills".to_owned(),
            },
        };
        let facets = self.facets.map_or(String::new(), |(kind, n)| {
            format!(" of {n} x {n} {kind} facets")
        });
        let held = match self.held {
            Held::AllRound => "clamped all round",
            Held::TwoEdges => "clamped at two edges",
            Held::OneEdge => "clamped at one edge",
        };
        let body = match self.body {
            BodyKind::Sheet { thickness, .. } => format!("sheet {thickness:.2} thick, {held}"),
            BodyKind::Block { .. } => "block".to_owned(),
            BodyKind::Arch { .. } => "arch".to_owned(),
            BodyKind::SheetOnBlock { thickness, .. } => {
                format!("sheet {thickness:.2} thick, {held}, over a block")
            }
        };
        let friction = self
            .mu
            .map_or("no friction".to_owned(), |mu| format!("mu {mu:.2}"));
        let way = match (
            self.motion.force,
            self.motion.path.len(),
            self.motion.turn,
            self.motion.pressed,
        ) {
            (Some(_), ..) => "pressed by a force",
            (.., false) => "pressed and released",
            (_, 2, ..) => "pressed",
            (_, _, turn, _) if turn != 0.0 => "pressed and turned",
            (_, 3, ..) => "pressed and drawn",
            _ => "pressed, drawn and drawn back",
        };
        let augmented = if self.augmented { ", augmented" } else { "" };
        format!(
            "{tool}{facets} {way} on {body} ({}), {friction}{augmented}{}",
            self.element,
            self.effects.story()
        )
    }
}
