//! Numbers far apart: thin and thick, soft and stiff, small and large, near and far.
mod penalty;
mod scale;
mod thin;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "conditioning",
    cases: &[
        Case {
            name: "thickness",
            what: "cantilevers of t/L = .1 to 1e-4 bent by a cylinder, h8 and q18",
            right: "Timoshenko's force to 1 % (h8) and .5 % (q18), over nine decades of force",
            run: thin::thickness,
        },
        Case {
            name: "poisson",
            what: "a confined block pressed by a plane, nu from 0 to .4999, three elements",
            right: "the closed form of confined compression to 1e-9",
            run: penalty::poisson,
        },
        Case {
            name: "penalty",
            what: "a block pressed by a plane, penalty from .1 to 1e6 times the elements' stiffness",
            right: "springs in series to 1e-8; the error against the rigid answer falls as 1 / penalty",
            run: penalty::penalty,
        },
        Case {
            name: "penalty_under_ball",
            what: "a ball pressed into a block, penalty from .1 to 1e6 times the elements' stiffness",
            right: "the error against 1e6 falls as 1 / penalty; bounded iterations",
            run: penalty::under_ball,
        },
        Case {
            name: "stiffness_ratio",
            what: "two blocks in series, one 1e6 times as stiff, each as slave and as master",
            right: "bars in series, closed form to 1e-8; both roles agree",
            run: penalty::stiffness_ratio,
        },
        Case {
            name: "scale",
            what: "a ball on a clamped plate with friction, from 1e-9 to 1e6 in size, moduli 1e-18 to 1e18",
            right: "the same numbers after scaling to 1e-8, iteration for iteration",
            run: scale::scale,
        },
        Case {
            name: "far",
            what: "the same scene 1e4 plate lengths away from the origin",
            right: "the same forces to 1e-6: penetrations keep what digits the positions leave them",
            run: scale::far,
        },
        Case {
            name: "time_unit",
            what: "the same scene over 1e-9 and over 1e9 units of time",
            right: "the same forces to 1e-10, as many steps and iterations",
            run: scale::time_unit,
        },
    ],
};
