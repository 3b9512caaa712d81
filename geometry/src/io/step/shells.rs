//! Shells, solids and models as lists of faces.

use super::entity::Told;
use super::scope::Scope;

/// A face of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// A FACE, a CURVE_BOUNDED_SURFACE, or a surface that stands alone.
    pub index: u32,
    /// The body has the other side of the face.
    pub turned: bool,
    /// The shell or set that holds it, the body itself where there is none.
    pub shell: u32,
}

/// What an item of a representation is.
pub enum Found {
    /// A solid or a sheet, and which of both.
    Body(Vec<Member>, bool),
    /// Nothing that has faces.
    Nothing,
    /// Something that has faces, but is not read.
    Unread,
}

/// Types whose names begin or end so have no faces of their own.
const FACELESS: [&str; 20] = [
    "PLACEMENT",
    "POINT",
    "CURVE",
    "GEOMETRIC_CURVE_SET",
    "DIRECTION",
    "VECTOR",
    "VERTEX",
    "EDGE",
    "PATH",
    "LOOP",
    "WIREFRAME_MODEL",
    "REPRESENTATION_ITEM",
    "STYLED_ITEM",
    "ANNOTATION",
    "CAMERA",
    "TEXT",
    "CALLOUT",
    "OCCURRENCE",
    "CARTESIAN_TRANSFORMATION_OPERATOR",
    "AXIS",
];

/// The faces of an item of a representation.
pub fn faces(scope: &Scope, index: u32) -> Told<Found> {
    let entity = scope.entity(index, 0)?;
    let mut members = Vec::new();
    if entity.is("MANIFOLD_SOLID_BREP") {
        let outer = entity.reference("MANIFOLD_SOLID_BREP", 0, "the outer shell of a solid")?;
        shell(scope, outer, false, &mut members, 0)?;
        if entity.is("BREP_WITH_VOIDS") {
            for void in entity.targets("BREP_WITH_VOIDS", 0, "a void of a solid")? {
                shell(scope, void, false, &mut members, 0)?;
            }
        }
        return Ok(Found::Body(members, true));
    }
    if entity.is("SHELL_BASED_SURFACE_MODEL") {
        for one in entity.targets("SHELL_BASED_SURFACE_MODEL", 0, "a shell of a model")? {
            shell(scope, one, false, &mut members, 0)?;
        }
        return Ok(Found::Body(members, false));
    }
    if entity.is("FACE_BASED_SURFACE_MODEL") {
        for one in entity.targets("FACE_BASED_SURFACE_MODEL", 0, "a set of faces of a model")? {
            shell(scope, one, false, &mut members, 0)?;
        }
        return Ok(Found::Body(members, false));
    }
    if entity.is("CONNECTED_FACE_SET") {
        shell(scope, index, false, &mut members, 0)?;
        return Ok(Found::Body(members, false));
    }
    if entity.is("FACE") {
        face(scope, index, false, index, &mut members)?;
        return Ok(Found::Body(members, false));
    }
    if entity.is("SURFACE") {
        members.push(Member {
            index,
            turned: false,
            shell: index,
        });
        return Ok(Found::Body(members, false));
    }
    if entity.is("GEOMETRIC_SET") {
        for one in entity.targets("GEOMETRIC_SET", 0, "a member of a set")? {
            if scope.entity(one, 0)?.is("SURFACE") {
                members.push(Member {
                    index: one,
                    turned: false,
                    shell: index,
                });
            }
        }
        return Ok(match members.is_empty() {
            true => Found::Nothing,
            false => Found::Body(members, false),
        });
    }
    let faceless = FACELESS.iter().any(|kind| entity.is(kind));
    let kind = entity.kind();
    let named = |word: &str| {
        FACELESS
            .iter()
            .any(|f| word.starts_with(f) || word.ends_with(f))
    };
    Ok(match faceless || kind.split(' ').any(named) {
        true => Found::Nothing,
        false => Found::Unread,
    })
}

fn shell(
    scope: &Scope,
    index: u32,
    turned: bool,
    members: &mut Vec<Member>,
    depth: usize,
) -> Told<()> {
    let entity = scope.entity(index, depth)?;
    for kind in ["ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL"] {
        if entity.is(kind) {
            let same = entity.flag(kind, 1, "the orientation of a shell")?;
            let inner = entity.reference(kind, 0, "a shell")?;
            return shell(scope, inner, turned == same, members, depth + 1);
        }
    }
    for one in entity.targets("CONNECTED_FACE_SET", 0, "a face of a shell")? {
        face(scope, one, turned, index, members)?;
    }
    Ok(())
}

fn face(
    scope: &Scope,
    index: u32,
    mut turned: bool,
    shell: u32,
    members: &mut Vec<Member>,
) -> Told<()> {
    let (mut index, mut depth) = (index, 0);
    loop {
        let entity = scope.entity(index, depth)?;
        if !entity.is("ORIENTED_FACE") {
            members.push(Member {
                index,
                turned,
                shell,
            });
            return Ok(());
        }
        turned ^= !entity.flag("ORIENTED_FACE", 1, "the orientation of a face")?;
        index = entity.reference("ORIENTED_FACE", 0, "a face")?;
        depth += 1;
    }
}
