//! Bodies whose elements with assumed and enhanced strains give way where they are squeezed: the elements do, not the structure,
//! and what they give may be far off.
use crate::assembly::Fault;
use crate::mesh::ThicknessColumns;
use crate::model::state::State;
use crate::model::{BodyModel, Model};
use crate::shell::{Block, H8Block};
use crate::solve::newton::StepFailure;
use covact_geometry::Vec3;
use rayon::prelude::*;

/// Cuts of a step after which elements that turn inside out are given up where others may replace them.
pub(super) const HOPELESS: u32 = 3;
/// Cuts of a step after which squeezed elements of shells are replaced.
pub(super) const SUSPECT: u32 = 2;
/// Part of its length that an edge of an element has to have lost for the element to count as squeezed, and for it to be looked
/// into: thin shells, whose elements rightly give way where they buckle, are not shortened as much, and stocky elements do not
/// buckle.
const SQUEEZED: f64 = 0.1;
const SHORTENED: f64 = 0.05;
const SHORTENED_STOCKY: f64 = 0.01;
/// Thickness of a stocky element, in terms of the longest edge of its faces.
const STOCKY: f64 = 0.5;
/// Most elements of a body that are looked into: those that are squeezed most.
const LOOKED_INTO: usize = 48;

/// Part of the volume that an element's material feels by which the one between its corners may fall short of it where it goes to
/// and fro from layer to layer, and elsewhere: a shell that is bent round a few of its elements shows a tenth.
const UNFELT: f64 = 0.05;
const UNFELT_SHELL: f64 = 0.15;

/// Difference of the directions of two edges along the thickness by which they turn against each other, of about .6 where an element
/// loses 5 % by that; and the part of it that those of an element that lies on it have to turn the other way.
const TURNS: f64 = 0.3;
const OTHERS: f64 = 0.25;

/// What helps where an element with enhanced strains cannot follow; empty for other failures.
pub(super) fn remedy(turned: Option<&BodyModel>) -> &'static str {
    match turned {
        Some(_) => {
            "; where it is squeezed rather than bent, element `h8_mean_dilatation` follows farther"
        }
        None => "",
    }
}

/// The body whose elements with enhanced strains turned inside out.
pub(super) fn turned<'m>(model: &'m Model, failure: &StepFailure) -> Option<&'m BodyModel> {
    let named = match failure {
        StepFailure::Fault(Fault::Element { body, .. }) | StepFailure::InsideOut { body, .. } => {
            body
        }
        _ => return None,
    };
    (model.bodies.iter()).find(|b| b.name == *named && b.block.alpha_len() > 0)
}

/// Whether elements of a body are squeezed, and not merely bent.
pub(super) fn compressed(body: &BodyModel, u: &[f64]) -> bool {
    (0..body.mesh.elements()).any(|e| shortened(body, u, e) > SQUEEZED)
}

/// Largest part of its length that an edge of an element has lost.
fn shortened(body: &BodyModel, u: &[f64], e: usize) -> f64 {
    let mesh = &body.mesh;
    let at = |n: u32| {
        let first = 3 * (body.first_node + n) as usize;
        Vec3::new(u[first], u[first + 1], u[first + 2])
    };
    let nodes = mesh.element(e);
    // Edges join nodes whose numbers differ in one bit.
    let edges = (0..8).flat_map(|a| [1, 2, 4].map(|bit| (a, a ^ bit)));
    let edges = edges.filter(|(a, b)| a < b && *b < nodes.len());
    edges.fold(0.0, |most: f64, (a, b)| {
        let (a, b) = (nodes[a], nodes[b]);
        let before = mesh.nodes[a as usize] - mesh.nodes[b as usize];
        most.max(1.0 - (before + at(a) - at(b)).norm() / before.norm())
    })
}

/// Part of its length that an edge of an element has to have lost for it to be looked into.
fn worth_a_look(body: &BodyModel, e: usize) -> f64 {
    let nodes = body.mesh.element(e);
    let longest = |bits: &[usize]| {
        let ends = |bit: usize| {
            (0..8)
                .filter(move |a| a & bit == 0)
                .map(move |a| (a, a ^ bit))
        };
        let edges = bits.iter().flat_map(|bit| ends(*bit));
        let at = |a: usize| body.mesh.nodes[nodes[a] as usize];
        edges.fold(0.0f64, |most, (a, b)| most.max((at(a) - at(b)).norm()))
    };
    match longest(&[4]) >= STOCKY * longest(&[1, 2]) {
        true => SHORTENED_STOCKY,
        false => SHORTENED,
    }
}

/// The bodies of H8 elements: their numbers, and the states of their elements.
fn h8_bodies<'a>(
    model: &'a Model,
    state: &'a State,
) -> impl Iterator<Item = (usize, &'a BodyModel, &'a H8Block, &'a [f64])> {
    let mut first = 0;
    model
        .bodies
        .iter()
        .enumerate()
        .filter_map(move |(number, body)| {
            let own = first..first + body.block.state_len() * body.block.elements();
            first = own.end;
            match &body.block {
                Block::H8(block) => Some((number, body, block, &state.elements[own])),
                _ => None,
            }
        })
}

