//! Scenes without one of their effects: what if it were not there?
use super::Plan;
use crate::scene::{
    Contact, Gap, InitialOverclosure, Kinematics, Load, MasterSurface, Passes, Penalty, Points,
    Scene, Stabilization, Surface, Tangent, nearest,
};

/// An effect that can be turned off.
#[derive(Debug, Clone, Copy)]
pub struct Removable {
    /// What the user calls it.
    pub name: &'static str,
    /// What is done without it, in words.
    pub instead: &'static str,
    /// Effects of the plan, or what their names begin with, of which one at least is on where the scene has it.
    effects: &'static [&'static str],
    /// Takes it out of a scene; whether anything was changed.
    remove: fn(&mut Scene) -> bool,
}

/// Why an effect cannot be turned off.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WithoutError {
    /// The program has no effect of this name that can be turned off.
    #[error("there is no effect `{name}` that can be turned off{}; these can: {known}", meant(.nearest))]
    Unknown {
        /// The name that was asked for.
        name: String,
        /// The most similar name.
        nearest: Option<&'static str>,
        /// All effects that can be turned off.
        known: String,
    },
    /// The effect is off in this scene.
    #[error("the scene has no effect `{name}` to turn off; it has {has}{}", meant(.nearest))]
    NotThere {
        /// The name that was asked for.
        name: String,
        /// The most similar name.
        nearest: Option<&'static str>,
        /// Effects of the scene that can be turned off.
        has: String,
    },
    /// The scene needs the effect.
    #[error("`{name}` cannot be turned off in this scene: {reason}")]
    Fixed {
        /// The name that was asked for.
        name: String,
        /// Why it has to stay.
        reason: &'static str,
    },
}

fn meant(nearest: &Option<&'static str>) -> String {
    nearest.map_or(String::new(), |n| format!(" (did you mean `{n}`?)"))
}

/// Everything that can be turned off.
pub const REMOVABLE: &[Removable] = &[
    Removable {
        name: "friction",
        instead: "points slide freely",
        effects: &["contact.friction"],
        remove: |scene| {
            contacts(scene, |c| {
                c.tangential_penalty = Penalty::Auto;
                c.friction.take().is_some()
            })
        },
    },
    Removable {
        name: "augmentation",
        instead: "the penalties alone hold the points",
        effects: &["contact.augmentation"],
        remove: |scene| contacts(scene, |c| c.augmentation.take().is_some()),
    },
    Removable {
        name: "offset",
        instead: "contact begins on the master",
        effects: &["contact.offset"],
        remove: |scene| contacts(scene, |c| std::mem::take(&mut c.offset) != 0.0),
    },
    Removable {
        name: "overclosure",
        instead: "the first step resolves with strain what starts below the master",
        effects: &[
            "contact.overclosure.stress_free",
            "contact.overclosure.shrink",
        ],
        remove: |scene| {
            contacts(scene, |c| {
                let was = std::mem::take(&mut c.initial_overclosure);
                was != InitialOverclosure::Strain
            })
        },
    },
    Removable {
        name: "averaged",
        instead: "every slave point has a gap of its own",
        effects: &["contact.gap.averaged"],
        remove: |scene| contacts(scene, |c| std::mem::take(&mut c.gap) == Gap::Averaged),
    },
    Removable {
        name: "segments",
        instead: "the same rules on whole faces, which are not cut",
        effects: &["contact.points.segments"],
        remove: |scene| {
            contacts(scene, |c| match c.points {
                Points::Segments(degree) => {
                    c.points = Points::Gauss(degree / 2 + 1);
                    true
                }
                _ => false,
            })
        },
    },
    Removable {
        name: "two_half",
        instead: "the slave is one side",
        effects: &["contact.passes.two_half"],
        remove: |scene| contacts(scene, |c| take_pass(c, Passes::TwoHalf)),
    },
    Removable {
        name: "edges",
        instead: "edges of the master sink into the slave between its points",
        effects: &["contact.passes.edges"],
        remove: |scene| contacts(scene, |c| take_pass(c, Passes::Edges)),
    },
    Removable {
        name: "smooth",
        instead: "the faces of bodies are taken as they are",
        effects: &["contact.master.smooth"],
        remove: |scene| {
            contacts(scene, |c| {
                c.master_surface.take() == Some(MasterSurface::Smooth)
            })
        },
    },
    Removable {
        name: "facets",
        instead: "rigid surfaces are used as they are",
        effects: &[
            "contact.master.rigid.facets.bilinear",
            "contact.master.rigid.facets.biquadratic",
            "contact.master.rigid.facets.smooth",
        ],
        remove: |scene| {
            let whole = |s: &mut Surface| s.facets.take().is_some();
            scene
                .surfaces
                .values_mut()
                .map(whole)
                .fold(false, |a, b| a | b)
        },
    },
    Removable {
        name: "rotational",
        instead: "the published tangent without its rotational part",
        effects: &["contact.tangent.rotational"],
        remove: |scene| published(scene, |rotational, _| *rotational = false),
    },
    Removable {
        name: "curvature",
        instead: "the published tangent without its curvature part",
        effects: &["contact.tangent.curvature"],
        remove: |scene| published(scene, |_, curvature| *curvature = false),
    },
    Removable {
        name: "self_contact",
        instead: "bodies pass through themselves",
        effects: &["contact.self"],
        remove: |scene| {
            let before = scene.contacts.len();
            let surfaces = &scene.surfaces;
            scene.contacts.retain(|_, c| !c.is_own(surfaces));
            scene.contacts.len() < before
        },
    },
    Removable {
        name: "contact",
        instead: "nothing touches",
        effects: &["contact.normal.penalty"],
        remove: |scene| {
            let had = !scene.contacts.is_empty();
            scene.contacts.clear();
            // Surfaces that nothing touches have no motion that forces could drive.
            scene.surfaces.clear();
            had
        },
    },
    Removable {
        name: "follower",
        instead: "pressures keep their first direction",
        effects: &["load.follower_pressure"],
        remove: |scene| {
            let dead = |l: &mut Load| std::mem::take(&mut l.follower);
            scene.loads.values_mut().map(dead).fold(false, |a, b| a | b)
        },
    },
    Removable {
        name: "large_rotation",
        instead: "displacements are small (`\"kinematics\": \"small\"`): linear elements, contact linearised at the start",
        effects: &["large_rotation"],
        remove: |scene| {
            let was = std::mem::replace(&mut scene.solution.kinematics, Kinematics::Small);
            was == Kinematics::Large
        },
    },
    Removable {
        name: "stabilization",
        instead: "nothing helps where the structure does not hold",
        effects: &["stabilization.viscous"],
        remove: |scene| {
            let was = std::mem::replace(&mut scene.solution.stabilization, Stabilization::None);
            was != Stabilization::None
        },
    },
    Removable {
        name: "dynamics",
        instead: "a run is a sequence of equilibria",
        effects: &["dynamics"],
        remove: |scene| {
            for body in scene.bodies.values_mut() {
                (body.velocity, body.spin) = (None, None);
            }
            scene.solution.dynamics.take().is_some()
        },
    },
    Removable {
        name: "damping",
        instead: "nothing but the time integration damps",
        effects: &["dynamics.damping", "dynamics.viscosity"],
        remove: |scene| {
            let dynamics = scene.solution.dynamics.as_mut();
            dynamics.is_some_and(|d| std::mem::take(&mut d.damping) != Default::default())
        },
    },
    Removable {
        name: "fields",
        instead: "no fields are written",
        effects: &["output.fields"],
        remove: |scene| std::mem::take(&mut scene.output.every) != 0,
    },
];

