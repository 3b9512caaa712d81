//! Which side of a surface is its outside, and why that cannot be told, in words.
use super::super::error::text;
use super::ModelError;
use super::surfaces::LISTED;
use crate::model::surface::SurfaceSet;
use covact_geometry::Vec3;
use covact_geometry::project::{ComponentSide, SideError, SideOutcome};

/// Part of the slave's element size within which its points say nothing where others do: chords of its faces cut a curved surface,
/// and what lies flush on a surface is on either side of it by rounding.
pub(super) const NEAR: f64 = 0.1;

/// Chooses the side of every component of a surface by the points that are clear of it, by the middles of the elements behind the
/// slave's faces where they do not decide, and by the points near it where nothing else does.
///
/// # Errors
/// Points that contradict each other, where elements do so too.
pub(super) fn vote(
    set: &mut SurfaceSet,
    [clear, centers, near]: [&[Vec3]; 3],
) -> Result<Vec<ComponentSide>, SideError> {
    let first = set.orient_towards(clear);
    if let Ok(found) = &first
        && !found.iter().any(undecided)
    {
        return first;
    }
    let mut found = match first {
        Ok(found) => {
            let second = with(set, found.clone(), centers);
            second.unwrap_or(found)
        }
        Err(contradiction) => set.orient_towards(centers).map_err(|_| contradiction)?,
    };
    if found.iter().any(undecided)
        && let Ok(third) = with(set, found.clone(), near)
    {
        found = third;
    }
    Ok(found)
}

/// What is `decided`, and the sides of the rest of the components by other points.
fn with(
    set: &mut SurfaceSet,
    decided: Vec<ComponentSide>,
    points: &[Vec3],
) -> Result<Vec<ComponentSide>, SideError> {
    let sides = set.sides().to_vec();
    let mut found = set.orient_towards(points)?;
    for (now, before) in found.iter_mut().zip(decided) {
        if !undecided(&before) {
            let patch = set.components()[before.component][0];
            set.set_component_side(before.component, sides[patch]);
            *now = before;
        }
    }
    Ok(found)
}

pub(super) fn undecided(found: &ComponentSide) -> bool {
    matches!(found.outcome, SideOutcome::Undecided { .. })
}

/// The slave starts on both sides of a part.
pub(super) fn both_sides(name: &str, labels: &[String], error: &SideError) -> ModelError {
    let SideError::BothSides {
        patch,
        front,
        back,
        patches,
    } = error;
    let label = |patch: &usize| labels.get(*patch).map_or("?", String::as_str);
    let mut among: Vec<&str> = patches.iter().take(LISTED).map(label).collect();
    if patches.len() > LISTED {
        among.push("...");
    }
    let part = match patches.len() {
        1 => String::new(),
        n => format!(
            ", which belongs to a part of {n} patches ({})",
            among.join(", ")
        ),
    };
    let message = format!(
        "the outside of surface `{name}` is not clear: the slave starts on both sides of {}{part}: {front} point(s) on \
         one side, {back} on the other",
        label(patch)
    );
    text(format!("/surfaces/{name}/side"), message).help(
        "move the surface clear of the body with `placement`, or say `side`: `outward`, `inward`, `as_given`, `reversed` \
         or `{\"point\": [x, y, z]}`",
    )
}

#[cfg(test)]
mod tests {
    use crate::model::build::build;
    use crate::scene;
    use serde_json::json;

    /// A strap that lies flush on a pin: its nodes are on the pin but for rounding, its faces cut it, and only the elements behind
    /// them tell the side. The same with a strap inside of a bore, and a little away from both.
    #[test]
    fn faces_that_lie_on_a_surface_leave_its_side_to_their_elements() {
        for (faces, inside, right) in [("inner", 0.5, "outward"), ("outer", -0.5, "inward")] {
            for (elements, away) in [(8, 0.0), (40, 0.0), (8, 0.01), (8, -0.01)] {
                for points in [json!("nodes"), json!({ "gauss": 2 })] {
                    let sides = |side: &str| {
                        let scene = json!({
                            "covact": 1,
                            "materials": { "m": { "st_venant_kirchhoff": { "E": 1e3, "nu": 0.3 } } },
                            "bodies": { "strap": {
                                "mesh": { "cylinder_panel": {
                                    "radius": 10.0 + inside, "thickness": 1, "angles": [-90, 90], "y": [0, 2],
                                    "elements": [elements, 1]
                                } },
                                "material": "m"
                            } },
                            "surfaces": { "pin": {
                                "cylinder": {
                                    "radius": 10.0 - 2.0 * inside * away, "length": 4, "center": [0, 1, 0], "axis": [0, 1, 0]
                                },
                                "side": side
                            } },
                            "contacts": { "c": { "slave": format!("strap.{faces}"), "master": "pin", "points": points } },
                            "supports": { "held": { "on": "strap.phi_min", "fixed": true } }
                        });
                        let loaded = scene::parse(&scene.to_string(), "scene.json")
                            .unwrap_or_else(|e| panic!("{e}"));
                        let model = build(&loaded).unwrap_or_else(|e| panic!("{e}"));
                        model.surfaces[0].set.sides().to_vec()
                    };
                    assert_eq!(sides("auto"), sides(right), "{faces} {elements} {away}");
                }
            }
        }
    }
}
