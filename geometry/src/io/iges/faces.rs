//! What becomes of every surface entity of a file: patches, or a reason why not.

use super::super::error::Fail;
use super::super::report::{CadPatch, FaceBorder, SkipKind, Skipped, TrimReport};
use super::Model;
use super::brep::{self, Edges};
use super::bridging::{Bridging, Skip};
use super::curve;
use super::directory::Entry;
use super::drawing;
use super::groups::{Groups, Placement, refusal};
use super::labels::{label, name_of};
use super::piece::{Found, Piece, Refusal, border_of, turned};
use super::rivals::{Rival, Rivals};
use super::surfaces::{self, BasePatch, BaseSurface};
use super::tags::tags;
use super::transform::{Affine, matrix_of};
use super::trimmed::{self, describe};
use crate::io::brep::{
    Boundary, Face, GAP, Host, Stretch, Tally, add, approximation, bounds_outside, by_parameters,
    disagreement, grown, loops, widest_gap, without_parameters,
};

/// All surfaces of a file.
#[derive(Default)]
pub struct Outcome {
    pub patches: Vec<CadPatch>,
    pub skipped: Vec<Skipped>,
    pub trims: TrimReport,
}

/// Reads all surfaces, in the order of the file.
pub fn read(model: &Model, notes: &mut Vec<String>) -> Result<Outcome, Fail> {
    let mut groups = Groups::read(model, notes)?;
    let mut hidden = 0;
    let mut reader = Reader {
        model,
        edges: Edges::default(),
        out: Outcome::default(),
        bridging: Bridging::new(),
        rivals: Rivals::default(),
        notes,
    };
    for (index, entry) in model.entries.iter().enumerate() {
        if !is_surface(entry.type_number) || groups.usage[index].face.is_some() {
            continue;
        }
        let placed = groups.placements(model, index, reader.notes)?;
        let refused = refusal(model, &groups, index, &placed);
        let blanked = entry.status.blanked || placed.iter().any(|p| p.hidden_in != 0);
        hidden += usize::from(model.hidden && blanked && refused.is_none());
        reader.entity(entry, &placed, refused)?;
    }
    reader.notes.extend(drawing::external(&model.entries));
    reader.bridge()?;
    let rivals = std::mem::take(&mut reader.rivals);
    rivals.settle(&mut reader.out, model, reader.notes);
    if hidden > 0 {
        let text = format!("{hidden} hidden (blanked) surface(s) were asked for and read as well");
        reader.notes.push(text);
    }
    Ok(reader.out)
}

/// Entities that are a surface, or a solid whose boundary would be one.
fn is_surface(type_number: u32) -> bool {
    surfaces::is_base(type_number) || is_face(type_number) || is_solid(type_number)
}

/// Entities that are a part of a surface.
pub fn is_face(type_number: u32) -> bool {
    matches!(type_number, 143 | 144 | 510)
}

/// Solid primitives and what is made of them, and arrays of subfigures.
fn is_solid(type_number: u32) -> bool {
    matches!(
        type_number,
        150 | 152 | 154 | 156 | 158 | 160 | 162 | 164 | 168 | 412 | 414
    )
}

struct Reader<'a, 'n> {
    model: &'a Model<'a>,
    edges: Edges,
    out: Outcome,
    bridging: Bridging<'a>,
    rivals: Rivals,
    notes: &'n mut Vec<String>,
}

