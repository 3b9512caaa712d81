//! Elements at the edge of what they can follow.
mod bent;
mod distorted;
mod squeezed;

pub use squeezed::between_planes;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "elements",
    cases: &[
        Case {
            name: "squeezed",
            what: "blocks of 1, 2 and 4 layers between plates, shortened by 40 %, free or confined sideways",
            right: "neo-Hooke's closed form, uniform, to 1e-9; q18 and h8_displacement without a negative pivot",
            run: squeezed::squeezed,
        },
        Case {
            name: "squeezed_sheet",
            what: "a sheet of elements four times as long as thick, in two layers, squeezed by 30 %",
            right: "the closed form, uniform, to 1e-9",
            run: squeezed::sheet,
        },
        Case {
            name: "distorted",
            what: "blocks whose corner Jacobian is 1e-3 of the mean, and wedges with an edge of 1e-3, pressed by 30 %",
            right: "uniform pressure and the closed form of the force to 1e-9",
            run: distorted::distorted,
        },
        Case {
            name: "inverted",
            what: "a mesh with an element turned inside out, and a block crushed within one step",
            right: "named: body, element, place and remedy; the crushed one ends without a false answer",
            run: distorted::inverted,
        },
        Case {
            name: "full_circle",
            what: "strips of t/L = 1e-3 bent until their ends meet, h8 and q18",
            right: "M = 2 pi EI / L and its work, to 1 % and 2e-4; errors fall with the square of h",
            run: bent::full_circle,
        },
        Case {
            name: "layers",
            what: "a cantilever of 1, 2 and 8 layers of h8 bent by a cylinder",
            right: "Timoshenko's force to 1 %, whatever the layers",
            run: bent::layers,
        },
    ],
};
