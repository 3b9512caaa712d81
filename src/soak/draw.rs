//! What a seed means.
use super::clearance::{Place, clearance};
use super::effects::{Effects, draw_effects};
use covact_geometry::{NurbsPatch, Vec3};
use fastrand::Rng;
use std::f64::consts::PI;

/// The body that the tool meets; lengths are of the order of 10.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyKind {
    /// A plate about the origin, its top at z = 0.
    Sheet {
        /// Lengths along x and y.
        size: [f64; 2],
        /// Thickness along z.
        thickness: f64,
    },
    /// A block about the z axis, its top at z = 0.
    Block {
        /// Lengths along x and y.
        size: [f64; 2],
        /// Height along z.
        height: f64,
    },
    /// Part of a cylinder about the y axis, its crown at z = 0, both straight edges clamped.
    Arch {
        /// Radius of the mid-surface.
        radius: f64,
        /// Thickness of the wall.
        thickness: f64,
        /// Angle from the crown to a straight edge (degrees).
        half_angle: f64,
        /// Half of its length along y.
        half_width: f64,
    },
    /// A plate, its top at z = 0, at a distance above a block: two bodies.
    SheetOnBlock {
        /// Lengths of both along x and y.
        size: [f64; 2],
        /// Thickness of the plate.
        thickness: f64,
        /// Distance of the plate from the block.
        gap: f64,
    },
}

/// How a sheet is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    AllRound,
    TwoEdges,
    OneEdge,
}

/// The rigid surface that moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Tool {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A bar.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Direction of its axis.
        axis: [f64; 3],
    },
    /// A plane.
    Plane {
        /// Its outward normal.
        normal: [f64; 3],
    },
    /// One patch from a CAD file.
    Patch(Box<NurbsPatch>),
}

/// Displacement of the tool over time, and its turn about the z axis in degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Times and displacements.
    pub path: Vec<(f64, [f64; 3])>,
    /// Turn about the z axis at the end (degrees).
    pub turn: f64,
    /// Whether the tool presses at the end.
    pub pressed: bool,
    /// The force that drives the tool along z after its path; none: its path is prescribed.
    pub force: Option<f64>,
    /// How far the tool goes beyond touch.
    pub pressing: f64,
}