/// The bodies that have squeezed elements which give way in a shape that the plain brick resists, and where one of them is.
pub(super) fn lost(model: &Model, state: &State) -> Vec<(usize, Vec3)> {
    // Linear elements are as stiff as they were at the start, and have no states.
    if model.small.is_some() {
        return Vec::new();
    }
    let found = h8_bodies(model, state).filter_map(|(number, body, block, states)| {
        let len = block.state_len();
        let mut squeezed: Vec<(f64, usize)> = (0..block.elements())
            .map(|e| (shortened(body, &state.u, e), e))
            .filter(|(part, e)| len > 0 && *part > worth_a_look(body, *e))
            .collect();
        squeezed.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        squeezed.truncate(LOOKED_INTO);
        let gives = |e: usize| {
            let u = body.displacements(block, e, &state.u);
            // One that cannot be evaluated holds nothing either.
            (block.loses_hold(e, &u, &states[e * len..][..len])).unwrap_or(true)
        };
        let (_, e) = squeezed.into_iter().find(|(_, e)| gives(*e))?;
        Some((number, middle(body, block, e)))
    });
    found.collect()
}

/// Elements whose material does not feel how far they are pressed.
pub(super) struct Unfelt {
    /// The body.
    pub body: usize,
    /// It goes to and fro from layer to layer: elements that bend too little may stand in for these.
    pub layered: bool,
    /// Middle of the one that is farthest from it, before anything moved.
    pub at: Vec3,
    /// Part of its volume that it has lost between its corners, and of which its strains know.
    pub lost: [f64; 2],
}

/// The bodies with such elements. Assumed shear strains leave out that nodes go to and fro from layer to layer, while the assumed
/// thickness strains count the longer way between them: elements then keep the volume that their material resists, and lose the
/// one that they have. What is bent round a radius of few elements shows the same, but less of it.
pub(super) fn unfelt(model: &Model, state: &State) -> Vec<Unfelt> {
    // What is linear in displacements says nothing of volumes.
    if model.small.is_some() {
        return Vec::new();
    }
    let enhanced = h8_bodies(model, state).filter(|(_, _, block, _)| block.alpha_len() > 0);
    let found = enhanced.filter_map(|(number, body, block, states)| {
        let len = block.state_len();
        let lost = |e: usize| {
            let u = body.displacements(block, e, &state.u);
            let (before, now) = (block.volume(e), block.volume_between(e, &u));
            if now >= (1.0 - UNFELT) * before {
                return None;
            }
            // One that cannot be evaluated fails where it is assembled.
            let felt = (block.volume_felt(e, &u, &states[e * len..][..len])).ok()?;
            let lost = [now, felt].map(|v| 1.0 - v / before);
            (now < (1.0 - UNFELT) * felt).then_some((now / felt, lost, e))
        };
        let elements = (0..block.elements()).into_par_iter().with_min_len(256);
        let mut worst: Vec<_> = elements.filter_map(lost).collect();
        worst.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let least = worst.first()?.0;
        let columns = ThicknessColumns::new(&body.mesh);
        let position = |n: u32| model.position((body.first_node + n) as usize, &state.u);
        let layered =
            (worst.iter()).find(|(.., e)| goes_to_and_fro(&block.nodes_of(*e), &columns, position));
        let bent = worst.first().filter(|_| least < 1.0 - UNFELT_SHELL);
        let (_, lost, e) = layered.or(bent)?;
        Some(Unfelt {
            body: number,
            layered: layered.is_some(),
            at: middle(body, block, *e),
            lost: *lost,
        })
    });
    found.collect()
}

/// Middle of an element before anything moved.
fn middle(body: &BodyModel, block: &H8Block, e: usize) -> Vec3 {
    let nodes = block.nodes_of(e).map(|n| body.mesh.nodes[n as usize]);
    nodes.iter().sum::<Vec3>() / 8.0
}

/// Whether the edges of an element along the thickness turn against each other one way, and those that go on from them in the next
/// layer the other way. What is bent turns the same way in all of its layers.
fn goes_to_and_fro(
    nodes: &[u32; 8],
    columns: &ThicknessColumns,
    position: impl Fn(u32) -> Vec3,
) -> bool {
    let way = |[from, to]: [u32; 2]| (position(to) - position(from)).try_normalize(0.0);
    let own: [_; 4] = std::array::from_fn(|a| way([nodes[a], nodes[a + 4]]));
    let above = std::array::from_fn(|a| {
        let [up, _] = columns.neighbours(nodes[a + 4]);
        way([nodes[a + 4], up?])
    });
    let below = std::array::from_fn(|a| {
        let [_, down] = columns.neighbours(nodes[a]);
        way([down?, nodes[a]])
    });
    let against = |next: &[Option<Vec3>; 4], a: usize, b: usize| {
        let along = (position(nodes[a]) - position(nodes[b])).try_normalize(0.0)?;
        let turn = |ways: &[Option<Vec3>; 4]| Some((ways[a]? - ways[b]?).dot(&along));
        let (own, next) = (turn(&own)?, turn(next)?);
        Some(own.abs() > TURNS && -own * next > OTHERS * own * own)
    };
    [above, below].iter().any(|next| {
        let mut pairs = (0..4).flat_map(|a| (0..a).map(move |b| (a, b)));
        pairs.any(|(a, b)| against(next, a, b).unwrap_or(false))
    })
}
