//! A matrix in MUMPS: the calls of the library for one structure of values.
use super::super::MumpsFault;
use super::layout::{self, Layout};
use super::library::Api;
use super::settings::MumpsOptions;
use crate::scene::MumpsOrdering;
use std::ptr;
use tempfile::TempDir;

/// What kind of matrix it is, as MUMPS's `SYM`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Unsymmetric = 0,
    /// Pivots are taken as they come.
    Definite = 1,
    /// With pivots of one and two rows.
    Indefinite = 2,
}

/// The entries of a matrix: the upper triangle of a symmetric one.
#[derive(Debug, Default)]
pub(super) struct Entries {
    pub order: usize,
    /// Rows and columns, from one on.
    pub rows: Vec<i32>,
    pub columns: Vec<i32>,
    pub values: Vec<f64>,
    /// Place of each unknown in the order of elimination, from one on; none: MUMPS orders.
    pub places: Option<Vec<i32>>,
}

/// The structure of the library, and some room behind it.
#[repr(C, align(16))]
struct Raw([u8; layout::ROOM]);

pub(super) struct Instance {
    api: &'static Api,
    layout: &'static Layout,
    raw: Box<Raw>,
    pub entries: Entries,
    /// Where factors are that are not in memory.
    _folder: Option<TempDir>,
}

/// Numbers of the control parameters that are set, as the users' guide counts them.
mod icntl {
    /// Output: errors, diagnostics, global information and how much of it.
    pub const OUTPUT: [usize; 4] = [1, 2, 3, 4];
    pub const COLUMN_PERMUTATION: usize = 6;
    pub const ORDERING: usize = 7;
    pub const SCALING: usize = 8;
    pub const SYMMETRIC_STRATEGY: usize = 12;
    pub const RELAXATION: usize = 14;
    pub const BLOCKS: usize = 15;
    pub const THREADS: usize = 16;
    pub const OUT_OF_CORE: usize = 22;
    pub const NULL_PIVOTS: usize = 24;
    pub const DETERMINANT: usize = 33;
}

/// Percent by which work space may be larger than estimated at last: no matrix needs so much.
const MOST_RELAXATION: i32 = 2000;
/// Diagonal scaling: pivots are then in parts of the diagonal.
const DIAGONAL: i32 = 1;

impl Instance {
    /// An instance with its structure analysed.
    ///
    /// # Errors
    /// Any [`MumpsFault`]
    pub fn new(
        kind: Kind,
        entries: Entries,
        options: &MumpsOptions,
        (threads, tolerance): (usize, f64),
    ) -> Result<Self, MumpsFault> {
        let api = Api::get()?;
        let mut raw = Box::new(Raw([0; layout::ROOM]));
        let at = (&raw mut raw.0).cast::<u8>();
        // SAFETY: these fields are in all versions where the layout has them, and there is room for any of them; nothing is
        // pointed to.
        unsafe {
            write(at, layout::SYM, kind as i32);
            write(at, layout::PAR, 1i32);
            write(at, layout::COMM_FORTRAN, USE_COMM_WORLD);
            write(at, layout::JOB, Job::Start as i32);
            api.call(at.cast());
        }
        let layout = match layout::of(&raw.0) {
            Ok(layout) => layout,
            Err(found) => {
                let at = (&raw mut raw.0).cast::<u8>();
                // SAFETY: the structure is the library's own, as it left it.
                unsafe {
                    write(at, layout::JOB, Job::End as i32);
                    api.call(at.cast());
                }
                let fault =
                    found.map_or(MumpsFault::NoVersion, |found| MumpsFault::Version { found });
                return Err(fault);
            }
        };
        let mut instance = Instance {
            api,
            layout,
            raw,
            entries,
            _folder: None,
        };
        instance.prepare(kind, options, threads, tolerance)?;
        Ok(instance)
    }

