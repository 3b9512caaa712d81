//! Elements at the edge of what they can follow.
use super::Group;

pub const GROUP: Group = Group {
    name: "elements",
    cases: &[],
};
