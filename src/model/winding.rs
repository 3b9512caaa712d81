//! How large steps may be for what is prescribed to be known between their ends: a cam that goes round in ten steps, or a load that
//! swings, has its peaks within them.
use super::Model;
use super::error::number;
use super::surface::{SurfaceModel, with_patches};
use crate::contact::closest::ClosestPoint;
use crate::scene::{LoadedScene, TimeFunction};
use covact_geometry::{Surface, Vec3};

/// Part of all of its way by which what is prescribed may be off the straight line between the ends of a step. Of a circle a step
/// follows 23 degrees then, and a peak between two steps is at most 2 % larger than at either.
const OFF: f64 = 0.01;
/// Times of the run at which this is looked at; fewest between two kinks.
const TIMES: f64 = 400.0;
const FEWEST: f64 = 8.0;
/// Part of the run below which no step is asked for: what is faster jumps, and is no straighter in smaller ones.
const SMALLEST: f64 = 1.0 / 250.0;
/// Most points of a surface, and most expressions, whose ways are followed.
const POINTS: usize = 48;
const EXPRESSIONS: usize = 48;
/// By how many degrees a surface is turned to see whether it is the same all round its axis.
const TURN: f64 = 37.0;

/// The largest step between two times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestStep {
    /// Between which times.
    pub span: [f64; 2],
    /// The step (time).
    pub size: f64,
}

/// What goes its way over time: a value, or a point of a surface.
type Way<'m> = Box<dyn Fn(f64) -> Option<Vec3> + 'm>;

/// Where steps have to be smaller than `max`, of a run until `end`; nothing where what is prescribed goes in straight lines.
pub fn largest_steps(model: &Model, end: f64, max: f64) -> Vec<LargestStep> {
    let expressions: Vec<(&TimeFunction, Vec3)> = (model.functions())
        .filter(|(f, _)| f.is_expression())
        .collect();
    let every = expressions.len().div_ceil(EXPRESSIONS).max(1);
    let mut ways: Vec<Way<'_>> = Vec::new();
    for (f, x) in expressions.into_iter().step_by(every) {
        ways.push(Box::new(move |t| {
            Some(Vec3::new(f.eval_at(&x, t).ok()?, 0.0, 0.0))
        }));
    }
    for surface in &model.surfaces {
        ways.extend(turned_points(surface, end).into_iter().map(|x| -> Way<'_> {
            Box::new(move |t| {
                Some(
                    surface
                        .motion
                        .pose(t)
                        .ok()?
                        .transform_point(&x.into())
                        .coords,
                )
            })
        }));
    }
    if ways.is_empty() || end.is_nan() || end <= 0.0 {
        return Vec::new();
    }
    let mut ends: Vec<f64> = (model.kinks.iter().copied())
        .filter(|t| *t > 0.0 && *t < end)
        .collect();
    ends.push(end);
    let spans: Vec<[f64; 2]> = std::iter::once(0.0)
        .chain(ends.iter().copied())
        .zip(ends.iter().copied())
        .map(|(a, b)| [a, b])
        .collect();
    let mut sizes = vec![max; spans.len()];
    for way in &ways {
        let all = extent(way, &spans, end);
        for (size, span) in sizes.iter_mut().zip(&spans) {
            *size = size.min(followed(way, *span, (*size, OFF * all), end));
        }
    }
    let found = spans.into_iter().zip(sizes);
    found
        .filter(|(_, size)| *size < max)
        .map(|(span, size)| LargestStep { span, size })
        .collect()
}

/// What the user is told of them.
pub(super) fn note(found: &[LargestStep]) -> Option<String> {
    let smallest = (found.iter()).min_by(|a, b| a.size.total_cmp(&b.size))?;
    Some(format!(
        "steps are at most {} from time {} to {}: what is prescribed goes round, or swings, within larger ones \
         (`solution.step.max` takes its place)",
        number(smallest.size),
        number(smallest.span[0]),
        number(smallest.span[1])
    ))
}

