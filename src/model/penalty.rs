//! Automatic penalty.
use crate::mesh::{ElementKind, Face, Mesh};
use crate::scene::Material;

/// Penalty as a multiple of `E / s`, `s` being the smaller of the faces' edge length and the thickness of the elements
/// below them; of two deformable sides the softer one counts. A pressure of a fifth of Young's modulus then sinks in by 1 % of `s`; a stiffer value would
/// only cost digits in the factorization.
pub const FACTOR: f64 = 20.0;

/// Bound on the automatic penalty of slender bodies, as a multiple of `E / t (t/L)^5` (thickness t, length L of the body).
/// The pressure that bends a plate by its own thickness is about `E (t/L)^4`; under this bound it sinks in by 2000 times
/// the rounding of a position L. A stiffer penalty would make of it a penetration that double precision cannot hold.
pub const SLENDER: f64 = 2e12;

/// Where the penalty of a pair starts that the run rules by its error, as a multiple of what suits the elements: of bodies that
/// bend, where they are just slender enough to do so, and of compact ones. More slender ones bend under less, and start softer
/// with the square of their thickness. A start that is too soft is solved in a few iterations and is measured before it is
/// accepted; one that is too stiff makes points chatter.
pub const START: [f64; 2] = [1e-3, 0.1];

/// Thickness over length below which a body bends.
const BENDS: f64 = 0.1;

/// Penetration under a given penalty above which the user is told, as a fraction of the slave's element size.
pub const TOLERATED: f64 = 0.01;

/// Multiple of the elements' stiffness above which a given penalty is warned of: rounding then takes more digits of a
/// displacement than contact asks for.
pub const WARNED: f64 = 1e4;

/// Multiple of the elements' stiffness above which a given penalty is refused: of sixteen digits seven are gone, and what is
/// left carries no stress of a thin shell.
pub const REFUSED: f64 = 1e7;

/// What is to be said of a given penalty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given {
    Fine,
    /// So many times the stiffness of the elements, which costs digits.
    Stiff(f64),
    /// So many times their stiffness, which leaves none.
    TooStiff(f64),
}

/// Judges a given penalty by the automatic one of elements that are not bounded for being slender (force / length^3).
pub fn judge(given: f64, automatic: f64) -> Given {
    let multiple = FACTOR * given / automatic;
    match multiple {
        m if m > REFUSED => Given::TooStiff(m),
        m if m > WARNED => Given::Stiff(m),
        _ => Given::Fine,
    }
}

/// Young's modulus of a material.
pub fn modulus(material: &Material) -> f64 {
    material.elastic().e
}

/// Sizes of the elements under some faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceSize {
    /// Mean distance of nodes along the edges of the faces: their mean length (square root of the mean area), half of it for
    /// quadratic elements.
    pub edge: f64,
    /// Mean depth of the elements below the faces: volume by area.
    pub depth: f64,
    /// Thickness of the body below the faces, taken as its volume by their area (more where they are a part of a side).
    pub thickness: f64,
    /// Length of the body: the diagonal of its box.
    pub length: f64,
}

/// Measures the elements under some faces.
pub fn face_size(mesh: &Mesh, faces: &[Face]) -> FaceSize {
    let area: f64 = faces.iter().map(|&f| mesh.face_area_normal(f).0).sum();
    let volume: f64 = (faces.iter())
        .map(|f| mesh.element_volume(f.element as usize))
        .sum();
    let spans = match mesh.kind {
        ElementKind::H8 => 1.0,
        ElementKind::Q18 => 2.0,
        ElementKind::Nurbs => 1.0,
    };
    FaceSize {
        edge: (area / faces.len().max(1) as f64).sqrt() / spans,
        depth: volume / area,
        thickness: mesh.volume() / area,
        length: {
            let [low, high] = mesh.bounds();
            (high - low).norm()
        },
    }
}

