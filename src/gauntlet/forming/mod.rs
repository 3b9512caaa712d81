//! Sheets that are held, drawn, bent between tools and let go.
mod bent;
mod drawn;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "forming",
    cases: &[
        Case {
            name: "holder",
            what: "a strip between a plate and a holder that a force presses on it, drawn out",
            right: "the pull is 2 mu N in every step once it slides, to 1e-6",
            run: drawn::holder,
        },
        Case {
            name: "belt",
            what: "a belt over 120 degrees of a drum that is turned under it, two thicknesses",
            right: "Euler's exponent mu beta, to .3 % where the thickness goes to nothing",
            run: drawn::belt,
        },
        Case {
            name: "stretched_cup",
            what: "a clamped sheet of metal stretched over a ball with friction, in steps and in half of them",
            right: "work = stored + plastic + rubbed; what is left falls faster than the step",
            run: drawn::cup,
        },
        Case {
            name: "matched_dies",
            what: "a strip closed in between a cylinder and a bore that leave it just its thickness",
            right: "the moment is EI / R, to .15 %; both dies press alike",
            run: bent::matched,
        },
        Case {
            name: "springback",
            what: "a strip of metal wrapped on a cylinder of ten thicknesses and released",
            right: "a beam of the bilinear law in plane strain springs back as much, to 1 %",
            run: bent::springback,
        },
        Case {
            name: "released_twice",
            what: "a strip bent between a punch and a die, released by forces and by tools that go back",
            right: "both leave the same shape, stored energy and plastic work, to 1e-6",
            run: bent::released,
        },
    ],
};
