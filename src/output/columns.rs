//! The columns of the history table: their names, units and meanings.

/// What a column of `history.csv` holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColumnDoc {
    /// Name; `<name>` stands for a surface, support, body or contact pair, `<axis>` for x, y or z.
    pub pattern: &'static str,
    /// Unit in terms of the scene's units.
    pub unit: &'static str,
    /// What the number is.
    pub meaning: &'static str,
}

const fn doc(pattern: &'static str, unit: &'static str, meaning: &'static str) -> ColumnDoc {
    ColumnDoc {
        pattern,
        unit,
        meaning,
    }
}

/// Every column a history may have. Names are stable: columns are added, never renamed.
pub const COLUMNS: &[ColumnDoc] = &[
    doc("step", "-", "number of the accepted step, from 1"),
    doc("time", "time", "time at the end of the step"),
    doc("dt", "time", "length of the step"),
    doc(
        "iterations",
        "-",
        "Newton iterations of the accepted attempt",
    ),
    doc(
        "iterations.failed",
        "-",
        "Newton iterations of the step's attempts that failed before: other starts, and longer steps that were cut",
    ),
    doc(
        "cuts",
        "-",
        "attempts of this step that failed and were rolled back",
    ),
    doc(
        "residual",
        "-",
        "residual of the last iteration, relative to the largest force",
    ),
    doc(
        "force.<name>.<axis>",
        "force",
        "total force that a rigid surface, or a support, exerts on the bodies",
    ),
    doc(
        "moment.<name>.<axis>",
        "force length",
        "moment of that force about the origin of the scene",
    ),
    doc(
        "displacement.<name>.<axis>",
        "length",
        "free displacement of a surface driven by force, on top of its prescribed motion",
    ),
    doc(
        "rotation.<name>.<axis>",
        "degree",
        "rotation vector of its free rotation about its centre",
    ),
    doc(
        "force_balance.<name>.<axis>",
        "force",
        "its driving force less the force it exerts: nothing where it is free, what its guide takes elsewhere",
    ),
    doc(
        "moment_balance.<name>.<axis>",
        "force length",
        "the same of moments about its present centre (of two free rotations to second order of the angles)",
    ),
    doc(
        "slave.force.<name>.<axis>",
        "force",
        "total force on the slave faces of a contact pair whose master is a body",
    ),
    doc(
        "slave.moment.<name>.<axis>",
        "force length",
        "moment of that force about the origin of the scene",
    ),
    doc(
        "master.force.<name>.<axis>",
        "force",
        "total force on the master faces of such a pair",
    ),
    doc(
        "master.moment.<name>.<axis>",
        "force length",
        "moment of that force about the origin of the scene",
    ),
    doc(
        "imbalance.force.<name>",
        "force",
        "length of the sum of the forces on both sides of such a pair",
    ),
    doc(
        "imbalance.moment.<name>",
        "force length",
        "length of the sum of the moments on both sides of such a pair",
    ),
    doc("energy.internal", "energy", "strain energy of all bodies"),
    doc(
        "energy.contact",
        "energy",
        "energy stored in the contact penalties",
    ),
    doc(
        "augmentations",
        "-",
        "times in the step that tractions became multipliers; only with augmentation",
    ),
    doc(
        "energy.friction",
        "energy",
        "energy stored in the tangential penalties, beside what multipliers carry; only with friction",
    ),
    doc(
        "energy.dissipated",
        "energy",
        "energy dissipated by friction since the start",
    ),
    doc(
        "points.stick",
        "-",
        "slave points that touch without sliding",
    ),
    doc("points.slip", "-", "slave points that slide"),
    doc(
        "energy.plastic",
        "energy",
        "work that plastic flow has taken since the start; only with a material that flows",
    ),
    doc(
        "energy.stabilization",
        "energy",
        "energy that the forces of the stabilisation took since the start (they may give some back); only with it",
    ),
    doc(
        "stabilization.share",
        "-",
        "forces of the stabilisation (sum of their magnitudes at nodes) relative to those of loads, supports or contacts, \
         whichever are largest",
    ),
    doc(
        "penetration.max",
        "length",
        "largest penetration of a slave point; 0 without contact",
    ),
    doc(
        "gap.min",
        "length",
        "smallest normal distance of a slave point; negative in penetration",
    ),
    doc(
        "pressure.max",
        "force/length^2",
        "largest contact pressure at a slave point",
    ),
    doc("area.contact", "length^2", "slave area in contact"),
    doc("points.active", "-", "slave points in contact"),
    doc(
        "points.changed",
        "-",
        "most slave points that switched their status in one iteration of the step",
    ),
    doc(
        "energy.external",
        "energy",
        "work of supports, loads, rigid surfaces and overclosures that are resolved, since the start (trapezoidal rule)",
    ),
    doc(
        "energy.adjusted",
        "energy",
        "energy put in since the start by what changes in contact itself: multipliers, and penalties, which take up all that a step over which they change leaves out of balance; and by elements that are pressed and take other strains for that",
    ),
    doc(
        "energy.imbalance",
        "energy",
        "external and adjusted less stored (internal, contact, friction) and dissipated energy: the error of the rule, of \
         second order in the step, or a jump of the path",
    ),
    doc(
        "energy.kinetic",
        "energy",
        "kinetic energy of all bodies; only with inertia (`solution.dynamics`)",
    ),
    doc(
        "energy.damping",
        "energy",
        "energy that damping has taken since the start; only with inertia",
    ),
    doc(
        "energy.viscosity",
        "energy",
        "the part of `energy.damping` that viscous material has taken; only with a `viscosity`",
    ),
    doc(
        "energy.integrator",
        "energy",
        "in place of `energy.imbalance` with inertia: external and adjusted less stored, dissipated, damping and what the kinetic \
         energy has grown by; what the time integration has taken of vibrations that steps do not resolve and at impacts, and \
         the error of the trapezoidal rule",
    ),
    doc(
        "way.<name>.<axis>",
        "length",
        "translation of a surface that moves: the prescribed one, and what forces drive",
    ),
    doc(
        "way.<name>.angle",
        "degree",
        "angle of its prescribed rotation",
    ),
    doc(
        "probe.<name>.<axis>",
        "length or force",
        "displacement or reaction that a probe records: mean or sum over its nodes",
    ),
    doc(
        "probe.<name>",
        "length, force or force/length^2",
        "largest displacement or reaction at the nodes of a probe, or their von Mises stress",
    ),
];

/// True when `column` is one of [`COLUMNS`].
pub fn documented(column: &str) -> bool {
    COLUMNS.iter().any(|doc| fits(doc.pattern, column))
}

/// A name may hold dots itself, so the middle is what remains between the known start and end.
fn fits(pattern: &str, column: &str) -> bool {
    let Some((head, tail)) = pattern.split_once("<name>") else {
        return pattern == column;
    };
    let Some(rest) = column.strip_prefix(head) else {
        return false;
    };
    let name = if tail == ".<axis>" {
        [".x", ".y", ".z"]
            .iter()
            .find_map(|end| rest.strip_suffix(end))
    } else {
        rest.strip_suffix(tail)
    };
    name.is_some_and(|name| !name.is_empty())
}

/// The columns as a Markdown table.
pub fn column_table() -> String {
    let mut text = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for doc in COLUMNS {
        text.push_str(&format!(
            "| `{}` | {} | {} |\n",
            doc.pattern, doc.unit, doc.meaning
        ));
    }
    text
}
