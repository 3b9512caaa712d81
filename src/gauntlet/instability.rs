//! Equilibria that are lost, and bodies that nothing holds until they touch.
use super::Group;

pub const GROUP: Group = Group {
    name: "instability",
    cases: &[],
};