impl<'a> Reader<'a, '_> {
    /// One surface entity in all its copies.
    fn entity(
        &mut self,
        entry: &'a Entry,
        placed: &[Placement],
        refused: Option<Refusal>,
    ) -> Result<(), Fail> {
        let before = (self.notes.len(), self.out.patches.len(), self.out.trims);
        let (name, refused) = match refused {
            Some(refused) => (None, Some(refused)),
            None => self.copies(entry, placed)?,
        };
        let Some(refused) = refused else {
            return Ok(());
        };
        let skip = Skip {
            entry,
            placed: placed.to_vec(),
            name,
            refused,
        };
        // Copies that were read are kept: what refused the next one is not the boundary, which is theirs as well.
        let none_read = self.out.patches.len() == before.1;
        if skip.is_open() && none_read {
            self.notes.truncate(before.0);
            self.out.trims = before.2;
            self.bridging.open.push(skip);
        } else {
            self.out.skipped.push(skip.told());
        }
        Ok(())
    }

    /// Reads the faces again of which boundaries gave no trim, closing wider gaps now that the size of the part is known.
    fn bridge(&mut self) -> Result<(), Fail> {
        self.bridging.begin();
        for skip in std::mem::take(&mut self.bridging.open) {
            let (_, refused) = self.copies(skip.entry, &skip.placed)?;
            if refused.is_some() {
                // What was said first tells more than what is wrong with a wider tolerance.
                self.out.skipped.push(skip.told());
            }
        }
        self.out.patches.sort_by_key(|p| p.entity);
        self.out.skipped.sort_by_key(|s| s.entity);
        Ok(())
    }

    /// Reads every copy; the entity's name, and the first reason why a copy could not be read.
    fn copies(
        &mut self,
        entry: &Entry,
        placed: &[Placement],
    ) -> Result<(Option<String>, Option<Refusal>), Fail> {
        if let Err(reason) = self.model.grant.open() {
            return Ok((None, Some((SkipKind::Surface, reason))));
        }
        if is_solid(entry.type_number) {
            let reason = match entry.type_number {
                412 | 414 => "arrays of subfigures are not read",
                _ => "solids given by primitives are not read",
            };
            return Ok((None, Some((SkipKind::Unsupported, reason.to_owned()))));
        }
        let (mut name, mut refused) = (None, None);
        let all = self.model.hidden;
        for copy in placed.iter().filter(|p| all || p.hidden_in == 0) {
            let map = copy.map.after(&matrix_of(self.model, entry, self.notes)?);
            let (found, pieces, base) = match is_face(entry.type_number) {
                true => self.face(entry, &map)?,
                false => {
                    let (found, pieces) = self.whole(entry, &copy.map)?;
                    (found, pieces, entry.number)
                }
            };
            name = found;
            let pieces = match copy.turned {
                true => pieces.and_then(turned),
                false => pieces,
            };
            let pieces = pieces.and_then(|pieces| {
                let granted = pieces
                    .iter()
                    .try_for_each(|p| self.model.grant.patch(&p.patch));
                granted.map_err(|reason| (SkipKind::Surface, reason))?;
                Ok(pieces)
            });
            match pieces {
                Ok(pieces) => {
                    let whole = pieces.iter().filter(|p| p.border == FaceBorder::Natural);
                    self.bridging
                        .extend(whole.flat_map(|p| p.patch.bounds()).collect::<Vec<_>>());
                    for piece in pieces {
                        self.rivals.extend(
                            piece
                                .rival
                                .map(|rival| (entry.number, copy.instance, rival)),
                        );
                        self.out.patches.push(CadPatch {
                            patch: piece.patch,
                            entity: entry.number,
                            type_number: entry.type_number,
                            base,
                            instance: copy.instance,
                            border: piece.border,
                            name: name.clone(),
                            tags: tags(self.model, entry),
                        });
                    }
                }
                Err(reason) => {
                    refused.get_or_insert(reason);
                    // The copies differ in place only.
                    break;
                }
            }
        }
        Ok((name, refused))
    }

    /// A surface that stands alone.
    fn whole(&mut self, entry: &Entry, outer: &Affine) -> Result<(Option<String>, Found), Fail> {
        let (surface, values) =
            match curve::settle(surfaces::read(self.model, entry, outer, self.notes))? {
                Ok(read) => read,
                Err(reason) => return Ok((label(entry), Err((SkipKind::Surface, reason)))),
            };
        let name = name_of(self.model, entry, values)?;
        let pieces = match surface {
            BaseSurface::Patches(patches) => {
                self.approximated(entry, &patches);
                Ok(patches.into_iter().map(|p| Piece::whole(p.patch)).collect())
            }
            BaseSurface::Unbounded(plane) => match &plane.border {
                Some((number, border)) if *border == surfaces::Border::Outer => {
                    self.bordered(entry, *number, &plane, outer)?
                }
                _ => {
                    let reason = "has no end, and no face says which part of it is meant";
                    Err((SkipKind::Unsupported, reason.to_owned()))
                }
            },
        };
        Ok((name, pieces))
    }

    /// A plane (108) that its own closed curve bounds.
    fn bordered(
        &mut self,
        entry: &Entry,
        number: u32,
        plane: &surfaces::Unbounded,
        outer: &Affine,
    ) -> Result<Found, Fail> {
        let index =
            self.model
                .index(i64::from(number), (entry.line, 1), "the border of a plane")?;
        let curve = &self.model.entries[index];
        let map = outer.after(&matrix_of(self.model, entry, self.notes)?);
        let read = trimmed::space_parts(self.model, curve, &map, self.notes);
        let space = match curve::settle(read)? {
            Ok(space) => space,
            Err(reason) => return Ok(Err((SkipKind::Boundary, reason))),
        };
        let boundary = Boundary {
            name: describe(curve),
            stretches: vec![Stretch {
                space,
                ..Stretch::default()
            }],
        };
        let face = Face {
            base: 0,
            boundaries: vec![boundary],
            outer: true,
            values: 0,
            fault: None,
        };
        Ok(match plane.sized(&face.points()) {
            Ok(base) => self
                .bounded(entry, &base, &face, None)
                .map(|piece| vec![piece]),
            Err(reason) => Err((SkipKind::Surface, reason)),
        })
    }

    /// A face, with its name and the number of its surface.
    fn face(&mut self, entry: &Entry, map: &Affine) -> Result<(Option<String>, Found, u32), Fail> {
        let model = self.model;
        let face = match entry.type_number {
            144 => trimmed::read_144(model, entry, map, self.notes)?,
            143 => trimmed::read_143(model, entry, map, self.notes)?,
            _ => brep::read_510(model, entry, map, &mut self.edges, self.notes)?,
        };
        let base = &model.entries[face.base];
        let mut name = match name_of(self.model, entry, face.values)? {
            Some(name) => Some(name),
            None => label(base),
        };
        let refused = |kind, reason: String| Err((kind, reason));
        if let Some(reason) = &face.fault {
            return Ok((
                name,
                refused(SkipKind::Boundary, reason.clone()),
                base.number,
            ));
        }
        let on = |reason: String| format!("{}: {reason}", describe(base));
        if !surfaces::is_base(base.type_number) {
            let reason = format!("lies on {}, which is not read", describe(base));
            return Ok((name, refused(SkipKind::Unsupported, reason), base.number));
        }
        let read = curve::settle(surfaces::read(model, base, map, self.notes))?;
        let (surface, values) = match read {
            Ok(read) => read,
            Err(reason) => return Ok((name, refused(SkipKind::Surface, on(reason)), base.number)),
        };
        if name.is_none() {
            name = name_of(self.model, base, values)?;
        }
        let patches = match surface {
            BaseSurface::Patches(patches) => patches,
            BaseSurface::Unbounded(unbounded) => match unbounded.sized(&face.points()) {
                Ok(patch) => vec![patch],
                Err(reason) => {
                    return Ok((name, refused(SkipKind::Boundary, on(reason)), base.number));
                }
            },
        };
        self.approximated(base, &patches);
        let pieces = match &patches[..] {
            _ if face.boundaries.is_empty() => {
                Ok(patches.into_iter().map(|p| Piece::whole(p.patch)).collect())
            }
            [patch] => {
                let name = (entry.number != base.number).then_some(base);
                self.bounded(entry, patch, &face, name)
                    .map(|piece| vec![piece])
            }
            _ => {
                let reason = on(format!(
                    "falls into {} patches, across which its boundary is not followed",
                    patches.len()
                ));
                refused(SkipKind::Boundary, reason)
            }
        };
        Ok((name, pieces, base.number))
    }

    /// A patch with the boundaries of a face.
    fn bounded(
        &mut self,
        entry: &Entry,
        base: &BasePatch,
        face: &Face,
        surface: Option<&Entry>,
    ) -> Result<Piece, Refusal> {
        let resolution = self.model.resolution().unwrap_or(0.0);
        match face.points() {
            points if points.is_empty() => self.bridging.extend(base.patch.bounds()),
            points => self.bridging.extend(points),
        }
        let grown = grown(base, face, resolution, &self.model.grant);
        let patch = grown.as_ref().map_or(&base.patch, |g| &g.patch);
        let host = Host::new(patch, &base.parameters, resolution, &self.model.grant);
        let host = host.bridging(self.bridging.length);
        let mut tally = Tally {
            tolerance: host.agree,
            ..Tally::default()
        };
        let mut said = Vec::new();
        // A B-rep's loops do not say which of them is the outer one.
        let sort = entry.type_number != 144;
        let [curves, points] = face.extent();
        let granted = self.model.grant.boundary(curves, points);
        let made =
            granted.and_then(|()| loops(&host, &face.boundaries, sort, &mut tally, &mut said));
        let trimmed = made.and_then(|loops| {
            let gap = match tally.bridged {
                0 => GAP,
                _ => GAP.max(1.001 * widest_gap(&host, &loops)),
            };
            // Curves in the parameter plane bound what they enclose there, whichever way they run.
            let mut first = face.boundaries.iter().take(1).flat_map(|b| &b.stretches);
            let in_space = first.all(|s| s.parameter.is_empty());
            let outer = face.outer && !(in_space && bounds_outside(&host, &loops));
            let trimmed = match outer && in_space && host.is_round() {
                // A trimmed surface (144) may be bounded by loops of either direction.
                true => (patch.trimmed_by(loops.clone(), true, gap))
                    .or_else(|e| patch.trimmed_by(loops, false, gap).map_err(|_| e)),
                false => patch.trimmed_by(loops, outer, gap),
            };
            trimmed.map_err(|e| e.to_string())
        });
        if let Some(grown) = grown.as_ref().filter(|g| g.continued > 0.0) {
            let share = grown.continued;
            said.push(format!(
                "its boundary leaves the surface, which was continued by {share:.1e} of its range"
            ));
        }
        let noted = |said: Vec<String>| -> Vec<String> {
            let whole = said
                .iter()
                .map(|text| format!("{}: {text}", describe(entry)));
            whole.collect()
        };
        match trimmed {
            Ok(trimmed) => {
                if tally.bridged > 0 {
                    let (n, widest) = (tally.bridged, tally.largest_bridge);
                    said.push(format!(
                        "{n} gap(s) of up to {widest:.1e} between its boundary curves were closed"
                    ));
                }
                let border = border_of(&trimmed.patch);
                // The other face takes as much again.
                let other = tally.rejected > 0
                    && self.model.grant.boundary(curves, points).is_ok()
                    && self.model.grant.patch(patch).is_ok();
                let other = other.then(|| by_parameters(&host, face, sort));
                let rival = other.flatten().map(|(patch, other, told)| {
                    said.extend(disagreement(&trimmed.patch, &patch, host.grant));
                    Rival {
                        border: border_of(&patch),
                        patch,
                        tallies: [tally, other],
                        notes: [std::mem::take(&mut said), told].map(&noted),
                    }
                });
                // What there is to say of a face with a rival is said when one of the two is chosen.
                if rival.is_none() {
                    self.notes.extend(noted(said));
                    add(&mut self.out.trims, &tally);
                }
                Ok(Piece {
                    patch: trimmed.patch,
                    border,
                    rival,
                })
            }
            Err(reason) => {
                if let Some(face) = face.in_space()
                    && let Ok(piece) = self.bounded(entry, base, &face, surface)
                {
                    self.notes.extend(noted(vec![without_parameters(&reason)]));
                    self.out.trims.rejected += 1;
                    return Ok(piece);
                }
                self.notes.extend(noted(said));
                let on = surface.map_or(String::new(), |s| format!(" on {}", describe(s)));
                Err((SkipKind::Boundary, format!("{reason}{on}")))
            }
        }
    }

    /// Says where a surface is not what the entity defines.
    fn approximated(&mut self, entry: &Entry, patches: &[BasePatch]) {
        if let Some(text) = approximation(patches) {
            let note = format!("{}: {text}", describe(entry));
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}
