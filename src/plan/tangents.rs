//! The tangent of a contact pair and its parts: which of them there are for its geometry.
use super::pairs::EffectContext;
use super::{Effect, Reporter, Why, why};
use crate::contact::kind::TangentKind;
use crate::model::EffectKind;
use crate::model::error::number;
use crate::model::kernel::GapKind;
use crate::model::surface::with_patches;
use crate::scene::FacetKind;
use covact_geometry::Surface;

/// Cosine of the angle between normals above which a patch is smooth across a knot: a degree.
const SMOOTH: f64 = 0.999_847_7;

/// Knots across which the normals of patches turn at once, seen at five places along each.
fn creases<S: Surface>(patches: &[S]) -> usize {
    let mut count = 0;
    for patch in patches {
        let domain = patch.domain();
        for dir in 0..2 {
            let turns = |knot: f64| {
                (0..5).any(|k| {
                    let [a, b] = domain[1 - dir];
                    let along = a + (b - a) * (f64::from(k) + 0.5) / 5.0;
                    let step = 1e-7 * (domain[dir][1] - domain[dir][0]);
                    let normal = |x: f64| {
                        let mut xi = [along; 2];
                        xi[dir] = x;
                        let [r, s] = patch.jet(xi).rho_i;
                        r.cross(&s)
                    };
                    let (n, m) = (normal(knot - step), normal(knot + step));
                    n.dot(&m) < SMOOTH * n.norm() * m.norm()
                })
            };
            count += patch
                .crease_knots(dir)
                .into_iter()
                .filter(|x| turns(*x))
                .count();
        }
    }
    count
}

impl Reporter<'_> {
    pub(super) fn tangents(&self, told: &EffectContext) -> Vec<Effect> {
        let key = told.key("tangent");
        let given = self.loaded.has(&key);
        let published = match told.kernel.tangent {
            TangentKind::Exact => None,
            TangentKind::Published(parts) => Some(parts),
        };
        let reason = match (given, published) {
            (false, _) => "no `tangent`: it is consistent at every penetration",
            (true, None) => "`tangent` is `exact`",
            (true, Some(_)) => "`tangent` is `published`",
        };
        let reason = match (self.still(told), published) {
            (Some(still), None) => format!("{still}: the tangent is exact as it stands"),
            _ => reason.to_owned(),
        };
        let mut out = Vec::new();
        for (name, on) in [
            (EffectKind::TangentExact, published.is_none()),
            (EffectKind::TangentPublished, published.is_some()),
        ] {
            out.push(self.effect(name, &key, why(on, &*reason, &*reason)));
        }
        let part = |key: &str| match published {
            Some(_) => told.key(&format!("tangent/published/{key}")),
            None => told.key("tangent"),
        };
        out.push(self.effect(
            EffectKind::TangentMain,
            &key,
            Ok("penalty times normal by normal".to_owned()),
        ));
        let rotational = match (published, told.pair.body_master()) {
            (Some(parts), Some(_)) if !parts.rotational => {
                Err("`rotational` is false in `tangent`".to_owned())
            }
            (_, Some(_)) => Ok("the master's tangents turn with its nodes".to_owned()),
            (_, None) => Err(format!(
                "a rigid master has no rotational part: `{}` has no rows of its own at the points",
                told.pair.master_name(self.model)
            )),
        };
        let at = match told.pair.body_master() {
            Some(_) => part("rotational"),
            None => told.key("master"),
        };
        let (at, rotational) = match self.still(told) {
            Some(why) => ("/solution/kinematics".to_owned(), Err(why)),
            None => (at, rotational),
        };
        out.push(self.effect(EffectKind::TangentRotational, at, rotational));
        let (at, curvature) = self.curvature(told);
        let (at, curvature) = match published {
            Some(parts) if !parts.curvature => (
                part("curvature"),
                Err("`curvature` is false in `tangent`".to_owned()),
            ),
            _ => (at, curvature),
        };
        let (at, curvature) = match self.still(told) {
            Some(why) => ("/solution/kinematics".to_owned(), Err(why)),
            None => (at, curvature),
        };
        out.push(self.effect(EffectKind::TangentCurvature, at, curvature));
        out.push(self.edges(told));
        out
    }

    /// Why the tangent of normals is nothing, where they stay.
    fn still(&self, told: &EffectContext) -> Option<String> {
        (told.kernel.gap == GapKind::Linearised)
            .then(|| "displacements are small: normals and feet stay as at the start".to_owned())
    }

    /// Whether the master is curved anywhere, and what tells.
    fn curvature(&self, told: &EffectContext) -> (String, Why) {
        let Some(number_of) = told.pair.rigid_master() else {
            let smooth = told.pair.body_master().is_some_and(|m| m.smooth);
            let why = match smooth {
                true => "the smooth surface over the faces of the master is curved",
                false => "faces of a body twist and bend as it deforms",
            };
            return (told.key("master"), Ok(why.to_owned()));
        };
        let surface = &self.model.surfaces[number_of];
        let described = self.loaded.scene.surfaces.get(&surface.name);
        let shape = match described {
            Some(s) if s.facets.is_some() => "facets",
            Some(s) if s.cad.is_some() => "cad",
            Some(s) if s.sphere.is_some() => "sphere",
            Some(s) if s.cylinder.is_some() => "cylinder",
            Some(s) if s.patches.is_some() => "patches",
            _ => "plane",
        };
        let at = crate::scene::pointer(&["surfaces", &surface.name, shape]);
        let range = with_patches!(&surface.set, s => s.curvature_range());
        let radii = [range.convex, range.concave].map(|c| c.map(|c| c.radius()));
        let sides: Vec<String> = (radii.into_iter().zip(["convex", "hollow"]))
            .filter_map(|(r, side)| Some(format!("{side} of radius {}", number(r?))))
            .collect();
        let why = match sides.is_empty() {
            true => Err(format!(
                "a flat master has no curvature part: `{}` is flat{}",
                surface.name,
                match surface.facets.as_ref().map(|f| f.kind) {
                    Some(FacetKind::Bilinear) => ", facet by facet",
                    _ => "",
                }
            )),
            false => Ok(format!("`{}` is {}", surface.name, sides.join(" and "))),
        };
        (at, why)
    }

    /// Whether feet may lie on edges and corners, where the traction acts along the distance.
    fn edges(&self, told: &EffectContext) -> Effect {
        let kind = EffectKind::TangentEdges;
        if let Some(still) = self.still(told) {
            return self.effect(kind, "/solution/kinematics", Err(still));
        }
        let Some(surface) = told.pair.rigid_master() else {
            let smooth = told.pair.body_master().is_some_and(|m| m.smooth);
            return self.effect(
                kind,
                told.key("master"),
                why(
                    !smooth,
                    "faces of the master meet at edges and corners",
                    "the surface over the master's faces is smooth",
                ),
            );
        };
        let surface = &self.model.surfaces[surface];
        let edges = surface.set.edges();
        let [sharp, partial] = [edges.sharp, edges.partial.len()];
        let creases = with_patches!(&surface.set, s => creases(s.patches()));
        self.effect(
            kind,
            crate::scene::pointer(&["surfaces", &surface.name]),
            why(
                sharp + partial + creases > 0,
                format!(
                    "`{}` has {sharp} sharp edge(s), {partial} shared in parts and {creases} crease(s)",
                    surface.name
                ),
                format!("`{}` has no sharp edges", surface.name),
            ),
        )
    }
}
