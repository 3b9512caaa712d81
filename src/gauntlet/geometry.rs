//! Surfaces as hard as CAD files hold them: poles, seams, creases, slivers, trims.
use super::Group;

pub const GROUP: Group = Group {
    name: "geometry",
    cases: &[],
};
