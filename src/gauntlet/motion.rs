//! Long ways: over borders and edges, off and on, round corners, to and fro.
use super::Group;

pub const GROUP: Group = Group {
    name: "motion",
    cases: &[],
};
