//! Where the fields of MUMPS's C structure are. It changes from version to version, and nothing but the version in it says how.
//!
//! The types follow `dmumps_c.h` of the versions that [`KNOWN`] lists, with integers of 32 bits. Only those fields are named
//! that are used; the others keep their places. Versions 5.5.1, 5.7.3 and 5.9.0 were run; of 5.3.5, 5.4.1 and 5.8.2 the headers were
//! compared.
#![allow(dead_code)]
use std::mem::offset_of;

type Pointer = *mut u8;

/// What all known versions begin with.
#[repr(C)]
struct Head {
    sym: i32,
    par: i32,
    job: i32,
    comm_fortran: i32,
    icntl: [i32; 60],
    keep: [i32; 500],
    cntl: [f64; 15],
    dkeep: [f64; 230],
    keep8: [i64; 150],
    n: i32,
    nblk: i32,
    nz_alloc: i32,
    nz: i32,
    nnz: i64,
    irn: Pointer,
    jcn: Pointer,
    a: Pointer,
    nz_loc: i32,
    nnz_loc: i64,
    distributed: [Pointer; 3],
    nelt: i32,
    elements: [Pointer; 3],
    blocks: [Pointer; 2],
    perm_in: Pointer,
    orderings: [Pointer; 2],
    scaling: [Pointer; 2],
    scaling_from_mumps: [i32; 2],
}

/// Versions 5.3 to 5.5.
#[repr(C)]
struct Version53 {
    head: Head,
    vectors: Vectors53,
    deficiency: i32,
    pivnul_list: Pointer,
    mapping: Pointer,
    size_schur: i32,
    tail: Tail53,
}

#[repr(C)]
struct Vectors53 {
    rhs: Pointer,
    other_vectors: [Pointer; 4],
    vector_indices: [Pointer; 4],
    nrhs: i32,
    lrhs: i32,
    other_sizes: [i32; 5],
    schur_sizes: [i32; 3],
    grid: [i32; 4],
    info: [i32; 80],
    infog: [i32; 80],
    rinfo: [f64; 40],
    rinfog: [f64; 40],
}

#[repr(C)]
struct Tail53 {
    schur: [Pointer; 2],
    instance_number: i32,
    wk_user: Pointer,
    version_number: [u8; 32],
    ooc_tmpdir: [u8; 256],
    ooc_prefix: [u8; 64],
    write_problem: [u8; 256],
    lwk_user: i32,
    save: [u8; 512],
    metis_options: [i32; 40],
}

/// Versions 5.7 and 5.8.
#[repr(C)]
struct Version57 {
    head: Head,
    vectors: Vectors57,
    deficiency: i32,
    pivnul_list: Pointer,
    mapping: Pointer,
    singular_values: Pointer,
    size_schur: i32,
    tail: Tail57,
}

/// Version 5.9.
#[repr(C)]
struct Version59 {
    head: Head,
    vectors: Vectors57,
    pivnul_list: Pointer,
    mapping: Pointer,
    singular_values: Pointer,
    nb_singular_values: i32,
    size_schur: i32,
    tail: Tail57,
}

#[repr(C)]
struct Vectors57 {
    local_scaling: [Pointer; 2],
    factors: [Pointer; 3],
    rhs: Pointer,
    other_vectors: [Pointer; 5],
    vector_indices: [Pointer; 6],
    nrhs: i32,
    lrhs: i32,
    other_sizes: [i32; 6],
    schur_sizes: [i32; 3],
    grid: [i32; 4],
    ld_rhsintr: i32,
    info: [i32; 80],
    infog: [i32; 80],
    rinfo: [f64; 40],
    rinfog: [f64; 40],
}

#[repr(C)]
struct Tail57 {
    schur: [Pointer; 2],
    wk_user: Pointer,
    version_number: [u8; 32],
    ooc_tmpdir: [u8; 1024],
    ooc_prefix: [u8; 256],
    write_problem: [u8; 1024],
    lwk_user: i32,
    save: [u8; 1280],
    metis_options: [i32; 40],
    instance_number: i32,
}

/// Offsets in bytes of the fields that are used.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Major and minor number of the versions that have it.
    pub versions: &'static [[u16; 2]],
    pub version_number: usize,
    pub rhs: usize,
    pub nrhs: usize,
    pub lrhs: usize,
    pub infog: usize,
    pub rinfog: usize,
    pub pivnul_list: usize,
    pub ooc_tmpdir: usize,
    /// Bytes for the name of a folder, with the zero at its end.
    pub folder: usize,
    pub size: usize,
}

pub(super) const SYM: usize = offset_of!(Head, sym);
pub(super) const PAR: usize = offset_of!(Head, par);
pub(super) const JOB: usize = offset_of!(Head, job);
pub(super) const COMM_FORTRAN: usize = offset_of!(Head, comm_fortran);
pub(super) const ICNTL: usize = offset_of!(Head, icntl);
pub(super) const CNTL: usize = offset_of!(Head, cntl);
pub(super) const N: usize = offset_of!(Head, n);
pub(super) const NNZ: usize = offset_of!(Head, nnz);
pub(super) const IRN: usize = offset_of!(Head, irn);
pub(super) const JCN: usize = offset_of!(Head, jcn);
pub(super) const A: usize = offset_of!(Head, a);
pub(super) const PERM_IN: usize = offset_of!(Head, perm_in);

