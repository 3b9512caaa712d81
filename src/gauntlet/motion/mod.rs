//! Long ways: over borders and edges, off and on, round corners, to and fro.
mod cycles;
mod turns;
mod ways;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "motion",
    cases: &[
        Case {
            name: "borders",
            what: "a pressed block drawn over a cylinder's seam, and over borders of four patches",
            right: "the same forces and energies as on one patch, to 1e-9, with friction and without",
            run: ways::borders,
        },
        Case {
            name: "open_edges",
            what: "a round body slid onto a plate over its open edge, and off over the other",
            right: "between them as if pressed there; no force and no energy left at the end",
            run: ways::open_edges,
        },
        Case {
            name: "fillet",
            what: "a shell drawn round a filleted corner",
            right: "without friction what pulls is what holds back (steady motion stores nothing)",
            run: ways::fillet,
        },
        Case {
            name: "sharp_corner",
            what: "a shell drawn round a corner of 90 degrees without fillet",
            right: "the same in the mean over two elements, and forces balance",
            run: ways::sharp_corner,
        },
        Case {
            name: "full_turn",
            what: "a cylinder turned twice in steps of 90 degrees under a pressed block",
            right: "no force changes; with friction the second turn is the first",
            run: turns::full_turn,
        },
        Case {
            name: "cam",
            what: "an eccentric cylinder turned in steps of 90, 45 and 15 degrees under a block",
            right: "the same at any step, the same as moved on a circle, and back where it began",
            run: turns::cam,
        },
        Case {
            name: "turned_together",
            what: "block and tool, pressed and sheared, turned together in steps of 60 degrees",
            right: "stresses and energies do not change, to 1e-9",
            run: turns::together,
        },
        Case {
            name: "through_in_one_step",
            what: "a ball driven deep into a sheet in steps larger than the sheet is thick",
            right: "the answer of small steps, to 1e-8",
            run: cycles::through,
        },
        Case {
            name: "mirrored_elements",
            what: "a step that throws a soft block through itself: its mirror image has no strain",
            right: "the answer of small steps, to 1e-8: no element is turned inside out",
            run: cycles::mirrored,
        },
        Case {
            name: "reversal",
            what: "a sheet pushed to and fro between two tools by its load, with friction and without",
            right: "below the mirror image of above; nothing left in between",
            run: cycles::reversal,
        },
        Case {
            name: "fifty_times",
            what: "contact closed and opened 50 times, with friction and without",
            right: "the last cycle is the first, to 1e-10",
            run: cycles::fifty_times,
        },
    ],
};