impl FaceSize {
    /// What suits the elements, and what bounds it where the body is slender, over Young's modulus.
    fn penalties(&self) -> [f64; 2] {
        let slender = SLENDER / self.thickness * (self.thickness / self.length).powi(5);
        [FACTOR / self.edge.min(self.depth), slender]
    }

    /// How many times smaller the automatic penalty is for being bounded; 1 where it is not.
    pub fn bounded(&self) -> f64 {
        let [solid, slender] = self.penalties();
        (solid / slender).max(1.0)
    }
}

/// Relative error of forces that a ruled penalty aims at where the scene asks for none.
pub const ACCURACY: f64 = 4e-3;

/// What a run may choose the penalty of a pair by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ruled {
    /// Relative error of forces that it aims at.
    pub accuracy: f64,
    /// The stiffest that it may take (force / length^3).
    pub stiffest: f64,
    /// Penetration above which it is raised whatever the error of forces (length).
    pub deepest: f64,
    /// Half of the layer of elements behind the points: what lies deeper under it is told (length).
    pub half: f64,
    /// Of contacts that a stage releases: the thickness of the body (length).
    pub released: Option<f64>,
}

impl Ruled {
    /// Penetration above which it is raised whatever the error of forces (length), where the master is curved by `radius` (length; zero
    /// where it is not known, or has an edge).
    pub fn limit(&self, radius: f64) -> f64 {
        let Some(t) = self.released else {
            return self.deepest;
        };
        let gentle = radius / (TIGHT * t);
        (RELEASED * t * gentle.powi(2).max(1.0)).min(self.deepest)
    }
}

/// Part of the depth of an element layer, or of its edges where they are shorter, that a point may sink in under a ruled
/// penalty: the layers of a stack are to stay apart.
const DEEPEST: f64 = 0.1;

/// As [`DEEPEST`], of contacts that a stage releases, and of the thickness of the body, on tools of a radius of [`TIGHT`] thicknesses. A
/// sheet of metal that sinks into its tool by `d` where it lifts off is bent further than the tool by the part `d/R`, and unloads as it
/// settles, and forces tell little of it. Springback takes the part `3 s R / (E t)` of the curvature (s: yield stress), so that what
/// it errs by grows as `d t / R^2`: this much is a hundredth of it for `E/s = 700`. On a flat tool no sheet is bent by what it sinks in.
const RELEASED: f64 = 1e-3;
const TIGHT: f64 = 5.0;

/// Penalties that suit a side of a contact, or both (force / length^3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suitable {
    /// What multiples of the automatic one refer to.
    pub automatic: f64,
    /// Where a penalty starts that is ruled by its error.
    pub start: f64,
    /// What it stays below.
    pub stiffest: f64,
    /// Penetration that is too deep (length).
    pub deepest: f64,
    /// Thickness of the body, of the thinner of two (length).
    pub thickness: f64,
}

impl Suitable {
    /// Penetration that a penalty is to start from, also in contacts that are `released`, whatever the curvature of their masters.
    pub fn first_depth(&self, released: bool) -> f64 {
        match released {
            true => self.deepest.min(RELEASED * self.thickness),
            false => self.deepest,
        }
    }

    /// Half of the layer of elements that [`Self::deepest`] is a part of (length).
    pub fn half_of_layer(&self) -> f64 {
        0.5 / DEEPEST * self.deepest
    }

    /// Of faces of a body.
    pub fn new(material: &Material, size: &FaceSize) -> Self {
        let solid = modulus(material) * size.penalties()[0];
        let [bending, compact] = START;
        let slender = size.thickness / (BENDS * size.length);
        Suitable {
            automatic: automatic(material, size),
            start: match slender < 1.0 {
                true => solid * bending * slender.powi(2),
                false => solid * compact,
            },
            stiffest: solid * WARNED / FACTOR,
            deepest: DEEPEST * size.edge.min(size.depth),
            thickness: size.thickness,
        }
    }

    /// What suits impacts: two of Young's moduli over the size of an element, which a wave meets as a wall and which stays
    /// what it is.
    pub fn impact(&self) -> f64 {
        START[1] * self.stiffest * FACTOR / WARNED
    }