macro_rules! layout {
    ($type:ty, $versions:expr, $folder:expr) => {
        Layout {
            versions: $versions,
            version_number: offset_of!($type, tail.version_number),
            rhs: offset_of!($type, vectors.rhs),
            nrhs: offset_of!($type, vectors.nrhs),
            lrhs: offset_of!($type, vectors.lrhs),
            infog: offset_of!($type, vectors.infog),
            rinfog: offset_of!($type, vectors.rinfog),
            pivnul_list: offset_of!($type, pivnul_list),
            ooc_tmpdir: offset_of!($type, tail.ooc_tmpdir),
            folder: $folder,
            size: size_of::<$type>(),
        }
    };
}

static KNOWN: [Layout; 3] = [
    layout!(Version53, &[[5, 3], [5, 4], [5, 5]], 256),
    layout!(Version57, &[[5, 7], [5, 8]], 1024),
    layout!(Version59, &[[5, 9]], 1024),
];

/// Bytes that are given to the library: more than the structure of any version takes, so that one of an unknown version
/// stays within them until its version was read.
pub(super) const ROOM: usize = 1 << 15;

/// The layout that these bytes have, which a library has filled: known by the version that is where this layout has it.
pub(super) fn of(bytes: &[u8]) -> Result<&'static Layout, Option<[u16; 3]>> {
    let at = |layout: &&Layout| {
        let version = version(bytes.get(layout.version_number..)?)?;
        (layout.versions.contains(&[version[0], version[1]])).then_some(())
    };
    if let Some(layout) = KNOWN.iter().find(|l| at(l).is_some()) {
        return Ok(layout);
    }
    let mut anywhere = (0..bytes.len()).filter(|&i| i == 0 || bytes[i - 1] == 0);
    Err(anywhere.find_map(|i| version(&bytes[i..])))
}

/// A version such as `5.5.1`, or `5.5.1c` of the consortium, at the start of a text that a zero or a blank ends.
fn version(bytes: &[u8]) -> Option<[u16; 3]> {
    let end = bytes.iter().position(|b| matches!(b, 0 | b' '))?;
    let text = std::str::from_utf8(&bytes[..end.min(30)]).ok()?;
    let mut parts = text.splitn(3, '.');
    let mut number = |last: bool| {
        let part = parts.next()?;
        let digits = match last {
            true => part.trim_end_matches(|c: char| !c.is_ascii_digit()),
            false => part,
        };
        let digits = digits.split('.').next()?;
        digits.parse().ok()
    };
    Some([number(false)?, number(false)?, number(true)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes and places that a C compiler gives to the headers of 5.3.5 (as to 5.5.1), 5.7.3 (as to 5.8.2) and 5.9.0.
    #[test]
    fn layouts_are_those_of_the_headers() {
        let expected = [
            [5600, 5672, 6048, 6688, 7016, 7072, 7104, 8360],
            [5640, 5736, 6120, 6760, 7088, 7144, 7176, 10928],
            [5640, 5736, 6120, 6760, 7080, 7136, 7168, 10920],
        ];
        for (l, expected) in KNOWN.iter().zip(expected) {
            let places = [l.rhs, l.nrhs, l.infog, l.rinfog, l.pivnul_list];
            let texts = [l.version_number, l.ooc_tmpdir, l.size];
            assert_eq!([&places[..], &texts].concat(), expected);
            assert_eq!((l.lrhs, l.size < ROOM), (l.nrhs + 4, true));
        }
        assert_eq!((ICNTL, CNTL, N, PERM_IN), (16, 2256, 5416, 5552));
    }

    #[test]
    fn only_versions_that_are_known_have_a_layout() {
        let filled = |at: usize, text: &str| {
            let mut bytes = vec![0u8; ROOM];
            bytes[at..at + text.len()].copy_from_slice(text.as_bytes());
            bytes
        };
        let [old, new, newest] = [0, 1, 2].map(|i| KNOWN[i].version_number);
        assert_eq!(of(&filled(old, "5.5.1")), Ok(&KNOWN[0]));
        assert_eq!(of(&filled(old, "5.4.1c  ")), Ok(&KNOWN[0]));
        assert_eq!(of(&filled(new, "5.8.2")), Ok(&KNOWN[1]));
        assert_eq!(of(&filled(newest, "5.9.0")), Ok(&KNOWN[2]));
        assert_eq!(of(&filled(newest, "5.8.2")), Err(Some([5, 8, 2])));
        assert_eq!(of(&filled(old, "5.2.1")), Err(Some([5, 2, 1])));
        assert_eq!(of(&filled(100, "4.10.0")), Err(Some([4, 10, 0])));
        assert_eq!(of(&filled(0, "")), Err(None));
    }
}