/// Times of a span, ends included.
fn times([a, b]: [f64; 2], end: f64) -> impl Iterator<Item = f64> {
    let count = (TIMES * (b - a) / end).ceil().max(FEWEST);
    (0..=count as u32).map(move |i| a + (b - a) * f64::from(i) / count)
}

/// The longest side of the box around a way.
fn extent(way: &Way<'_>, spans: &[[f64; 2]], end: f64) -> f64 {
    let all = spans.iter().flat_map(|span| times(*span, end));
    let mut sides = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
    for x in all.filter_map(way) {
        sides = [sides[0].inf(&x), sides[1].sup(&x)];
    }
    (sides[1] - sides[0]).max().max(0.0)
}

/// The largest step, at most `size`, within which a way is nowhere in a span farther than `off` from a straight line; `size` where it
/// jumps.
fn followed(way: &Way<'_>, span: [f64; 2], (size, off): (f64, f64), end: f64) -> f64 {
    let straight = |step: f64| {
        let begins = times(span, end).filter(|t| t + step <= span[1] + 1e-9 * end);
        begins.into_iter().all(|t| {
            let at = |part: f64| way((t + part * step).min(span[1]));
            let Some(((a, b), middle)) = at(0.0).zip(at(1.0)).zip(at(0.5)) else {
                return true;
            };
            ((a + b) * 0.5 - middle).norm() <= off
        })
    };
    let all = span[1] - span[0];
    let mut count = (all / size - 1e-6).ceil().max(1.0);
    loop {
        let step = all / count;
        if step < SMALLEST * end {
            return size;
        }
        if straight(step) {
            return if step < size { step } else { size };
        }
        count = (1.25 * count).ceil();
    }
}

/// Points of a surface that turns, in its own coordinates; none of one that is the same all round its axis.
fn turned_points(surface: &SurfaceModel, end: f64) -> Vec<Vec3> {
    let motion = &surface.motion;
    if !motion.turns() || surface.driven.is_some() {
        return Vec::new();
    }
    let points: Vec<Vec3> = with_patches!(&surface.set, set => {
        let patches = set.patches();
        let every = patches.len().div_ceil(POINTS / 3).max(1);
        (patches.iter().step_by(every))
            .flat_map(|patch| {
                let [u, v] = patch.domain();
                [0.0, 0.5, 1.0].map(|s| patch.point([u[0] + s * (u[1] - u[0]), v[0] + s * (v[1] - v[0])]))
            })
            .collect()
    });
    let Some(turn) = motion.turned(TURN) else {
        return Vec::new();
    };
    let longest = |x: &Vec3| (turn.transform_point(&(*x).into()).coords - x).norm();
    let size = points.iter().map(longest).fold(0.0, f64::max);
    let off = |x: &Vec3| {
        let x = turn.transform_point(&(*x).into()).coords;
        let foot = surface.set.project(&x, None, size);
        foot.is_none_or(|foot| foot.distance > OFF * size)
    };
    let angles = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| motion.turn(0.0, part * end));
    let turns = angles.iter().flatten().any(|angle| *angle != 0.0);
    match turns && points.iter().any(off) {
        true => points,
        false => Vec::new(),
    }
}

impl Model {
    /// Takes down how large steps may be beside what is prescribed, unless the scene says how large they are. With inertia steps follow
    /// their own error.
    pub(super) fn bound_steps(&mut self, loaded: &LoadedScene) {
        let solution = &loaded.scene.solution;
        let given = |key: &str| loaded.has(&format!("/solution/step/{key}"));
        if given("max") || !solution.step.adaptive || solution.dynamics.is_some() {
            return;
        }
        self.largest_steps = largest_steps(self, solution.end_time, solution.steps(given).max);
        self.notes.extend(note(&self.largest_steps));
    }
}

#[cfg(test)]
mod tests {
    use crate::model::build::build;
    use crate::scene;
    use serde_json::{Value, json};

