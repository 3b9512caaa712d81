//! Plastic flow: uniform states in closed form, and descriptions of one material that must agree.
mod flow;
mod hill;
mod tube;

pub use flow::{metal, sheet};

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "metal",
    cases: &[
        Case {
            name: "upset",
            what: "a cube of metal upset between planes by 30 %, three elements",
            right: "closed form: Kirchhoff's stress follows the hardening, force and plastic work",
            run: flow::upset,
        },
        Case {
            name: "any_step",
            what: "the cube upset by 10 % in one step, in four and in twenty",
            right: "the same force to 1e-9: the way is straight in logarithmic strains",
            run: flow::any_step,
        },
        Case {
            name: "let_go_and_reloaded",
            what: "the cube upset, let go until the contact opens, and upset further",
            right: "back at the same strain the same force; at the end as without the pause; Hooke's way back",
            run: flow::reloaded,
        },
        Case {
            name: "one_curve",
            what: "a ball pressed into a clamped sheet; one hardening curve as line, as table, as power law",
            right: "the same force, energies and plastic work, to 1e-9",
            run: flow::one_curve,
        },
        Case {
            name: "other_units",
            what: "the ball, the sheet and friction in units of length and force of their own",
            right: "the same numbers after scaling, to 1e-9",
            run: flow::units,
        },
        Case {
            name: "swings",
            what: "a bar of Armstrong and Frederick's metal stretched and pressed by 2 % six times",
            right: "the settled stress is yield stress + C / g tanh(g dp / 2), to 1e-9",
            run: flow::swings,
        },
        Case {
            name: "hill_of_mises",
            what: "the ball and the sheet with Hill's law whose r-values are all one",
            right: "as von Mises' law, to 1e-9",
            run: hill::mises,
        },
        Case {
            name: "rolled_across",
            what: "an oblong sheet of rolled steel under the ball; the sheet turned by 90 degrees with its rolling direction",
            right: "the same with x and y exchanged, to 1e-9; across the rolling direction it is another",
            run: hill::across,
        },
        Case {
            name: "strips",
            what: "strips of rolled steel cut at 0, 45 and 90 degrees, stretched by .1 %",
            right: "width strain over thickness strain is the r-value, to 2e-5 (elastic strains are 1e-5 of it)",
            run: hill::strips,
        },
        Case {
            name: "thick_tube",
            what: "a tube of perfect plasticity under inner pressure, plastic half way through",
            right: "Hill's expansion of its outer side, to .6 %, of second order in the mesh",
            run: tube::expanded,
        },
    ],
};
