//! Sticking and sliding: limits, borders between them, what is remembered and what is not.
mod bar;
mod block;
mod free;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "friction",
    cases: &[
        Case {
            name: "mu_0_to_2",
            what: "a flat block pushed over a plane, mu = 0, 0.1, 0.5, 1 and 2",
            right: "it sticks below mu N, and then the push is mu N to 1e-12",
            run: block::coefficients,
        },
        Case {
            name: "slip_front",
            what: "a bar held by friction along its side, pulled at its end until three quarters slide",
            right: "pull and border of slip by the closed form of the bar, F^2 = 2 EA q u",
            run: bar::slip_front,
        },
        Case {
            name: "hysteresis",
            what: "that bar pushed back and pulled again",
            right: "Masing's rule; the loop closes, and its area is what was dissipated",
            run: bar::hysteresis,
        },
        Case {
            name: "wedge",
            what: "a wedge driven in by force and let go, mu just below and above the tangent of its angle",
            right: "force ratio tan(a + phi) inwards, tan(a - phi) outwards; it stays, or leaves and is named",
            run: free::wedge,
        },
        Case {
            name: "pole",
            what: "a block drawn over the pole of a sphere",
            right: "as over the sphere with the pole elsewhere, and without any, to 1e-9",
            run: block::pole,
        },
        Case {
            name: "closing_again",
            what: "a block drawn, lifted, and put down elsewhere",
            right: "from then on as one that never touched before, to 1e-10",
            run: block::closing_again,
        },
        Case {
            name: "mu_in_time",
            what: "mu up to 2, down to 0 and up to 1 while a block slides",
            right: "the push is mu(t) N at every step, to 1e-12",
            run: block::mu_in_time,
        },
        Case {
            name: "fast_turn",
            what: "a plane turned under a block by up to 30 degrees a step, and by 180, which is cut",
            right: "first order in the step; half a turn a step ends as quarter turns do",
            run: block::fast_turn,
        },
        Case {
            name: "sled",
            what: "a plate laid on a block and pushed aside, both by force, below mu N and above",
            right: "below it springs back to where it was; above, surface and contact are named",
            run: free::sled,
        },
    ],
};