/// Changes all contacts; whether any was changed.
fn contacts(scene: &mut Scene, change: impl Fn(&mut Contact) -> bool) -> bool {
    let all = scene.contacts.values_mut();
    all.map(change).fold(false, |a, b| a | b)
}

/// Leaves a contact one pass where it has this one.
fn take_pass(contact: &mut Contact, pass: Passes) -> bool {
    let on = contact.passes == pass;
    if on {
        contact.passes = Passes::One;
    }
    on
}

/// Leaves out parts of the published tangent, where that form goes with what else a contact has.
fn published(scene: &mut Scene, leave_out: impl Fn(&mut bool, &mut bool)) -> bool {
    contacts(scene, |c| {
        if c.friction.is_some() || c.offset != 0.0 {
            return false;
        }
        let (mut rotational, mut curvature) = match c.tangent {
            Tangent::Exact => (true, true),
            Tangent::Published {
                rotational,
                curvature,
            } => (rotational, curvature),
        };
        leave_out(&mut rotational, &mut curvature);
        c.tangent = Tangent::Published {
            rotational,
            curvature,
        };
        true
    })
}

impl Removable {
    /// Whether an effect of the plan is one of its own.
    fn takes(&self, effect: &str) -> bool {
        let own = |own: &str| {
            let rest = effect.strip_prefix(own);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.effects.iter().any(|name| own(name))
    }

    /// The effect of this name, its own or that of one of its effects in the plan.
    ///
    /// # Errors
    /// [`WithoutError::Unknown`]
    pub fn named(name: &str) -> Result<&'static Removable, WithoutError> {
        let found = (REMOVABLE.iter()).find(|r| r.name == name || r.takes(name));
        let names: Vec<&str> = REMOVABLE.iter().map(|r| r.name).collect();
        found.ok_or_else(|| WithoutError::Unknown {
            name: name.to_owned(),
            nearest: nearest(name, REMOVABLE.iter().map(|r| r.name)),
            known: listed(&names),
        })
    }

    /// Whether an effect of the plan belongs to it.
    pub fn has(&self, effect: &str) -> bool {
        self.takes(effect)
    }

    /// Whether a scene has the effect, by its plan.
    pub fn is_on(&self, plan: &Plan) -> bool {
        let mut on = plan.effects().filter(|e| e.on);
        on.any(|e| self.takes(e.name))
    }

    /// The scene without the effect, which has this plan with it.
    ///
    /// # Errors
    /// [`WithoutError::NotThere`], or [`WithoutError::Fixed`] where it belongs to something else.
    pub fn remove(&self, scene: &Scene, plan: &Plan) -> Result<Scene, WithoutError> {
        if !self.is_on(plan) {
            let there: Vec<&'static str> = (REMOVABLE.iter())
                .filter(|r| r.is_on(plan))
                .map(|r| r.name)
                .collect();
            return Err(WithoutError::NotThere {
                name: self.name.to_owned(),
                nearest: nearest(self.name, there.iter().copied()),
                has: listed(&there),
            });
        }
        let mut out = scene.clone();
        match (self.remove)(&mut out) {
            true => Ok(out),
            false => Err(WithoutError::Fixed {
                name: self.name.to_owned(),
                reason: match self.name {
                    "facets" => "the surface is given as triangles, and no other is known",
                    _ => {
                        "the published tangent, of which it is a part, does not go with friction or an offset"
                    }
                },
            }),
        }
    }
}

fn listed(names: &[&str]) -> String {
    match names {
        [] => "none".to_owned(),
        names => format!("`{}`", names.join("`, `")),
    }
}
