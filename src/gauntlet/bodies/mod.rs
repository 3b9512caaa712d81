//! Contact between deformable bodies, and of a body with itself.
mod blocks;
mod fits;
mod images;
mod placed;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "bodies",
    cases: &[
        Case {
            name: "every_rule",
            what: "two equal blocks pressed by 20 %: nodes, Gauss, Lobatto, segments, averaged gaps, two half passes",
            right: "one closed form of uniform compression with all of them, force and pressure to 1e-9",
            run: blocks::every_rule,
        },
        Case {
            name: "pile",
            what: "five loose plates with meshes that do not match, piled up between two planes, squeezed by 30 %",
            right: "one block on springs in series, closed form to 1e-9; forces of all five contacts equal",
            run: blocks::pile,
        },
        Case {
            name: "small_on_big",
            what: "a soft block of 6 x 6 elements inside of one face of a stiff block 40 times as wide, a ball presses it",
            right: "as on a rigid plane, to 1e-6 (the ratio of their stiffnesses)",
            run: blocks::small_on_big,
        },
        Case {
            name: "mirror_images",
            what: "two equal arches pressed on each other at their crowns, by one pass and by two half passes",
            right: "one arch on a rigid plane half way, to what the penetration leaves; two halves to 1e-4",
            run: images::arches,
        },
        Case {
            name: "folded_shut",
            what: "a ring squashed between planes until its inner side touches itself",
            right: "a quarter of it on a rigid plane of symmetry, to what the penetration leaves: 3e-5, and less as it falls",
            run: images::ring,
        },
        Case {
            name: "both_faces",
            what: "a sheet in four layers between two rollers with friction, one on each of its faces",
            right: "half of the thickness on a plane of symmetry under one roller, to 1e-10",
            run: images::sheet,
        },
        Case {
            name: "placed_elsewhere",
            what: "a block pressed and drawn over an arch by five kinds of contact, all of it turned and moved",
            right: "forces turn along, all else is the same, to 1e-9",
            run: placed::placed,
        },
        Case {
            name: "sides_exchanged",
            what: "a block drawn over an arch by two half passes with friction, slave and master exchanged",
            right: "the same in every step, to 1e-9: neither side is preferred",
            run: placed::exchanged,
        },
        Case {
            name: "shrink_fit",
            what: "two tubes with facets that do not match, with an interference that is resolved",
            right: "Lame's pressure between them to .5 %; the error falls as the mesh is refined",
            run: fits::shrunk,
        },
        Case {
            name: "line_contact",
            what: "a roller on a deep block in plane strain, strains of .3 %",
            right: "Hertz: largest pressure by the force to .5 %, half width to one element",
            run: fits::line,
        },
    ],
};