    /// The steps of a block below a tool, of a run until 1 whose steps are a tenth otherwise.
    fn sizes(surface: Value, motion: Value, push: Value) -> Vec<f64> {
        let mut tool = surface;
        tool["motion"] = motion;
        let scene = json!({
            "covact": 1,
            "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3}}},
            "bodies": {"b": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"
            }},
            "surfaces": {"tool": tool},
            "contacts": {"c": {"slave": "b.top", "master": "tool"}},
            "supports": {"below": {"on": "b.bottom", "displacement": {"x": push, "y": 0, "z": 0}}}
        });
        let loaded = scene::parse(&scene.to_string(), "scene.json").expect("a scene");
        let model = build(&loaded).expect("a model");
        model.largest_steps.iter().map(|s| s.size).collect()
    }

    /// A cam turns about an axis beside its own: half a step of a turn by `phi` is off its chord by `r (1 - cos(phi / 2))`, of a way of
    /// `2 r`. A roller turned about its own axis is the same all the time, and so is what goes straight.
    #[test]
    fn a_cam_is_followed_and_a_roller_is_not() {
        let roller = || json!({"cylinder": {"radius": 1, "length": 4, "center": [0.5, 0.5, 2.5], "axis": [0, 1, 0]}, "side": "outward"});
        let turned = |x: f64, angle: Value| json!({"rotation": {"center": [x, 0.5, 2.5], "axis": [0, 1, 0], "angle": angle}});
        let still = || json!(0);
        assert!(sizes(roller(), turned(0.5, json!("720*t")), still()).is_empty());
        let cam = sizes(roller(), turned(1.0, json!("720*t")), still());
        let [size] = cam[..] else { panic!("{cam:?}") };
        // The farthest point goes round on a circle of 1.5, and cos(phi / 2) is .98 at 23 degrees.
        let degrees = 720.0 * size;
        assert!(degrees < 23.1 && degrees > 15.0, "{degrees}");
        // A table says when it turns; a turn of 20 degrees goes almost straight.
        let table = json!({"table": [[0, 0], [0.5, 0], [1, 720]]});
        let late = sizes(roller(), turned(1.0, table), still());
        assert_eq!(late.len(), 1);
        assert!(late[0] < size);
        assert!(sizes(roller(), turned(1.0, json!("20*t")), still()).is_empty());
    }

    /// A swing has its peaks; a jump is no straighter in smaller steps, and a ramp is straight.
    #[test]
    fn a_swing_is_followed_to_its_peaks() {
        let plane = || json!({"plane": {"center": [0.5, 0.5, 2], "size": [4, 4]}, "side": {"point": [0.5, 0.5, 0]}});
        let of = |push: Value| sizes(plane(), json!({"translation": [0, 0, 0]}), push);
        let swing = of(json!("0.1*sin(6.283185307179586*3*t)"));
        let [size] = swing[..] else {
            panic!("{swing:?}")
        };
        let degrees = 3.0 * 360.0 * size;
        assert!(degrees < 23.1 && degrees > 15.0, "{degrees}");
        assert!(of(json!("0.1*t")).is_empty() && of(json!("0.1*t^2")).is_empty());
        assert!(of(json!({"table": [[0, 0], [0.1, 0.2], [0.2, 0], [1, 0]]})).is_empty());
        assert!(of(json!("min(0.1, max(0, 1e9*(t-0.37)))")).is_empty());
    }

    /// Steps with inertia follow their own error, and those that a scene gives are what it says.
    #[test]
    fn steps_that_are_ruled_otherwise_are_left_alone() {
        let bounded = |solution: Value| {
            let scene = json!({
                "covact": 1,
                "materials": {"m": {"neo_hooke": {"E": 1, "nu": 0.3, "density": 1}}},
                "bodies": {"b": {
                    "mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"
                }},
                "supports": {"below": {"on": "b.bottom", "displacement": {"x": "0.1*sin(20*t)", "y": 0, "z": 0}}},
                "solution": solution
            });
            let loaded = scene::parse(&scene.to_string(), "scene.json").expect("a scene");
            !build(&loaded).expect("a model").largest_steps.is_empty()
        };
        assert!(bounded(json!({})));
        assert!(!bounded(json!({"dynamics": {}})));
        assert!(!bounded(json!({"step": {"max": 0.1}})));
    }
}
