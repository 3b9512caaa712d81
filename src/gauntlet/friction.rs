//! Stick and slip where laws of friction break down.
use super::Group;

pub const GROUP: Group = Group {
    name: "friction",
    cases: &[],
};
