//! The course of a run: stages, the order of loads, runs that are stopped and continued, solvers, small displacements.
mod small;
mod ways;

use super::{Case, Group};

pub const GROUP: Group = Group {
    name: "stages",
    cases: &[
        Case {
            name: "as_tables",
            what: "two tools with friction and a pressure, moved by three stages; the same by tables over time",
            right: "the same in every step, to 1e-9",
            run: ways::tables,
        },
        Case {
            name: "either_order",
            what: "a ball and a cylinder pressed into rubber, one after the other, the other way round, and at once",
            right: "the same state at the end, to 1e-9: without friction the way does not matter",
            run: ways::order,
        },
        Case {
            name: "continued",
            what: "runs with friction, metal, multipliers, and with inertia, stopped half way and continued",
            right: "the history of runs that are not stopped, to the last bit",
            run: ways::continued,
        },
        Case {
            name: "solvers",
            what: "a ball in rubber with Cholesky's, LDL^T and LU factorization",
            right: "the same iterations; forces and energy to 1e-9",
            run: ways::solvers,
        },
        Case {
            name: "small_limit",
            what: "a fixed block pressed by a plane with small displacements and with large ones, three depths",
            right: "the difference falls as the depth, and the small ones are linear in it, to 1e-9",
            run: small::limit,
        },
        Case {
            name: "superposed",
            what: "a block pressed by a plane, a pressure on its side, and both, with small displacements",
            right: "forces add up, to 1e-9, while all of it stays in contact",
            run: small::superposed,
        },
        Case {
            name: "rigid_limit",
            what: "a block between planes with multipliers, at a penalty of its stiffness and at 100 times that",
            right: "the closed form of rigid planes with both, to 1e-6",
            run: small::multipliers,
        },
    ],
};
