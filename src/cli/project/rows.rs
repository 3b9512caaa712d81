//! What `covact project` writes: a row per point.
use covact_geometry::{EdgeKind, Foot, Location, Status};
use serde::Serialize;
use std::fmt::Write;

/// First line of the table.
pub(super) const HEADER: &str =
    "entity,patch,xi1,xi2,x,y,z,signed_distance,where,number,kind,status\n";

/// Closest point of one query.
#[derive(Debug, Serialize)]
struct Row {
    /// Number of the entity in the file, and of the patch in the order of the file, from 0.
    entity: Option<u32>,
    patch: Option<u32>,
    xi1: Option<f64>,
    xi2: Option<f64>,
    x: Option<f64>,
    y: Option<f64>,
    z: Option<f64>,
    /// Positive on the outside.
    signed_distance: Option<f64>,
    /// Face, edge, corner, crease or pole.
    r#where: Option<&'static str>,
    /// Number of the edge, corner or pole; direction of the crease.
    number: Option<u32>,
    /// How the edge or corner continues: smooth, sharp or free.
    kind: Option<&'static str>,
    status: &'static str,
}

const BEYOND: Row = Row {
    entity: None,
    patch: None,
    xi1: None,
    xi2: None,
    x: None,
    y: None,
    z: None,
    signed_distance: None,
    r#where: None,
    number: None,
    kind: None,
    status: "beyond reach",
};

impl Row {
    fn new(foot: &Foot, entity: u32) -> Self {
        let kind = |kind| match kind {
            EdgeKind::Smooth => "smooth",
            EdgeKind::Sharp => "sharp",
            EdgeKind::Free => "free",
        };
        let (place, number, kind) = match foot.location {
            Location::Face => ("face", None, None),
            Location::Edge { edge, kind: k } => ("edge", Some(edge), Some(kind(k))),
            Location::Corner { corner, kind: k } => ("corner", Some(corner), Some(kind(k))),
            Location::Crease { dir } => ("crease", Some(u32::from(dir)), None),
            Location::Pole { edge } => ("pole", Some(edge), None),
        };
        let rho = foot.jet.rho;
        Row {
            entity: Some(entity),
            patch: Some(foot.patch),
            xi1: Some(foot.xi[0]),
            xi2: Some(foot.xi[1]),
            x: Some(rho.x),
            y: Some(rho.y),
            z: Some(rho.z),
            signed_distance: Some(foot.signed_distance),
            r#where: Some(place),
            number,
            kind,
            status: match foot.status {
                Status::Unique => "unique",
                Status::NonUnique => "non-unique",
                Status::NotConverged => "not converged",
            },
        }
    }

    /// Numbers are the shortest that are read back as the same.
    fn csv(&self, out: &mut String) {
        let whole = |out: &mut String, n: Option<u32>| {
            // Writing into a string cannot fail.
            let _ = n.map(|n| write!(out, "{n}"));
            out.push(',');
        };
        let text = |out: &mut String, t: Option<&str>| {
            out.push_str(t.unwrap_or(""));
            out.push(',');
        };
        whole(out, self.entity);
        whole(out, self.patch);
        let numbers = [
            self.xi1,
            self.xi2,
            self.x,
            self.y,
            self.z,
            self.signed_distance,
        ];
        for number in numbers {
            let _ = number.map(|x| write!(out, "{x:?}"));
            out.push(',');
        }
        text(out, self.r#where);
        whole(out, self.number);
        text(out, self.kind);
        out.push_str(self.status);
        out.push('\n');
    }
}

/// How many points ended how.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(super) struct Tally {
    pub unique: u64,
    pub non_unique: u64,
    pub not_converged: u64,
    pub beyond_reach: u64,
}

impl Tally {
    pub fn points(&self) -> u64 {
        self.unique + self.non_unique + self.not_converged + self.beyond_reach
    }

    pub fn add(&mut self, other: &Self) {
        self.unique += other.unique;
        self.non_unique += other.non_unique;
        self.not_converged += other.not_converged;
        self.beyond_reach += other.beyond_reach;
    }
}

/// Rows of some points, as CSV or as lines of JSON.
pub(super) fn rows(
    feet: &[Option<Foot>],
    entities: &[u32],
    json: bool,
) -> Result<(String, Tally), serde_json::Error> {
    let mut out = String::with_capacity(feet.len() * 160);
    let mut tally = Tally::default();
    for foot in feet {
        *match foot.map(|foot| foot.status) {
            Some(Status::Unique) => &mut tally.unique,
            Some(Status::NonUnique) => &mut tally.non_unique,
            Some(Status::NotConverged) => &mut tally.not_converged,
            None => &mut tally.beyond_reach,
        } += 1;
        let row = foot.map_or(BEYOND, |foot| {
            Row::new(&foot, entities[foot.patch as usize])
        });
        match json {
            true => {
                out += &serde_json::to_string(&row)?;
                out.push('\n');
            }
            false => row.csv(&mut out),
        }
    }
    Ok((out, tally))
}
