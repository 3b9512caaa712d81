//! Motion with inertia: what bodies weigh, and how they move at the start.
use super::error::{At, number, text};
use super::{Model, ModelError, penalty};
use crate::contact::points::SlavePoint;
use crate::scene::{self, Scene, ValueError};
use crate::shell::Block;
use covact_geometry::Vec3;

/// Part of the time of a run over which the velocity of a support at the start is measured.
const INSTANT: f64 = 1e-5;
/// Part of the size of a model that a support may prescribe at the start and still be at rest there.
const AT_REST: f64 = 1e-9;

/// Inertia of a model.
#[derive(Debug, Clone)]
pub struct DynamicsModel {
    /// What the scene asks for.
    pub settings: scene::Dynamics,
    /// Mass per undeformed volume, per body.
    pub densities: Vec<f64>,
    /// Motion of every body at the start.
    pub motions: Vec<StartMotion>,
    /// Time that a wave takes along an element of the slave, per pair.
    pub waves: Vec<f64>,
    /// Largest area that a node of the slave stands for over its mass, per pair (length^2 / mass).
    pub lightest: Vec<f64>,
    /// Dashpots beside the elements of every body; nothing where material is not viscous.
    pub dashpots: Vec<Block>,
    /// Diagonal of the box around all bodies (length).
    pub size: f64,
    /// Time in which velocities of supports at the start are measured.
    pub instant: f64,
}

/// Velocity of a rigid motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StartMotion {
    /// Of the point `about` (length / time).
    pub velocity: Vec3,
    /// Angular velocity (radians / time).
    pub spin: Vec3,
    /// Point that the body turns about.
    pub about: Vec3,
}

impl StartMotion {
    /// Velocity of a point (length / time).
    pub fn at(&self, x: &Vec3) -> Vec3 {
        self.velocity + self.spin.cross(&(x - self.about))
    }
}

/// The inertia that a scene asks for.
///
/// # Errors
/// A material without a density, or a support that does not start where the body is.
pub(super) fn dynamics(scene: &Scene, model: &Model) -> Result<Option<DynamicsModel>, ModelError> {
    let Some(settings) = scene.solution.dynamics else {
        return Ok(None);
    };
    let (mut densities, mut motions) = (Vec::new(), Vec::new());
    for body in &model.bodies {
        let density = body.material.elastic().density.ok_or_else(|| {
            let message = format!("the material of body `{}` has no density", body.name);
            text(format!("/bodies/{}/material", body.name), message)
        })?;
        densities.push(density);
        let described = scene.bodies.get(&body.name);
        let spin = described.and_then(|b| b.spin);
        motions.push(StartMotion {
            velocity: (described.and_then(|b| b.velocity)).map_or_else(Vec3::zeros, Vec3::from),
            spin: spin.map_or_else(Vec3::zeros, |s| Vec3::from(s.rate)),
            about: match spin.and_then(|s| s.about) {
                Some(about) => about.into(),
                None => center(&body.mesh),
            },
        });
    }
    let wave = |body: usize, length: f64| {
        length * (densities[body] / penalty::modulus(&model.bodies[body].material)).sqrt()
    };
    let waves = (model.pairs.iter()).map(|p| wave(p.body, p.element_size));
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let body_nodes = model.nodes[..model.body_nodes()].iter();
    let (low, high) = body_nodes.fold(start, |(low, high), x| (low.inf(x), high.sup(x)));
    let viscous = model
        .bodies
        .iter()
        .filter(|_| settings.damping.viscosity > 0.0);
    let dashpots = viscous.map(|body| {
        let pointer = || format!("/bodies/{}", body.name);
        body.block.dashpots(&body.mesh).at(pointer)
    });
    let dashpots = dashpots.collect::<Result<_, _>>()?;
    let own = DynamicsModel {
        settings,
        dashpots,
        waves: waves.collect(),
        lightest: lightest(model, &densities),
        densities,
        motions,
        size: (high - low).norm(),
        instant: INSTANT * scene.solution.end_time,
    };
    let zero = vec![0.0; 3 * model.nodes.len()];
    let names = model.prescribed.iter().map(|p| p.support);
    let names = names.chain(model.means.iter().map(|m| m.support));
    for (support, name) in model.supports().zip(names) {
        let pointer = || format!("/supports/{}/displacement", model.supports[name as usize]);
        let starts = support.missing(&zero, 0.0).at(pointer)?;
        if starts.abs() > AT_REST * own.size {
            let message = format!(
                "at time 0 the support is {} away from where the body is, and no inertia follows a jump",
                number(starts)
            );
            let help = "let the displacement begin at 0, and move the body by its `placement`";
            return Err(text(pointer(), message).help(help));
        }
    }
    Ok(Some(own))
}

/// For every pair, the largest area of a slave node over its mass: times the penalty, the square of the fastest frequency of
/// contact.
fn lightest(model: &Model, densities: &[f64]) -> Vec<f64> {
    let mut masses = vec![0.0; model.nodes.len()];
    for (body, density) in model.bodies.iter().zip(densities) {
        let own = &mut masses[body.first_node as usize..];
        for (mass, volume) in own.iter_mut().zip(body.mesh.nodal_volumes()) {
            *mass = density * volume;
        }
    }
    let mut areas = vec![0.0; model.nodes.len()];
    let of = |points: &[SlavePoint]| {
        areas.fill(0.0);
        for p in points {
            p.terms().for_each(|(n, w)| areas[n] += w * p.area);
        }
        let ratios = areas.iter().zip(&masses).filter(|(a, _)| **a > 0.0);
        ratios.map(|(a, m)| a / m).fold(0.0, f64::max)
    };
    model.pairs.iter().map(|p| &p.points[..]).map(of).collect()
}

/// Centre of mass of a mesh.
fn center(mesh: &crate::mesh::Mesh) -> Vec3 {
    let volumes = mesh.nodal_volumes();
    let moment: Vec3 = (mesh.nodes.iter().zip(&volumes)).map(|(x, v)| x * *v).sum();
    moment / volumes.iter().sum::<f64>()
}

impl DynamicsModel {
    /// Velocities at the start, and accelerations where supports prescribe them, 3 per node of the model. What a support holds
    /// moves as that says.
    ///
    /// # Errors
    /// A prescribed value that cannot be evaluated.
    pub fn start(&self, model: &Model) -> Result<[Vec<f64>; 2], ValueError> {
        let zero = vec![0.0; 3 * model.nodes.len()];
        let (mut v, mut a) = (zero.clone(), zero.clone());
        for (body, motion) in model.bodies.iter().zip(&self.motions) {
            let first = body.first_node as usize;
            for (n, x) in body.mesh.nodes.iter().enumerate() {
                v[3 * (first + n)..][..3].copy_from_slice(motion.at(x).as_slice());
            }
        }
        // Means after what is prescribed, and each is met by the second of its two.
        let h = self.instant;
        for support in model.supports() {
            let [free, tied] = support.dofs.map(|d| d as usize);
            let mut rates = [0.0; 2];
            if support.moves() {
                let [w0, w1, w2] = [0.0, h, 2.0 * h].map(|t| support.missing(&zero, t));
                let (w0, w1, w2) = (w0?, w1?, w2?);
                rates = [
                    (-3.0 * w0 + 4.0 * w1 - w2) / (2.0 * h),
                    (w0 - 2.0 * w1 + w2) / (h * h),
                ];
            }
            for (of, rate) in [&mut v, &mut a].into_iter().zip(rates) {
                of[tied] = match free == tied {
                    true => rate,
                    false => 2.0 * rate - of[free],
                };
            }
        }
        Ok([v, a])
    }
}
