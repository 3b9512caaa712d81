//! Pressure, weight, and forces past a limit point.
mod pressure;
mod truss;
mod weight;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "loads",
    cases: &[
        Case {
            name: "hydrostatic",
            what: "a curved block under pressure on all of its faces that follows them, three elements",
            right: "it shrinks alike, closed form to 1e-9, and nothing holds it; h8 of second order",
            run: pressure::hydrostatic,
        },
        Case {
            name: "balloon",
            what: "a thick tube of rubber blown up by half of its bore by pressure that follows, two meshes",
            right: "the integral over an incompressible neo-Hooke tube, to .4 %, of second order",
            run: pressure::balloon,
        },
        Case {
            name: "column",
            what: "a soft column on a floor under its own weight, shortened by a twentieth, two meshes",
            right: "the floor bears the weight; height and energy of the bar in closed form, of second order",
            run: weight::column,
        },
        Case {
            name: "lifted_strip",
            what: "a heavy strip on a floor lifted at its end",
            right: "force q L / 2 with L^4 = 24 EI d / q (a beam that peels off), to .3 %",
            run: weight::lifted,
        },
        Case {
            name: "catenary",
            what: "a thin strip hung up by both ends, half as deep as wide, two meshes",
            right: "elastic catenary: sag to .02 %, tension to .04 %",
            run: weight::catenary,
        },
        Case {
            name: "truss",
            what: "a shallow truss of two bars pushed through by its crown",
            right: "von Mises' truss in closed form in every step, up, down and through zero, to 1e-8",
            run: truss::pushed,
        },
        Case {
            name: "truss_snaps",
            what: "that truss under a force beyond its limit point",
            right: "it jumps at the limit force, and to the other branch of the closed form, to 1e-5",
            run: truss::snaps,
        },
    ],
};