    fn prepare(
        &mut self,
        kind: Kind,
        options: &MumpsOptions,
        threads: usize,
        tolerance: f64,
    ) -> Result<(), MumpsFault> {
        self.result(Job::Start)?;
        for output in icntl::OUTPUT {
            self.control(output, 0);
        }
        // The analysis has no values to look at.
        self.control(icntl::COLUMN_PERMUTATION, 0);
        self.control(icntl::SYMMETRIC_STRATEGY, 1);
        self.control(icntl::THREADS, i32::try_from(threads).unwrap_or(0));
        match kind {
            Kind::Definite => self.control(icntl::SCALING, DIAGONAL),
            Kind::Indefinite | Kind::Unsymmetric => self.control(icntl::NULL_PIVOTS, 1),
        }
        // A threshold below zero is one of scaled values, not in parts of a norm.
        self.real_control(3, -tolerance);
        self.control(icntl::DETERMINANT, i32::from(kind == Kind::Unsymmetric));
        if let Some(folder) = &options.out_of_core {
            self.out_of_core(folder)?;
        }
        let asked = options.ordering;
        match &self.entries.places {
            Some(_) => self.control(icntl::ORDERING, GIVEN),
            None => {
                self.control(icntl::ORDERING, number(asked));
                // Three unknowns a node: the ordering sees nodes.
                self.control(icntl::BLOCKS, -3);
            }
        }
        let Entries {
            order,
            rows,
            columns,
            values,
            places,
        } = &mut self.entries;
        let (n, entries) = (*order as i32, rows.len() as i64);
        let at = (&raw mut self.raw.0).cast::<u8>();
        let places = places.as_mut().map_or(ptr::null_mut(), Vec::as_mut_ptr);
        // SAFETY: the layout is that of the library; the arrays are as long as is stated, keep their places on the heap, and live as
        // long as the instance.
        unsafe {
            write(at, layout::N, n);
            write(at, layout::NNZ, entries);
            write(at, layout::IRN, rows.as_mut_ptr());
            write(at, layout::JCN, columns.as_mut_ptr());
            write(at, layout::A, values.as_mut_ptr());
            write(at, layout::PERM_IN, places);
        }
        self.call(Job::Analysis)?;
        if self.entries.places.is_none() && self.infog(7) != number(asked) {
            let asked = asked.name();
            return Err(MumpsFault::NoOrdering { asked });
        }
        Ok(())
    }

    fn out_of_core(&mut self, folder: &std::path::Path) -> Result<(), MumpsFault> {
        let folder = tempfile::Builder::new()
            .prefix("covact-factors-")
            .tempdir_in(folder)
            .map_err(|e| MumpsFault::Folder { kind: e.kind() })?;
        let name = folder.path().as_os_str().as_encoded_bytes();
        let most = self.layout.folder - 1;
        if name.len() > most {
            return Err(MumpsFault::LongFolder { most });
        }
        let field = &mut self.raw.0[self.layout.ooc_tmpdir..][..self.layout.folder];
        field.fill(0);
        field[..name.len()].copy_from_slice(name);
        self._folder = Some(folder);
        self.control(icntl::OUT_OF_CORE, 1);
        Ok(())
    }

    /// Factorizes the matrix of the values in `entries`.
    ///
    /// # Errors
    /// [`MumpsFault::Code`]
    pub fn factorize(&mut self) -> Result<(), MumpsFault> {
        loop {
            let made = self.call(Job::Factorization);
            let Err(MumpsFault::Code { code, .. }) = made else {
                return made;
            };
            // Pivots that were put off need more room than the analysis could know of.
            let relaxation = self.integer(layout::ICNTL, icntl::RELAXATION);
            if !matches!(code, -8 | -9 | -17 | -20) || relaxation >= MOST_RELAXATION {
                return made;
            }
            self.control(icntl::RELAXATION, (2 * relaxation).max(40));
        }
    }

    /// Overwrites a right-hand side with the solution.
    ///
    /// # Errors
    /// [`MumpsFault::Code`]
    pub fn solve(&mut self, x: &mut [f64]) -> Result<(), MumpsFault> {
        let n = self.entries.order;
        assert_eq!(x.len(), n);
        let at = (&raw mut self.raw.0).cast::<u8>();
        // SAFETY: the layout is that of the library, and the right-hand side is as long as is stated.
        unsafe {
            write(at, self.layout.nrhs, 1i32);
            write(at, self.layout.lrhs, n as i32);
            write(at, self.layout.rhs, x.as_mut_ptr());
        }
        let solved = self.call(Job::Solution);
        let at = (&raw mut self.raw.0).cast::<u8>();
        // SAFETY: as above. The right-hand side is not the instance's.
        unsafe { write(at, self.layout.rhs, ptr::null_mut::<f64>()) };
        solved
    }

    /// Number of negative pivots; none where the matrix is unsymmetric.
    pub fn negative_pivots(&self) -> usize {
        self.infog(12).max(0) as usize
    }

    /// An unknown that nothing is left of when its turn comes.
    pub fn null_pivot(&self) -> Option<usize> {
        if self.infog(28) <= 0 {
            return None;
        }
        // SAFETY: the layout is that of the library, which points to as many numbers as it says there are.
        let number = unsafe {
            let list: *const i32 = self
                .raw
                .0
                .as_ptr()
                .add(self.layout.pivnul_list)
                .cast::<*const i32>()
                .read();
            if list.is_null() { 0 } else { list.read() }
        };
        usize::try_from(number - 1).ok()
    }

