//! Why the outside of a surface cannot be told, in words.
use super::super::error::text;
use super::ModelError;
use super::surfaces::LISTED;
use covact_geometry::project::SideError;

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
