//! Numbers far apart: thin and thick, soft and stiff, small and large, near and far.
use super::Group;

pub const GROUP: Group = Group {
    name: "conditioning",
    cases: &[],
};