    /// The smallest pivot of the scaled matrix.
    pub fn smallest_pivot(&self) -> f64 {
        self.rinfog(19)
    }

    pub fn is_determinant_negative(&self) -> bool {
        self.rinfog(12) < 0.0
    }

    /// Operations and entries of the factors that the analysis expects.
    pub fn cost(&self) -> (f64, u64) {
        let entries = i64::from(self.infog(20));
        let entries = if entries < 0 {
            -1_000_000 * entries
        } else {
            entries
        };
        (self.rinfog(1), entries.unsigned_abs())
    }

    /// Bytes that the analysis expects a factorization to take.
    pub fn memory(&self) -> u64 {
        let out_of_core = self.integer(layout::ICNTL, icntl::OUT_OF_CORE) > 0;
        let megabytes = self.infog(if out_of_core { 27 } else { 17 });
        1_000_000 * u64::from(megabytes.max(0).unsigned_abs())
    }

    /// The entries, once the instance has come to its end.
    pub fn into_entries(mut self) -> Entries {
        std::mem::take(&mut self.entries)
    }

    fn call(&mut self, job: Job) -> Result<(), MumpsFault> {
        let at = (&raw mut self.raw.0).cast::<u8>();
        // SAFETY: the structure is an instance's, with arrays of the lengths that are stated.
        unsafe {
            write(at, layout::JOB, job as i32);
            self.api.call(at.cast());
        }
        self.result(job)
    }

    fn result(&self, job: Job) -> Result<(), MumpsFault> {
        let (code, detail) = (self.infog(1), self.infog(2));
        match code {
            // Above zero are warnings: what they are of is looked at where it matters.
            0.. => Ok(()),
            _ => Err(MumpsFault::Code {
                phase: job.name(),
                code,
                detail,
            }),
        }
    }

    fn control(&mut self, number: usize, value: i32) {
        let at = layout::ICNTL + 4 * (number - 1);
        self.raw.0[at..at + 4].copy_from_slice(&value.to_ne_bytes());
    }

    fn real_control(&mut self, number: usize, value: f64) {
        let at = layout::CNTL + 8 * (number - 1);
        self.raw.0[at..at + 8].copy_from_slice(&value.to_ne_bytes());
    }

    /// An entry of an array of integers, counted from one.
    fn integer(&self, array: usize, number: usize) -> i32 {
        let mut bytes = [0; 4];
        bytes.copy_from_slice(&self.raw.0[array + 4 * (number - 1)..][..4]);
        i32::from_ne_bytes(bytes)
    }

    fn infog(&self, number: usize) -> i32 {
        self.integer(self.layout.infog, number)
    }

    fn rinfog(&self, number: usize) -> f64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&self.raw.0[self.layout.rinfog + 8 * (number - 1)..][..8]);
        f64::from_ne_bytes(bytes)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // What the library could not free it cannot be told again.
        let _ = self.call(Job::End);
    }
}

// SAFETY: the library allows one call at a time, from any thread, which `Api::call` sees to; the arrays are the instance's own.
unsafe impl Send for Instance {}

/// Stands for all processes in `comm_fortran`.
const USE_COMM_WORLD: i32 = -987_654;
/// Number of the ordering that is given.
const GIVEN: i32 = 1;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Job {
    Start = -1,
    End = -2,
    Analysis = 1,
    Factorization = 2,
    Solution = 3,
}

impl Job {
    fn name(self) -> &'static str {
        match self {
            Job::Start => "start",
            Job::End => "end",
            Job::Analysis => "analysis",
            Job::Factorization => "factorization",
            Job::Solution => "solution",
        }
    }
}

/// MUMPS's `ICNTL(7)`.
fn number(ordering: MumpsOrdering) -> i32 {
    match ordering {
        MumpsOrdering::Amd => 0,
        MumpsOrdering::Amf => 2,
        MumpsOrdering::Scotch => 3,
        MumpsOrdering::Pord => 4,
        MumpsOrdering::Metis => 5,
        MumpsOrdering::Qamd => 6,
        MumpsOrdering::Auto => 7,
    }
}

/// # Safety
/// There are `offset` bytes and a value of the type behind `at`.
unsafe fn write<T>(at: *mut u8, offset: usize, value: T) {
    // SAFETY: as the caller says; no field need be aligned.
    unsafe { at.add(offset).cast::<T>().write_unaligned(value) }
}