/// A scene drawn from a seed.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomScene {
    /// The seed that it was drawn from.
    pub seed: u64,
    /// The body that the tool meets.
    pub body: BodyKind,
    /// How the body is held.
    pub held: Held,
    /// `h8`, `q18` or `h8_displacement`.
    pub element: &'static str,
    /// Elements along both directions of the surface.
    pub elements: [u32; 2],
    /// Young's modulus.
    pub e: f64,
    /// Poisson's ratio.
    pub nu: f64,
    /// The rigid surface.
    pub tool: Tool,
    /// Position of the tool's reference point at the start: the centre of a sphere, cylinder or plane; a patch is where it
    /// is.
    pub center: [f64; 3],
    /// Facets in place of the exact surface: kind and number along both directions.
    pub facets: Option<(&'static str, u32)>,
    /// How the tool moves.
    pub motion: Motion,
    /// Friction coefficient; none: without friction.
    pub mu: Option<f64>,
    /// Whether tractions are augmented.
    pub augmented: bool,
    /// `nodes`, or a rule and its number.
    pub points: (&'static str, u32),
    /// Multiple of the automatic penalty; none: the automatic one.
    pub penalty: Option<f64>,
    /// Number of steps that the scene asks for.
    pub steps: u32,
    /// Held at the other end along x.
    pub mirrored: bool,
    /// What else acts.
    pub effects: Effects,
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

fn chance(rng: &mut Rng, share: f64) -> bool {
    rng.f64() < share
}

/// The scene of a seed: the same on every machine.
pub fn draw(seed: u64) -> RandomScene {
    // Neighbouring seeds give unrelated scenes.
    let mut rng = Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1_e995);
    loop {
        let scene = attempt(seed, &mut rng);
        if scene.presses() {
            return scene;
        }
    }
}

/// The scene of a seed with effects.
pub fn draw_with_effects(seed: u64) -> RandomScene {
    let mut scene = draw(seed);
    scene.effects = draw_effects(&scene);
    scene
}

/// A scene, which may have no room to press in, or slave points too far apart to feel it.
fn attempt(seed: u64, rng: &mut Rng) -> RandomScene {
    let body = body(rng);
    let held = [Held::AllRound, Held::TwoEdges, Held::OneEdge][rng.usize(0..3)];
    let solid = matches!(body, BodyKind::Block { .. });
    let element = match (solid, chance(rng, 0.3)) {
        (true, shell) => ["h8_displacement", "h8"][usize::from(shell)],
        (false, quadratic) => ["h8", "q18"][usize::from(quadratic)],
    };
    let most = if element == "q18" { [3, 6] } else { [6, 11] };
    let elements = [0; 2].map(|_| rng.u32(most[0]..most[1]));
    let mut tool = tool(rng);
    let gap = between(rng, 0.005, 0.3);
    let center = place(rng, &mut tool, &body, gap);
    let faceted = matches!(tool, Tool::Sphere { .. } | Tool::Cylinder { .. });
    let facets = (faceted && chance(rng, 0.2)).then(|| {
        let kind = ["bilinear", "biquadratic", "smooth"][rng.usize(0..3)];
        (kind, rng.u32(24..40))
    });
    let e = 10f64.powf(between(rng, 0.0, 5.0));
    let motion = motion(rng, (&body, held), &tool, center, gap, e);
    RandomScene {
        seed,
        body,
        held,
        element,
        elements,
        e,
        nu: match chance(rng, 0.1) {
            true => 0.49,
            false => between(rng, 0.0, 0.45),
        },
        tool,
        center,
        facets,
        motion,
        mu: chance(rng, 0.5).then(|| between(rng, 0.05, 1.0)),
        augmented: chance(rng, 0.15),
        points: [
            ("nodes", 0),
            ("gauss", 2),
            ("gauss", 2),
            ("gauss", 3),
            ("lobatto", 3),
        ][rng.usize(0..5)],
        penalty: chance(rng, 0.4).then(|| 10f64.powf(between(rng, -1.0, 1.0))),
        steps: rng.u32(8..20),
        mirrored: false,
        effects: Effects::default(),
    }
}

impl RandomScene {
    /// Whether the tool surely comes to slave points: where it is round it may end between them.
    fn presses(&self) -> bool {
        let half = self.body.half();
        let within = match (self.points, self.element) {
            (("nodes", _), "q18") => 2,
            (("nodes", _), _) => 1,
            (("lobatto", n), _) => n - 1,
            ((_, n), _) => n,
        };
        let spacing = [0, 1]
            .map(|k| 2.0 * half[k] / f64::from(self.elements[k] * within))
            .into_iter()
            .fold(0.0, f64::max);
        let sagitta = match self.tool {
            Tool::Sphere { radius } => 0.25 * spacing * spacing / radius,
            Tool::Cylinder { radius, .. } => 0.125 * spacing * spacing / radius,
            Tool::Plane { .. } => 0.0,
            Tool::Patch(_) => 0.05 * spacing * spacing,
        };
        self.motion.pressing > sagitta + 0.05
    }
}

fn body(rng: &mut Rng) -> BodyKind {
    let size = [0; 2].map(|_| between(rng, 8.0, 12.0));
    match rng.u32(0..10) {
        0..4 => BodyKind::Sheet {
            size,
            thickness: between(rng, 0.15, 1.0),
        },
        4..7 => BodyKind::Block {
            size,
            height: between(rng, 2.0, 5.0),
        },
        7..9 => BodyKind::SheetOnBlock {
            size,
            thickness: between(rng, 0.2, 1.0),
            gap: between(rng, 0.0, 0.1),
        },
        _ => BodyKind::Arch {
            radius: between(rng, 8.0, 20.0),
            thickness: between(rng, 0.2, 0.8),
            half_angle: between(rng, 15.0, 40.0),
            half_width: between(rng, 2.0, 4.0),
        },
    }
}

fn tool(rng: &mut Rng) -> Tool {
    match rng.u32(0..10) {
        0..3 => Tool::Sphere {
            radius: between(rng, 1.5, 6.0),
        },
        3..6 => {
            let angle = between(rng, 0.0, PI);
            let slope = between(rng, -0.05, 0.05);
            Tool::Cylinder {
                radius: between(rng, 1.0, 5.0),
                axis: [angle.cos(), angle.sin(), slope],
            }
        }
        6..7 => {
            let tilt = [0; 2].map(|_| between(rng, -0.15, 0.15));
            Tool::Plane {
                normal: [tilt[0], tilt[1], -1.0],
            }
        }
        _ => Tool::Patch(Box::new(hills(rng))),
    }
}

/// A bicubic patch over [-9, 9]^2 with random heights, every other one rational.
fn hills(rng: &mut Rng) -> NurbsPatch {
    const N: usize = 7;
    let amplitude = between(rng, 0.3, 2.0);
    let rational = rng.bool();
    let knots: Vec<f64> = [0.0; 3]
        .into_iter()
        .chain((0..=N - 3).map(|i| i as f64))
        .chain([(N - 3) as f64; 3])
        .collect();
    let mut points = Vec::with_capacity(N * N);
    let mut weights = Vec::with_capacity(N * N);
    for j in 0..N {
        for i in 0..N {
            let [x, y] = [i, j].map(|k| 18.0 * k as f64 / (N - 1) as f64 - 9.0);
            points.push(Vec3::new(x, y, amplitude * (2.0 * rng.f64() - 1.0)));
            weights.push(match rational {
                true => between(rng, 0.5, 2.0),
                false => 1.0,
            });
        }
    }
    let patch = NurbsPatch::new(
        [3, 3],
        [knots.clone(), knots],
        [N, N],
        &points,
        Some(&weights),
    );
    // The net above is valid for every seed.
    patch.unwrap_or_else(|e| unreachable!("a bicubic net: {e}"))
}

/// Puts the tool, not exactly over the middle, where its smallest height above the body is `gap`; its centre.
fn place(rng: &mut Rng, tool: &mut Tool, body: &BodyKind, gap: f64) -> [f64; 3] {
    let mut center = match tool {
        Tool::Patch(_) => [0.0; 3],
        _ => [between(rng, -1.0, 1.0), between(rng, -1.0, 1.0), 0.0],
    };
    let up = gap - clearance(tool, center, Place::default(), body, |_, _| true);
    match tool {
        Tool::Patch(patch) => {
            if let Ok(moved) = patch.transformed(&|p| p + Vec3::new(0.0, 0.0, up)) {
                **patch = moved;
            }
        }
        _ => center[2] += up,
    }
    center
}

/// How far the tool may go down without squeezing what is clamped, along a way aside and a turn (degrees).
fn room(
    scene: (&BodyKind, Held),
    tool: &Tool,
    center: [f64; 3],
    aside: [f64; 2],
    turn: f64,
) -> f64 {
    let (body, held) = scene;
    let half = body.half();
    // Within a thickness or so of a clamped edge.
    let clamped = |x: f64, y: f64| {
        let [ends, sides] = [half[0] - x.abs() < 0.6, half[1] - y.abs() < 0.6];
        match (body, held) {
            (BodyKind::Block { .. }, _) => false,
            (BodyKind::Arch { .. }, _) | (_, Held::TwoEdges) => ends,
            (_, Held::AllRound) => ends || sides,
            (_, Held::OneEdge) => ends && x < 0.0,
        }
    };
    (0..=6)
        .map(|k| {
            let share = f64::from(k) / 6.0;
            let at = Place {
                aside: aside.map(|a| share * a),
                turn: (share * turn).to_radians(),
            };
            clearance(tool, center, at, body, clamped)
        })
        .fold(f64::INFINITY, f64::min)
}

fn motion(
    rng: &mut Rng,
    scene: (&BodyKind, Held),
    tool: &Tool,
    center: [f64; 3],
    gap: f64,
    e: f64,
) -> Motion {
    let (body, held) = scene;
    let depth = match (body, tool) {
        (BodyKind::Block { height, .. }, Tool::Plane { .. }) => {
            height * between(rng, 0.02, 0.15) + gap
        }
        (BodyKind::Block { height, .. }, _) => height * between(rng, 0.03, 0.2) + gap,
        (BodyKind::SheetOnBlock { .. }, _) => between(rng, 0.1, 0.6) + gap,
        (
            BodyKind::Arch {
                radius, half_angle, ..
            },
            _,
        ) => {
            let rise = radius * (1.0 - half_angle.to_radians().cos());
            rise * between(rng, 0.1, 0.6) + gap
        }
        (BodyKind::Sheet { .. }, _) if held == Held::OneEdge => between(rng, 0.2, 3.0) + gap,
        (BodyKind::Sheet { .. }, _) => between(rng, 0.1, 1.5) + gap,
    };
    let angle = between(rng, 0.0, 2.0 * PI);
    let way = between(rng, 0.2, 2.5);
    let (kind, turned) = (rng.u32(0..6), between(rng, 5.0, 60.0));
    let aside = match kind {
        2 | 5 => [way * angle.cos(), way * angle.sin()],
        _ => [0.0; 2],
    };
    let turn = if kind == 3 { turned } else { 0.0 };
    let depth = depth.min(room(scene, tool, center, aside, turn) - 0.03);
    let down = [0.0, 0.0, -depth];
    let aside = [aside[0], aside[1], -depth];
    let start = (0.0, [0.0; 3]);
    let (path, pressed) = match kind {
        0 | 1 => (vec![start, (1.0, down)], true),
        2 => (vec![start, (0.4, down), (1.0, aside)], true),
        3 => (vec![start, (0.5, down), (1.0, down)], true),
        4 => (vec![start, (0.5, down), (1.0, [0.0; 3])], false),
        _ => (vec![start, (0.4, down), (0.7, aside), (1.0, down)], true),
    };
    let solid = matches!(body, BodyKind::Block { .. });
    let flat = matches!(tool, Tool::Plane { .. });
    let force =
        (solid && !flat && pressed && chance(rng, 0.2)).then(|| -e * between(rng, 0.05, 0.4));
    Motion {
        path,
        turn,
        pressed,
        force,
        pressing: depth - gap,
    }
}