    /// Of a contact between two sides: the softer one counts.
    pub fn both(&self, other: &Self) -> Self {
        Suitable {
            automatic: self.automatic.min(other.automatic),
            start: self.start.min(other.start),
            stiffest: self.stiffest.min(other.stiffest),
            deepest: self.deepest.min(other.deepest),
            thickness: self.thickness.min(other.thickness),
        }
    }
}

/// The automatic penalty (force / length^3); scales with the units of the scene as it should.
pub fn automatic(material: &Material, size: &FaceSize) -> f64 {
    let [solid, slender] = size.penalties();
    modulus(material) * solid.min(slender)
}

/// Poisson's ratio of a material.
pub fn poisson(material: &Material) -> f64 {
    material.elastic().nu
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::closest::ClosestPoint;
    use crate::model::build::build;
    use serde_json::json;

    /// A sheet that is let go may sink into a tool by what bends it further by the same part of its springback, whatever the radius.
    #[test]
    fn released_sheets_sink_in_by_what_bends_them_further() {
        let ruled = Ruled {
            accuracy: ACCURACY,
            stiffest: 1.0,
            deepest: 0.1,
            half: 0.5,
            released: Some(2.0),
        };
        let limits = [0.0, 4.0, 10.0, 30.0, 100.0, f64::INFINITY].map(|r| ruled.limit(r));
        let expected = [2e-3, 2e-3, 2e-3, 18e-3, 0.1, 0.1];
        for (limit, expected) in limits.iter().zip(expected) {
            assert!((limit / expected - 1.0).abs() < 1e-12, "{limits:?}");
        }
        let lasting = Ruled {
            released: None,
            ..ruled
        };
        assert_eq!([0.0, f64::INFINITY].map(|r| lasting.limit(r)), [0.1; 2]);
    }

    /// Of exact surfaces the radius is known at every point, of facets it is not.
    #[test]
    fn radii_of_tools_are_those_at_their_points() {
        let scene = json!({
            "covact": 1,
            "materials": { "m": { "neo_hooke": { "E": 1, "nu": 0.3 } } },
            "bodies": { "b": {
                "mesh": { "block": { "min": [-1, -1, -1], "max": [1, 1, 0], "elements": [1, 1, 1] } }, "material": "m"
            } },
            "surfaces": {
                "a": { "cylinder": { "radius": 6, "length": 8, "center": [0, 0, 7], "axis": [0, 1, 0] }, "side": "outward" },
                "b": { "plane": { "center": [0, 0, 1], "normal": [0, 0, -1], "size": [8, 8] } },
                "c": { "sphere": { "radius": 3, "center": [0, 0, 4] }, "side": "outward" },
                "d": {
                    "sphere": { "radius": 3, "center": [0, 0, 4] }, "facets": { "kind": "bilinear", "count": [12, 12] }, "side": "outward"
                }
            },
            "contacts": {
                "a": { "slave": "b.top", "master": "a" }, "b": { "slave": "b.top", "master": "b" },
                "c": { "slave": "b.top", "master": "c" }, "d": { "slave": "b.top", "master": "d" }
            },
            "supports": { "s": { "on": "b.bottom", "fixed": true } }
        });
        let loaded = crate::scene::parse(&scene.to_string(), "scene.json").expect("a scene");
        let model = build(&loaded).expect("a model");
        let radii = model.surfaces.iter().map(|surface| {
            let q = covact_geometry::Vec3::new(0.3, 0.2, 0.5);
            let foot = surface.set.project(&q, None, f64::INFINITY);
            surface.radius_at(foot.expect("a foot").hint())
        });
        let radii: Vec<f64> = radii.collect();
        assert!((radii[0] - 6.0).abs() < 1e-9, "{radii:?}");
        assert!(radii[1] > 1e12, "{radii:?}");
        assert!((radii[2] - 3.0).abs() < 1e-9, "{radii:?}");
        assert_eq!(radii[3], 0.0);
    }
}
